//! `sagnac_tolerance_upper`, `sagnac_tolerance_lower`: what the values of some units promise of all.

use super::numbers::{Finish, Kept, state_fields};
use datafusion::arrow::datatypes::{DataType, FieldRef};
use datafusion::common::{DataFusionError, Result, ScalarValue};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, Signature, Volatility};
use sagnac_core::lot::tolerance::{Promise, normal_factor};

/// The side on which a bound lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Above the values.
    Upper,
    /// Below them.
    Lower,
}

/// Mean plus or less k standard deviations, with the exact factor k of a normal sample (`normal_factor`). Units scatter normally on
/// the scale of the logarithm where the quantity is a positive magnitude: give `ln(value)` there and take `exp` of the bound. Null below
/// two values.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Tolerance {
    side: Side,
    signature: Signature,
}

/// Arguments: value, proportion, confidence.
const WIDTH: usize = 3;

impl Tolerance {
    /// The function for one side.
    pub fn new(side: Side) -> Tolerance {
        Tolerance { side, signature: Signature::exact(vec![DataType::Float64; WIDTH], Volatility::Immutable) }
    }
}

impl AggregateUDFImpl for Tolerance {
    fn name(&self) -> &str {
        match self.side {
            Side::Upper => "sagnac_tolerance_upper",
            Side::Lower => "sagnac_tolerance_lower",
        }
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _arguments: &[DataType]) -> Result<DataType> {
        Ok(DataType::Float64)
    }

    fn accumulator(&self, _args: AccumulatorArgs) -> Result<Box<dyn Accumulator>> {
        Ok(Box::new(Kept::new(WIDTH, self.side)))
    }

    fn state_fields(&self, _args: StateFieldsArgs) -> Result<Vec<FieldRef>> {
        Ok(state_fields(WIDTH))
    }
}

impl Finish for Side {
    fn finish(&self, rows: &[Vec<f64>]) -> Result<ScalarValue> {
        let column = |i: usize| rows.iter().filter_map(move |row| row.get(i).copied());
        let (Some(proportion), Some(confidence)) = (column(1).next(), column(2).next()) else {
            return Ok(ScalarValue::Float64(None));
        };
        let probability = |p: f64| p > 0.0 && p < 1.0;
        if !(probability(proportion) && probability(confidence)) {
            let text = "proportion and confidence of a tolerance bound lie between 0 and 1, such as 0.95";
            return Err(DataFusionError::Execution(text.to_owned()));
        }
        let size = rows.len() as f64;
        let mean = column(0).sum::<f64>() / size;
        let squares = column(0).map(|v| (v - mean).powi(2)).sum::<f64>();
        let bound = normal_factor(size, size - 1.0, Promise { proportion, confidence }).map(|factor| {
            let reach = factor * (squares / (size - 1.0)).sqrt();
            match self {
                Side::Upper => mean + reach,
                Side::Lower => mean - reach,
            }
        });
        Ok(ScalarValue::Float64(bound))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_those_of_the_tables() {
        // Ten values 1..=10: mean 5.5, s 3.0277; 95/95 has k = 2.91096.
        let rows: Vec<Vec<f64>> = (1..=10).map(|v| vec![f64::from(v), 0.95, 0.95]).collect();
        let bound = |side: Side, rows: &[Vec<f64>]| match side.finish(rows).unwrap() {
            ScalarValue::Float64(bound) => bound,
            other => panic!("{other}"),
        };
        let reach = 2.91096 * 3.027_650_354;
        assert!((bound(Side::Upper, &rows).unwrap() - 5.5 - reach).abs() < 1e-4);
        assert!((bound(Side::Lower, &rows).unwrap() - 5.5 + reach).abs() < 1e-4);
        assert_eq!(bound(Side::Upper, &rows[..1]), None);
        assert_eq!(bound(Side::Upper, &[]), None);
        assert!(Side::Upper.finish(&[vec![1.0, 1.0, 0.95]]).is_err());
    }
}
