//! A line that is repeated to the end of a text file whose rows differ otherwise: erased memory, a logger that ran on.

use crate::byte_stream::{Packing, io_error};
use crate::format::BadBlock;
use crate::{Candidate, IngestError, open_file};
use sagnac_core::message::note;
use std::io::{Read, Seek, SeekFrom};

/// Bytes at the end that are looked at before the whole file is.
const TAIL_BYTES: u64 = 16 << 10;

/// Fewest equal lines at the end that are none of the recording.
const MIN_EQUAL_LINES: u64 = 32;

/// Largest file that is looked at, bytes: it is read into memory.
const MAX_FILE_BYTES: u64 = 256 << 20;

/// Longest line that is looked at, bytes.
const MAX_LINE_BYTES: usize = 1 << 10;

/// Equal lines at the end of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct VoidRows {
    /// The line.
    pub line: Vec<u8>,
    /// First of them, as a row of data counted from 1.
    pub first_row: u64,
    /// Their number.
    pub rows: u64,
}

impl VoidRows {
    /// What they are, for the user.
    pub fn block(&self) -> BadBlock {
        let note = note!(
            "ingest.judged.void_rows",
            first = self.first_row,
            last = self.first_row + self.rows - 1,
            before = self.first_row - 1
        );
        BadBlock { first_row: self.first_row, rows: self.rows, note }
    }
}

/// Looks for lines at the end of a plain file that are all the same. `data_line`: line of the first row, counted from 1.
/// Nothing is looked for where the user says which rows are read.
pub(super) fn look(file: &Candidate, data_line: u64) -> Result<Option<VoidRows>, IngestError> {
    if file.packing != Packing::Plain || file.options.rows.is_some() || file.bytes > MAX_FILE_BYTES {
        return Ok(None);
    }
    let io = |e| io_error(&file.path, &e);
    let mut handle = open_file(&file.path).map_err(io)?;
    handle.seek(SeekFrom::Start(file.bytes.saturating_sub(TAIL_BYTES))).map_err(io)?;
    let mut tail = Vec::new();
    handle.by_ref().take(TAIL_BYTES).read_to_end(&mut tail).map_err(io)?;
    if tail.contains(&0) || at_end(&tail, 0).is_none() {
        return Ok(None);
    }
    handle.seek(SeekFrom::Start(0)).map_err(io)?;
    let mut all = Vec::new();
    handle.take(file.bytes).read_to_end(&mut all).map_err(io)?;
    Ok(at_end(&all, data_line.saturating_sub(1)))
}

/// The equal lines at the end of a text, with `above` lines before its first row.
fn at_end(text: &[u8], above: u64) -> Option<VoidRows> {
    let lines = || text.rsplit(|c| *c == b'\n').filter(|l| !l.trim_ascii().is_empty());
    let line = lines().next().filter(|l| l.len() < MAX_LINE_BYTES)?.trim_ascii_end();
    let rows = lines().take_while(|l| l.trim_ascii_end() == line).count() as u64;
    let before = lines().count() as u64 - rows;
    let first_row = (before + 1).checked_sub(above)?;
    (rows >= MIN_EQUAL_LINES).then(|| VoidRows { line: line.to_vec(), first_row, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_repeated_to_the_end_is_no_row() {
        let good: String = (0..50).map(|i| format!("{i},0.1,2\n")).collect();
        let erased = "4294967.295,nan,-1\n".repeat(40);
        let found = at_end(format!("t,rate,x\n{good}{erased}").as_bytes(), 1).unwrap();
        assert_eq!((found.first_row, found.rows), (51, 40));
        assert_eq!(found.line, b"4294967.295,nan,-1");
        assert_eq!(at_end(good.as_bytes(), 0), None);
    }
}
