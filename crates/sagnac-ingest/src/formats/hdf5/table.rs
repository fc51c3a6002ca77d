//! Rows of datasets as blocks.

use super::container::{container, damaged};
use super::file_tree::{Pick, Place};
use super::number::{Bytes, Number, Whole};
use crate::column_inference::infer;
use crate::decode_pipeline::{Blocks, run_pipeline};
use crate::error::{IngestError, IngestErrorKind};
use crate::{Block, Column, FileFacts, OnBlock, Table};
use hdf5_reader::error::Error;
use hdf5_reader::{Dataset, H5Type, Hdf5File, SliceInfo, SliceInfoElem};
use sagnac_core::message::{Note, note};
use sagnac_core::recording::Role;
use sagnac_core::units::Affine;
use std::path::{Path, PathBuf};

/// Rows in a block, and the most where chunks are longer than that.
const ROWS: u64 = 1 << 15;
const MAX_ROWS: u64 = 1 << 18;
/// Bytes of a dataset that are read at once.
const SLICE: u64 = 32 << 20;

/// Whole numbers taken for stamps: least and greatest of the first, what one counts in s, and the unit.
const STAMPS: &[(i128, i128, f64, &str)] = &[
    (1_000_000_000_000_000_000, 3_000_000_000_000_000_000, 1e-9, "ns"),
    (1_000_000_000_000_000, 3_000_000_000_000_000, 1e-6, "us"),
];

/// The chosen columns of a file.
pub(super) struct Hdf5Table {
    pub path: PathBuf,
    pub bytes: u64,
    pub rows: u64,
    pub places: Vec<Place>,
}

/// A dataset with the wanted columns in it and their slots.
struct Wanted<'a> {
    dataset: Dataset,
    columns: Vec<(usize, &'a Place)>,
}

/// Sets aside the columns whose filter is not known here, so that the others can be read.
pub(super) fn unfiltered(
    file: &Hdf5File,
    path: &Path,
    columns: &mut [Column],
    places: &[Place],
    notes: &mut Vec<Note>,
) -> Result<(), IngestError> {
    let mut tried: Vec<(&str, Option<String>)> = Vec::new();
    for (column, place) in columns.iter_mut().zip(places).filter(|(c, _)| c.numeric) {
        let name = place.dataset.as_str();
        let known = tried.iter().find(|(n, _)| *n == name).map(|(_, f)| f.clone());
        let filter = match known {
            Some(filter) => filter,
            None => {
                let dataset = file.dataset(name).map_err(|e| damaged(path, &e))?;
                let first = match place.pick {
                    Pick::Field { .. } => slice::<Bytes>(&dataset, place.pick, 0, 1, (0, 0)).map(drop),
                    _ => slice::<Number>(&dataset, place.pick, 0, 1, (0, 0)).map(drop),
                };
                // Other faults are reported when the rows are read.
                let filter = match first {
                    Err(Error::UnsupportedFilter(f)) => Some(f),
                    Err(Error::Context { source, .. }) => match *source {
                        Error::UnsupportedFilter(f) => Some(f),
                        _ => None,
                    },
                    _ => None,
                };
                if let Some(filter) = &filter {
                    let note = note!("ingest.hdf5.filtered", name);
                    notes.push(note.with("filter", filter.as_str()));
                }
                tried.push((name, filter.clone()));
                filter
            }
        };
        if let Some(filter) = filter {
            column.numeric = false;
            column.storage = format!("{} under {filter}", column.storage);
        }
    }
    Ok(())
}

/// Turns whole numbers that count from 1970 and are too great for f64 into seconds from an epoch near them.
pub(super) fn dated(
    file: &Hdf5File,
    path: &Path,
    columns: &mut [Column],
    places: &mut [Place],
    notes: &mut Vec<Note>,
) -> Result<(), IngestError> {
    for (column, place) in columns.iter_mut().zip(places) {
        let wide = column.numeric
            && place.storage.is_some_and(|s| s.is_wide_integer())
            && place.conversion == Affine::IDENTITY;
        if !wide
            || place.pick != Pick::All
            || infer(&column.name, Some("s").filter(|_| column.unit.is_some())).role != Role::Time
        {
            continue;
        }
        let dataset = file.dataset(&place.dataset).map_err(|e| damaged(path, &e))?;
        let first = slice::<Whole>(&dataset, place.pick, 0, 1, (0, 0)).map_err(|e| damaged(path, &e))?;
        let Some(first) = first.first().map(|w| w.0) else { continue };
        let unit = column.unit.as_deref();
        let Some(&(.., step_s, word)) = STAMPS.iter().find(|(least, most, _, word)| {
            (*least..*most).contains(&first) && unit.is_none_or(|u| u == *word)
        }) else {
            continue;
        };
        let per_s = (1.0 / step_s).round() as i128;
        let epoch = first.div_euclid(per_s);
        place.base = Some(epoch * per_s);
        place.conversion = Affine { factor: step_s, offset: 0.0 };
        column.unit = Some("s".to_owned());
        column.epoch_s = Some(epoch as f64);
        notes.push(note!("ingest.hdf5.stamps", name = column.name.as_str(), unit = word));
    }
    Ok(())
}

impl Table for Hdf5Table {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        run_pipeline(&self.path, wanted.len(), on_block, |blocks| self.decode(wanted, blocks))
    }
}

impl Hdf5Table {
    fn decode(&self, wanted: &[usize], blocks: &mut Blocks) -> Result<(), IngestError> {
        let file = container(&self.path, self.bytes)?;
        let mut datasets: Vec<Wanted<'_>> = Vec::new();
        for (slot, place) in wanted.iter().filter_map(|&w| self.places.get(w)).enumerate() {
            let same = datasets
                .iter_mut()
                .find(|d| d.columns.first().is_some_and(|(_, p)| p.dataset == place.dataset));
            match same {
                Some(known) => known.columns.push((slot, place)),
                None => datasets.push(Wanted {
                    dataset: file.dataset(&place.dataset).map_err(|e| damaged(&self.path, &e))?,
                    columns: vec![(slot, place)],
                }),
            }
        }
        let rows = block_rows(&datasets);
        let mut start = 0;
        while start < self.rows {
            let end = start.saturating_add(rows).min(self.rows);
            let mut block = blocks.empty();
            for d in &datasets {
                d.read(start, end, &mut block).map_err(|e| self.lost(d, start, end, &e))?;
            }
            block.bytes_done = (self.bytes as f64 * (end as f64 / self.rows as f64)) as u64;
            if !blocks.pass(block) {
                return Ok(());
            }
            start = end;
        }
        Ok(())
    }

    /// The diagnostic of rows that cannot be decoded.
    fn lost(&self, wanted: &Wanted<'_>, start: u64, end: u64, error: &Error) -> IngestError {
        let name = wanted.columns.first().map_or("", |(_, p)| p.dataset.as_str());
        let whole = damaged(&self.path, error);
        let note =
            note!("ingest.hdf5.slice", name, first = start + 1, last = end, reason = error.to_string());
        let kind = whole.kind();
        let error = IngestError::new(kind, &self.path, note);
        match whole.advice() {
            Some(hint) if kind == IngestErrorKind::Damaged => error.hint(hint.clone()),
            _ => whole,
        }
    }
}

/// Rows read at once: whole chunks where they are short, within the limit of bytes.
fn block_rows(datasets: &[Wanted<'_>]) -> u64 {
    let mut rows = ROWS;
    let mut widest = 1;
    for (i, d) in datasets.iter().enumerate() {
        let Some((_, place)) = d.columns.first() else { continue };
        let (low, high) = d.span();
        let row_bytes = (d.dataset.raw_element_size().unwrap_or(8) as u64).saturating_mul(high - low + 1);
        widest = row_bytes.max(widest);
        let along = match place.pick {
            Pick::Column { rows_last: true, .. } => 1,
            _ => 0,
        };
        let chunk = d.dataset.chunks().and_then(|c| c.get(along).copied()).map_or(0, u64::from);
        if i == 0 && chunk > 0 {
            rows = if chunk >= ROWS { chunk.min(MAX_ROWS) } else { ROWS / chunk * chunk };
        }
    }
    rows.min(SLICE / widest).max(1)
}

impl Wanted<'_> {
    /// First and last wanted column of a dataset of two dimensions.
    fn span(&self) -> (u64, u64) {
        let index = |(_, p): &(usize, &Place)| match p.pick {
            Pick::Column { index, .. } => index,
            _ => 0,
        };
        let low = self.columns.iter().map(index).min().unwrap_or(0);
        (low, self.columns.iter().map(index).max().unwrap_or(0))
    }

    /// Puts rows into a block.
    fn read(&self, start: u64, end: u64, block: &mut Block) -> Result<(), Error> {
        let (low, high) = self.span();
        let Some((_, first)) = self.columns.first() else { return Ok(()) };
        let rows = (end - start) as usize;
        if let Some(base) = first.base {
            let values = slice::<Whole>(&self.dataset, first.pick, start, end, (low, high))?;
            // Division rounds once; 1e-9 is no f64 and would round twice.
            let per_s = (1.0 / first.conversion.factor).round();
            for (slot, _) in &self.columns {
                fill(block, *slot, values.iter().map(|w| (w.0 - base) as f64 / per_s));
            }
            return Ok(());
        }
        if let Pick::Field { .. } = first.pick {
            let records = slice::<Bytes>(&self.dataset, first.pick, start, end, (low, high))?;
            for (slot, place) in &self.columns {
                let (Pick::Field { offset }, Some(storage)) = (place.pick, place.storage) else { continue };
                let number = |r: &Bytes| storage.number(r.0.get(offset..).unwrap_or_default());
                fill(block, *slot, records.iter().map(number));
            }
            return Ok(());
        }
        let values = slice::<Number>(&self.dataset, first.pick, start, end, (low, high))?;
        let width = (high - low + 1) as usize;
        for (slot, place) in &self.columns {
            let (from, step) = match place.pick {
                Pick::Column { index, rows_last: true, .. } => ((index - low) as usize * rows, 1),
                Pick::Column { index, .. } => ((index - low) as usize, width),
                _ => (0, 1),
            };
            let conversion = place.conversion;
            let missing = place.missing;
            let one = values.get(from..).unwrap_or_default().iter().step_by(step).take(rows);
            if conversion == Affine::IDENTITY && missing.is_none() {
                fill(block, *slot, one.map(|n| n.0));
            } else {
                let value = |n: &Number| if missing == Some(n.0) { f64::NAN } else { conversion.apply(n.0) };
                fill(block, *slot, one.map(value));
            }
        }
        Ok(())
    }
}

fn fill(block: &mut Block, slot: usize, values: impl Iterator<Item = f64>) {
    if let Some(column) = block.columns.get_mut(slot) {
        column.extend(values);
    }
}

/// Rows of a dataset, in the order of the file.
fn slice<T: H5Type>(
    dataset: &Dataset,
    pick: Pick,
    start: u64,
    end: u64,
    (low, high): (u64, u64),
) -> Result<Vec<T>, Error> {
    let span = |start, end| SliceInfoElem::Slice { start, end, step: 1 };
    let selections = match pick {
        Pick::Column { rows_last: true, .. } => vec![span(low, high + 1), span(start, end)],
        Pick::Column { .. } => vec![span(start, end), span(low, high + 1)],
        Pick::All | Pick::Field { .. } => vec![span(start, end)],
    };
    let array = dataset.read_slice::<T>(&SliceInfo { selections })?;
    let expected = (end - start).saturating_mul(high - low + 1);
    if array.len() as u64 != expected {
        return Err(Error::InvalidData(format!("{expected} values expected, {} found", array.len())));
    }
    if array.is_standard_layout() {
        return Ok(array.into_raw_vec_and_offset().0);
    }
    Ok(array.iter().cloned().collect())
}
