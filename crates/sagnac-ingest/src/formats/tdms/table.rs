//! Values of TDMS channels as blocks.

use super::bytes::{stamp, word};
use super::properties::FROM_1904_S;
use super::scale::Step;
use super::segments::{Channel, Kind, Piece};
use crate::byte_stream::io_error;
use crate::decode_pipeline::{Blocks, run_pipeline};
use crate::error::IngestError;
use crate::open_file;
use crate::{FileFacts, OnBlock, Table};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Rows in a block.
const ROWS: u64 = 1 << 15;
/// Bytes of the file that are kept, as so many pages.
const PAGE: u64 = 1 << 18;
const PAGES: usize = 48;

/// Where the values of a column come from.
pub(super) enum Origin {
    /// A channel.
    Channel { kind: Kind, pieces: Vec<Piece>, steps: Vec<Step>, base_s: i64 },
    /// The time base of waveforms.
    Waveform { offset_s: f64, increment_s: f64 },
}

impl Origin {
    /// The values of a channel; stamps are counted from `base_s`, in s from 1970.
    pub fn channel(channel: &Channel, steps: Vec<Step>, base_s: i64) -> Origin {
        Origin::Channel { kind: channel.kind, pieces: channel.pieces.clone(), steps, base_s }
    }
}

/// The chosen channels of a file.
pub(super) struct TdmsTable {
    pub path: PathBuf,
    pub bytes: u64,
    pub rows: u64,
    pub origins: Vec<Origin>,
}

/// The full second of the first stamp of a channel, s from 1970.
pub(super) fn first_stamp_s(path: &Path, channel: &Channel) -> Result<i64, IngestError> {
    let Some(first) = channel.pieces.first() else { return Ok(0) };
    let mut bytes = Vec::new();
    Pages::open(path)?.read(first.at, 16, &mut bytes)?;
    Ok(stamp(&bytes, first.big_endian).0.saturating_sub(FROM_1904_S))
}

impl Table for TdmsTable {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        run_pipeline(&self.path, wanted.len(), on_block, |blocks| self.decode(wanted, blocks))
    }
}

impl TdmsTable {
    fn decode(&self, wanted: &[usize], blocks: &mut Blocks) -> Result<(), IngestError> {
        let mut pages = Pages::open(&self.path)?;
        let mut cursors: Vec<(&Origin, Cursor)> =
            wanted.iter().filter_map(|&w| self.origins.get(w)).map(|o| (o, Cursor::default())).collect();
        let mut start = 0;
        while start < self.rows {
            let end = start.saturating_add(ROWS).min(self.rows);
            let mut block = blocks.empty();
            for ((origin, cursor), column) in cursors.iter_mut().zip(&mut block.columns) {
                match origin {
                    Origin::Waveform { offset_s, increment_s } => {
                        column.extend((start..end).map(|i| offset_s + i as f64 * increment_s));
                    }
                    Origin::Channel { kind, pieces, steps, base_s } => {
                        cursor.take(end - start, pieces, *kind, *base_s, &mut pages, column)?;
                        for step in steps {
                            column.iter_mut().for_each(|v| *v = step.apply(*v));
                        }
                    }
                }
            }
            block.bytes_done = (self.bytes as f64 * (end as f64 / self.rows as f64)) as u64;
            if !blocks.pass(block) {
                return Ok(());
            }
            start = end;
        }
        Ok(())
    }
}

/// Place in the pieces of a channel.
#[derive(Default)]
struct Cursor {
    piece: usize,
    chunk: u64,
    value: u64,
    bytes: Vec<u8>,
}

impl Cursor {
    /// Appends the next values.
    fn take(
        &mut self,
        mut count: u64,
        pieces: &[Piece],
        kind: Kind,
        base_s: i64,
        pages: &mut Pages,
        out: &mut Vec<f64>,
    ) -> Result<(), IngestError> {
        let width = kind.bytes().unwrap_or(8);
        while count > 0 {
            let Some(piece) = pieces.get(self.piece) else { break };
            if self.chunk == piece.chunks {
                (self.piece, self.chunk, self.value) = (self.piece + 1, 0, 0);
                continue;
            }
            let n = count.min(piece.count - self.value);
            // A value beyond the file would have been refused when the segments were read.
            let at = piece.at + self.chunk * piece.chunk_step + self.value * piece.value_step;
            let span = (n - 1) * piece.value_step + width;
            pages.read(at, span, &mut self.bytes)?;
            let values = self.bytes.chunks(piece.value_step as usize).take(n as usize);
            convert(values, kind, piece, base_s, out);
            count -= n;
            self.value += n;
            if self.value == piece.count {
                (self.chunk, self.value) = (self.chunk + 1, 0);
            }
        }
        Ok(())
    }
}

/// Turns the bytes of values into numbers.
fn convert<'a>(
    values: impl Iterator<Item = &'a [u8]>,
    kind: Kind,
    piece: &Piece,
    base_s: i64,
    out: &mut Vec<f64>,
) {
    let big = piece.big_endian;
    let cut = |v: &'a [u8], n: u8| word(v.get(..usize::from(n)).unwrap_or_default(), big);
    match kind {
        Kind::Float(8) if !big => {
            out.extend(values.map(|v| v.first_chunk::<8>().map_or(f64::NAN, |b| f64::from_le_bytes(*b))))
        }
        Kind::Float(8) => out.extend(values.map(|v| f64::from_bits(cut(v, 8)))),
        Kind::Float(_) => out.extend(values.map(|v| f64::from(f32::from_bits(cut(v, 4) as u32)))),
        Kind::Unsigned(n) => out.extend(values.map(|v| cut(v, n) as f64)),
        Kind::Signed(n) => {
            let shift = 64 - 8 * u32::from(n);
            out.extend(values.map(|v| (((cut(v, n) << shift) as i64) >> shift) as f64));
        }
        Kind::Stamp => out.extend(values.map(|v| {
            let (seconds, fraction) = stamp(v.get(..16).unwrap_or_default(), big);
            let whole = i128::from(seconds) - i128::from(FROM_1904_S) - i128::from(base_s);
            whole as f64 + fraction as f64 / 2f64.powi(64)
        })),
        Kind::Other(..) => out.extend(values.map(|_| f64::NAN)),
    }
}

/// The file in pages; those used last are kept, for the channels of a segment stand side by side.
struct Pages {
    path: PathBuf,
    file: File,
    pages: Vec<(u64, u64, Vec<u8>)>,
    clock: u64,
}

impl Pages {
    fn open(path: &Path) -> Result<Pages, IngestError> {
        let file = open_file(path).map_err(|e| io_error(path, &e))?;
        Ok(Pages { path: path.to_owned(), file, pages: Vec::new(), clock: 0 })
    }

    /// Reads bytes that must be there.
    fn read(&mut self, at: u64, len: u64, out: &mut Vec<u8>) -> Result<(), IngestError> {
        out.clear();
        let end = at.saturating_add(len);
        let mut at = at;
        while at < end {
            let number = at / PAGE;
            let page = self.page(number)?;
            let from = (at - number * PAGE) as usize;
            let to = ((end - number * PAGE).min(PAGE)) as usize;
            let Some(bytes) = page.get(from..to) else {
                let e = std::io::Error::from(std::io::ErrorKind::UnexpectedEof);
                return Err(io_error(&self.path, &e));
            };
            out.extend_from_slice(bytes);
            at += bytes.len() as u64;
        }
        Ok(())
    }

    fn page(&mut self, number: u64) -> Result<&[u8], IngestError> {
        self.clock += 1;
        let known = self.pages.iter().position(|p| p.0 == number);
        let index = match known {
            Some(index) => index,
            None => {
                let mut bytes = if self.pages.len() < PAGES {
                    Vec::new()
                } else {
                    let oldest = self.pages.iter().enumerate().min_by_key(|(_, p)| p.1).map_or(0, |(i, _)| i);
                    self.pages.swap_remove(oldest).2
                };
                bytes.clear();
                let io = |e| io_error(&self.path, &e);
                self.file.seek(SeekFrom::Start(number * PAGE)).map_err(io)?;
                self.file.by_ref().take(PAGE).read_to_end(&mut bytes).map_err(io)?;
                self.pages.push((number, 0, bytes));
                self.pages.len() - 1
            }
        };
        let clock = self.clock;
        match self.pages.get_mut(index) {
            Some(page) => {
                page.1 = clock;
                Ok(page.2.as_slice())
            }
            None => Ok(&[]),
        }
    }
}
