//! An HDF5 file opened within bounds of memory, and the diagnostics of its decoder.

use crate::error::{IngestError, IngestErrorKind};
use hdf5_reader::error::Error;
use hdf5_reader::{FileStorage, Hdf5File, OpenOptions};
use sagnac_core::message::note;
use std::path::Path;
use std::sync::Arc;

/// Largest chunk, and memory for chunks that are used again, bytes.
const MAX_CHUNK_BYTES: usize = 256 << 20;
const CHUNK_CACHE: usize = 64 << 20;
/// Bytes of a chunk that are always allowed, and how many more per byte of the file.
const CHUNK_ALLOWED: usize = 16 << 20;
const CHUNK_RATIO: u64 = 50;
/// Largest slice, bytes as stored.
const MAX_SLICE_BYTES: usize = 64 << 20;
/// Opens the file for reading by ranges; nothing larger than the limits is held.
pub(super) fn container(path: &Path, bytes: u64) -> Result<Hdf5File, IngestError> {
    let storage = FileStorage::open(path).map_err(|e| damaged(path, &e))?;
    let per_file = usize::try_from(bytes.saturating_mul(CHUNK_RATIO)).unwrap_or(usize::MAX);
    let options = OpenOptions::default()
        .with_chunk_cache_bytes(CHUNK_CACHE)
        .with_max_chunk_bytes(MAX_CHUNK_BYTES.min(per_file.max(CHUNK_ALLOWED)))
        .with_max_read_bytes(MAX_SLICE_BYTES)
        .with_max_object_header_bytes(usize::try_from(bytes).unwrap_or(usize::MAX).min(16 << 20));
    Hdf5File::from_storage_with_options(Arc::new(storage), options).map_err(|e| damaged(path, &e))
}

/// The diagnostic of what the decoder says.
pub(super) fn damaged(path: &Path, error: &Error) -> IngestError {
    let mut inner = error;
    while let Error::Context { source, .. } = inner {
        inner = source;
    }
    let hint = match inner {
        Error::Io(e) => return crate::byte_stream::io_error(path, e),
        Error::UnsupportedFilter(_) => "ingest.hdf5.hint.filter",
        Error::ResourceLimit(_) => "ingest.hdf5.hint.limit",
        Error::UnsupportedEncoding(_)
        | Error::UnsupportedDatatypeClass(_)
        | Error::UnsupportedLayoutClass(_) => "ingest.hdf5.hint.encoding",
        _ => "ingest.hint.damaged",
    };
    IngestError::new(IngestErrorKind::Damaged, path, note!("ingest.hdf5.damaged", reason = error.to_string()))
        .hint(hint)
}
