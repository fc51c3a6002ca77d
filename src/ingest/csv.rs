//! Delimited text: one thread reads and hashes, two parse, the caller consumes, all at once.

use super::compressed::{ByteStream, Digested, Packing};
use super::dialect::{self, Dialect};
use super::error::{IngestError, IngestErrorKind};
use super::lines::LineParser;
use super::{Block, Candidate, Column, FileFacts, Format, OnBlock, Opened, Table};
use crate::text::Note;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};

/// Text that one parser takes at a time, bytes: small enough for the second-level cache.
const CHUNK: usize = 1 << 20;

/// Longest line of a recording, bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Threads that parse.
const PARSERS: usize = 2;

/// Chunks between the reader and the parsers, and blocks between the parsers and the consumer.
const QUEUE: usize = 4;

/// Delimited text, plain or packed.
pub(super) struct DelimitedText;

impl Format for DelimitedText {
    fn id(&self) -> &'static str {
        "csv"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        !file.head.contains(&0)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let dialect = dialect::sniff(&file.path, &file.head, file.head_is_all)?;
        let columns = dialect
            .names
            .iter()
            .map(|name| Column {
                name: name.clone(),
                numeric: true,
                storage: "text".to_owned(),
                unit: None,
                epoch_s: None,
                rollover_s: None,
            })
            .collect();
        let rows_estimate = (file.packing == Packing::Plain && dialect.mean_line > 0.0).then(|| {
            ((file.bytes as f64 - dialect.data_offset as f64).max(0.0) / dialect.mean_line).round() as u64
        });
        let notes = dialect.notes.clone();
        let table = Text { path: file.path.clone(), packing: file.packing, dialect };
        Ok(Opened {
            columns,
            rows_estimate,
            notes,
            metadata: Vec::new(),
            stated_sample_rate_hz: None,
            table: Box::new(table),
        })
    }
}

struct Text {
    path: PathBuf,
    packing: Packing,
    dialect: Dialect,
}

struct Chunk {
    number: u64,
    text: Vec<u8>,
    bytes_done: u64,
}

impl Table for Text {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let parser =
            LineParser::new(self.dialect.delimiter, self.dialect.decimal, self.dialect.names.len(), wanted);
        let stream = ByteStream::open(&self.path, self.packing)?;
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
        mut stream: ByteStream,
        out: &SyncSender<Chunk>,
        free: &Receiver<Vec<u8>>,
    ) -> Result<Option<Digested>, IngestError> {
        let mut skipped = vec![0; self.dialect.data_offset];
        stream.fill(&mut skipped)?;
        drop(skipped);
        let mut tail: Vec<u8> = Vec::new();
        let mut number = 0;
        loop {
            let mut text = free.try_recv().unwrap_or_default();
            text.clear();
            text.append(&mut tail);
            let kept = text.len();
            text.resize(kept + CHUNK, 0);
            let n = stream.fill(text.get_mut(kept..).unwrap_or_default())?;
            text.truncate(kept + n);
            let last = n < CHUNK;
            if last {
                if text.last().is_some_and(|&c| c != b'\n') {
                    text.push(b'\n');
                }
            } else {
                let cut = memchr::memrchr(b'\n', &text).map_or(0, |i| i + 1);
                tail.extend_from_slice(text.get(cut..).unwrap_or_default());
                text.truncate(cut);
                if tail.len() > LONGEST_LINE {
                    return Err(IngestError::new(
                        IngestErrorKind::UnknownFormat,
                        &self.path,
                        Note::new("ingest.long_line").with("bytes", LONGEST_LINE),
                    )
                    .hint("ingest.hint.line_per_sample"));
                }
            }
            let bytes_done = stream.file_bytes();
            if out.send(Chunk { number, text, bytes_done }).is_err() {
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
        let (mut next, mut rows, mut line) = (0, 0u64, self.dialect.data_line);
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
    parser: &LineParser,
    chunks: &Mutex<Receiver<Chunk>>,
    text_back: &SyncSender<Vec<u8>>,
    blocks: &SyncSender<(u64, Block)>,
    free: &Mutex<Receiver<Block>>,
) {
    loop {
        let Ok(Ok(chunk)) = chunks.lock().map(|c| c.recv()) else { return };
        let mut block = free.lock().ok().and_then(|f| f.try_recv().ok()).unwrap_or_default();
        parser.parse(&chunk.text, &mut block);
        block.bytes_done = chunk.bytes_done;
        let _ = text_back.try_send(chunk.text);
        if blocks.send((chunk.number, block)).is_err() {
            return;
        }
    }
}
