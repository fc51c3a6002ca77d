//! Whether a text file ends within a row.

use crate::byte_stream::{Packing, io_error};
use crate::open_file;
use crate::{Candidate, IngestError};
use sagnac_core::message::{Note, note};
use std::io::{Read, Seek, SeekFrom};

/// Bytes at the end that are looked at.
const TAIL: u64 = 16 << 10;

/// Rows before the last one that must agree about its form.
const ROWS: usize = 8;

/// A sentence where the last row is not ended and is shorter than the rows before it are written: fewer fields, or a last
/// field with fewer decimals where all others have the same. Whole rows without a line end are usual at the end of a
/// file; where the rows vary in their decimals nothing can be detected.
pub(super) fn look(file: &Candidate) -> Result<Vec<Note>, IngestError> {
    if file.packing != Packing::Plain {
        return Ok(Vec::new());
    }
    let io = |e| io_error(&file.path, &e);
    let mut handle = open_file(&file.path).map_err(io)?;
    handle.seek(SeekFrom::Start(file.bytes.saturating_sub(TAIL))).map_err(io)?;
    let mut tail = Vec::new();
    handle.take(TAIL).read_to_end(&mut tail).map_err(io)?;
    Ok(if unfinished(&tail) { vec![note!("ingest.text_unfinished")] } else { Vec::new() })
}

fn unfinished(tail: &[u8]) -> bool {
    // Text of two bytes a character is not looked at.
    if tail.contains(&0) {
        return false;
    }
    let mut lines = tail.rsplit(|b| *b == b'\n');
    let Some(last) = lines.next().filter(|l| !l.trim_ascii().is_empty()) else { return false };
    let before: Vec<&[u8]> = lines.take(ROWS).collect();
    let (Some(first), true) = (before.first(), before.len() == ROWS) else { return false };
    let marks = |line: &[u8]| line.iter().filter(|b| matches!(b, b',' | b';' | b'\t')).count();
    let words = |line: &[u8]| line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).count();
    let same = |of: &dyn Fn(&[u8]) -> usize| before.iter().all(|l| of(l) == of(first));
    if same(&marks) && same(&words) && (marks(last) < marks(first) || words(last) < words(first)) {
        return true;
    }
    let decimals = |line: &[u8]| {
        let line = line.trim_ascii_end();
        line.iter().rev().take_while(|b| b.is_ascii_digit()).count()
    };
    let point = |line: &[u8]| {
        let line = line.trim_ascii_end();
        line.iter().rev().find(|b| !b.is_ascii_digit()).is_some_and(|b| *b == b'.')
    };
    before.iter().all(|l| point(l)) && same(&decimals) && (!point(last) || decimals(last) < decimals(first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_breaks_off_is_told_from_one_without_a_line_end() {
        let rows: String = (0..20).map(|i| format!("{i}.0,{}.12345\n", i * i)).collect();
        for (end, cut) in
            [("", false), ("20.0,400.12345", false), ("20.0,400.123", true), ("20.0", true), ("20.0,4", true)]
        {
            assert_eq!(unfinished(format!("{rows}{end}").as_bytes()), cut, "{end}");
        }
    }
}
