//! Columns that lie in different places of a file, each packed or not, read side by side in blocks of rows.

use super::positioned_file::{FileRange, PositionedFile, digest_unless};
use super::records::{ROWS, fields, set_aside_unusable};
use crate::byte_stream::io_error;
use crate::error::{IngestError, IngestErrorKind};
use crate::layout::Field;
use crate::{Block, FileFacts, OnBlock, Table};
use sagnac_core::message::Note;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// Numbers in a block, all columns together, at most.
const NUMBERS: usize = 1 << 20;

/// Packed streams that are unpacked side by side; more are unpacked one after the other into a temporary file.
const SIDE_BY_SIDE: usize = 16;

/// Unpacked size from which the ratio is watched, and unpacked bytes per byte of the file beyond which it is refused:
/// as for packed files.
const BOMB_FROM: u64 = 16 << 20;
const BOMB_RATIO: u64 = 500;

/// How a stream of bytes is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coding {
    /// As it is.
    Stored,
    /// As it is, with the CRC-32 of the whole.
    Checked(u32),
    /// Deflate, with the CRC-32 of what it unpacks to.
    Deflate(u32),
    /// zlib.
    Zlib,
}

/// A stream of bytes in a file.
#[derive(Debug, Clone)]
pub(crate) struct Stream {
    /// Its name in diagnostics.
    pub name: String,
    /// First byte in the file.
    pub from: u64,
    /// Length in the file, bytes.
    pub length: u64,
    /// How it is packed.
    pub coding: Coding,
}

/// Bytes at the start of a stream with a CRC-32 that are read for its sake before the wanted ones.
const CHECKED_FROM: u64 = 1 << 20;

impl Stream {
    /// The same bytes without the check of the whole.
    fn unchecked(&self) -> Stream {
        Stream { coding: Coding::Stored, ..self.clone() }
    }

    /// The unpacked bytes from the start. The end of the packed data is checked where it is read to it.
    pub fn open(&self, at: &Arc<PositionedFile>) -> Unpacked {
        let part = FileRange::new(at, self.from, self.length);
        let limit = BOMB_FROM.max(at.size.saturating_mul(BOMB_RATIO));
        let inner = match self.coding {
            Coding::Stored => Inner::Stored(part),
            Coding::Checked(crc) => Inner::Checked(part, flate2::Crc::new(), crc),
            Coding::Deflate(crc) => {
                Inner::Deflate(flate2::read::DeflateDecoder::new(part), flate2::Crc::new(), crc)
            }
            Coding::Zlib => Inner::Zlib(flate2::read::ZlibDecoder::new(part)),
        };
        Unpacked { inner, done: 0, limit }
    }
}

enum Inner {
    Stored(FileRange),
    Checked(FileRange, flate2::Crc, u32),
    Deflate(flate2::read::DeflateDecoder<FileRange>, flate2::Crc, u32),
    Zlib(flate2::read::ZlibDecoder<FileRange>),
}

/// Unpacked bytes, in order.
pub(crate) struct Unpacked {
    inner: Inner,
    done: u64,
    limit: u64,
}

/// What stands for a bomb among the errors of reading.
const BOMB: &str = "unpacks to far more than a recording could";

impl Read for Unpacked {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = match &mut self.inner {
            Inner::Stored(part) => return part.read(buffer),
            Inner::Zlib(d) => d.read(buffer)?,
            Inner::Checked(part, crc, expected) => checked(part, crc, *expected, buffer)?,
            Inner::Deflate(d, crc, expected) => checked(d, crc, *expected, buffer)?,
        };
        self.done += n as u64;
        if self.done > self.limit {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, BOMB));
        }
        Ok(n)
    }
}

/// Reads on and compares the CRC-32 at the end.
fn checked(
    from: &mut dyn Read,
    crc: &mut flate2::Crc,
    expected: u32,
    buffer: &mut [u8],
) -> io::Result<usize> {
    let n = from.read(buffer)?;
    crc.update(buffer.get(..n).unwrap_or_default());
    if n == 0 && !buffer.is_empty() && crc.sum() != expected {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "the CRC-32 does not fit"));
    }
    Ok(n)
}

impl Unpacked {
    /// Fills the buffer as far as the stream goes.
    pub fn fill(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut done = 0;
        while let Some(rest) = buffer.get_mut(done..).filter(|r| !r.is_empty()) {
            match self.read(rest) {
                Ok(0) => break,
                Ok(n) => done += n,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(done)
    }

    /// Passes over bytes; false when the stream ends before.
    pub fn skip(&mut self, mut bytes: u64) -> io::Result<bool> {
        if let Inner::Stored(part) = &mut self.inner {
            part.skip(bytes);
            return Ok(true);
        }
        let mut scratch = [0; 1 << 13];
        while bytes > 0 {
            let n = scratch.len().min(usize::try_from(bytes).unwrap_or(usize::MAX));
            let read = self.fill(scratch.get_mut(..n).unwrap_or_default())?;
            if read == 0 {
                return Ok(false);
            }
            bytes -= read as u64;
        }
        Ok(true)
    }

    /// Reads on to the end, so that what the packing says of the whole is checked.
    pub fn drain(&mut self) -> io::Result<()> {
        if matches!(self.inner, Inner::Stored(_)) {
            return Ok(());
        }
        let mut scratch = [0; 1 << 13];
        while self.fill(&mut scratch)? > 0 {}
        Ok(())
    }
}

/// The diagnostic of a stream that cannot be unpacked or ends early.
pub(crate) fn stream_error(path: &std::path::Path, name: &str, error: &io::Error) -> IngestError {
    let (kind, key, hint) = match error.kind() {
        io::ErrorKind::FileTooLarge => (IngestErrorKind::Bomb, "ingest.binary.part_bomb", "ingest.hint.bomb"),
        io::ErrorKind::UnexpectedEof => {
            (IngestErrorKind::Damaged, "ingest.binary.part_short", "ingest.hint.cut_off")
        }
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
            (IngestErrorKind::Damaged, "ingest.binary.part_damaged", "ingest.hint.copy_again")
        }
        _ => return io_error(path, error),
    };
    let note = Note::new(key).with("name", name).with("reason", error.to_string());
    IngestError::new(kind, path, note).hint(hint)
}

/// Records at a place of a stream, one for each row.
#[derive(Debug, Clone)]
pub(crate) struct RecordGroup {
    /// Which stream.
    pub stream: usize,
    /// First byte of the first record in the unpacked stream.
    pub offset: u64,
    /// Length of a record, bytes, at least 1.
    pub stride: usize,
}

/// A column: a field of the records of a group.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColumnPlace {
    /// Which group.
    pub group: usize,
    /// Where and how its values stand in the records of the group.
    pub field: Field,
}

/// Unpacked streams that are read at several places.
#[derive(Default)]
struct UnpackedCopies {
    file: Option<Arc<PositionedFile>>,
    writer: Option<File>,
    length: u64,
    /// Where a stream begins, and its length.
    places: BTreeMap<usize, (u64, u64)>,
}

/// Columns in a file.
pub(crate) struct ColumnStreamTable {
    path: PathBuf,
    /// Size of the file as it stands, bytes.
    bytes: u64,
    at: Arc<PositionedFile>,
    streams: Vec<Stream>,
    groups: Vec<RecordGroup>,
    columns: Vec<Option<ColumnPlace>>,
    rows: u64,
    spool: Mutex<UnpackedCopies>,
}

/// Where a group is read from.
struct Source {
    bytes: Unpacked,
    group: usize,
    name: String,
    buffer: Vec<u8>,
    stride: usize,
}

impl ColumnStreamTable {
    /// Puts columns together that were found in a file.
    pub fn new(
        path: PathBuf,
        bytes: u64,
        at: Arc<PositionedFile>,
        streams: Vec<Stream>,
        groups: Vec<RecordGroup>,
        columns: Vec<Option<ColumnPlace>>,
        rows: u64,
    ) -> ColumnStreamTable {
        ColumnStreamTable { path, bytes, at, streams, groups, columns, rows, spool: Mutex::default() }
    }

    /// Opens what the wanted columns are read from, each group once.
    fn sources(&self, wanted: &[usize]) -> Result<Vec<Source>, IngestError> {
        let mut groups: Vec<usize> =
            wanted.iter().filter_map(|w| self.columns.get(*w)?.as_ref().map(|l| l.group)).collect();
        groups.sort_unstable();
        groups.dedup();
        let mut uses: BTreeMap<usize, usize> = BTreeMap::new();
        for group in groups.iter().filter_map(|g| self.groups.get(*g)) {
            *uses.entry(group.stream).or_default() += 1;
        }
        let packed = |s: &usize| {
            self.streams.get(*s).is_some_and(|s| matches!(s.coding, Coding::Deflate(_) | Coding::Zlib))
        };
        let many = uses.keys().filter(|s| packed(s)).count() > SIDE_BY_SIDE;
        let mut sources = Vec::new();
        for group in groups {
            let Some(found) = self.groups.get(group) else { continue };
            let Some(stream) = self.streams.get(found.stream) else { continue };
            let spooled = packed(&found.stream) && (many || uses.get(&found.stream).is_some_and(|n| *n > 1));
            let mut bytes = match stream.coding {
                _ if spooled => self.spooled(found.stream, stream)?,
                // A check of the whole needs the whole: not where only parts of it are read.
                Coding::Checked(_) if found.offset > CHECKED_FROM => stream.unchecked().open(&self.at),
                _ => stream.open(&self.at),
            };
            bytes.skip(found.offset).map_err(|e| stream_error(&self.path, &stream.name, &e))?;
            let (name, stride) = (stream.name.clone(), found.stride.max(1));
            sources.push(Source { bytes, group, name, buffer: Vec::new(), stride });
        }
        Ok(sources)
    }

    /// A packed stream as part of the temporary file, into which it is unpacked when it is wanted first.
    fn spooled(&self, index: usize, stream: &Stream) -> Result<Unpacked, IngestError> {
        let fail = |e: io::Error| stream_error(&self.path, &stream.name, &e);
        let mut spool = self.spool.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if !spool.places.contains_key(&index) {
            if spool.writer.is_none() {
                spool.writer = Some(tempfile::tempfile().map_err(|e| io_error(&self.path, &e))?);
            }
            let start = spool.length;
            let mut length = 0u64;
            let mut bytes = stream.open(&self.at);
            let mut buffer = vec![0; 1 << 18];
            let Some(writer) = spool.writer.as_mut() else {
                return Err(fail(io::ErrorKind::NotFound.into()));
            };
            // Readers by position may have moved the place of writing.
            writer.seek(SeekFrom::Start(start)).map_err(|e| io_error(&self.path, &e))?;
            loop {
                let n = bytes.fill(&mut buffer).map_err(fail)?;
                if n == 0 {
                    break;
                }
                let chunk = buffer.get(..n).unwrap_or_default();
                writer.write_all(chunk).map_err(|e| io_error(&self.path, &e))?;
                length += n as u64;
            }
            let handle = writer.try_clone().map_err(|e| io_error(&self.path, &e))?;
            spool.length = start + length;
            spool.file = Some(PositionedFile::of(handle, spool.length));
            spool.places.insert(index, (start, length));
        }
        let place = spool.places.get(&index).zip(spool.file.as_ref());
        let Some(((from, length), file)) = place else { return Err(fail(io::ErrorKind::NotFound.into())) };
        let stored =
            Stream { name: stream.name.clone(), from: *from, length: *length, coding: Coding::Stored };
        Ok(stored.open(file))
    }

    /// Reads every row; false when the consumer stopped.
    fn deliver(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<bool, IngestError> {
        let columns: Vec<Option<Field>> = self.columns.iter().map(|l| l.map(|l| l.field)).collect();
        let fields = fields(&self.path, &columns, wanted)?;
        let mut sources = self.sources(wanted)?;
        let most = (NUMBERS / wanted.len().max(1)).clamp(64, ROWS);
        let widest = sources.iter().map(|s| s.stride).max().unwrap_or(1);
        let most = most.min(((1 << 22) / widest).max(1)) as u64;
        let places: Vec<Option<(usize, Field)>> = wanted
            .iter()
            .map(|w| {
                let place = self.columns.get(*w).copied().flatten()?;
                Some((sources.iter().position(|s| s.group == place.group)?, place.field))
            })
            .collect();
        let mut block = Block::default();
        let mut done = 0u64;
        while done < self.rows {
            let rows = most.min(self.rows - done) as usize;
            block.reset(fields.len());
            block.first_row = done + 1;
            for source in &mut sources {
                let size = rows.saturating_mul(source.stride);
                source.buffer.resize(size, 0);
                let n = source.bytes.fill(&mut source.buffer);
                let n = n.map_err(|e| stream_error(&self.path, &source.name, &e))?;
                if n < size {
                    let end = io::Error::from(io::ErrorKind::UnexpectedEof);
                    return Err(stream_error(&self.path, &source.name, &end));
                }
            }
            for (column, place) in block.columns.iter_mut().zip(&places) {
                let Some((source, field)) = place else { continue };
                let Some(source) = sources.get(*source) else { continue };
                field.decode(&source.buffer, source.stride, column);
            }
            set_aside_unusable(&mut block, &fields);
            done += rows as u64;
            block.bytes_done = (self.bytes as f64 * (done as f64 / self.rows.max(1) as f64)) as u64;
            if on_block(&mut block).is_break() {
                return Ok(false);
            }
        }
        for source in &mut sources {
            source.bytes.drain().map_err(|e| stream_error(&self.path, &source.name, &e))?;
        }
        Ok(true)
    }
}

impl Table for ColumnStreamTable {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let hash = scope.spawn(|| digest_unless(&self.path, &stop));
            let delivered = self.deliver(wanted, on_block);
            if !matches!(delivered, Ok(true)) {
                stop.store(true, Ordering::Relaxed);
            }
            let digested = hash
                .join()
                .map_err(|_| IngestError::new(IngestErrorKind::Io, &self.path, "ingest.thread_stopped"))?;
            if !delivered? {
                return Ok(None);
            }
            Ok(digested?.map(|d| FileFacts { sha256: d.sha256, bytes: d.bytes, rows: self.rows }))
        })
    }
}
