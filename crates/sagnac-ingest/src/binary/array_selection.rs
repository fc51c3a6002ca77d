//! Which of the arrays in a container are the recording: those of one length.

use crate::error::{IngestError, IngestErrorKind};
use sagnac_core::message::{Note, note};
use std::collections::BTreeMap;
use std::path::Path;

/// Arrays that are named one by one in the notes.
const NAMED: usize = 20;

/// An array in a container.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    /// Its name; that of its structure for a field of one.
    pub name: String,
    /// Rows.
    pub rows: u64,
    /// Columns.
    pub columns: usize,
    /// True for a field of a structure, which comes with its fellows.
    pub in_structure: bool,
}

/// The number of rows of the recording. It is that of the array that is asked for, else the one that most values have.
pub(crate) fn rows(path: &Path, arrays: &[Array], part: Option<&str>) -> Result<Option<u64>, IngestError> {
    if let Some(part) = part {
        let named = arrays.iter().filter(|a| a.name == part).max_by_key(|a| a.rows);
        return match named {
            Some(array) => Ok(Some(array.rows)),
            None => {
                let mut names: Vec<&str> = arrays.iter().map(|a| a.name.as_str()).collect();
                names.dedup();
                names.truncate(NAMED);
                let note = note!("ingest.binary.no_part", name = part);
                Err(IngestError::new(IngestErrorKind::Column, path, note)
                    .hint(note!("ingest.hint.the_file_has", names = names.join(", "))))
            }
        };
    }
    let mut values: BTreeMap<u64, u64> = BTreeMap::new();
    for array in arrays {
        let all = values.entry(array.rows).or_default();
        *all = all.saturating_add(array.rows.saturating_mul(array.columns as u64));
    }
    // Of equals the longer one: `max_by_key` takes the last.
    Ok(values.into_iter().max_by_key(|(_, values)| *values).map(|(rows, _)| rows))
}

/// True when an array belongs to the recording.
pub(crate) fn belongs(array: &Array, rows: u64, part: Option<&str>, arrays: &[Array]) -> bool {
    let alone =
        part.is_some_and(|part| arrays.iter().any(|a| a.name == part && (a.in_structure || a.columns > 1)));
    array.rows == rows && (!alone || part == Some(array.name.as_str()))
}

/// Remarks on arrays that are left out; `left` holds the reason of each.
pub(crate) fn notes(left: Vec<Note>) -> Vec<Note> {
    let more = left.len().saturating_sub(NAMED);
    let mut notes: Vec<Note> = left.into_iter().take(NAMED).collect();
    if more > 0 {
        notes.push(note!("ingest.binary.more_left_out", count = more));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::english::english;

    fn array(name: &str, rows: u64, columns: usize) -> Array {
        Array { name: name.into(), rows, columns, in_structure: false }
    }

    #[test]
    fn the_length_of_most_values_wins_and_a_part_overrides_it() {
        let all = [array("t", 500, 1), array("rate", 500, 1), array("temp", 50, 3), array("long", 1000, 1)];
        let path = Path::new("a.npz");
        assert_eq!(rows(path, &all, None).unwrap(), Some(1000), "of equals the longer one");
        assert_eq!(rows(path, &all[..3], None).unwrap(), Some(500));
        assert_eq!(rows(path, &all, Some("t")).unwrap(), Some(500));
        assert!(belongs(&all[1], 500, Some("t"), &all), "a vector comes with those of its length");
        assert!(!belongs(&all[1], 50, Some("temp"), &all));
        let error = english(&rows(path, &all, Some("x")).unwrap_err().note());
        assert!(error.contains("`x`") && error.contains("t, rate, temp, long"), "{error}");
        assert_eq!(rows(path, &[], None).unwrap(), None);
    }
}
