//! Archives of NumPy arrays (`.npz`): zip files in which each member is an array. The directory is read by the `rawzip`
//! crate; the members are unpacked here, side by side, so that none is ever held as a whole.

use super::array::{self, MAGIC};
use crate::binary::array_selection;
use crate::binary::column_stream::{
    Coding, ColumnPlace, ColumnStreamTable, RecordGroup, Stream, stream_error,
};
use crate::binary::positioned_file::PositionedFile;
use crate::error::{IngestError, IngestErrorKind};
use crate::metadata::{Metadata, stated_sample_rate_hz};
use crate::{Candidate, Column, Format, Opened};
use rawzip::{CompressionMethod, ReaderAt, ZipLocator};
use sagnac_core::message::{Note, note};
use std::io;
use std::sync::Arc;

/// Most members of an archive.
const MAX_MEMBERS: usize = 4096;

/// Bytes of a member that are looked at: its header and some data.
const HEAD: usize = 1 << 16;

/// An archive of NumPy arrays.
pub(crate) struct Npz;

/// An array of the archive that may become columns.
struct Member {
    stream: usize,
    data_at: u64,
    columns: array::Columns,
}

/// Contents of an archive.
#[derive(Default)]
struct ArchiveContents {
    streams: Vec<Stream>,
    members: Vec<Member>,
    arrays: Vec<array_selection::Array>,
    left: Vec<Note>,
    metadata: Metadata,
    rate_hz: Option<f64>,
}

impl Format for Npz {
    fn id(&self) -> &'static str {
        "npz"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        // The first member of an archive of arrays has the name of a file `*.npy`.
        let name = || {
            let length = usize::from(u16::from_le_bytes([*file.head.get(26)?, *file.head.get(27)?]));
            file.head.get(30..30usize.checked_add(length)?)
        };
        file.head.starts_with(b"PK\x03\x04") && name().is_some_and(|n| n.ends_with(b".npy"))
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let at = PositionedFile::open(file)?;
        let found = members(file, &at)?;
        let path = &file.path;
        let part = file.options.part.as_deref();
        let rows = array_selection::rows(path, &found.arrays, part)?;
        let Some(rows) = rows.filter(|rows| *rows > 0) else {
            let error = IngestError::new(IngestErrorKind::Empty, path, "ingest.npz.nothing");
            return Err(match found.left.into_iter().next() {
                Some(reason) => error.hint(reason),
                None => error.hint("ingest.hint.check_written"),
            });
        };
        let mut left = found.left;
        let (mut columns, mut groups, mut places) = (Vec::<Column>::new(), Vec::new(), Vec::new());
        let mut notes = Vec::new();
        for (member, array) in found.members.into_iter().zip(&found.arrays) {
            if !array_selection::belongs(array, rows, part, &found.arrays) {
                left.push(other_length(array, rows));
                continue;
            }
            notes.extend(member.columns.note.clone());
            let (stream, stride) = (member.stream, member.columns.stride);
            if member.columns.by_rows {
                groups.push(RecordGroup { stream, offset: member.data_at, stride });
            }
            for place in member.columns.list {
                if !member.columns.by_rows {
                    groups.push(RecordGroup { stream, offset: member.data_at + place.from, stride });
                }
                let group = groups.len().saturating_sub(1);
                places.push(place.field.map(|field| ColumnPlace { group, field }));
                columns.push(place.column);
            }
        }
        notes.extend(array_selection::notes(left));
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: Some(rows),
            cut_off: Vec::new(),
            notes,
            metadata: found.metadata.entries(),
            stated_sample_rate_hz: found.rate_hz,
            table: Box::new(ColumnStreamTable::new(
                path.clone(),
                file.bytes,
                at,
                found.streams,
                groups,
                places,
                rows,
            )),
        })
    }
}

/// Remark on an array that does not belong to the recording.
fn other_length(array: &array_selection::Array, rows: u64) -> Note {
    note!("ingest.binary.other_length", name = array.name.as_str(), rows = array.rows, chosen = rows)
}

impl ReaderAt for PositionedFile {
    fn read_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
        self.read(offset, buffer)
    }
}

/// Looks at every member of the archive.
fn members(file: &Candidate, at: &Arc<PositionedFile>) -> Result<ArchiveContents, IngestError> {
    let path = &file.path;
    let damaged = |e: rawzip::Error| {
        let note = note!("ingest.npz.damaged", reason = e.to_string());
        IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.damaged")
    };
    let mut buffer = vec![0; rawzip::RECOMMENDED_BUFFER_SIZE];
    let located = ZipLocator::new().locate_in_reader(at.as_ref(), &mut buffer, at.size);
    let archive = located.map_err(|(_, e)| damaged(e))?;
    let mut directory = archive.entries(&mut buffer);
    let mut found = ArchiveContents::default();
    let mut count = 0;
    while let Some(member) = directory.next_entry().map_err(damaged)? {
        count += 1;
        if count > MAX_MEMBERS {
            let note = note!("ingest.binary.too_many_columns", most = MAX_MEMBERS);
            let error = IngestError::new(IngestErrorKind::Damaged, path, note);
            return Err(error.hint("ingest.hint.give_recording"));
        }
        let full = String::from_utf8_lossy(member.file_path().as_bytes()).into_owned();
        let leave = |reason: Note| note!("ingest.binary.left_out", name = shown(&full), reason);
        let coding = match member.compression_method() {
            _ if member.flags().is_encrypted() => None,
            CompressionMethod::STORE => Some(Coding::Checked(member.crc32())),
            CompressionMethod::DEFLATE => Some(Coding::Deflate(member.crc32())),
            _ => None,
        };
        let Some(name) = full.strip_suffix(".npy") else {
            found.left.push(leave("ingest.npz.no_array".into()));
            continue;
        };
        let Some(coding) = coding else {
            found.left.push(leave("ingest.npz.packing".into()));
            continue;
        };
        let (from, end) = archive.get_entry(member.wayfinder()).map_err(damaged)?.compressed_data_range();
        let stream = Stream { name: full.clone(), from, length: end.saturating_sub(from), coding };
        let size = member.uncompressed_size_hint();
        let mut head = vec![0; HEAD.min(usize::try_from(size).unwrap_or(HEAD))];
        let n = stream.open(at).fill(&mut head).map_err(|e| stream_error(path, &full, &e))?;
        head.truncate(n);
        if !head.starts_with(MAGIC) {
            found.left.push(leave("ingest.npz.no_array".into()));
            continue;
        }
        let array = match array::header(&head) {
            Ok(array) => array,
            Err((reason, _)) => {
                found.left.push(leave(reason));
                continue;
            }
        };
        if size.checked_sub(array.data_at).is_none_or(|there| there < array.data_bytes) {
            let note = note!("ingest.npz.short", name = shown(&full), declared = array.data_bytes);
            return Err(IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.cut_off"));
        }
        let data = usize::try_from(array.data_at).ok().and_then(|at| head.get(at..)).unwrap_or_default();
        let columns = match array.columns(name, data) {
            Ok(columns) => columns,
            Err((reason, _)) => {
                found.left.push(leave(reason));
                continue;
            }
        };
        if array.is_scalar() {
            scalar(&mut found, name, &columns, data);
            continue;
        }
        found.arrays.push(array_selection::Array {
            name: name.to_owned(),
            rows: columns.rows,
            columns: columns.list.len(),
            in_structure: false,
        });
        found.members.push(Member { stream: found.streams.len(), data_at: array.data_at, columns });
        found.streams.push(stream);
    }
    Ok(found)
}

/// Keeps a single value: as the sample rate where its name says so, and among what the file says of itself.
fn scalar(found: &mut ArchiveContents, name: &str, columns: &array::Columns, data: &[u8]) {
    let Some(place) = columns.list.first() else { return };
    let Some(field) = place.field else {
        // Texts are characters of four bytes each, in the order of the machine that nearly every file comes from.
        let characters = data.chunks_exact(4).take(200).filter_map(|c| {
            let code = u32::from_le_bytes([*c.first()?, *c.get(1)?, *c.get(2)?, *c.get(3)?]);
            char::from_u32(code).filter(|c| *c != '\0')
        });
        if place.column.storage.contains('U') {
            found.metadata.add(name, &characters.collect::<String>());
        }
        return;
    };
    let mut value = Vec::new();
    field.decode(data.get(..columns.stride).unwrap_or_default(), columns.stride, &mut value);
    if let Some(value) = value.first() {
        found.rate_hz = found.rate_hz.or_else(|| stated_sample_rate_hz(name, *value));
        found.metadata.add(name, &value.to_string());
    }
}

fn shown(name: &str) -> String {
    crate::error::shorten(name)
}
