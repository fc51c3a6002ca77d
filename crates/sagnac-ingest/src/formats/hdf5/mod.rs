//! HDF5, NetCDF-4 and MATLAB v7.3: the datasets of one group as columns, read in slices of rows.

mod attributes;
mod container;
mod file_tree;
mod number;
mod table;

use crate::error::{IngestError, IngestErrorKind};
use crate::metadata::Metadata;
use crate::part_selection;
use crate::{Candidate, Format, Opened};
use container::{container, damaged};
use sagnac_core::message::note;

/// First bytes of the file, or of what follows a user block.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Bytes of a dataset per byte of the file beyond which a file is refused, and where that starts to count.
const BOMB_RATIO: u64 = 1000;
const BOMB_FROM: u64 = 16 << 20;

/// HDF5.
pub(super) struct Hdf5;

impl Format for Hdf5 {
    fn id(&self) -> &'static str {
        "hdf5"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        let at = |start: usize| file.head.get(start..).is_some_and(|rest| rest.starts_with(SIGNATURE));
        // A user block is 512 bytes long, or twice that, or twice that ...
        at(0) || std::iter::successors(Some(512usize), |n| n.checked_mul(2)).take(9).any(at)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        part_selection::unpacked(file, "ingest.hdf5.what")?;
        let path = &file.path;
        let container = container(path, file.bytes)?;
        let found = file_tree::walk(&container).map_err(|e| damaged(path, &e))?;
        let found = found.narrowed(file.options.part.as_deref());
        let parts: Vec<part_selection::Part> = found.parts.iter().map(|p| p.part.clone()).collect();
        let (chosen, mut notes) = part_selection::choose(path, &parts, file.options.part.as_deref())?;
        let part = found.parts.into_iter().nth(chosen).ok_or_else(|| {
            IngestError::new(IngestErrorKind::Empty, path, "ingest.parts.none")
                .hint("ingest.parts.hint.check")
        })?;
        let rows = part.part.common_rows().unwrap_or(0);
        notes.extend(part_selection::odd_lengths(&part.part, rows));
        notes.extend(part.notes);
        notes.extend(found.notes);
        let mut columns = Vec::new();
        let mut places = Vec::new();
        for ((column, length), place) in part.part.columns.into_iter().zip(part.places) {
            if length != rows && column.numeric {
                continue;
            }
            if column.numeric && place.logical_bytes > BOMB_FROM.max(file.bytes.saturating_mul(BOMB_RATIO)) {
                return Err(IngestError::new(
                    IngestErrorKind::Bomb,
                    path,
                    note!(
                        "ingest.hdf5.bomb",
                        name = column.name,
                        bytes = place.logical_bytes,
                        file = file.bytes
                    ),
                )
                .hint("ingest.hint.bomb"));
            }
            columns.push(column);
            places.push(place);
        }
        let mut metadata = Metadata::default();
        for (key, value) in found.metadata.iter().chain(&part.metadata) {
            metadata.add(key, value);
        }
        let rate = part.stated_rate_hz.or(found.stated_rate_hz);
        if let Some(rate) = rate {
            notes.push(note!("ingest.parts.stated_rate", rate));
        }
        table::unfiltered(&container, path, &mut columns, &places, &mut notes)?;
        table::dated(&container, path, &mut columns, &mut places, &mut notes)?;
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: Some(rows),
            cut_off: Vec::new(),
            notes,
            metadata: metadata.entries(),
            stated_sample_rate_hz: rate,
            table: Box::new(table::Hdf5Table { path: path.clone(), bytes: file.bytes, rows, places }),
        })
    }
}
