//! The first values of a file that was opened: what its columns are by them, which rows are none of the recording.

use crate::column_judgement::{FirstValues, Judgement, Stated, judge};
use crate::cycle::Sensors;
use crate::error::{IngestError, IngestErrorKind};
use crate::format::{BadBlock, Opened};
use crate::guarded::guarded;
use crate::metadata::sample_rate_of_entry_hz;
use crate::options::{ReadOptions, RowMatch};
use crate::selected_rows::{SelectedRows, Selection};
use crate::{Table, stated_scales};
use sagnac_core::message::{Note, note};
use sagnac_core::recording::ColumnRef;
use sagnac_core::units::Unit;
use std::ops::ControlFlow;
use std::path::Path;

/// Rows that are looked at.
const MAX_ROWS_LOOKED_AT: usize = 4096;

/// Most columns that are looked at.
const MAX_COLUMNS_LOOKED_AT: usize = 256;

/// Distance from the middle of the later values, in their robust standard deviations, from which a value at the start is
/// no measurement of the same output.
const JUNK_DISTANCE_SD: f64 = 30.0;

/// Fewest rows of a bad block at the start.
const MIN_BLOCK: usize = 8;

/// Fewest equal values at the start that are none of the output, such as zeros before it is ready.
const MIN_CONSTANT: usize = 32;

/// A file with its columns judged and its rows chosen.
pub(crate) struct Settled {
    pub opened: Opened,
    /// Several sensors whose rows take turns, where none was chosen.
    pub sensors: Option<Sensors>,
}

/// Looks at the first values of a file and settles what its columns are and which rows are read.
///
/// # Errors
/// Options that do not fit the file.
pub(crate) fn settle(path: &Path, mut opened: Opened, options: &ReadOptions) -> Result<Settled, IngestError> {
    let matching = options.only.as_ref().map(|m| matching(path, &opened, m)).transpose()?;
    let selection = Selection { matching, rows: options.rows, unsigned: Vec::new() };
    let mut table = SelectedRows { inner: opened.table, selection };
    let numeric: Vec<usize> = (0..opened.columns.len())
        .filter(|&i| opened.columns.get(i).is_some_and(|c| c.numeric))
        .take(MAX_COLUMNS_LOOKED_AT)
        .collect();
    // What keeps the file from being read is told when it is read.
    let read = guarded(path, || first_rows(&table, &numeric)).unwrap_or_default();
    let mut values: Vec<FirstValues> = vec![Vec::new(); opened.columns.len()];
    for (index, of) in numeric.iter().zip(read) {
        if let Some(place) = values.get_mut(*index) {
            *place = of;
        }
    }
    let stated_hz = opened.metadata.iter().find_map(|(key, value)| sample_rate_of_entry_hz(key, value));
    opened.stated_sample_rate_hz = opened.stated_sample_rate_hz.or(stated_hz);
    stated_scales::apply(&mut opened.columns, &values, &opened.metadata, &mut opened.notes);
    let time_unit = options.time_unit.as_deref().map(Unit::parse).transpose().map_err(|e| {
        IngestError::new(
            IngestErrorKind::Unit,
            path,
            note!("ingest.judged.time_unit_wrong", reason = e.note()),
        )
    })?;
    let stated = Stated { time_unit, rate_hz: opened.stated_sample_rate_hz };
    let Judgement { notes, unsigned, sensors } = judge(&mut opened.columns, &values, &opened.labels, &stated);
    opened.notes.extend(notes);
    let sensors = sensors.filter(|_| options.only.is_none());
    table.selection.unsigned = unsigned;
    if options.rows.is_none() && sensors.is_none() {
        let gyros =
            opened.columns.iter().zip(&values).filter(|(c, _)| c.numeric && c.inferred().role.is_gyro());
        let junk = gyros.filter_map(|(_, of)| junk_at_start(of)).max();
        if let Some(rows) = junk {
            let note = note!("ingest.judged.junk_at_start", last = rows, next = rows + 1);
            opened.bad_blocks.push(BadBlock { first_row: 1, rows: rows as u64, note });
            table.selection.rows = Some((rows as u64 + 1, u64::MAX));
        }
    }
    opened.table = if table.selection.is_all() { table.inner } else { Box::new(table) };
    Ok(Settled { opened, sensors })
}

/// The first values of columns.
fn first_rows(table: &SelectedRows, columns: &[usize]) -> Result<Vec<FirstValues>, IngestError> {
    let mut values: Vec<FirstValues> = vec![Vec::new(); columns.len()];
    if columns.is_empty() {
        return Ok(values);
    }
    table.read(columns, &mut |block| {
        for (of, column) in values.iter_mut().zip(&block.columns) {
            of.extend(column.iter().take(MAX_ROWS_LOOKED_AT.saturating_sub(of.len())));
        }
        if values.first().is_some_and(|v| v.len() >= MAX_ROWS_LOOKED_AT) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    Ok(values)
}

/// The column and the number in it by which rows are chosen. A column of words is read as 1 where the word stands.
fn matching(path: &Path, opened: &Opened, of: &RowMatch) -> Result<(usize, f64), IngestError> {
    let error = |note: Note| IngestError::new(IngestErrorKind::Column, path, note);
    let position = match &of.column {
        ColumnRef::Position(p) => p.checked_sub(1).filter(|i| *i < opened.columns.len()),
        ColumnRef::Name(name) => opened.columns.iter().position(|c| c.name == *name),
    };
    let names = || opened.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
    let index = position.ok_or_else(|| {
        error(note!("ingest.no_column_named", name = shown(&of.column)))
            .hint(note!("ingest.hint.the_file_has", names = names()))
    })?;
    let labels = opened.labels.iter().find(|l| l.column == index);
    let value = if labels.is_some() { Some(1.0) } else { of.value.trim().parse::<f64>().ok() };
    let known = labels.is_none_or(|l| l.rows.is_empty() || l.rows.contains(&of.value));
    value.filter(|_| known).map(|v| (index, v)).ok_or_else(|| {
        let note = note!("ingest.judged.no_such_value", column = shown(&of.column));
        error(note.with("value", of.value.as_str()))
    })
}

/// A column as it was named.
fn shown(column: &ColumnRef) -> String {
    match column {
        ColumnRef::Name(name) => name.clone(),
        ColumnRef::Position(position) => position.to_string(),
    }
}

/// Rows at the start that are no measurement of what follows: nearly all of them far from the later values, of which none
/// is.
fn junk_at_start(values: &[f64]) -> Option<usize> {
    let later = values.get(values.len() / 2..)?;
    let (middle, spread) = middle_and_spread(later)?;
    let far = |v: &f64| (v - middle).abs() > JUNK_DISTANCE_SD * spread;
    let last = values.iter().rposition(far)? + 1;
    let share = values.get(..last)?.iter().filter(|v| far(v)).count() as f64 / last as f64;
    // The values that follow at once are as the later ones: a unit that settles comes nearer little by little.
    let next = values.get(last..(2 * last).min(values.len()))?;
    let settled = next.len() >= MIN_BLOCK && next.iter().all(|v| (v - middle).abs() <= 8.0 * spread);
    let block = values.get(..last)?;
    let held = last >= MIN_CONSTANT && block.iter().all(|v| Some(v) == block.first());
    let unlike = jumps(block, spread) || held;
    (last >= MIN_BLOCK && 2 * last < values.len() && share > 0.5 && settled && unlike).then_some(last)
}

/// True where values jump about by far more than noise does, as junk does and a unit that is turned or settles does not.
fn jumps(values: &[f64], spread: f64) -> bool {
    let steps = values.iter().zip(values.get(1..).unwrap_or_default());
    let large = steps.filter(|(a, b)| (*b - *a).abs() > JUNK_DISTANCE_SD * spread).count();
    8 * large >= values.len()
}

/// The middle of values and their standard deviation by the middle distance from it.
fn middle_and_spread(values: &[f64]) -> Option<(f64, f64)> {
    let mut of: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let half = of.len() / 2;
    if half < MIN_BLOCK {
        return None;
    }
    let middle = *of.select_nth_unstable_by(half, f64::total_cmp).1;
    of.iter_mut().for_each(|v| *v = (*v - middle).abs());
    let spread = 1.4826 * *of.select_nth_unstable_by(half, f64::total_cmp).1;
    (spread > 0.0).then_some((middle, spread))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn junk_at_the_start_is_told_from_a_unit_that_settles_or_is_turned() {
        let noise = |i: usize| (1.7 * i as f64).sin() + (0.9 * (i * i) as f64).cos();
        let of = |start: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..2000).map(|i| if i < 100 { start(i) } else { 300.0 + noise(i) }).collect()
        };
        assert_eq!(junk_at_start(&of(&|i| [0.0, 32_438.0, -32_438.0][i % 3])), Some(100));
        assert_eq!(junk_at_start(&of(&|i| 300.0 + noise(i))), None);
        let settles: Vec<f64> =
            (0..2000).map(|i| 300.0 + 500.0 * (-(i as f64) / 100.0).exp() + noise(i)).collect();
        assert_eq!(junk_at_start(&settles), None);
        assert_eq!(junk_at_start(&of(&|i| 5000.0 + noise(i))), None);
        assert_eq!(junk_at_start(&of(&|_| 0.0)), Some(100));
    }
}
