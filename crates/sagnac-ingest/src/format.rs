//! What a file format implements: it recognises a file by its first bytes and opens it as a table.

use crate::block::{Block, FileFacts};
use crate::byte_stream::Packing;
use crate::column::Column;
use crate::error::IngestError;
use crate::options::ReadOptions;
use sagnac_core::message::Note;
use std::ops::ControlFlow;
use std::path::PathBuf;

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
