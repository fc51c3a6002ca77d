//! A table of which only some rows are read, and whose unsigned counts are taken as signed: what the user or the first
//! look at a file decides about every format alike.

use crate::block::LOCATED_PER_BLOCK;
use crate::error::IngestError;
use crate::{Block, FieldFaultKind, FileFacts, OnBlock, Table};

/// Rows to be read and counts to be signed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Selection {
    /// Column whose value a row must have, and the value.
    pub matching: Option<(usize, f64)>,
    /// First and last row, counted from 1 among those that match.
    pub rows: Option<(u64, u64)>,
    /// Columns of two's complement that is written without a sign, with the number of their values: 65536 for 16 bits.
    pub unsigned: Vec<(usize, f64)>,
}

impl Selection {
    /// True where the table is read as it is.
    pub fn is_all(&self) -> bool {
        *self == Selection::default()
    }
}

/// A table read by a selection. Its rows are counted anew.
pub(crate) struct SelectedRows {
    /// The whole table.
    pub inner: Box<dyn Table>,
    /// What is read of it.
    pub selection: Selection,
}

impl Table for SelectedRows {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let mut columns = wanted.to_vec();
        let slot_of_match = self.selection.matching.map(|(column, value)| {
            let slot = columns.iter().position(|c| *c == column).unwrap_or_else(|| {
                columns.push(column);
                columns.len() - 1
            });
            (slot, value)
        });
        let (mut matched, mut passed) = (0u64, 0u64);
        let facts = self.inner.read(&columns, &mut |block| {
            let keep: Vec<bool> = (0..block.rows())
                .map(|row| {
                    let matches = slot_of_match.is_none_or(|(slot, value)| {
                        block.columns.get(slot).and_then(|c| c.get(row)).is_some_and(|v| *v == value)
                    });
                    matched += u64::from(matches);
                    matches
                        && self.selection.rows.is_none_or(|(first, last)| (first..=last).contains(&matched))
                })
                .collect();
            block.columns.truncate(wanted.len());
            retain(block, &keep, passed);
            passed += block.rows() as u64;
            for (slot, column) in wanted.iter().enumerate() {
                let values =
                    self.selection.unsigned.iter().find(|(c, _)| c == column).map(|(_, values)| *values);
                if let (Some(values), Some(column)) = (values, block.columns.get_mut(slot)) {
                    column.iter_mut().filter(|v| **v >= 0.5 * values).for_each(|v| *v -= values);
                }
            }
            let flow = if block.rows() > 0 { on_block(block) } else { std::ops::ControlFlow::Continue(()) };
            block.columns.resize_with(columns.len(), Vec::new);
            flow
        })?;
        Ok(facts.map(|facts| FileFacts { rows: passed, ..facts }))
    }
}

/// Keeps some rows of a block; `passed`: rows that were passed on before.
fn retain(block: &mut Block, keep: &[bool], passed: u64) {
    let slots = block.columns.len();
    block.faults.retain(|f| f.slot < slots);
    block.non_finite.truncate(slots);
    block.unparsable.truncate(slots);
    let first_row = std::mem::replace(&mut block.first_row, passed + 1);
    if keep.iter().all(|k| *k) {
        block.faults.iter_mut().for_each(|f| f.row = f.row - first_row + passed + 1);
        return;
    }
    let kept = keep.iter().filter(|k| **k).count();
    for column in &mut block.columns {
        let mut of = keep.iter();
        column.retain(|_| of.next().copied().unwrap_or(false));
    }
    let mut places = Vec::with_capacity(keep.len());
    let mut next = passed;
    for k in keep {
        next += u64::from(*k);
        places.push(k.then_some(next));
    }
    let place = |row: u64| {
        let at = usize::try_from(row.checked_sub(first_row)?).ok()?;
        places.get(at).copied().flatten()
    };
    block.faults = std::mem::take(&mut block.faults)
        .into_iter()
        .filter_map(|f| Some(crate::FieldFault { row: place(f.row)?, ..f }))
        .collect();
    for (slot, column) in block.columns.iter().enumerate() {
        let without = column.iter().filter(|v| !v.is_finite()).count() as u64;
        let Some(all) = block.unparsable.get_mut(slot) else { continue };
        let listed =
            block.faults.iter().filter(|f| f.slot == slot && f.kind == FieldFaultKind::Unparsable).count();
        // Only the first faults of a block are located; when the list is full the rest is taken in proportion.
        *all = if *all <= LOCATED_PER_BLOCK {
            listed as u64
        } else {
            (*all as f64 * kept as f64 / keep.len().max(1) as f64) as u64
        }
        .min(without);
        let unparsable = *all;
        if let Some(count) = block.non_finite.get_mut(slot) {
            *count = without - unparsable;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::in_memory::{self, MemoryColumn};
    use std::ops::ControlFlow;
    use std::path::Path;

    fn table(columns: Vec<(&str, Vec<f64>)>) -> Box<dyn Table> {
        let columns = columns.into_iter().map(|(name, values)| MemoryColumn {
            name: name.to_owned(),
            epoch_s: None,
            values: Box::new(values),
        });
        in_memory::open(Path::new("memory"), columns.collect(), 3).unwrap().table
    }

    fn read(selection: Selection, wanted: &[usize]) -> (Vec<Vec<f64>>, Vec<u64>, u64) {
        let x = vec![1.0, f64::NAN, 3.0, 4.0, 65_535.0, 6.0, 7.0, 8.0];
        let id = vec![0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
        let selected = SelectedRows { inner: table(vec![("x", x), ("id", id)]), selection };
        let (mut out, mut rows) = (vec![Vec::new(); wanted.len()], Vec::new());
        let facts = selected.read(wanted, &mut |block| {
            assert_eq!(block.columns.len(), wanted.len());
            rows.extend(block.faults.iter().map(|f| f.row));
            out.iter_mut().zip(&block.columns).for_each(|(o, c)| o.extend_from_slice(c));
            ControlFlow::Continue(())
        });
        (out, rows, facts.unwrap().unwrap().rows)
    }

    #[test]
    fn rows_are_chosen_by_a_value_and_by_their_number() {
        let of = |value| Selection { matching: Some((1, value)), ..Selection::default() };
        assert_eq!(read(of(0.0), &[0]), (vec![vec![1.0, 3.0, 65_535.0, 7.0]], vec![], 4));
        let (out, faults, rows) = read(of(1.0), &[0, 1]);
        assert!(out[0][0].is_nan() && out[0][1..] == [4.0, 6.0, 8.0] && out[1] == [1.0; 4]);
        assert_eq!((faults, rows), (vec![1], 4));
        let rows = Selection { matching: Some((1, 0.0)), rows: Some((2, 3)), ..Selection::default() };
        assert_eq!(read(rows, &[0]).0, [[3.0, 65_535.0]]);
    }

    #[test]
    fn unsigned_counts_become_signed() {
        let unsigned = vec![(0, 65_536.0)];
        let selection = Selection { unsigned, rows: Some((3, 6)), ..Selection::default() };
        assert_eq!(read(selection, &[0]).0, [[3.0, 4.0, -1.0, 6.0]]);
    }
}
