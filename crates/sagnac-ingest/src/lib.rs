//! Files into blocks of numbers.
//!
//! A [`Format`] recognises a file by its first bytes and opens it as a [`Table`]; [`FORMATS`] lists them all, so that
//! one more format costs one file and one line. [`open`] gives a [`Source`]: the columns of a file and a way to read
//! wanted ones block by block. [`stream`] puts a time base on the blocks and feeds them to sinks.

mod accumulated;
mod binary;
mod choice;
mod column;
pub mod compressed;
mod delimited;
#[cfg(test)]
mod english;
mod error;
pub mod faults;
mod field_faults;
mod following;
mod guarded;
pub mod guess;
mod hdf5;
mod identity;
pub mod joined;
mod matlab;
mod memory;
mod number;
mod numpy;
mod options;
mod parquet;
mod parts;
pub mod pattern;
mod pauses;
mod plan;
mod pump;
pub mod raw;
mod reduce;
mod ros;
mod source;
mod stream;
mod system;
mod tdms;
pub mod timebase;
pub mod value_checks;

pub use column::Column;
pub(crate) use column::DATES;
pub use compressed::Packing;
pub use error::{IngestError, IngestErrorKind};
pub use joined::PartFacts;
pub use options::{Encoding, ReadOptions, StampOptions, StampWriting, TextOptions};
pub use pauses::Pauses;
pub use plan::{Plan, TimeBaseSpec, prepare};
pub use source::{Source, open, open_with};
pub use stream::{ChannelFacts, FileReport, StreamReport, locate, stream, stream_path};
pub use system::io_reason;

use sagnac_core::message::Note;
use std::ops::ControlFlow;
use std::path::PathBuf;

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

/// Takes blocks in order; may stop the reading.
pub type OnBlock<'a> = dyn FnMut(&mut Block) -> ControlFlow<()> + 'a;

/// An opened file that can be read.
pub trait Table: Send + Sync {
    /// Reads the wanted columns (positions from 0, each at most once) from the start; every row is delivered once, in
    /// order, in blocks of bounded size. `None` when the consumer stopped the reading.
    ///
    /// # Errors
    /// Whatever keeps the file from being read to its end.
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError>;
}

/// A file of which the first bytes have been looked at.
pub struct Candidate {
    /// Path.
    pub path: PathBuf,
    /// Size, bytes.
    pub bytes: u64,
    /// How it is packed.
    pub packing: Packing,
    /// The first unpacked bytes, at most 256 KiB.
    pub head: Vec<u8>,
    /// True when `head` is the whole content.
    pub head_is_all: bool,
    /// What the user decided about the file.
    pub options: ReadOptions,
}

/// What a format says of a file.
pub struct Opened {
    /// Columns.
    pub columns: Vec<Column>,
    /// Rows, when the format knows or can estimate them cheaply.
    pub rows_estimate: Option<u64>,
    /// What shows that the end of the file is missing.
    pub cut_off: Vec<Note>,
    /// What was decided about the file and why.
    pub notes: Vec<Note>,
    /// What the file says of itself, key and value as written: a bounded number of bounded length.
    pub metadata: Vec<(String, String)>,
    /// Sample rate that the file states, Hz.
    pub stated_sample_rate_hz: Option<f64>,
    /// The reader.
    pub table: Box<dyn Table>,
}

/// A file format.
pub trait Format: Sync {
    /// Id, for example `csv`.
    fn id(&self) -> &'static str;
    /// True when the first bytes are of this format.
    fn recognises(&self, file: &Candidate) -> bool;
    /// True when a file may be opened as of this format because its user says so; opening then says what is wrong.
    fn may_be(&self, file: &Candidate) -> bool {
        self.recognises(file)
    }
    /// Opens a file that was recognised.
    ///
    /// # Errors
    /// Says what is wrong with the file.
    fn open(&self, file: &Candidate) -> Result<Opened, IngestError>;
}

/// Every format, the most particular first: raw records only where a layout is given, text last, because it takes
/// whatever looks like lines.
pub static FORMATS: &[&dyn Format] = &[
    &raw::Raw,
    &parquet::Parquet,
    &numpy::Npy,
    &numpy::Npz,
    &hdf5::Hdf5,
    &matlab::Mat,
    &tdms::Tdms,
    &ros::Mcap,
    &ros::RosBag,
    &delimited::DelimitedText,
];

/// Longest piece of the start of a file that is looked at, bytes.
const HEAD: usize = 256 << 10;

#[cfg(test)]
mod tests;
