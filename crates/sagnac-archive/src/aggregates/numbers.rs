//! Rows of numbers that an aggregate keeps for each group, and how they travel between machines.

use datafusion::arrow::array::{
    Array, ArrayRef, AsArray, BooleanArray, Float64Array, ListArray, PrimitiveArray,
};
use datafusion::arrow::buffer::{OffsetBuffer, ScalarBuffer};
use datafusion::arrow::datatypes::{DataType, Field, FieldRef, Float64Type};
use datafusion::common::{DataFusionError, Result, ScalarValue};
use datafusion::logical_expr::{Accumulator, EmitTo, GroupsAccumulator};
use std::fmt::Debug;
use std::sync::Arc;

/// Arguments of an aggregate.
pub const ARGUMENT_COUNT: usize = 3;

/// The arguments of one row.
pub type Row = [f64; ARGUMENT_COUNT];

/// Results made of the rows of a group.
pub trait Finish: Debug + Send + Sync + 'static {
    /// Its value, from the rows in ascending order.
    ///
    /// # Errors
    /// When an argument cannot be used.
    fn finish(&self, rows: &[Row]) -> Result<ScalarValue>;
}

/// Keeps the rows in which every argument is a number, group by group.
#[derive(Debug)]
pub struct Kept<F: Finish> {
    groups: Vec<Vec<Row>>,
    finish: F,
}

/// The only field of the state: the numbers of a group, row after row.
pub fn state_fields() -> Vec<FieldRef> {
    vec![Arc::new(Field::new("numbers", DataType::List(item()), true))]
}

fn item() -> FieldRef {
    Arc::new(Field::new("item", DataType::Float64, true))
}

impl<F: Finish> Kept<F> {
    /// An aggregate without rows.
    pub fn new(finish: F) -> Kept<F> {
        Kept { groups: vec![], finish }
    }

    fn add(
        kept: &mut Vec<Vec<Row>>,
        columns: &[ArrayRef],
        group_of: impl Fn(usize) -> Option<usize>,
        groups: usize,
    ) -> Result<()> {
        kept.resize_with(groups.max(kept.len()), Vec::new);
        let numbers: Vec<&PrimitiveArray<Float64Type>> =
            columns.iter().filter_map(|c| c.as_primitive_opt()).collect();
        let [a, b, c] = <[_; ARGUMENT_COUNT]>::try_from(numbers).map_err(|_| no_numbers())?;
        for i in 0..a.len() {
            if a.is_null(i) || b.is_null(i) || c.is_null(i) {
                continue;
            }
            let row = [a.value(i), b.value(i), c.value(i)];
            let group = group_of(i).and_then(|g| kept.get_mut(g));
            if let Some(group) = group.filter(|_| row.iter().all(|v| v.is_finite())) {
                group.push(row);
            }
        }
        Ok(())
    }

    fn merge(&mut self, states: &[ArrayRef], group_of: impl Fn(usize) -> usize, groups: usize) -> Result<()> {
        self.groups.resize_with(groups.max(self.groups.len()), Vec::new);
        let lists = states.first().and_then(|s| s.as_list_opt::<i32>()).ok_or_else(no_numbers)?;
        for i in (0..lists.len()).filter(|i| lists.is_valid(*i)) {
            let values = lists.value(i);
            let numbers = values.as_primitive_opt::<Float64Type>().ok_or_else(no_numbers)?.values();
            if let Some(group) = self.groups.get_mut(group_of(i)) {
                group.extend(numbers.as_chunks::<ARGUMENT_COUNT>().0);
            }
        }
        Ok(())
    }

    fn finished(&self, mut rows: Vec<Row>) -> Result<ScalarValue> {
        rows.sort_unstable_by(|a, b| {
            let different = a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne());
            different.unwrap_or(std::cmp::Ordering::Equal)
        });
        self.finish.finish(&rows)
    }
}

fn no_numbers() -> DataFusionError {
    DataFusionError::Internal("an aggregate got no numbers".to_owned())
}

/// Groups as lists of their numbers.
fn lists(groups: &[Vec<Row>]) -> ListArray {
    let numbers: Vec<f64> = groups.iter().flatten().flatten().copied().collect();
    let offsets = OffsetBuffer::from_lengths(groups.iter().map(|g| g.len() * ARGUMENT_COUNT));
    ListArray::new(item(), offsets, Arc::new(Float64Array::new(ScalarBuffer::from(numbers), None)), None)
}

impl<F: Finish> GroupsAccumulator for Kept<F> {
    fn update_batch(
        &mut self,
        values: &[ArrayRef],
        group_indices: &[usize],
        filter: Option<&BooleanArray>,
        total: usize,
    ) -> Result<()> {
        let wanted = |i: usize| filter.is_none_or(|f| f.is_valid(i) && f.value(i));
        Self::add(&mut self.groups, values, |i| group_indices.get(i).copied().filter(|_| wanted(i)), total)
    }

    fn evaluate(&mut self, emit_to: EmitTo) -> Result<ArrayRef> {
        let groups = emit_to.take_needed(&mut self.groups);
        let values: Vec<ScalarValue> =
            groups.into_iter().map(|rows| self.finished(rows)).collect::<Result<_>>()?;
        ScalarValue::iter_to_array(values)
    }

    fn state(&mut self, emit_to: EmitTo) -> Result<Vec<ArrayRef>> {
        let groups = emit_to.take_needed(&mut self.groups);
        Ok(vec![Arc::new(lists(&groups))])
    }

    fn merge_batch(&mut self, values: &[ArrayRef], group_indices: &[usize], total: usize) -> Result<()> {
        self.merge(values, |i| group_indices.get(i).copied().unwrap_or(usize::MAX), total)
    }

    /// Each row as a group of its own.
    fn convert_to_state(&self, values: &[ArrayRef], filter: Option<&BooleanArray>) -> Result<Vec<ArrayRef>> {
        let wanted = |i: usize| filter.is_none_or(|f| f.is_valid(i) && f.value(i));
        let mut each = vec![];
        let rows = values.first().map_or(0, |v| v.len());
        Self::add(&mut each, values, |i| Some(i).filter(|_| wanted(i)), rows)?;
        Ok(vec![Arc::new(lists(&each))])
    }

    fn size(&self) -> usize {
        let rows: usize = self.groups.iter().map(Vec::capacity).sum();
        rows * size_of::<Row>() + self.groups.capacity() * size_of::<Vec<Row>>()
    }
}

/// Without groups all rows are of one.
impl<F: Finish> Accumulator for Kept<F> {
    fn update_batch(&mut self, values: &[ArrayRef]) -> Result<()> {
        Self::add(&mut self.groups, values, |_| Some(0), 1)
    }

    fn evaluate(&mut self) -> Result<ScalarValue> {
        let rows = self.groups.first().cloned().unwrap_or_default();
        self.finished(rows)
    }

    fn size(&self) -> usize {
        size_of_val(self) + GroupsAccumulator::size(self)
    }

    fn state(&mut self) -> Result<Vec<ScalarValue>> {
        self.groups.resize_with(1, Vec::new);
        Ok(vec![ScalarValue::List(Arc::new(lists(&self.groups)))])
    }

    fn merge_batch(&mut self, states: &[ArrayRef]) -> Result<()> {
        self.merge(states, |_| 0, 1)
    }
}
