//! Delimited text: one thread reads and hashes, two parse, the caller consumes, all at once.

use super::encoding::TextStream;
use super::rows::{LineParser, Lines};
use crate::byte_stream::{ByteStream, Digested, Packing};
use crate::error::{IngestError, IngestErrorKind};
use crate::options::Encoding;
use crate::{Block, FileFacts, OnBlock, Table};
use sagnac_core::message::note;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};

/// Text that one parser takes at a time, bytes: small enough for the second-level cache.
const CHUNK: usize = 1 << 20;

/// Longest line of a recording, bytes.
const MAX_LINE_BYTES: usize = 1 << 20;

/// Threads that parse.
const PARSERS: usize = 2;

/// Chunks between the reader and the parsers, and blocks between the parsers and the consumer.
const QUEUE: usize = 2;

/// A text file of which the writing is known.
pub(super) struct Text {
    /// Path.
    pub path: PathBuf,
    /// How it is packed.
    pub packing: Packing,
    /// Its characters.
    pub encoding: Encoding,
    /// How its lines are written.
    pub lines: Lines,
    /// Position of the first data line in the text as UTF-8, bytes; within the head that was looked at.
    pub data_offset: usize,
    /// Line the data start on, counted from 1.
    pub data_line: u64,
}

struct Chunk {
    number: u64,
    text: Vec<u8>,
    /// Where its lines stand.
    used: Range<usize>,
    bytes_done: u64,
}

impl Table for Text {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let parser = LineParser::new(&self.lines, wanted);
        let stream = TextStream::new(ByteStream::open(&self.path, self.packing)?, self.encoding);
        let (chunk_out, chunk_in) = sync_channel::<Chunk>(QUEUE);
        let (text_back, text_free) = sync_channel::<Vec<u8>>(2 * QUEUE + PARSERS);
        let (block_out, block_in) = sync_channel::<(u64, Block)>(QUEUE);
        let (block_back, block_free) = sync_channel::<Block>(2 * QUEUE + PARSERS);
        let chunk_in = Arc::new(Mutex::new(chunk_in));
        let block_free = Arc::new(Mutex::new(block_free));
        std::thread::scope(|scope| {
            let reader = scope.spawn(move || self.cut(stream, &chunk_out, &text_free));
            for _ in 0..PARSERS {
                let (chunks, blocks, free) = (chunk_in.clone(), block_out.clone(), block_free.clone());
                let (text_back, parser) = (text_back.clone(), &parser);
                scope.spawn(move || parse(parser, &chunks, &text_back, &blocks, &free));
            }
            // The parsers alone hold these now, so that the end of one side is seen by the other.
            drop((block_out, chunk_in, text_back, block_free));
            let rows = self.deliver(block_in, &block_back, on_block);
            let digested = match reader.join() {
                Ok(result) => result,
                Err(_) => Err(IngestError::new(IngestErrorKind::Io, &self.path, "ingest.thread_stopped")),
            };
            let (Some(rows), digested) = (rows, digested?) else { return Ok(None) };
            Ok(digested.map(|d| FileFacts { sha256: d.sha256, bytes: d.bytes, rows }))
        })
    }
}

impl Text {
    /// Cuts the text at line ends and hands it out; `None` when nobody wants it any more.
    fn cut(
        &self,
        mut stream: TextStream,
        out: &SyncSender<Chunk>,
        free: &Receiver<Vec<u8>>,
    ) -> Result<Option<Digested>, IngestError> {
        let mut tail: Vec<u8> = Vec::new();
        let mut number = 0;
        loop {
            let kept = tail.len();
            // A buffer that was used keeps its bytes, and a fresh one is not written to: neither is cleared.
            let mut text = free.try_recv().unwrap_or_default();
            if text.is_empty() {
                text = vec![0; kept + CHUNK];
            } else if text.len() < kept + CHUNK {
                text.resize(kept + CHUNK, 0);
            }
            text.iter_mut().zip(&tail).for_each(|(to, from)| *to = *from);
            tail.clear();
            let n = stream.fill(text.get_mut(kept..kept + CHUNK).unwrap_or_default())?;
            let mut used = if number == 0 { self.data_offset.min(kept + n)..kept + n } else { 0..kept + n };
            let last = stream.ended();
            if last {
                if text.get(used.clone()).is_some_and(|t| t.last().is_some_and(|&c| c != b'\n')) {
                    text.truncate(used.end);
                    text.push(b'\n');
                    used.end += 1;
                }
            } else {
                let lines = text.get(used.clone()).unwrap_or_default();
                let cut = used.start + memchr::memrchr(b'\n', lines).map_or(0, |i| i + 1);
                tail.extend_from_slice(text.get(cut..used.end).unwrap_or_default());
                used.end = cut;
                if tail.len() > MAX_LINE_BYTES {
                    return Err(IngestError::new(
                        IngestErrorKind::UnknownFormat,
                        &self.path,
                        note!("ingest.long_line", bytes = MAX_LINE_BYTES),
                    )
                    .hint("ingest.hint.line_per_sample"));
                }
            }
            let bytes_done = stream.file_bytes();
            if out.send(Chunk { number, text, used, bytes_done }).is_err() {
                return Ok(None);
            }
            number += 1;
            if last {
                return stream.finish().map(Some);
            }
        }
    }

    /// Puts the blocks in order, numbers their rows and lines and passes them on; `None` when the consumer stopped.
    fn deliver(
        &self,
        blocks: Receiver<(u64, Block)>,
        back: &SyncSender<Block>,
        on_block: &mut OnBlock<'_>,
    ) -> Option<u64> {
        let mut waiting: BTreeMap<u64, Block> = BTreeMap::new();
        let (mut next, mut rows, mut line) = (0, 0u64, self.data_line);
        for (number, block) in blocks {
            waiting.insert(number, block);
            while let Some(mut block) = waiting.remove(&next) {
                block.first_row = rows + 1;
                block.first_line = line;
                for fault in &mut block.faults {
                    fault.row += rows + 1;
                    fault.line += line;
                }
                rows += block.rows() as u64;
                line += block.lines;
                next += 1;
                if block.rows() > 0 && on_block(&mut block).is_break() {
                    return None;
                }
                // A full return channel only means that the memory is not used again.
                let _ = back.try_send(block);
            }
        }
        Some(rows)
    }
}

/// One parser: takes chunks until there are none or nobody wants blocks.
fn parse(
    parser: &LineParser<'_>,
    chunks: &Mutex<Receiver<Chunk>>,
    text_back: &SyncSender<Vec<u8>>,
    blocks: &SyncSender<(u64, Block)>,
    free: &Mutex<Receiver<Block>>,
) {
    loop {
        let Ok(Ok(chunk)) = chunks.lock().map(|c| c.recv()) else { return };
        let mut block = free.lock().ok().and_then(|f| f.try_recv().ok()).unwrap_or_default();
        parser.parse(chunk.text.get(chunk.used).unwrap_or_default(), &mut block);
        block.bytes_done = chunk.bytes_done;
        let _ = text_back.try_send(chunk.text);
        if blocks.send((chunk.number, block)).is_err() {
            return;
        }
    }
}
