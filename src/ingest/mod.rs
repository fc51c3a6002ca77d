//! Files into blocks of numbers.
//!
//! A [`Format`] recognises a file by its first bytes and opens it as a [`Table`]; [`FORMATS`] lists them all, so that
//! one more format costs one file and one line. [`open`] gives a [`Source`]: the columns of a file and a way to read
//! wanted ones block by block. [`stream`] puts a time base on the blocks and feeds them to sinks.

pub mod compressed;
mod csv;
mod dialect;
mod error;
mod guarded;
mod identity;
mod lines;
mod memory;
mod number;
mod options;
mod parquet;
mod plan;
mod reduce;
mod stream;

pub use compressed::Packing;
pub use error::{IngestError, IngestErrorKind};
pub use options::{Encoding, ReadOptions, TextOptions};
pub use plan::{Plan, TimeBaseSpec, prepare};
pub use stream::{ChannelFacts, StreamReport, stream, stream_path};

use crate::recording::ColumnRef;
use crate::text::{Arg, Note};
use compressed::{ByteStream, io_error};
use identity::FileIdentity;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in the header, or `column_1`, `column_2` ... where there is none.
    pub name: String,
    /// True when the format can give numbers for it. A text file says so of every column.
    pub numeric: bool,
    /// Type in the file, in the format's words, for example `DOUBLE`; `text` for text files.
    pub storage: String,
    /// Unit the format itself declares, for example `ms` for a Parquet time stamp.
    pub unit: Option<String>,
    /// Seconds from 1970 to the zero of the values, when the reader turned stamps with a date into seconds; the unit is
    /// `s` then.
    pub epoch_s: Option<f64>,
    /// Period after which the stamps start again, s: 86400 for clock time, 604800 for seconds of a week.
    pub rollover_s: Option<f64>,
}

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
    /// Row of the first, counted from 1.
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
    /// Opens a file that was recognised.
    ///
    /// # Errors
    /// Says what is wrong with the file.
    fn open(&self, file: &Candidate) -> Result<Opened, IngestError>;
}

/// Every format, the most particular first. Text comes last: it takes whatever looks like lines.
pub static FORMATS: &[&dyn Format] = &[&parquet::Parquet, &csv::DelimitedText];

/// First bytes of kinds of files that are not read, with the keys of what they are and what to do about them.
const NOT_READ: &[(&[u8], &str, &str)] = &[
    (b"PK\x03\x04", "ingest.kind.zip", "ingest.hint.export_sheet"),
    (b"\x89HDF", "ingest.kind.hdf5", "ingest.hint.export_data"),
    (b"MATLAB 5.0", "ingest.kind.matlab", "ingest.hint.export_data"),
    (b"\x93NUMPY", "ingest.kind.numpy", "ingest.hint.export_data"),
    (b"%PDF", "ingest.kind.pdf", "ingest.hint.give_recording"),
    (b"7z\xbc\xaf", "ingest.kind.seven_zip", "ingest.hint.unpack"),
    (b"BZh", "ingest.kind.bzip2", "ingest.hint.repack"),
    (b"\xfd7zXZ", "ingest.kind.xz", "ingest.hint.repack"),
    (b"\xff\xfe", "ingest.kind.utf16", "ingest.hint.save_utf8"),
    (b"\xfe\xff", "ingest.kind.utf16", "ingest.hint.save_utf8"),
];

/// Longest piece of the start of a file that is looked at, bytes.
const HEAD: usize = 256 << 10;

/// A recording that can be read: a file, or columns in memory.
pub struct Source {
    path: PathBuf,
    format: &'static str,
    packing: Packing,
    bytes: u64,
    /// Of a file; columns in memory have none.
    identity: Option<FileIdentity>,
    opened: Opened,
}

/// Opens a recording; the format is found by its content.
///
/// # Errors
/// A directory, an unreadable, empty or damaged file, an unknown kind of file, a file without rows.
pub fn open(path: &Path) -> Result<Source, IngestError> {
    open_with(path, &ReadOptions::default())
}

/// Opens a recording as its user says.
///
/// # Errors
/// As [`open`], and where what was said does not fit the file.
pub fn open_with(path: &Path, options: &ReadOptions) -> Result<Source, IngestError> {
    let metadata = std::fs::metadata(path).map_err(|e| io_error(path, &e))?;
    if metadata.is_dir() {
        return Err(
            IngestError::new(IngestErrorKind::Io, path, "ingest.is_folder").hint("ingest.hint.name_a_file")
        );
    }
    if metadata.len() == 0 {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.empty_file")
            .hint("ingest.hint.check_written"));
    }
    let mut first = ByteStream::open(path, Packing::Plain)?;
    let mut magic = [0; 8];
    let n = first.fill(&mut magic)?;
    let packing = Packing::of(&magic[..n]);
    let mut head = vec![0; HEAD];
    let mut stream = ByteStream::open(path, packing)?;
    let n = stream.fill(&mut head)?;
    head.truncate(n);
    let head_is_all = n < HEAD;
    if head.is_empty() {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.empty_packed")
            .hint("ingest.hint.check_written"));
    }
    if let Some((_, what, hint)) = NOT_READ.iter().find(|(magic, ..)| head.starts_with(magic)) {
        return Err(IngestError::new(
            IngestErrorKind::UnknownFormat,
            path,
            Note::new("ingest.not_read").with("what", Arg::Key((*what).to_owned())),
        )
        .hint(*hint));
    }
    let candidate = Candidate {
        path: path.to_owned(),
        bytes: metadata.len(),
        packing,
        head,
        head_is_all,
        options: options.clone(),
    };
    let Some(format) = FORMATS.iter().find(|f| f.recognises(&candidate)) else {
        return Err(IngestError::new(IngestErrorKind::UnknownFormat, path, "ingest.unknown")
            .hint("ingest.hint.give_known"));
    };
    let opened = format.open(&candidate)?;
    let identity = FileIdentity::of(&metadata);
    Ok(Source {
        path: path.to_owned(),
        format: format.id(),
        packing,
        bytes: metadata.len(),
        identity: Some(identity),
        opened,
    })
}

impl Source {
    /// A recording in memory: names with columns of equal length. Used by simulations and tests.
    ///
    /// # Errors
    /// [`IngestErrorKind::Empty`] without columns or rows or with columns of different length.
    pub fn from_columns(
        name: &str,
        columns: Vec<(String, Vec<f64>)>,
        block_rows: usize,
    ) -> Result<Source, IngestError> {
        let opened = memory::open(Path::new(name), columns, block_rows)?;
        Ok(Source {
            path: PathBuf::from(name),
            format: "memory",
            packing: Packing::Plain,
            bytes: 0,
            identity: None,
            opened,
        })
    }

    /// A recording without columns under the path of one that could not be opened, so that its report can name it.
    pub fn unopened(path: &Path) -> Source {
        let opened = memory::nothing();
        Source {
            path: path.to_owned(),
            format: "unknown",
            packing: Packing::Plain,
            bytes: 0,
            identity: None,
            opened,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Id of the format, `memory` for a recording in memory.
    pub fn format(&self) -> &'static str {
        self.format
    }

    /// How the file is packed.
    pub fn packing(&self) -> Packing {
        self.packing
    }

    /// Size of the file, bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Columns in the order of the file.
    pub fn columns(&self) -> &[Column] {
        &self.opened.columns
    }

    /// Rows, where that is known or can be estimated without reading the file.
    pub fn rows_estimate(&self) -> Option<u64> {
        self.opened.rows_estimate
    }

    /// What was decided about the file and why.
    pub fn notes(&self) -> &[Note] {
        &self.opened.notes
    }

    /// What the file says of itself, key and value as written.
    pub fn metadata(&self) -> &[(String, String)] {
        &self.opened.metadata
    }

    /// Sample rate that the file states, Hz. It counts only where neither stamps nor the user tell the rate.
    pub fn stated_sample_rate_hz(&self) -> Option<f64> {
        self.opened.stated_sample_rate_hz
    }

    /// Finds a column; the result is its position from 0.
    ///
    /// # Errors
    /// [`IngestErrorKind::Column`] when it is not there, stands twice, or holds no numbers.
    pub fn resolve(&self, column: &ColumnRef) -> Result<usize, IngestError> {
        let error = |message: Note| IngestError::new(IngestErrorKind::Column, &self.path, message);
        let columns = self.columns();
        let index = match column {
            ColumnRef::Position(p) => p.checked_sub(1).filter(|&i| i < columns.len()).ok_or_else(|| {
                error(Note::new("ingest.no_column_at").with("position", *p))
                    .hint(Note::new("ingest.hint.columns_to").with("count", columns.len()))
            })?,
            ColumnRef::Name(name) => {
                let found: Vec<usize> =
                    (0..columns.len()).filter(|&i| columns.get(i).is_some_and(|c| c.name == *name)).collect();
                match found.as_slice() {
                    [one] => *one,
                    [] => {
                        let near = columns
                            .iter()
                            .map(|c| (strsim::damerau_levenshtein(&c.name, name), &c.name))
                            .min()
                            .filter(|(distance, c)| *distance <= 1 + c.chars().count() / 3);
                        let hint = match near {
                            Some((_, near)) => {
                                Note::new("ingest.hint.did_you_mean").with("name", near.as_str())
                            }
                            None => {
                                let names: Vec<&str> =
                                    columns.iter().take(30).map(|c| c.name.as_str()).collect();
                                Note::new("ingest.hint.the_file_has").with("names", names.join(", "))
                            }
                        };
                        return Err(
                            error(Note::new("ingest.no_column_named").with("name", name.as_str())).hint(hint)
                        );
                    }
                    several => {
                        let places: Vec<String> = several.iter().map(|i| (i + 1).to_string()).collect();
                        return Err(error(
                            Note::new("ingest.name_twice")
                                .with("name", name.as_str())
                                .with("count", several.len())
                                .with("places", places.join(", ")),
                        )
                        .hint("ingest.hint.give_position"));
                    }
                }
            }
        };
        match columns.get(index) {
            Some(c) if !c.numeric => Err(error(
                Note::new("ingest.column_no_numbers")
                    .with("name", c.name.as_str())
                    .with("storage", c.storage.as_str()),
            )),
            _ => Ok(index),
        }
    }

    /// Reads wanted columns (positions from 0; one may be wanted twice) in blocks, in order. `None` when the consumer
    /// stopped the reading.
    ///
    /// # Errors
    /// Whatever keeps the file from being read to its end; [`IngestErrorKind::NotNumeric`] when more than half of the
    /// first 1000 fields of a wanted column are no numbers.
    pub fn read(
        &self,
        wanted: &[usize],
        on_block: &mut OnBlock<'_>,
    ) -> Result<Option<FileFacts>, IngestError> {
        let mut unique: Vec<usize> = Vec::new();
        for &w in wanted {
            if !unique.contains(&w) {
                unique.push(w);
            }
        }
        let slots: Vec<usize> = wanted.iter().filter_map(|w| unique.iter().position(|u| u == w)).collect();
        let mut guard = reduce::FirstRows::new(unique.len());
        let mut refusal = None;
        let facts = self.opened.table.read(&unique, &mut |block| {
            if let Some(fault) = guard.judge(block) {
                refusal = Some(fault);
                return ControlFlow::Break(());
            }
            reduce::spread(block, &slots);
            let flow = on_block(block);
            reduce::gather(block, unique.len());
            flow
        });
        // A file that was still being written is not a damaged one.
        let facts = match (facts, &self.identity) {
            (Err(e), Some(identity)) => return Err(identity.still_at(&self.path).err().unwrap_or(e)),
            (facts, _) => facts?,
        };
        if let Some(fault) = refusal.or_else(|| guard.judge_short()) {
            return Err(reduce::not_numeric(&self.path, &fault, &unique, self.columns()));
        }
        if let Some(facts) = &facts {
            compressed::unchanged(&self.path, self.bytes, facts.bytes, facts.bytes)?;
            self.identity.as_ref().map_or(Ok(()), |identity| identity.still_at(&self.path))?;
        }
        if facts.as_ref().is_some_and(|f| f.rows == 0) {
            return Err(IngestError::new(IngestErrorKind::Empty, &self.path, "ingest.no_rows")
                .hint("ingest.hint.check_written"));
        }
        Ok(facts)
    }
}

#[cfg(test)]
mod tests;
