//! Rows of numbers that an aggregate keeps, and how they travel between machines.

use datafusion::arrow::array::{Array, ArrayRef, AsArray};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Float64Type};
use datafusion::common::{DataFusionError, Result, ScalarValue};
use datafusion::logical_expr::Accumulator;
use std::fmt::Debug;
use std::sync::Arc;

/// What is made of the rows of a group.
pub trait Finish: Debug + Send + Sync + 'static {
    /// Its value, from the rows in ascending order.
    ///
    /// # Errors
    /// When an argument cannot be used.
    fn finish(&self, rows: &[Vec<f64>]) -> Result<ScalarValue>;
}

/// Keeps the rows of a group in which every argument is a number.
#[derive(Debug)]
pub struct Kept<F: Finish> {
    width: usize,
    rows: Vec<Vec<f64>>,
    finish: F,
}

impl<F: Finish> Kept<F> {
    /// An aggregate of some arguments.
    pub fn new(width: usize, finish: F) -> Kept<F> {
        Kept { width, rows: vec![], finish }
    }

    fn add(&mut self, columns: &[ArrayRef]) -> Result<()> {
        let numbers: Vec<_> = columns.iter().filter_map(|c| c.as_primitive_opt::<Float64Type>()).collect();
        if numbers.len() != self.width {
            return Err(DataFusionError::Internal("an aggregate got no numbers".to_owned()));
        }
        for row in 0..numbers.first().map_or(0, |c| c.len()) {
            let values: Vec<f64> = numbers.iter().filter(|c| c.is_valid(row)).map(|c| c.value(row)).collect();
            if values.len() == self.width && values.iter().all(|v| v.is_finite()) {
                self.rows.push(values);
            }
        }
        Ok(())
    }
}

/// The fields of the state: a list of numbers for each argument.
pub fn state_fields(width: usize) -> Vec<FieldRef> {
    let item = Arc::new(Field::new("item", DataType::Float64, true));
    (0..width)
        .map(|i| Arc::new(Field::new(format!("numbers_{i}"), DataType::List(item.clone()), true)))
        .collect()
}

impl<F: Finish> Accumulator for Kept<F> {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<()> {
        self.add(values)
    }

    fn evaluate(&mut self) -> Result<ScalarValue> {
        self.rows.sort_by(|a, b| {
            let different = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
            different.unwrap_or(std::cmp::Ordering::Equal)
        });
        self.finish.finish(&self.rows)
    }

    fn size(&self) -> usize {
        size_of_val(self) + self.rows.capacity() * (size_of::<Vec<f64>>() + self.width * size_of::<f64>())
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>> {
        let column = |i: usize| {
            let values: Vec<ScalarValue> =
                self.rows.iter().map(|row| ScalarValue::Float64(row.get(i).copied())).collect();
            ScalarValue::List(ScalarValue::new_list_nullable(&values, &DataType::Float64))
        };
        Ok((0..self.width).map(column).collect())
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<()> {
        let lists: Vec<_> = states.iter().filter_map(|s| s.as_list_opt::<i32>()).collect();
        for row in 0..lists.first().map_or(0, |l| l.len()) {
            let columns: Vec<ArrayRef> =
                lists.iter().filter(|l| l.is_valid(row)).map(|l| l.value(row)).collect();
            if !columns.is_empty() {
                self.add(&columns)?;
            }
        }
        Ok(())
    }
}
