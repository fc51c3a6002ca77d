//! Finds records in a stream by their sync word and checksum, and tells what was lost.

use crate::binary::records::{FramedRecords, Framer};
use crate::layout::{Checksum, Layout};
use memchr::memmem;

/// Rows of passed-over bytes that are reported at once, so that a stretch without records needs no memory.
const AT_ONCE: u64 = 1000;

/// Finds records in a stream.
pub(super) struct Scanner {
    sync: Vec<u8>,
    checksum: Option<Checksum>,
    record: usize,
    pending: Vec<u8>,
    /// Place of the first pending byte in the unpacked file.
    at: u64,
    /// Where the bytes begin that belong to no record, and whether rows of them were reported already.
    lost: Option<(u64, bool)>,
}

/// What stands at the start of some bytes.
enum Match {
    /// A record.
    Record,
    /// A record whose checksum is wrong: made and found.
    Wrong(u32, u32),
    /// No record.
    Nothing,
    /// More bytes are needed to tell.
    More,
}

impl Scanner {
    pub fn new(layout: &Layout) -> Scanner {
        Scanner {
            sync: layout.sync.clone(),
            checksum: layout.checksum.clone(),
            record: layout.record_bytes.max(1),
            pending: Vec::new(),
            at: layout.header_bytes,
            lost: None,
        }
    }

    /// A record counts when its checksum is right. Without a checksum, or with a wrong one, it counts as one when the
    /// next record begins right behind it: bytes that were dropped inside would shift that. Where sync was lost, the
    /// next record must be there in any case, so that the checksum is not made anew at every byte.
    fn look(&self, rest: &[u8], end: bool) -> Match {
        let Some(record) = rest.get(..self.record) else { return Match::More };
        if !record.starts_with(&self.sync) {
            return Match::Nothing;
        }
        let behind = rest.get(self.record..).unwrap_or_default();
        let next = if behind.len() >= self.sync.len() {
            behind.starts_with(&self.sync)
        } else if end {
            self.sync.starts_with(behind)
        } else {
            return Match::More;
        };
        if !next && (self.lost.is_some() || self.checksum.is_none()) {
            return Match::Nothing;
        }
        match self.checksum.as_ref().and_then(|c| c.differs(record)) {
            None => Match::Record,
            Some((made, found)) if next => Match::Wrong(made, found),
            Some(_) => Match::Nothing,
        }
    }

    /// Turns the bytes since sync was lost into rows without values.
    fn report_lost(&mut self, now: u64, out: &mut FramedRecords) {
        let Some((from, told)) = self.lost.take() else { return };
        let bytes = now.saturating_sub(from);
        let record = self.record as u64;
        let rows = (bytes + record / 2) / record;
        let rows = if told { rows } else { rows.max(1) };
        self.bad_rows(rows, &format!("sync @{from} +{bytes} B"), out);
    }

    fn bad_rows(&self, rows: u64, text: &str, out: &mut FramedRecords) {
        for _ in 0..rows {
            out.bad.push((out.records.len() / self.record, text.to_owned()));
            out.records.resize(out.records.len() + self.record, 0);
        }
    }
}

impl Framer for Scanner {
    fn take(&mut self, bytes: &[u8], end: bool, out: &mut FramedRecords) {
        let mut pending = std::mem::take(&mut self.pending);
        pending.extend_from_slice(bytes);
        let mut at = 0;
        loop {
            let rest = pending.get(at..).unwrap_or_default();
            let here = self.at + at as u64;
            match self.look(rest, end) {
                Match::Record => {
                    self.report_lost(here, out);
                    out.records.extend_from_slice(rest.get(..self.record).unwrap_or_default());
                    at += self.record;
                }
                Match::Wrong(made, found) => {
                    self.report_lost(here, out);
                    let word = self.checksum.as_ref().map_or("", |c| c.word);
                    self.bad_rows(1, &format!("{word} {found:x} ≠ {made:x} @{here}"), out);
                    at += self.record;
                }
                Match::Nothing => {
                    self.lost.get_or_insert((here, false));
                    let ahead = rest.get(1..).unwrap_or_default();
                    // A word that is cut by the end of what was read so far may still be one.
                    let keep = ahead.len().saturating_sub(self.sync.len().saturating_sub(1));
                    at += 1 + memmem::find(ahead, &self.sync).unwrap_or(if end { ahead.len() } else { keep });
                }
                Match::More => {
                    if end && !rest.is_empty() {
                        let from = self.lost.take().map_or(here, |(from, _)| from);
                        let bytes = here + rest.len() as u64 - from;
                        let rows = bytes.div_ceil(self.record as u64);
                        self.bad_rows(rows, &format!("{bytes}/{} B @{from}", self.record), out);
                        at = pending.len();
                    }
                    break;
                }
            }
        }
        let now = self.at + at as u64;
        if end {
            self.report_lost(now, out);
        } else if let Some((from, _)) = self.lost {
            let rows = (now - from) / self.record as u64;
            if rows >= AT_ONCE {
                let bytes = rows * self.record as u64;
                self.bad_rows(rows, &format!("sync @{from} +{bytes} B"), out);
                self.lost = Some((from + bytes, true));
            }
        }
        pending.drain(..at.min(pending.len()));
        self.at = now;
        self.pending = pending;
    }
}

#[cfg(test)]
#[path = "framing_tests.rs"]
mod tests;
