//! The first fields of columns, whatever they hold: which columns hold numbers is found for all of them at once.

use super::error::IngestError;
use super::requested_columns::NumericCheck;
use super::source::{NoNumbers, Source};
use super::{Block, FieldFault, FieldFaultKind};
use std::ops::ControlFlow;

/// Rows that are looked at before a column is judged.
const PROBED_ROWS: u64 = 1000;

/// The first fields of a column.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FirstFields {
    /// Fields that are finite numbers.
    pub numbers: u64,
    /// Fields that are neither numbers nor empty.
    pub texts: u64,
    /// The first of those fields as it is written, shortened.
    pub first_text: Option<String>,
    /// True where [`Source::read`] refuses the column.
    pub is_refused: bool,
}

impl FirstFields {
    fn is_empty(&self) -> bool {
        self.numbers + self.texts == 0
    }
}

impl Source {
    /// Looks at the first rows of columns (positions from 0, each once); a column without a value in them is read on until it
    /// has one.
    ///
    /// # Errors
    /// As [`Source::read`], but for columns that hold no numbers.
    pub fn first_fields(&self, columns: &[usize]) -> Result<Vec<FirstFields>, IngestError> {
        let mut found = self.look(columns, |rows, _| rows >= PROBED_ROWS)?;
        let places: Vec<usize> =
            (0..columns.len()).filter(|&i| found.get(i).is_some_and(FirstFields::is_empty)).collect();
        if places.is_empty() {
            return Ok(found);
        }
        let empty: Vec<usize> = places.iter().filter_map(|i| columns.get(*i).copied()).collect();
        let later =
            self.look(&empty, |rows, all| rows >= PROBED_ROWS && all.iter().all(|f| !f.is_empty()))?;
        for (place, fields) in places.into_iter().zip(later) {
            if let Some(found) = found.get_mut(place) {
                *found = fields;
            }
        }
        Ok(found)
    }

    /// Reads columns until enough was seen of them.
    fn look(
        &self,
        columns: &[usize],
        enough: impl Fn(u64, &[FirstFields]) -> bool,
    ) -> Result<Vec<FirstFields>, IngestError> {
        let mut found = vec![FirstFields::default(); columns.len()];
        if columns.is_empty() {
            return Ok(found);
        }
        let (mut rows, mut part, mut check) = (0, 0, NumericCheck::new(columns.len()));
        self.read_with(
            columns,
            NoNumbers::PassedOn,
            &mut |block| {
                // Each file of a recording is judged for itself.
                if block.part != part {
                    refuse(&mut found, check.judge_at_end());
                    (part, check) = (block.part, NumericCheck::new(columns.len()));
                }
                refuse(&mut found, check.judge(block));
                add(&mut found, block);
                rows += block.rows() as u64;
                if enough(rows, &found) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
            &mut |_, _| {},
        )?;
        refuse(&mut found, check.judge_at_end());
        Ok(found)
    }
}

fn refuse(found: &mut [FirstFields], faults: Vec<FieldFault>) {
    for fault in faults {
        if let Some(fields) = found.get_mut(fault.slot) {
            fields.is_refused = true;
        }
    }
}

fn add(found: &mut [FirstFields], block: &Block) {
    for ((fields, values), texts) in found.iter_mut().zip(&block.columns).zip(&block.unparsable) {
        fields.numbers += values.iter().filter(|v| v.is_finite()).count() as u64;
        fields.texts += texts;
    }
    for fault in block.faults.iter().filter(|f| f.kind == FieldFaultKind::Unparsable) {
        if let Some(fields) = found.get_mut(fault.slot) {
            fields.first_text.get_or_insert_with(|| fault.text.clone());
        }
    }
}

#[cfg(test)]
#[cfg(feature = "text")]
mod tests {
    use super::*;
    use crate::{IngestErrorKind, open};

    #[test]
    fn every_column_is_looked_at_in_one_reading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit.csv");
        let mut text = String::from("t,word,late,none\n");
        for row in 0..5000 {
            let late = if row < 3000 { "" } else { "7" };
            text.push_str(&format!("{row},w{row},{late},\n"));
        }
        std::fs::write(&path, text).unwrap();
        let source = open(&path).unwrap();
        let found = source.first_fields(&[0, 1, 2, 3]).unwrap();
        let held: Vec<(bool, bool, bool)> =
            found.iter().map(|f| (f.numbers > 0, f.texts > 0, f.is_refused)).collect();
        let expected =
            [(true, false, false), (false, true, true), (true, false, false), (false, false, false)];
        assert_eq!(held, expected);
        assert_eq!(found[1].first_text.as_deref(), Some("w0"));
        // As a reading of each column says.
        for (i, fields) in found.iter().enumerate() {
            let read = source.read(&[i], &mut |_| ControlFlow::Continue(()));
            let refused = read.is_err_and(|e| e.kind() == IngestErrorKind::NotNumeric);
            assert_eq!(refused, fields.is_refused, "{i}");
        }
    }
}
