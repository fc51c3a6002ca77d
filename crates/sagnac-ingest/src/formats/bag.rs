//! ROS 1 bags, version 2.0: records of named fields and data, messages in chunks, an index at the end.

use super::topics::container::{Catalog, Container, Event, Fields, OnEvent, Stream, broken, unpack};
use super::topics::message::Encoding;
use crate::error::IngestError;
use crate::{Candidate, Format, Opened, part_selection};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::Path;

/// First bytes of a file.
const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

const MESSAGE: u8 = 0x02;
const BAG: u8 = 0x03;
const CHUNK: u8 = 0x05;
const CHUNK_INFO: u8 = 0x06;
const CONNECTION: u8 = 0x07;

/// A ROS 1 bag.
pub(super) struct RosBag;

impl Format for RosBag {
    fn id(&self) -> &'static str {
        "rosbag"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(MAGIC)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        part_selection::unpacked(file, "ingest.ros.bag")?;
        super::topics::open(file, &BagFile)
    }
}

/// Finds the messages in a file.
struct BagFile;

/// The value of a field in a record header.
fn field<'a>(header: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let mut f = Fields(header);
    while let Some(entry) = f.sized() {
        let split = entry.iter().position(|b| *b == b'=')?;
        let (key, value) = entry.split_at_checked(split)?;
        if key == name.as_bytes() {
            return value.get(1..);
        }
    }
    None
}

fn text<'a>(header: &'a [u8], name: &str) -> Option<&'a str> {
    std::str::from_utf8(field(header, name)?).ok()
}

fn code(header: &[u8]) -> Option<u8> {
    field(header, "op")?.first().copied()
}

fn number(header: &[u8], name: &str) -> Option<u32> {
    Fields(field(header, name)?).u32()
}

/// Id, topic and type of a connection.
fn connection<'a>(header: &'a [u8], data: &'a [u8]) -> Option<(u32, &'a str, &'a str)> {
    Some((number(header, "conn")?, text(header, "topic")?, text(data, "type")?))
}

/// Passes a connection or message on; nothing when it cannot be read.
fn pass_record(header: &[u8], data: &[u8], at: u64, on_event: &mut OnEvent<'_>) -> Option<ControlFlow<()>> {
    Some(match code(header)? {
        CONNECTION => {
            let (id, topic, type_name) = connection(header, data)?;
            let encoding = (Some(Encoding::Ros1), "ros1");
            on_event(Event::Channel { id, topic, type_name, encoding })
        }
        MESSAGE => {
            let mut time = Fields(field(header, "time")?);
            let (seconds, nanoseconds) = (u64::from(time.u32()?), u64::from(time.u32()?));
            let log_ns = seconds * 1_000_000_000 + nanoseconds;
            on_event(Event::Message { id: number(header, "conn")?, log_ns, data, at })
        }
        _ => ControlFlow::Continue(()),
    })
}

impl Container for BagFile {
    fn index(&self, path: &Path, bytes: u64) -> Result<Option<Catalog>, IngestError> {
        let mut stream = Stream::open(path, MAGIC.len() as u64, bytes)?;
        let (mut header, mut data) = (Vec::new(), Vec::new());
        let first = part(&mut stream, &mut header)? && code(&header) == Some(BAG);
        let start = field(&header, "index_pos").and_then(|v| Fields(v).u64()).filter(|_| first);
        let Some(start) = start.filter(|s| *s > 0 && *s < bytes) else { return Ok(None) };
        let mut stream = Stream::open(path, start, bytes)?;
        let mut catalog = Catalog::default();
        while stream.left() > 0 {
            if !(part(&mut stream, &mut header)? && part(&mut stream, &mut data)?) {
                return Ok(None);
            }
            let understood = match code(&header) {
                Some(CONNECTION) => connection(&header, &data).map(|(id, topic, type_name)| {
                    catalog.channel(id, topic, type_name, (Some(Encoding::Ros1), "ros1"));
                }),
                Some(CHUNK_INFO) => chunk_info(&header, &data, &mut catalog),
                _ => None,
            };
            if understood.is_none() {
                return Ok(None);
            }
        }
        Ok((!catalog.topics.is_empty()).then_some(catalog))
    }

    fn scan(
        &self,
        path: &Path,
        bytes: u64,
        skip: &BTreeSet<u64>,
        on_event: &mut OnEvent<'_>,
    ) -> Result<Option<u64>, IngestError> {
        let mut stream = Stream::open(path, MAGIC.len() as u64, bytes)?;
        let (mut header, mut data, mut unpacked) = (Vec::new(), Vec::new(), Vec::new());
        let mut indexed = false;
        while stream.left() > 0 {
            let at = stream.at;
            let fault = || broken(path, "ingest.ros.record", at);
            if !part(&mut stream, &mut header)? {
                return Ok(Some(at));
            }
            let code = code(&header).ok_or_else(fault)?;
            indexed |= code == CHUNK_INFO;
            if skip.contains(&at) || !matches!(code, CHUNK | CONNECTION | MESSAGE) {
                if !pass_over(&mut stream, &mut data)? {
                    return Ok(Some(at));
                }
                continue;
            }
            if !part(&mut stream, &mut data)? {
                return Ok(Some(at));
            }
            if code != CHUNK {
                if pass_record(&header, &data, at, on_event).ok_or_else(fault)?.is_break() {
                    return Ok(None);
                }
                continue;
            }
            let packing = text(&header, "compression").ok_or_else(fault)?;
            let size = number(&header, "size").ok_or_else(fault)?;
            let records = if packing == "none" {
                data.as_slice()
            } else {
                unpack(path, at, packing, &data, size.into(), &mut unpacked)?;
                unpacked.as_slice()
            };
            let mut inside = Fields(records);
            while !inside.0.is_empty() {
                let (header, data) = inside.sized().zip(inside.sized()).ok_or_else(fault)?;
                if pass_record(header, data, at, on_event).ok_or_else(fault)?.is_break() {
                    return Ok(None);
                }
            }
        }
        // A recorder that ends as it should writes where each chunk stands.
        Ok((!indexed).then_some(bytes))
    }
}

/// Place of a chunk and the messages of each connection in it.
fn chunk_info(header: &[u8], data: &[u8], catalog: &mut Catalog) -> Option<()> {
    let at = Fields(field(header, "chunk_pos")?).u64()?;
    let mut ids = BTreeSet::new();
    for entry in data.chunks_exact(8) {
        let mut f = Fields(entry);
        let (id, messages) = (f.u32()?, f.u32()?);
        catalog.count(id, messages.into());
        ids.insert(id);
    }
    catalog.chunks.push((at, ids));
    Some(())
}

/// Reads a header or data with the length before them; false when the file breaks off.
fn part(stream: &mut Stream, out: &mut Vec<u8>) -> Result<bool, IngestError> {
    if !stream.take(4, out)? {
        return Ok(false);
    }
    let Some(len) = Fields(out).u32() else { return Ok(false) };
    stream.take(len.into(), out)
}

/// Passes over data with the length before them.
fn pass_over(stream: &mut Stream, scratch: &mut Vec<u8>) -> Result<bool, IngestError> {
    if !stream.take(4, scratch)? {
        return Ok(false);
    }
    match Fields(scratch).u32() {
        Some(len) => stream.skip(len.into()),
        None => Ok(false),
    }
}
