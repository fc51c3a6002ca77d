//! `sagnac_tolerance_upper`, `sagnac_tolerance_lower`: what the values of some units promise of all.

use super::numbers::{ARGUMENT_COUNT, Finish, Kept, Row, state_fields};
use datafusion::arrow::datatypes::{DataType, FieldRef};
use datafusion::common::{DataFusionError, Result, ScalarValue};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, GroupsAccumulator, Signature, Volatility};
use sagnac_core::lot::tolerance::{Promise, normal_factor};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

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

impl Tolerance {
    /// The function for one side.
    pub fn new(side: Side) -> Tolerance {
        Tolerance {
            side,
            signature: Signature::exact(vec![DataType::Float64; ARGUMENT_COUNT], Volatility::Immutable),
        }
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
        Ok(Box::new(Kept::new(self.side)))
    }

    fn groups_accumulator_supported(&self, _args: AccumulatorArgs) -> bool {
        true
    }

    fn create_groups_accumulator(&self, _args: AccumulatorArgs) -> Result<Box<dyn GroupsAccumulator>> {
        Ok(Box::new(Kept::new(self.side)))
    }

    fn state_fields(&self, _args: StateFieldsArgs) -> Result<Vec<FieldRef>> {
        Ok(state_fields())
    }
}

/// The factor of a sample of some size. It costs 1.5 ms, and a sheet of many lots asks for the same few sizes.
fn factor(size: usize, promise: Promise) -> Option<f64> {
    static KNOWN_FACTORS: Mutex<BTreeMap<[u64; 3], Option<f64>>> = Mutex::new(BTreeMap::new());
    let key = [size as u64, promise.proportion.to_bits(), promise.confidence.to_bits()];
    let known = || KNOWN_FACTORS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(factor) = known().get(&key) {
        return *factor;
    }
    let factor = normal_factor(size as f64, size as f64 - 1.0, promise);
    known().insert(key, factor);
    factor
}

impl Finish for Side {
    fn finish(&self, rows: &[Row]) -> Result<ScalarValue> {
        let Some([_, proportion, confidence]) = rows.first().copied() else {
            return Ok(ScalarValue::Float64(None));
        };
        let probability = |p: f64| p > 0.0 && p < 1.0;
        if !(probability(proportion) && probability(confidence)) {
            let text = "proportion and confidence of a tolerance bound lie between 0 and 1, such as 0.95";
            return Err(DataFusionError::Execution(text.to_owned()));
        }
        let size = rows.len() as f64;
        let mean = rows.iter().map(|[v, ..]| v).sum::<f64>() / size;
        let squares = rows.iter().map(|[v, ..]| (v - mean).powi(2)).sum::<f64>();
        let bound = factor(rows.len(), Promise { proportion, confidence }).map(|factor| {
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
        let rows: Vec<Row> = (1..=10).map(|v| [f64::from(v), 0.95, 0.95]).collect();
        let bound = |side: Side, rows: &[Row]| match side.finish(rows).unwrap() {
            ScalarValue::Float64(bound) => bound,
            other => panic!("{other}"),
        };
        let reach = 2.91096 * 3.027_650_354;
        assert!((bound(Side::Upper, &rows).unwrap() - 5.5 - reach).abs() < 1e-4);
        assert!((bound(Side::Lower, &rows).unwrap() - 5.5 + reach).abs() < 1e-4);
        assert_eq!(bound(Side::Upper, &rows[..1]), None);
        assert_eq!(bound(Side::Upper, &[]), None);
        assert!(Side::Upper.finish(&[[1.0, 1.0, 0.95]]).is_err());
    }
}
