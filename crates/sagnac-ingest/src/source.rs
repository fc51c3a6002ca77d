//! A recording that can be read: a file, several joined, or columns in memory.

use super::beside_columns::{Beside, ClockUncertainty};
use super::byte_stream::{self, ByteStream, Packing, io_error};
use super::error::{IngestError, IngestErrorKind};
use super::file_identity::FileIdentity;
use super::first_values::{Settled, settle};
use super::format_detection::format_of;
use super::guarded::guarded;
use super::in_memory::MemoryColumn;
use super::metadata::{serial_numbers, stated_start};
use super::named_file::open_file;
use super::requested_columns::{NumericCheck, not_numeric, repeat_columns, restore_columns};
use super::similar_column::similar;
use super::{BadBlock, Candidate, Column, FileFacts, HEAD, OnBlock, Opened, ReadOptions, Sensors, in_memory};
use sagnac_core::message::{Note, note};
use sagnac_core::recording::{ColumnRef, Role};
use sagnac_core::units::Unit;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most columns whose names are listed in a hint.
const NAMED_COLUMNS: usize = 30;

/// A recording that can be read: a file, or columns in memory.
#[derive(Clone)]
pub struct Source {
    path: PathBuf,
    format: &'static str,
    packing: Packing,
    bytes: u64,
    /// Of a file; columns in memory have none.
    identity: Option<FileIdentity>,
    opened: Arc<Opened>,
    /// Several sensors whose rows take turns, where none was chosen.
    sensors: Option<Sensors>,
    /// Unit of time stamps as the user states it.
    time_unit: Option<Unit>,
    /// Of a recording of several files.
    several: Option<Arc<SeveralFiles>>,
    /// Columns of files that were recorded beside it.
    beside: Option<Beside>,
}

/// A recording of several files, for what only such a one has.
pub(crate) struct SeveralFiles {
    /// The files in order, each with the phase of the test that it belongs to.
    pub files: Vec<(PathBuf, Option<String>)>,
    /// Each file follows the one before without a gap.
    pub contiguous: bool,
    /// Reads them one after the other.
    pub reader: Box<dyn ReadSeveral>,
}

/// Reads the files of a recording one after the other.
pub(crate) trait ReadSeveral: Send + Sync {
    /// As [`Source::read_parts`].
    ///
    /// # Errors
    /// As [`Source::read_parts`].
    fn read(
        &self,
        wanted: &[usize],
        no_numbers: NoNumbers,
        on_block: &mut OnBlock<'_>,
        on_part: &mut dyn FnMut(usize, PartFacts),
    ) -> Result<Option<FileFacts>, IngestError>;
}

/// What becomes of a requested column that holds no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoNumbers {
    /// The recording is refused.
    Refused,
    /// Its rows are passed on without values.
    PassedOn,
}

/// Rows read of one file of a recording of several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartFacts {
    /// Hash, size and rows.
    pub facts: FileFacts,
    /// Rows of the recording before this file.
    pub rows_before: u64,
}

/// Opens a recording; the format is found by its content.
///
/// # Errors
/// A folder, an unreadable, empty or damaged file, an unknown format, a format that is not compiled in.
pub fn open(path: &Path) -> Result<Source, IngestError> {
    open_with(path, &ReadOptions::default())
}

/// Opens a recording with options.
///
/// # Errors
/// As [`open`], and options that do not fit the file.
pub fn open_with(path: &Path, options: &ReadOptions) -> Result<Source, IngestError> {
    let metadata = std::fs::metadata(path).map_err(|e| io_error(path, &e))?;
    if metadata.is_dir() {
        return Err(
            IngestError::new(IngestErrorKind::Io, path, "ingest.is_folder").hint("ingest.hint.name_a_file")
        );
    }
    open_file(path).map_err(|e| io_error(path, &e))?;
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
    let candidate = Candidate {
        path: path.to_owned(),
        bytes: metadata.len(),
        packing,
        head,
        head_is_all,
        options: options.clone(),
    };
    let format = format_of(&candidate)?;
    let opened = guarded(path, || format.open(&candidate))?;
    let Settled { opened, sensors } = settle(path, opened, options)?;
    let time_unit = options.time_unit.as_deref().and_then(|u| Unit::parse(u).ok());
    Ok(Source {
        sensors,
        time_unit,
        path: path.to_owned(),
        format: format.id(),
        packing,
        bytes: metadata.len(),
        identity: Some(FileIdentity::of(&metadata)),
        opened: Arc::new(opened),
        several: None,
        beside: None,
    })
}

impl Source {
    /// A recording in memory: columns of equal length.
    ///
    /// # Errors
    /// [`IngestErrorKind::Empty`] without columns or rows or with columns of different length.
    pub fn from_columns(
        name: &str,
        columns: Vec<MemoryColumn>,
        block_rows: usize,
    ) -> Result<Source, IngestError> {
        let opened = in_memory::open(Path::new(name), columns, block_rows)?;
        let bytes = in_memory::bytes(opened.rows_estimate.unwrap_or_default(), opened.columns.len());
        Ok(Source { bytes, ..Source::alone(PathBuf::from(name), "memory", opened) })
    }

    /// A recording without columns under the path of one that could not be opened, so that its report can name it.
    pub fn unopened(path: &Path) -> Source {
        let opened = in_memory::nothing();
        Source::alone(path.to_owned(), "unknown", opened)
    }

    fn alone(path: PathBuf, format: &'static str, opened: Opened) -> Source {
        Source {
            path,
            format,
            packing: Packing::Plain,
            bytes: 0,
            identity: None,
            opened: Arc::new(opened),
            sensors: None,
            time_unit: None,
            several: None,
            beside: None,
        }
    }

    /// A recording of several files under a name. Format and packing are those of its first file.
    pub(super) fn of_several(
        name: &Path,
        format: &'static str,
        packing: Packing,
        bytes: u64,
        several: SeveralFiles,
        (described, sensors): (Opened, Option<Sensors>),
    ) -> Source {
        Source {
            path: name.to_owned(),
            format,
            packing,
            bytes,
            identity: None,
            opened: Arc::new(described),
            sensors,
            time_unit: None,
            several: Some(Arc::new(several)),
            beside: None,
        }
    }

    /// The recording with columns of files beside it.
    pub(crate) fn with_beside(mut self, columns: Vec<Column>, notes: Vec<Note>, beside: Beside) -> Source {
        if let Some(opened) = Arc::get_mut(&mut self.opened) {
            opened.columns.extend(columns);
            opened.notes.extend(notes);
            self.beside = Some(beside);
        }
        self
    }

    /// Uncertainties of the clocks of the files beside it, as far as they are known.
    pub fn clock_uncertainties(&self) -> Vec<ClockUncertainty> {
        self.beside.as_ref().map(Beside::uncertainties).unwrap_or_default()
    }

    /// The recording with the clock of a file beside it moved by an uncertainty, times a factor.
    #[must_use]
    pub fn with_clock_moved(&self, by: &ClockUncertainty, factor: f64) -> Source {
        Source { beside: self.beside.as_ref().map(|beside| beside.moved(by, factor)), ..self.clone() }
    }

    /// The files of the recording, in order: one, unless several were joined.
    pub fn files(&self) -> Vec<&Path> {
        match &self.several {
            None => vec![&self.path],
            Some(several) => several.files.iter().map(|(path, _)| path.as_path()).collect(),
        }
    }

    /// The phase of the test that a file belongs to, where a manifest says it.
    pub fn phase(&self, file: usize) -> Option<&str> {
        self.several.as_ref()?.files.get(file)?.1.as_deref()
    }

    /// True when each file follows the one before without a gap, as a manifest says.
    pub fn is_contiguous(&self) -> bool {
        self.several.as_ref().is_some_and(|s| s.contiguous)
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

    /// Decisions made in opening the file, with their reasons.
    pub fn notes(&self) -> &[Note] {
        &self.opened.notes
    }

    /// Evidence that the end of a file is missing, one note per file.
    pub fn cut_off(&self) -> &[Note] {
        &self.opened.cut_off
    }

    /// Metadata of the file, key and value as written.
    pub fn metadata(&self) -> &[(String, String)] {
        &self.opened.metadata
    }

    /// The serial numbers of units that the recording states under usual keys: more than one where files of several
    /// units were put together.
    pub fn stated_serials(&self) -> Vec<&str> {
        serial_numbers(self.metadata())
    }

    /// Several sensors whose rows take turns, where none was chosen.
    pub fn sensors(&self) -> Option<&Sensors> {
        self.sensors.as_ref()
    }

    /// Unit of time stamps as the user states it.
    pub fn time_unit(&self) -> Option<&Unit> {
        self.time_unit.as_ref()
    }

    /// Rows that are none of the recording and are left out.
    pub fn bad_blocks(&self) -> &[BadBlock] {
        &self.opened.bad_blocks
    }

    /// Position of the column that tells the time, from 0: the first that goes on, else the first that starts again,
    /// such as clock time.
    pub fn time_column(&self) -> Option<usize> {
        let first = |wanted: fn(&Column) -> bool| {
            self.columns().iter().position(|c| c.numeric && wanted(c) && c.inferred().role == Role::Time)
        };
        first(|c| c.rollover_s.is_none()).or_else(|| first(|_| true))
    }

    /// When the recording began, RFC 3339, as the file states it.
    pub fn stated_start(&self) -> Option<String> {
        stated_start(self.metadata())
    }

    /// Sample rate that the file states, Hz.
    pub fn stated_sample_rate_hz(&self) -> Option<f64> {
        self.opened.stated_sample_rate_hz
    }

    /// Sample rate where no stamps tell it, Hz: as declared by the user, else as the file states it.
    pub fn rate_without_stamps_hz(&self, declared_hz: Option<f64>) -> Option<f64> {
        declared_hz.or(self.stated_sample_rate_hz())
    }

    /// Finds a column; the result is its position from 0.
    ///
    /// # Errors
    /// [`IngestErrorKind::Column`] when it is not there, stands twice, or holds no numbers.
    pub fn resolve(&self, column: &ColumnRef) -> Result<usize, IngestError> {
        let columns = self.columns();
        let index = match column {
            ColumnRef::Position(p) => p.checked_sub(1).filter(|&i| i < columns.len()).ok_or_else(|| {
                self.column_error(note!("ingest.no_column_at", position = *p))
                    .hint(note!("ingest.hint.columns_to", count = columns.len()))
            })?,
            ColumnRef::Name(name) => self.column_named(name)?,
        };
        match columns.get(index) {
            Some(c) if !c.numeric => Err(self.column_error(note!(
                "ingest.column_no_numbers",
                name = c.name.as_str(),
                storage = c.storage.as_str()
            ))),
            _ => Ok(index),
        }
    }

    /// The column that a name means which no column has.
    pub fn similar_column(&self, name: &str) -> Option<&str> {
        similar(name, self.columns().iter().map(|c| c.name.as_str()))
    }

    /// Which columns there are, and which of them may be meant.
    pub fn columns_hint(&self, meant: Option<&str>) -> Note {
        let columns = self.columns();
        let mut names: Vec<&str> = columns.iter().take(NAMED_COLUMNS).map(|c| c.name.as_str()).collect();
        if columns.len() > NAMED_COLUMNS {
            names.push("…");
        }
        let hint = match meant {
            Some(meant) => note!("ingest.hint.column_meant", name = meant),
            None => note!("ingest.hint.the_file_has"),
        };
        hint.with("names", names.join(", "))
    }

    fn column_error(&self, message: Note) -> IngestError {
        IngestError::new(IngestErrorKind::Column, &self.path, message)
    }

    /// The only column of a name.
    fn column_named(&self, name: &str) -> Result<usize, IngestError> {
        let columns = self.columns();
        let found: Vec<usize> =
            columns.iter().enumerate().filter(|(_, c)| c.name == name).map(|(i, _)| i).collect();
        match found.as_slice() {
            [one] => Ok(*one),
            [] => {
                let hint = self.columns_hint(self.similar_column(name));
                Err(self.column_error(note!("ingest.no_column_named", name)).hint(hint))
            }
            several => {
                let places: Vec<String> = several.iter().map(|i| (i + 1).to_string()).collect();
                let note =
                    note!("ingest.name_twice", name, count = several.len(), places = places.join(", "));
                Err(self.column_error(note).hint("ingest.hint.give_position"))
            }
        }
    }

    /// Reads the requested columns (positions from 0, repetition allowed) in blocks, in order. Returns `None` if the
    /// consumer stopped the reading.
    ///
    /// # Errors
    /// [`IngestError`] if the file cannot be read to its end; [`IngestErrorKind::NotNumeric`] if more than half of the first
    /// 1000 fields of a requested column are not numbers.
    pub fn read(
        &self,
        wanted: &[usize],
        on_block: &mut OnBlock<'_>,
    ) -> Result<Option<FileFacts>, IngestError> {
        self.read_parts(wanted, on_block, &mut |_, _| {})
    }

    /// As [`Source::read`]; `on_part` receives hash and size of each file of a recording of several once it was read.
    ///
    /// # Errors
    /// As [`Source::read`], for each of the files.
    pub fn read_parts(
        &self,
        wanted: &[usize],
        on_block: &mut OnBlock<'_>,
        on_part: &mut dyn FnMut(usize, PartFacts),
    ) -> Result<Option<FileFacts>, IngestError> {
        self.read_with(wanted, NoNumbers::Refused, on_block, on_part)
    }

    /// As [`Source::read_parts`], with the columns judged or not.
    pub(crate) fn read_with(
        &self,
        wanted: &[usize],
        no_numbers: NoNumbers,
        on_block: &mut OnBlock<'_>,
        on_part: &mut dyn FnMut(usize, PartFacts),
    ) -> Result<Option<FileFacts>, IngestError> {
        match &self.beside {
            Some(beside) => beside.read(wanted, on_block, |wanted, on_block| {
                self.read_own(wanted, no_numbers, on_block, on_part)
            }),
            None => self.read_own(wanted, no_numbers, on_block, on_part),
        }
    }

    /// The same for columns of the recording's own files.
    fn read_own(
        &self,
        wanted: &[usize],
        no_numbers: NoNumbers,
        on_block: &mut OnBlock<'_>,
        on_part: &mut dyn FnMut(usize, PartFacts),
    ) -> Result<Option<FileFacts>, IngestError> {
        if let Some(several) = &self.several {
            return several.reader.read(wanted, no_numbers, on_block, on_part);
        }
        let mut unique: Vec<usize> = Vec::new();
        let mut slot_of = BTreeMap::new();
        for &w in wanted {
            slot_of.entry(w).or_insert_with(|| {
                unique.push(w);
                unique.len() - 1
            });
        }
        let slots: Vec<usize> = wanted.iter().filter_map(|w| slot_of.get(w).copied()).collect();
        let mut guard = (no_numbers == NoNumbers::Refused).then(|| NumericCheck::new(unique.len()));
        let mut refusal = None;
        let facts = self.opened.table.read(&unique, &mut |block| {
            refusal = guard.as_mut().and_then(|g| g.judge(block).into_iter().next());
            if refusal.is_some() {
                return ControlFlow::Break(());
            }
            repeat_columns(block, &slots);
            let flow = on_block(block);
            restore_columns(block, unique.len());
            flow
        });
        // A file that was still being written is not a damaged one.
        let facts = match (facts, &self.identity) {
            (Err(e), Some(identity)) => return Err(identity.check_unchanged(&self.path).err().unwrap_or(e)),
            (facts, _) => facts?,
        };
        if let Some(fault) = refusal.or_else(|| guard?.judge_at_end().into_iter().next()) {
            return Err(not_numeric(&self.path, &fault, &unique, self.columns()));
        }
        if let Some(facts) = &facts {
            byte_stream::unchanged(&self.path, self.bytes, facts.bytes, facts.bytes)?;
            self.identity.as_ref().map_or(Ok(()), |identity| identity.check_unchanged(&self.path))?;
        }
        if facts.as_ref().is_some_and(|f| f.rows == 0) {
            return Err(IngestError::new(IngestErrorKind::Empty, &self.path, "ingest.no_rows")
                .hint("ingest.hint.check_written"));
        }
        Ok(facts)
    }
}
