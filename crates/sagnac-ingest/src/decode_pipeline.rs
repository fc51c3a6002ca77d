//! Decoding beside hashing: a binary file is decoded on one thread and hashed on another while its blocks are used.

use super::byte_stream::{ByteStream, Digested, Packing};
use super::error::{IngestError, IngestErrorKind};
use super::guarded::guarded;
use super::in_memory::non_finite;
use super::{Block, FieldFaultKind, FileFacts, OnBlock};
use sagnac_core::numeric::range::usable;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Takes filled blocks from a decoder and gives empty ones to it.
pub(super) struct Blocks {
    slots: usize,
    done: u64,
    out: SyncSender<Block>,
    free: Receiver<Block>,
}

impl Blocks {
    /// An empty block for the next rows.
    pub fn empty(&self) -> Block {
        let mut block = self.free.try_recv().unwrap_or_default();
        block.reset(self.slots);
        block.first_row = self.done + 1;
        block
    }

    /// Passes a block on; values that cannot be used are counted as non-finite. False when nobody wants more.
    #[must_use]
    pub fn pass(&mut self, block: Block) -> bool {
        self.pass_without(block, &BTreeSet::new())
    }

    /// The same, without counting the rows whose faults the decoder has counted itself.
    #[must_use]
    pub fn pass_without(&mut self, mut block: Block, counted: &BTreeSet<u64>) -> bool {
        let rows = block.rows();
        let mut columns = std::mem::take(&mut block.columns);
        for (slot, column) in columns.iter_mut().enumerate() {
            column.resize(rows, f64::NAN);
            for (i, v) in column.iter_mut().enumerate().filter(|(_, v)| !usable(**v)) {
                let row = block.first_row + i as u64;
                if !counted.contains(&row) {
                    let text = v.to_string();
                    block.fault(|| non_finite(slot, row, text), slot, FieldFaultKind::NonFinite);
                }
                *v = f64::NAN;
            }
        }
        block.columns = columns;
        self.pass_counted(block)
    }

    /// The same for a block whose faults the decoder has counted all, and marked as NaN.
    #[must_use]
    pub fn pass_counted(&mut self, block: Block) -> bool {
        let rows = block.rows();
        if rows == 0 {
            return true;
        }
        self.done += rows as u64;
        self.out.send(block).is_ok()
    }

    /// Rows passed on so far.
    pub fn rows(&self) -> u64 {
        self.done
    }
}

/// Runs a decoder for `slots` columns and hands its blocks on; the file is hashed meanwhile.
///
/// # Errors
/// What the decoder says, and what keeps the file from being hashed.
pub(super) fn run_pipeline(
    path: &Path,
    slots: usize,
    on_block: &mut OnBlock<'_>,
    decode: impl FnOnce(&mut Blocks) -> Result<(), IngestError> + Send,
) -> Result<Option<FileFacts>, IngestError> {
    let (out, filled) = sync_channel::<Block>(3);
    let (back, free) = sync_channel::<Block>(8);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let stop = &stop;
        let hash = scope.spawn(move || digest(path, stop));
        let decoder = scope.spawn(move || {
            let mut blocks = Blocks { slots, done: 0, out, free };
            guarded(path, || decode(&mut blocks).map(|()| blocks.rows()))
        });
        let mut stopped = false;
        for mut block in filled {
            if on_block(&mut block).is_break() {
                stopped = true;
                stop.store(true, Ordering::Relaxed);
                break;
            }
            // A full return channel only means that the memory is not used again.
            let _ = back.try_send(block);
        }
        // The decoder ends when nobody takes its blocks; a fault of its own makes the hash useless.
        let lost = |_| IngestError::new(IngestErrorKind::Io, path, "ingest.thread_stopped");
        let rows = decoder.join().map_err(lost)?;
        if rows.is_err() {
            stop.store(true, Ordering::Relaxed);
        }
        let digested = hash.join().map_err(lost)?;
        if stopped {
            return Ok(None);
        }
        let (rows, Some(digested)) = (rows?, digested?) else { return Ok(None) };
        Ok(Some(FileFacts { sha256: digested.sha256, bytes: digested.bytes, rows }))
    })
}

/// Hashes a file unless asked to stop.
fn digest(path: &Path, stop: &AtomicBool) -> Result<Option<Digested>, IngestError> {
    let mut stream = ByteStream::open(path, Packing::Plain)?;
    let mut buffer = vec![0; 1 << 18];
    while stream.fill(&mut buffer)? > 0 {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
    }
    stream.finish().map(Some)
}
