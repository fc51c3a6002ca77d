//! Rows of a file in blocks: what a reader delivers.

/// Why a field of a file is not a finite number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldFaultKind {
    /// Empty, null, NaN, infinite, or beyond 1e60 in magnitude.
    NonFinite,
    /// No number, or the row has the wrong number of fields.
    Unparsable,
}

/// A field that is not a finite number; its value in the block is NaN.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldFault {
    /// Position among the requested columns.
    pub slot: usize,
    /// Row in the file, counted from 1 without header lines.
    pub row: u64,
    /// Line of the text, counted from 1; 0 for formats without lines.
    pub line: u64,
    /// Character in the line, counted from 1; 0 for formats without lines.
    pub character: u64,
    /// Kind.
    pub kind: FieldFaultKind,
    /// The field as it is written in the file, shortened.
    pub text: String,
}

/// At most this many faults of a kind are located in a block, for each column; all are counted.
pub(crate) const LOCATED_PER_BLOCK: u64 = 100;

/// Consecutive rows of the requested columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Block {
    /// Which file of the recording, counted from 0.
    pub part: usize,
    /// Number of the first row, counted from 1 over all files of the recording.
    pub first_row: u64,
    /// Line of the text that the block starts on, counted from 1.
    pub(crate) first_line: u64,
    /// Number of lines of text.
    pub(crate) lines: u64,
    /// One vector of equal length per requested column; NaN where a field is not a finite number.
    pub columns: Vec<Vec<f64>>,
    /// The first such fields of each kind and column, with their places.
    pub faults: Vec<FieldFault>,
    /// Number of non-finite fields per requested column.
    pub non_finite: Vec<u64>,
    /// Number of unparsable fields per requested column.
    pub unparsable: Vec<u64>,
    /// Bytes of the file read so far.
    pub bytes_done: u64,
}

impl Block {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Empties the block for `slots` columns, keeping its memory.
    pub(crate) fn reset(&mut self, slots: usize) {
        self.columns.resize_with(slots, Vec::new);
        self.columns.iter_mut().for_each(Vec::clear);
        self.faults.clear();
        for counts in [&mut self.non_finite, &mut self.unparsable] {
            counts.clear();
            counts.resize(slots, 0);
        }
        self.lines = 0;
        self.first_row = 0;
        self.first_line = 0;
    }

    /// Counts a fault and locates it while there is room.
    pub(crate) fn fault(&mut self, fault: impl FnOnce() -> FieldFault, slot: usize, kind: FieldFaultKind) {
        let counts = match kind {
            FieldFaultKind::NonFinite => &mut self.non_finite,
            FieldFaultKind::Unparsable => &mut self.unparsable,
        };
        if let Some(count) = counts.get_mut(slot) {
            *count += 1;
            if *count <= LOCATED_PER_BLOCK {
                self.faults.push(fault());
            }
        }
    }
}

/// Hash and size of a file that was read to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileFacts {
    /// SHA-256 of the bytes of the file, hexadecimal; empty for a recording in memory.
    pub sha256: String,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Number of rows.
    pub rows: u64,
}
