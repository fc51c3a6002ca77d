//! Rows of a file in blocks: what a reader delivers.

/// Why a field is no finite number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldFaultKind {
    /// Empty, null, NaN, infinite, or beyond 1e60 in magnitude.
    NonFinite,
    /// No number, or the row has the wrong number of fields.
    Unparsable,
}

/// A field that is no finite number; it is NaN in the block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldFault {
    /// Which of the wanted columns.
    pub slot: usize,
    /// Row in the file, counted from 1 without header lines.
    pub row: u64,
    /// Line of the text and character in it, counted from 1; 0 for formats without lines.
    pub line: u64,
    /// Character in the line, counted from 1; 0 for formats without lines.
    pub character: u64,
    /// Kind.
    pub kind: FieldFaultKind,
    /// The text found.
    pub text: String,
}

/// At most this many faults of a kind are located in a block, for each column; all are counted.
pub(crate) const LOCATED_PER_BLOCK: u64 = 100;

/// Some rows of the wanted columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Block {
    /// Which file of the recording, counted from 0.
    pub part: usize,
    /// Row of the first, counted from 1; in a recording of several files rows count on.
    pub first_row: u64,
    /// Line of the text that the block starts on, counted from 1.
    pub(crate) first_line: u64,
    /// Number of lines of text.
    pub(crate) lines: u64,
    /// One vector for each wanted column, all of one length; NaN where there is no finite number.
    pub columns: Vec<Vec<f64>>,
    /// Fields that are no finite numbers, the first of each kind and column.
    pub faults: Vec<FieldFault>,
    /// All non-finite fields, by wanted column.
    pub non_finite: Vec<u64>,
    /// All unparsable fields, by wanted column.
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

/// What is known of a file when it was read to the end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileFacts {
    /// SHA-256 of the bytes of the file, hexadecimal; empty for a recording in memory.
    pub sha256: String,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Rows.
    pub rows: u64,
}
