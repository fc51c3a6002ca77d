//! `sagnac_drift`: the course of a quantity of one unit.

use super::numbers::{ARGUMENT_COUNT, Finish, Kept, Row, state_fields};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Fields};
use datafusion::common::scalar::ScalarStructBuilder;
use datafusion::common::{Result, ScalarValue};
use datafusion::logical_expr::function::{AccumulatorArgs, StateFieldsArgs};
use datafusion::logical_expr::{Accumulator, AggregateUDFImpl, GroupsAccumulator, Signature, Volatility};
use sagnac_core::lot::control_chart::Measured;
use sagnac_core::lot::drift::drift;
use std::sync::Arc;

/// `sagnac_drift(time, value, standard_uncertainty)`: a struct of the last value less the first with the half width of its 95 % interval,
/// the slope per unit of the time with its own, the probability of such differences if the unit did not change, and the number of
/// values. Null below two values. It is what `sagnac history` computes for a unit, where tests share no uncertainty.
#[derive(Debug, PartialEq, Eq, Hash)]
pub struct Drift {
    signature: Signature,
}

impl Drift {
    /// The function.
    pub fn new() -> Drift {
        Drift { signature: Signature::exact(vec![DataType::Float64; ARGUMENT_COUNT], Volatility::Immutable) }
    }
}

impl Default for Drift {
    fn default() -> Drift {
        Drift::new()
    }
}

const FIELD_NAMES: [&str; 6] =
    ["change", "change_half_width", "slope", "slope_half_width", "steady_probability", "count"];

fn fields() -> Fields {
    FIELD_NAMES.iter().map(|name| Field::new(*name, DataType::Float64, true)).collect()
}

impl AggregateUDFImpl for Drift {
    fn name(&self) -> &str {
        "sagnac_drift"
    }

    fn signature(&self) -> &Signature {
        &self.signature
    }

    fn return_type(&self, _arguments: &[DataType]) -> Result<DataType> {
        Ok(DataType::Struct(fields()))
    }

    fn accumulator(&self, _args: AccumulatorArgs) -> Result<Box<dyn Accumulator>> {
        Ok(Box::new(Kept::new(Course)))
    }

    fn groups_accumulator_supported(&self, _args: AccumulatorArgs) -> bool {
        true
    }

    fn create_groups_accumulator(&self, _args: AccumulatorArgs) -> Result<Box<dyn GroupsAccumulator>> {
        Ok(Box::new(Kept::new(Course)))
    }

    fn state_fields(&self, _args: StateFieldsArgs) -> Result<Vec<FieldRef>> {
        Ok(state_fields())
    }
}

#[derive(Debug)]
struct Course;

impl Finish for Course {
    fn finish(&self, rows: &[Row]) -> Result<ScalarValue> {
        let (mut times, mut values) = (vec![], vec![]);
        for [time, value, standard] in rows.iter().copied() {
            times.push(time);
            values.push(Measured { value, standard });
        }
        let Some(found) = drift(&times, &values, 0.0) else {
            return ScalarValue::try_new_null(&DataType::Struct(fields()));
        };
        let numbers = [
            Some(found.change),
            Some(found.change_half_width),
            found.slope.map(|s| s.value),
            found.slope.map(|s| s.half_width),
            found.steady_probability,
            Some(values.len() as f64),
        ];
        let mut built = ScalarStructBuilder::new();
        for (field, number) in fields().iter().zip(numbers) {
            built = built.with_scalar(Arc::clone(field), ScalarValue::Float64(number));
        }
        built.build()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use datafusion::arrow::array::AsArray;
    use datafusion::arrow::datatypes::Float64Type;

    #[test]
    fn a_line_is_found_whatever_the_order_of_its_rows() {
        let rows: [Row; 3] = [[2.0, 5.0, 0.1], [0.0, 1.0, 0.1], [1.0, 3.0, 0.1]];
        let mut kept = Kept::new(Course);
        for row in &rows {
            let columns: Vec<_> = row.iter().map(|v| ScalarValue::from(*v).to_array().unwrap()).collect();
            Accumulator::update_batch(&mut kept, &columns).unwrap();
        }
        let mut merged = Kept::new(Course);
        let state: Vec<_> =
            Accumulator::state(&mut kept).unwrap().into_iter().map(|s| s.to_array().unwrap()).collect();
        Accumulator::merge_batch(&mut merged, &state).unwrap();
        let (own, other) =
            (Accumulator::evaluate(&mut kept).unwrap(), Accumulator::evaluate(&mut merged).unwrap());
        assert_eq!(own, other);
        let ScalarValue::Struct(found) = own else { panic!("no struct") };
        let number = |i: usize| found.column(i).as_primitive::<Float64Type>().value(0);
        assert!((number(0) - 4.0).abs() < 1e-12 && (number(2) - 2.0).abs() < 1e-12);
        assert!(number(4) < 1e-12);
        assert_eq!(number(5), 3.0);
    }

    #[test]
    fn one_value_has_no_course() {
        assert!(Course.finish(&[[0.0, 1.0, 0.1]]).unwrap().is_null());
    }
}
