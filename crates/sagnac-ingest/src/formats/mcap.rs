//! MCAP: records with their length before them, most of them in chunks that may be packed, and an index at the end.

use super::topics::container::{Catalog, Container, Event, Fields, OnEvent, Stream, broken, unpack};
use super::topics::message::Encoding;
use crate::error::IngestError;
use crate::{Candidate, Format, Opened, part_selection};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::Path;

/// First and last bytes of a file.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

const HEADER: u8 = 0x01;
const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const CHUNK_INDEX: u8 = 0x08;
const STATISTICS: u8 = 0x0b;
const METADATA: u8 = 0x0c;
const DATA_END: u8 = 0x0f;

/// Code and length of a record, bytes; length of a footer.
const HEAD: u64 = 9;
const FOOTER_BYTES: u64 = 20;
/// Longest index that is read at once, bytes.
const MAX_INDEX_BYTES: u64 = 256 << 20;

/// MCAP.
pub(super) struct Mcap;

impl Format for Mcap {
    fn id(&self) -> &'static str {
        "mcap"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(MAGIC)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        part_selection::unpacked(file, "ingest.ros.mcap")?;
        super::topics::open(file, &McapFile)
    }
}

/// Finds the messages in a file.
struct McapFile;

/// Names of types by the number of their schema.
type Schemas = BTreeMap<u16, String>;

fn schema(body: &[u8], schemas: &mut Schemas) -> Option<()> {
    let mut f = Fields(body);
    let (id, name) = (f.u16()?, f.text()?);
    schemas.insert(id, name.to_owned());
    Some(())
}

/// A channel: id, topic, type, encoding.
fn channel<'a>(body: &'a [u8], schemas: &'a Schemas) -> Option<(u32, &'a str, &'a str, &'a str)> {
    let mut f = Fields(body);
    let (id, schema, topic, encoding) = (f.u16()?, f.u16()?, f.text()?, f.text()?);
    Some((id.into(), topic, schemas.get(&schema).map_or("", String::as_str), encoding))
}

fn encoding(name: &str) -> (Option<Encoding>, &str) {
    let known = match name {
        "cdr" => Some(Encoding::Cdr),
        "ros1" => Some(Encoding::Ros1),
        _ => None,
    };
    (known, name)
}

/// Records in bytes: code and body.
fn records(mut bytes: &[u8]) -> impl Iterator<Item = Option<(u8, &[u8])>> {
    std::iter::from_fn(move || {
        let mut f = Fields(bytes);
        let code = *f.bytes(1)?.first()?;
        let body = f.u64().and_then(|len| f.bytes(usize::try_from(len).ok()?));
        // A record that is longer than what is left ends the run with a fault.
        bytes = if body.is_some() { f.0 } else { &[] };
        Some(body.map(|b| (code, b)))
    })
}

impl Container for McapFile {
    fn index(&self, path: &Path, bytes: u64) -> Result<Option<Catalog>, IngestError> {
        let Some(footer_at) = bytes.checked_sub(MAGIC.len() as u64 + HEAD + FOOTER_BYTES) else {
            return Ok(None);
        };
        let mut tail = Vec::new();
        let whole = Stream::open(path, footer_at, bytes)?.take(bytes - footer_at, &mut tail)?;
        let mut f = Fields(&tail);
        let head = f.bytes(1).and_then(|b| b.first().copied());
        let (Some(FOOTER), Some(FOOTER_BYTES), Some(start), Some(_), Some(crc), Some(MAGIC)) =
            (head, f.u64(), f.u64(), f.u64(), f.u32(), f.bytes(8))
        else {
            return Ok(None);
        };
        let length = footer_at.saturating_sub(start);
        if !whole || start == 0 || start > footer_at || length > MAX_INDEX_BYTES {
            return Ok(None);
        }
        let mut summary = Vec::new();
        if !Stream::open(path, start, bytes)?.take(length, &mut summary)? {
            return Ok(None);
        }
        let mut sum = flate2::Crc::new();
        sum.update(&summary);
        sum.update(tail.get(..25).unwrap_or_default());
        // An index without checksum might tell anything; the file itself is the better witness.
        if crc == 0 || sum.sum() != crc {
            return Ok(None);
        }
        Ok(summarise(&summary))
    }

    fn scan(
        &self,
        path: &Path,
        bytes: u64,
        skip: &BTreeSet<u64>,
        on_event: &mut OnEvent<'_>,
    ) -> Result<Option<u64>, IngestError> {
        let mut stream = Stream::open(path, 0, bytes)?;
        let (mut body, mut unpacked) = (Vec::new(), Vec::new());
        stream.skip(MAGIC.len() as u64)?;
        let mut schemas = Schemas::new();
        loop {
            let at = stream.at;
            if !stream.take(HEAD, &mut body)? {
                return Ok(Some(at));
            }
            let mut f = Fields(&body);
            let (Some([code]), Some(len)) = (f.bytes(1), f.u64()) else { return Ok(Some(at)) };
            let code = *code;
            if matches!(code, DATA_END | FOOTER) {
                return Ok(None);
            }
            let wanted = matches!(code, HEADER | SCHEMA | CHANNEL | MESSAGE | CHUNK | METADATA)
                && !(code == CHUNK && skip.contains(&at));
            if !wanted {
                if code == 0 {
                    return Err(broken(path, "ingest.ros.record", at));
                }
                if !stream.skip(len)? {
                    return Ok(Some(at));
                }
                continue;
            }
            if !stream.take(len, &mut body)? {
                return Ok(Some(at));
            }
            let flow = if code == CHUNK {
                let records_at = chunk(path, at, &body, &mut unpacked)?;
                let inside = match records_at {
                    Some(from) => body.get(from..).unwrap_or_default(),
                    None => unpacked.as_slice(),
                };
                let mut flow = ControlFlow::Continue(());
                for record in records(inside) {
                    let (code, body) = record.ok_or_else(|| broken(path, "ingest.ros.record", at))?;
                    flow = pass_record(code, body, at, &mut schemas, on_event)
                        .ok_or_else(|| broken(path, "ingest.ros.record", at))?;
                    if flow.is_break() {
                        break;
                    }
                }
                flow
            } else {
                pass_record(code, &body, at, &mut schemas, on_event)
                    .ok_or_else(|| broken(path, "ingest.ros.record", at))?
            };
            if flow.is_break() {
                return Ok(None);
            }
        }
    }
}

/// Opens a chunk. Records that are not packed stay where they are: their place in the body is returned.
fn chunk(path: &Path, at: u64, body: &[u8], unpacked: &mut Vec<u8>) -> Result<Option<usize>, IngestError> {
    let fault = || broken(path, "ingest.ros.record", at);
    let mut f = Fields(body);
    f.bytes(16).ok_or_else(fault)?;
    let (Some(size), Some(crc), Some(packing), Some(length)) = (f.u64(), f.u32(), f.text(), f.u64()) else {
        return Err(fault());
    };
    let from = body.len() - f.0.len();
    let packed = usize::try_from(length).ok().and_then(|n| f.bytes(n)).ok_or_else(fault)?;
    let plain = packing.is_empty();
    if !plain {
        unpack(path, at, packing, packed, size, unpacked)?;
    }
    let records = if plain { packed } else { unpacked.as_slice() };
    let mut sum = flate2::Crc::new();
    sum.update(records);
    if crc != 0 && sum.sum() != crc {
        return Err(broken(path, "ingest.ros.checksum", at));
    }
    Ok(plain.then_some(from))
}

/// Passes a record on; nothing when it cannot be read.
fn pass_record(
    code: u8,
    body: &[u8],
    at: u64,
    schemas: &mut Schemas,
    on_event: &mut OnEvent<'_>,
) -> Option<ControlFlow<()>> {
    Some(match code {
        SCHEMA => {
            schema(body, schemas)?;
            ControlFlow::Continue(())
        }
        CHANNEL => {
            let (id, topic, type_name, name) = channel(body, schemas)?;
            on_event(Event::Channel { id, topic, type_name, encoding: encoding(name) })
        }
        MESSAGE => {
            let mut f = Fields(body);
            let (id, _, log_ns, _) = (f.u16()?, f.u32()?, f.u64()?, f.u64()?);
            on_event(Event::Message { id: id.into(), log_ns, data: f.0, at })
        }
        HEADER => {
            let mut f = Fields(body);
            let (profile, library) = (f.text()?, f.text()?);
            match on_event(Event::Statement { key: "profile", value: profile }) {
                ControlFlow::Continue(()) => on_event(Event::Statement { key: "library", value: library }),
                stop => stop,
            }
        }
        METADATA => {
            let mut f = Fields(body);
            f.text()?;
            let mut map = Fields(f.sized()?);
            while !map.0.is_empty() {
                let (key, value) = (map.text()?, map.text()?);
                if on_event(Event::Statement { key, value }).is_break() {
                    return Some(ControlFlow::Break(()));
                }
            }
            ControlFlow::Continue(())
        }
        _ => ControlFlow::Continue(()),
    })
}

/// What an index says; nothing when it lacks the counts of messages.
fn summarise(summary: &[u8]) -> Option<Catalog> {
    let mut catalog = Catalog::default();
    let mut schemas = Schemas::new();
    let mut channels: Vec<&[u8]> = Vec::new();
    let mut counts = None;
    for record in records(summary) {
        match record? {
            (SCHEMA, body) => schema(body, &mut schemas)?,
            (CHANNEL, body) => channels.push(body),
            (STATISTICS, body) => {
                let mut f = Fields(body);
                f.bytes(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8)?;
                counts = Some(f.sized()?);
            }
            (CHUNK_INDEX, body) => {
                let mut f = Fields(body);
                let (_, _, at, _) = (f.u64()?, f.u64()?, f.u64()?, f.u64()?);
                let map = f.sized()?;
                let ids = map.chunks_exact(10).filter_map(|e| Fields(e).u16()).map(u32::from).collect();
                catalog.chunks.push((at, ids));
            }
            _ => {}
        }
    }
    for body in channels {
        let (id, topic, type_name, name) = channel(body, &schemas)?;
        catalog.channel(id, topic, type_name, encoding(name));
    }
    for entry in counts?.chunks_exact(10) {
        let mut f = Fields(entry);
        catalog.count(f.u16()?.into(), f.u64()?);
    }
    Some(catalog)
}
