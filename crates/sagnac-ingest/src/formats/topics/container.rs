//! What readers of message files share: channels, messages, records of bytes, packed chunks.

use super::message::{Encoding, Layout};
use crate::error::{IngestError, IngestErrorKind};
use crate::open_file;
use sagnac_core::message::{Note, note};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Unpacked bytes of a chunk that are always allowed, and how often more than its packed ones beyond that.
const CHUNK_ALLOWED: u64 = 16 << 20;
const CHUNK_RATIO: u64 = 500;

/// A topic of a file.
#[derive(Debug, Clone)]
pub(crate) struct Topic {
    pub name: String,
    pub type_name: String,
    /// Encoding, where it is known here.
    pub encoding: Option<Encoding>,
    /// Encoding as the file names it.
    pub encoding_name: String,
    /// Channels or connections that carry the topic.
    pub ids: BTreeSet<u32>,
    pub messages: u64,
}

impl Topic {
    /// The layout of the messages and how they are written, where both are known here.
    pub fn readable(&self) -> Option<(&'static Layout, Encoding)> {
        Layout::of(&self.type_name).zip(self.encoding)
    }
}

/// What a file holds.
#[derive(Debug, Default)]
pub(crate) struct Catalog {
    pub topics: Vec<Topic>,
    pub metadata: Vec<(String, String)>,
    /// Places of chunks, with the channels in them, where the file has an index of them.
    pub chunks: Vec<(u64, BTreeSet<u32>)>,
    /// Byte at which the file breaks off.
    pub broken_at: Option<u64>,
    /// False when the file had to be read through for want of an index.
    pub indexed: bool,
}

impl Catalog {
    /// Adds a channel to its topic.
    pub fn channel(&mut self, id: u32, name: &str, type_name: &str, encoding: (Option<Encoding>, &str)) {
        match self.topics.iter_mut().find(|t| t.name == name && t.type_name == type_name) {
            Some(known) => {
                known.ids.insert(id);
            }
            None => self.topics.push(Topic {
                name: name.to_owned(),
                type_name: type_name.to_owned(),
                encoding: encoding.0,
                encoding_name: encoding.1.to_owned(),
                ids: BTreeSet::from([id]),
                messages: 0,
            }),
        }
    }

    /// Counts messages of a channel.
    pub fn count(&mut self, id: u32, messages: u64) {
        if let Some(topic) = self.topics.iter_mut().find(|t| t.ids.contains(&id)) {
            topic.messages = topic.messages.saturating_add(messages);
        }
    }
}

/// What a reader meets in a file.
pub(crate) enum Event<'a> {
    /// A channel with its topic and type.
    Channel { id: u32, topic: &'a str, type_name: &'a str, encoding: (Option<Encoding>, &'a str) },
    /// A message.
    Message { id: u32, log_ns: u64, data: &'a [u8], at: u64 },
    /// Anything that the file says of itself.
    Statement { key: &'a str, value: &'a str },
}

/// Takes events; may stop the reading.
pub(crate) type OnEvent<'a> = dyn FnMut(Event<'_>) -> ControlFlow<()> + 'a;

/// A kind of file with messages.
pub(crate) trait Container: Sync + Send {
    /// Reads the index.
    fn index(&self, path: &Path, bytes: u64) -> Result<Option<Catalog>, IngestError>;

    /// Reads the file from its start, without the chunks at the places to be skipped; returns the byte at which the
    /// file breaks off.
    fn scan(
        &self,
        path: &Path,
        bytes: u64,
        skip: &BTreeSet<u64>,
        on_event: &mut OnEvent<'_>,
    ) -> Result<Option<u64>, IngestError>;
}

/// The index of a file, or what reading it through finds.
pub(crate) fn catalog(container: &dyn Container, path: &Path, bytes: u64) -> Result<Catalog, IngestError> {
    if let Some(found) = container.index(path, bytes)? {
        return Ok(Catalog { indexed: true, ..found });
    }
    let mut catalog = Catalog::default();
    let broken_at = container.scan(path, bytes, &BTreeSet::new(), &mut |event| {
        match event {
            Event::Channel { id, topic, type_name, encoding } => {
                catalog.channel(id, topic, type_name, encoding);
            }
            Event::Message { id, .. } => catalog.count(id, 1),
            Event::Statement { key, value } => {
                if catalog.metadata.len() < 64 {
                    catalog.metadata.push((key.to_owned(), value.to_owned()));
                }
            }
        }
        ControlFlow::Continue(())
    })?;
    catalog.broken_at = broken_at;
    Ok(catalog)
}

/// A file that is read from start to end, with its place.
pub(crate) struct Stream {
    path: PathBuf,
    file: BufReader<File>,
    pub at: u64,
    pub size: u64,
}

impl Stream {
    pub fn open(path: &Path, at: u64, size: u64) -> Result<Stream, IngestError> {
        let io = |e| crate::byte_stream::io_error(path, &e);
        let mut file = open_file(path).map_err(io)?;
        file.seek(SeekFrom::Start(at)).map_err(io)?;
        Ok(Stream { path: path.to_owned(), file: BufReader::with_capacity(1 << 18, file), at, size })
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.size.saturating_sub(self.at)
    }

    /// Reads so many bytes; false when the file does not have them.
    pub fn take(&mut self, len: u64, out: &mut Vec<u8>) -> Result<bool, IngestError> {
        out.clear();
        if len > self.left() {
            return Ok(false);
        }
        let io = |e| crate::byte_stream::io_error(&self.path, &e);
        let n = self.file.by_ref().take(len).read_to_end(out).map_err(io)?;
        self.at += n as u64;
        Ok(n as u64 == len)
    }

    /// Passes over so many bytes; false when the file does not have them.
    pub fn skip(&mut self, len: u64) -> Result<bool, IngestError> {
        let Some(step) = i64::try_from(len).ok().filter(|_| len <= self.left()) else { return Ok(false) };
        self.file.seek_relative(step).map_err(|e| crate::byte_stream::io_error(&self.path, &e))?;
        self.at += len;
        Ok(true)
    }
}

/// Little-endian fields of a record.
pub(crate) struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    pub fn bytes(&mut self, len: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(len)?;
        self.0 = rest;
        Some(taken)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.bytes(2)?.first_chunk().map(|b| u16::from_le_bytes(*b))
    }

    pub fn u32(&mut self) -> Option<u32> {
        self.bytes(4)?.first_chunk().map(|b| u32::from_le_bytes(*b))
    }

    pub fn u64(&mut self) -> Option<u64> {
        self.bytes(8)?.first_chunk().map(|b| u64::from_le_bytes(*b))
    }

    /// Bytes with their length before them.
    pub fn sized(&mut self) -> Option<&'a [u8]> {
        let len = self.u32()?;
        self.bytes(usize::try_from(len).ok()?)
    }

    /// A text with its length before it.
    pub fn text(&mut self) -> Option<&'a str> {
        std::str::from_utf8(self.sized()?).ok()
    }
}

/// The diagnostic of a place in a file that cannot be read.
pub(crate) fn broken(path: &Path, note: &'static str, at: u64) -> IngestError {
    IngestError::new(IngestErrorKind::Damaged, path, Note::new(note).with("at", at))
        .hint("ingest.hint.damaged")
}

/// Unpacks a chunk of which the unpacked size is stated; more than a recording could give is refused.
///
/// # Errors
/// An unknown packing, damaged bytes, another size than stated.
pub(crate) fn unpack(
    path: &Path,
    at: u64,
    packing: &str,
    packed: &[u8],
    size: u64,
    out: &mut Vec<u8>,
) -> Result<(), IngestError> {
    out.clear();
    let most = CHUNK_ALLOWED.max((packed.len() as u64).saturating_mul(CHUNK_RATIO));
    if size > most {
        return Err(IngestError::new(
            IngestErrorKind::Bomb,
            path,
            note!("ingest.ros.bomb", at, packed = packed.len(), unpacked = size),
        )
        .hint("ingest.hint.bomb"));
    }
    let damaged = |e: std::io::Error| {
        let note = note!("ingest.ros.chunk", at, reason = e.to_string());
        IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.damaged")
    };
    // One byte more than stated shows that there is more.
    let limit = size.saturating_add(1);
    match packing {
        "lz4" => {
            lz4_flex::frame::FrameDecoder::new(packed).take(limit).read_to_end(out).map_err(damaged)?;
        }
        "zstd" => {
            let decoder = zstd::stream::read::Decoder::with_buffer(packed).map_err(damaged)?;
            decoder.take(limit).read_to_end(out).map_err(damaged)?;
        }
        _ => {
            let note = note!("ingest.ros.packing", at);
            let note = note.with("packing", crate::error::shorten(packing));
            return Err(
                IngestError::new(IngestErrorKind::UnknownFormat, path, note).hint("ingest.ros.hint.packing")
            );
        }
    }
    if out.len() as u64 != size {
        return Err(broken(path, "ingest.ros.chunk_size", at));
    }
    Ok(())
}
