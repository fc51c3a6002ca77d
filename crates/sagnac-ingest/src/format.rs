//! What a file format implements: it recognises a file by its first bytes and opens it as a table.

use crate::block::{Block, FileFacts};
use crate::byte_stream::Packing;
use crate::column::Column;
use crate::cycle::Labels;
use crate::error::IngestError;
use crate::options::ReadOptions;
use sagnac_core::message::Note;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Receives blocks in order; `Break` stops the reading.
pub type OnBlock<'a> = dyn FnMut(&mut Block) -> ControlFlow<()> + 'a;

/// Reads the columns of an opened file.
pub trait Table: Send + Sync {
    /// Reads the requested columns (positions from 0, each at most once) from the start. Every row is delivered once, in
    /// order, in blocks of bounded size. Returns `None` if the consumer stopped the reading.
    ///
    /// # Errors
    /// [`IngestError`] if the file cannot be read to its end.
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError>;
}

/// A file whose format is to be found, with its first bytes.
pub struct Candidate {
    /// Path.
    pub path: PathBuf,
    /// Size, bytes.
    pub bytes: u64,
    /// How it is compressed.
    pub packing: Packing,
    /// Its first bytes, decompressed, at most 256 KiB.
    pub head: Vec<u8>,
    /// True if `head` is the whole content.
    pub head_is_all: bool,
    /// How the user wants it to be read.
    pub options: ReadOptions,
}

/// What a format tells about a file that it opened.
pub struct Opened {
    /// Columns.
    pub columns: Vec<Column>,
    /// Rows, when the format knows or can estimate them cheaply.
    pub rows_estimate: Option<u64>,
    /// Evidence that the end of the file is missing, one note each.
    pub cut_off: Vec<Note>,
    /// Decisions made in opening the file, with their reasons.
    pub notes: Vec<Note>,
    /// Metadata of the file, key and value as written: at most 64 entries of at most 200 characters.
    pub metadata: Vec<(String, String)>,
    /// Sample rate that the file states, Hz.
    pub stated_sample_rate_hz: Option<f64>,
    /// Words in the first rows of columns that hold few of them.
    pub labels: Vec<Labels>,
    /// Rows that are none of the recording and are left out.
    pub bad_blocks: Vec<BadBlock>,
    /// The reader.
    pub table: Box<dyn Table>,
}

/// Rows at the start or the end that are none of the recording.
#[derive(Debug, Clone, PartialEq)]
pub struct BadBlock {
    /// The first of them, counted from 1.
    pub first_row: u64,
    /// Their number.
    pub rows: u64,
    /// What they are, and how they are left out.
    pub note: Note,
}

/// A file format.
pub trait Format: Sync {
    /// Id, for example `csv`.
    fn id(&self) -> &'static str;
    /// True if the first bytes are of this format.
    fn recognises(&self, file: &Candidate) -> bool;
    /// True if the file may be opened because the user states this format; opening then reports what is wrong.
    fn may_be(&self, file: &Candidate) -> bool {
        self.recognises(file)
    }
    /// Opens a file that was recognised.
    ///
    /// # Errors
    /// [`IngestError`] if the file is damaged, empty, or of a variant that is not read.
    fn open(&self, file: &Candidate) -> Result<Opened, IngestError>;
}
