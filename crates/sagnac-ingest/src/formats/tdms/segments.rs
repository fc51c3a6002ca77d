//! The segments of a TDMS file: lead-ins and metadata, turned into where the values of every channel stand.
//!
//! A segment begins with a lead-in of 28 bytes, may hold metadata that add to what earlier segments said, and holds
//! values in chunks that repeat until the segment ends.

use super::bytes::{MetadataFault, Reader};
use super::properties::{Properties, Value};
use crate::error::{IngestError, IngestErrorKind};
use sagnac_core::message::{Note, note};
use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Length of a lead-in, bytes.
const LEAD_IN: u64 = 28;
/// Longest metadata of a segment that are read, bytes.
const MAX_METADATA_BYTES: u64 = 64 << 20;
/// Most objects of a file.
const MAX_OBJECTS: usize = 10_000;
/// Most channels times segments.
const MAX_PIECES: usize = 100_000_000;

const HAS_METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const HAS_VALUES: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Type of the values of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Signed(u8),
    Unsigned(u8),
    Float(u8),
    Stamp,
    /// A type of that number that is no number, with the bytes of a value where they are fixed.
    Other(u32, Option<u8>),
}

impl Kind {
    fn of(code: u32) -> Kind {
        match code {
            1..=4 => Kind::Signed(1 << (code - 1)),
            5..=8 => Kind::Unsigned(1 << (code - 5)),
            9 | 0x19 => Kind::Float(4),
            10 | 0x1a => Kind::Float(8),
            0x21 => Kind::Unsigned(1),
            0x44 => Kind::Stamp,
            0x0008_000c => Kind::Other(code, Some(8)),
            0x0010_000d => Kind::Other(code, Some(16)),
            _ => Kind::Other(code, None),
        }
    }

    /// Bytes of a value.
    pub fn bytes(self) -> Option<u64> {
        match self {
            Kind::Signed(n) | Kind::Unsigned(n) | Kind::Float(n) => Some(n.into()),
            Kind::Stamp => Some(16),
            Kind::Other(_, n) => n.map(u64::from),
        }
    }

    /// True when a value is a number or a stamp.
    pub fn is_number(self) -> bool {
        !matches!(self, Kind::Other(..))
    }

    /// Type in words.
    pub fn words(self) -> String {
        match self {
            Kind::Signed(n) => format!("i{}", n * 8),
            Kind::Unsigned(n) => format!("u{}", n * 8),
            Kind::Float(n) => format!("f{}", u32::from(n) * 8),
            Kind::Stamp => "time stamp".to_owned(),
            Kind::Other(0x20, _) => "text".to_owned(),
            Kind::Other(code, _) => format!("type {code:#x}"),
        }
    }
}

/// Values of a channel in one segment: `chunks` times `count` values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Piece {
    /// Byte of the first value.
    pub at: u64,
    /// Values in a chunk.
    pub count: u64,
    /// Bytes from a value to the next one.
    pub value_step: u64,
    /// Number of chunks.
    pub chunks: u64,
    /// Bytes from a chunk to the next one.
    pub chunk_step: u64,
    pub big_endian: bool,
}

/// A channel.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    pub group: String,
    pub name: String,
    pub kind: Kind,
    pub properties: Properties,
    pub pieces: Vec<Piece>,
    pub values: u64,
}

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub channels: Vec<Channel>,
    /// Properties of the file, and of groups by name.
    pub file: Properties,
    pub groups: HashMap<String, Properties>,
    pub segments: u64,
    /// Byte at which the last segment broke off.
    pub broken_at: Option<u64>,
}

/// Type, values in a chunk and bytes of them.
#[derive(Debug, Clone, Copy)]
struct Index {
    kind: Kind,
    count: u64,
    bytes: u64,
}

/// Reads the lead-ins and the metadata of all segments.
pub(super) struct Scanner<'a> {
    path: &'a Path,
    file: File,
    size: u64,
    contents: Contents,
    /// Channels by path.
    known: HashMap<String, usize>,
    /// Last index of every channel.
    last: Vec<Option<Index>>,
    /// Channels with values in the present segment, in order.
    active: Vec<usize>,
    pieces: usize,
}

impl Scanner<'_> {
    /// Reads the structure of a file.
    ///
    /// # Errors
    /// What cannot be understood, with its byte.
    pub fn scan(path: &Path, file: File, size: u64) -> Result<Contents, IngestError> {
        let mut scanner = Scanner {
            path,
            file,
            size,
            contents: Contents::default(),
            known: HashMap::new(),
            last: Vec::new(),
            active: Vec::new(),
            pieces: 0,
        };
        let mut at = 0;
        while at < size {
            match scanner.segment(at)? {
                Some(next) => at = next,
                None => {
                    scanner.contents.broken_at = Some(at);
                    break;
                }
            }
        }
        Ok(scanner.contents)
    }

    fn error(&self, at: u64, note: Note) -> IngestError {
        IngestError::new(IngestErrorKind::Damaged, self.path, note.with("at", at)).hint("ingest.hint.damaged")
    }

    fn bytes(&mut self, at: u64, len: u64) -> Result<Vec<u8>, IngestError> {
        let io = |path: &Path, e| crate::byte_stream::io_error(path, &e);
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(at)).map_err(|e| io(self.path, e))?;
        self.file.by_ref().take(len).read_to_end(&mut bytes).map_err(|e| io(self.path, e))?;
        Ok(bytes)
    }

    /// Reads a segment; returns where the next one starts, or nothing when the file breaks off before its metadata
    /// end.
    fn segment(&mut self, at: u64) -> Result<Option<u64>, IngestError> {
        let lead = self.bytes(at, LEAD_IN)?;
        let part = |from: usize, to: usize| lead.get(from..to);
        let le = |from| part(from, from + 4).and_then(|b| Some(u32::from_le_bytes(b.try_into().ok()?)));
        let (Some(tag), Some(toc)) = (part(0, 4), le(4)) else { return Ok(None) };
        if tag != b"TDSm" {
            return Err(self.error(at, note!("ingest.tdms.no_segment")));
        }
        if lead.len() < LEAD_IN as usize {
            return Ok(None);
        }
        let big_endian = toc & BIG_ENDIAN != 0;
        let mut reader = Reader::new(part(12, 28).unwrap_or_default(), big_endian);
        let (length, raw) = (reader.u64().unwrap_or(0), reader.u64().unwrap_or(0));
        let start = at.saturating_add(LEAD_IN);
        // A logger that was stopped by force leaves the length of the last segment open.
        let open = length == u64::MAX;
        let end = if open { self.size } else { start.saturating_add(length) };
        let Some(values_at) = start.checked_add(raw).filter(|v| *v <= end || open) else {
            return Err(self.error(at, note!("ingest.tdms.bad_lead_in")));
        };
        if values_at > self.size {
            return Ok(None);
        }
        if end > self.size || open {
            self.contents.broken_at = Some(at);
        }
        let end = end.min(self.size);
        if toc & DAQMX != 0 {
            return Err(IngestError::new(
                IngestErrorKind::UnknownFormat,
                self.path,
                note!("ingest.tdms.daqmx", at),
            )
            .hint("ingest.tdms.hint.daqmx"));
        }
        if toc & HAS_METADATA != 0 {
            self.metadata(start, values_at.saturating_sub(start), big_endian, toc & NEW_LIST != 0)?;
        }
        if toc & HAS_VALUES != 0 {
            self.values(values_at, end, toc & INTERLEAVED != 0, big_endian)?;
        }
        self.contents.segments += 1;
        Ok(Some(end))
    }

    fn metadata(&mut self, at: u64, len: u64, big_endian: bool, new_list: bool) -> Result<(), IngestError> {
        if len > MAX_METADATA_BYTES {
            return Err(self.error(at, note!("ingest.tdms.long_metadata", bytes = len)));
        }
        let bytes = self.bytes(at, len)?;
        let mut reader = Reader::new(&bytes, big_endian);
        if new_list {
            self.active.clear();
        }
        let outcome = self.objects(&mut reader);
        let place = at + reader.position() as u64;
        match outcome {
            Ok(()) => Ok(()),
            Err(MetadataFault::Short) => Err(self.error(place, note!("ingest.tdms.bad_metadata"))),
            Err(MetadataFault::Daqmx(path)) => Err(IngestError::new(
                IngestErrorKind::UnknownFormat,
                self.path,
                note!("ingest.tdms.daqmx_channel", name = crate::error::shorten(&path), at = place),
            )
            .hint("ingest.tdms.hint.daqmx")),
            Err(MetadataFault::Note(note)) => Err(self.error(place, *note)),
        }
    }

    fn objects(&mut self, reader: &mut Reader<'_>) -> Result<(), MetadataFault> {
        let count = reader.u32()?;
        for _ in 0..count {
            let path = reader.text()?;
            let steps = super::properties::split_path(&path);
            let channel = match steps.as_slice() {
                [group, name] => Some(self.channel(&path, group, name)?),
                _ => None,
            };
            self.index(reader, &path, channel)?;
            let properties = reader.u32()?;
            for _ in 0..properties {
                let name = reader.text()?;
                let value = Value::read(reader)?;
                let target = match (channel, steps.as_slice()) {
                    (Some(c), _) => self.contents.channels.get_mut(c).map(|c| &mut c.properties),
                    (None, [group]) => Some(self.contents.groups.entry(group.clone()).or_default()),
                    _ => Some(&mut self.contents.file),
                };
                if let Some(target) = target {
                    target.set(name, value);
                }
            }
        }
        Ok(())
    }

    /// Reads what the metadata say of the values of an object: none, as before, or type and number.
    fn index(
        &mut self,
        reader: &mut Reader<'_>,
        path: &str,
        channel: Option<usize>,
    ) -> Result<(), MetadataFault> {
        match reader.u32()? {
            u32::MAX => return Ok(()),
            0 => {
                channel.into_iter().for_each(|c| self.activate(c));
                return Ok(());
            }
            0x1269 | 0x1369 => return Err(MetadataFault::Daqmx(path.to_owned())),
            _ => {}
        }
        let kind = Kind::of(reader.u32()?);
        let dimension = reader.u32()?;
        let count = reader.u64()?;
        if dimension != 1 {
            return Err(MetadataFault::note("ingest.tdms.dimension", path));
        }
        let bytes = match kind {
            Kind::Other(0x20, _) => Some(reader.u64()?),
            _ => kind.bytes().and_then(|b| b.checked_mul(count)),
        };
        let Some(bytes) = bytes else { return Err(MetadataFault::note("ingest.tdms.kind", path)) };
        let Some(c) = channel else { return Ok(()) };
        if let Some(channel) = self.contents.channels.get_mut(c) {
            if channel.values > 0 && channel.kind != kind {
                return Err(MetadataFault::note("ingest.tdms.kind_changes", path));
            }
            channel.kind = kind;
        }
        if let Some(last) = self.last.get_mut(c) {
            *last = Some(Index { kind, count, bytes });
        }
        self.activate(c);
        Ok(())
    }

    fn channel(&mut self, path: &str, group: &str, name: &str) -> Result<usize, MetadataFault> {
        if let Some(&known) = self.known.get(path) {
            return Ok(known);
        }
        let index = self.contents.channels.len();
        if index >= MAX_OBJECTS {
            return Err(MetadataFault::note("ingest.tdms.objects", path));
        }
        self.contents.channels.push(Channel {
            group: group.to_owned(),
            name: name.to_owned(),
            kind: Kind::Other(0, None),
            properties: Properties::default(),
            pieces: Vec::new(),
            values: 0,
        });
        self.last.push(None);
        self.known.insert(path.to_owned(), index);
        Ok(index)
    }

    fn activate(&mut self, channel: usize) {
        if !self.active.contains(&channel) {
            self.active.push(channel);
        }
    }

    /// Notes where the values of a segment stand. Chunks repeat; the last one may break off.
    fn values(&mut self, at: u64, end: u64, interleaved: bool, big_endian: bool) -> Result<(), IngestError> {
        let too_large = |s: &Self| s.error(at, note!("ingest.tdms.too_large"));
        self.pieces = self.pieces.saturating_add(self.active.len());
        if self.pieces > MAX_PIECES {
            return Err(too_large(self));
        }
        let mut list: Vec<(usize, Index)> = Vec::new();
        for &c in &self.active {
            match self.last.get(c).copied().flatten() {
                Some(index) if index.count > 0 => list.push((c, index)),
                Some(_) => {}
                None => return Err(self.error(at, note!("ingest.tdms.no_index"))),
            }
        }
        let chunk = list.iter().try_fold(0u64, |n, (_, i)| n.checked_add(i.bytes));
        let chunk = chunk.ok_or_else(|| too_large(self))?;
        let room = end.saturating_sub(at);
        if chunk == 0 || room == 0 {
            return Ok(());
        }
        let (whole, rest) = (room / chunk, room % chunk);
        if rest > 0 && self.contents.broken_at.is_none() {
            self.contents.broken_at = Some(at);
        }
        let row: u64 = list.iter().filter_map(|(_, i)| i.kind.bytes()).sum();
        if interleaved {
            let count = list.first().map_or(0, |(_, i)| i.count);
            if list.iter().any(|(_, i)| i.count != count || i.kind.bytes().is_none()) {
                return Err(self.error(at, note!("ingest.tdms.interleaved")));
            }
        }
        let mut before = 0;
        for (c, index) in list {
            let width = index.kind.bytes().unwrap_or(0);
            let (value_step, next) = if interleaved { (row, width) } else { (width, index.bytes) };
            let left =
                if interleaved { rest / row.max(1) } else { rest.saturating_sub(before) / width.max(1) };
            if let Some(channel) = self.contents.channels.get_mut(c) {
                let mut add = |at: u64, count: u64, chunks: u64| {
                    if count > 0 && chunks > 0 && width > 0 {
                        let piece = Piece { at, count, value_step, chunks, chunk_step: chunk, big_endian };
                        channel.pieces.push(piece);
                        channel.values = channel.values.saturating_add(count.saturating_mul(chunks));
                    }
                };
                add(at + before, index.count, whole);
                add(at + whole * chunk + before, left.min(index.count), 1);
            }
            before += next;
        }
        Ok(())
    }
}
