//! A recording as a whole, in the units of the contract of explanations: time, rate, and the columns beside them.
//!
//! Acceptance never holds a recording; an explanation looks at it many times and does.

mod smooth;

pub use smooth::smooth;

use crate::effect::Column;
use crate::message::{Note, note};
use crate::recording::integrity::Integrity;
use std::collections::BTreeMap;

/// A recording: every row that can be used, in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Time of each row, s, on the recording's own scale.
    pub time_s: Vec<f64>,
    /// Output of the gyro, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// The columns beside, in the units that their names tell, a value a row.
    pub columns: BTreeMap<Column, Vec<f64>>,
    /// Position of each row on the uniform grid of the recording, 0 for the first; where samples are missing,
    /// positions are skipped.
    pub index: Vec<u64>,
    /// Rows left out or mended.
    pub faults: Faults,
    /// Which column of the file each quantity was read from.
    pub read_from: Vec<ReadFrom>,
    /// Mean sample interval over the unbroken stretches, s.
    pub sample_interval_s: f64,
    /// SHA-256 of the file, hexadecimal; empty for a recording in memory.
    pub sha256: String,
    /// What must be known of the recording.
    pub notes: Vec<Note>,
}

/// Rows that were left out, and values that were mended. Nothing is left out that is not counted here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faults {
    /// Rows of the file.
    pub rows: usize,
    /// Rows left out because their time cannot be used: unreadable, repeated, or out of order.
    pub without_time: usize,
    /// Rows left out because their rate is no finite number.
    pub without_rate: usize,
    /// Samples missing between rows.
    pub missing: usize,
    /// Values of the columns beside that are no finite numbers; they were interpolated between their neighbours.
    pub interpolated: BTreeMap<Column, usize>,
    /// Everything that was found, fault by fault.
    pub integrity: Integrity,
}

impl Series {
    /// The rows from some seconds after the first to others, the end excluded. What was counted of faults is that of the whole.
    #[must_use]
    pub fn between(&self, from_s: f64, to_s: f64) -> Series {
        let start = self.time_s.first().copied().unwrap_or(0.0);
        let kept = |t: &f64| *t - start >= from_s && *t - start < to_s;
        let first = self.time_s.iter().position(kept).unwrap_or(self.time_s.len());
        let end = self.time_s.iter().rposition(kept).map_or(first, |last| last + 1);
        let cut = |values: &[f64]| values.get(first..end).unwrap_or_default().to_vec();
        let index = self.index.get(first..end).unwrap_or_default();
        let origin = index.first().copied().unwrap_or(0);
        Series {
            time_s: cut(&self.time_s),
            rate_deg_h: cut(&self.rate_deg_h),
            columns: self.columns.iter().map(|(column, values)| (*column, cut(values))).collect(),
            index: index.iter().map(|i| i - origin).collect(),
            ..self.clone()
        }
    }

    /// Remarks on the recording: findings about it, and the rows that were left out or mended.
    pub fn remarks(&self) -> Vec<Note> {
        let mut out = self.notes.clone();
        let faults = &self.faults;
        for (key, count) in [
            ("explain.note.without_time", faults.without_time),
            ("explain.note.without_rate", faults.without_rate),
        ] {
            if count > 0 {
                out.push(Note::new(key).with("count", count));
            }
        }
        for (column, count) in &faults.interpolated {
            let read = self.read_from.iter().find(|r| r.name == column.name());
            let name = read.map_or(column.name(), |r| r.column.as_str());
            out.push(note!("explain.note.mended", count = *count, column = name));
        }
        out
    }
}

/// Where a quantity was read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadFrom {
    /// Name of the contract, `time_s`, `rate_deg_h`, or that of a column beside.
    pub name: &'static str,
    /// Column of the file.
    pub column: String,
    /// Unit in the file.
    pub unit: String,
    /// True where the name of the column says that its sensor is not on the unit, such as a thermometer of the room.
    pub elsewhere: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_begins_anew() {
        let series = Series {
            time_s: vec![5.0, 6.0, 7.0, 9.0],
            rate_deg_h: vec![0.0, 1.0, 2.0, 4.0],
            columns: BTreeMap::from([(Column::Temperature, vec![20.0, 21.0, 22.0, 24.0])]),
            index: vec![0, 1, 2, 4],
            ..Series::default()
        };
        let part = series.between(1.0, 4.5);
        assert_eq!((part.time_s, part.rate_deg_h), (vec![6.0, 7.0, 9.0], vec![1.0, 2.0, 4.0]));
        assert_eq!(
            (part.index, part.columns[&Column::Temperature].clone()),
            (vec![0, 1, 3], vec![21.0, 22.0, 24.0])
        );
        assert_eq!(series.between(0.0, f64::INFINITY), series);
        assert!(series.between(10.0, 20.0).time_s.is_empty());
    }
}
