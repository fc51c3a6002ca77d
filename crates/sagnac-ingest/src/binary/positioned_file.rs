//! Bytes of a file by position. A packed file is unpacked into a nameless temporary file first.

use crate::Candidate;
use crate::byte_stream::{ByteStream, Packing, io_error};
use crate::error::IngestError;
use crate::open_file;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes that are copied at a time.
const CHUNK: usize = 1 << 18;

/// A file that is read by position, by several readers at once.
#[derive(Debug)]
pub(crate) struct PositionedFile {
    file: File,
    /// Size, bytes.
    pub size: u64,
}

impl PositionedFile {
    /// Opens the content of a file, unpacked.
    pub fn open(candidate: &Candidate) -> Result<Arc<PositionedFile>, IngestError> {
        let path = &candidate.path;
        if candidate.packing == Packing::Plain {
            let file = open_file(path).map_err(|e| io_error(path, &e))?;
            return Ok(Arc::new(PositionedFile { file, size: candidate.bytes }));
        }
        let mut stream = ByteStream::open(path, candidate.packing)?;
        let mut file = tempfile::tempfile().map_err(|e| io_error(path, &e))?;
        let mut buffer = vec![0; CHUNK];
        let mut size = 0u64;
        loop {
            let n = stream.fill(&mut buffer)?;
            if n == 0 {
                return Ok(Arc::new(PositionedFile { file, size }));
            }
            file.write_all(buffer.get(..n).unwrap_or_default()).map_err(|e| io_error(path, &e))?;
            size += n as u64;
        }
    }

    /// Takes a file that is open already.
    pub fn of(file: File, size: u64) -> Arc<PositionedFile> {
        Arc::new(PositionedFile { file, size })
    }

    /// Reads some bytes; fewer than asked for at the end only.
    pub fn read(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let mut done = 0;
        while let Some(rest) = buffer.get_mut(done..).filter(|r| !r.is_empty()) {
            match self.read_some(offset.saturating_add(done as u64), rest) {
                Ok(0) => break,
                Ok(n) => done += n,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(done)
    }

    #[cfg(unix)]
    fn read_some(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(&self.file, buffer, offset)
    }

    #[cfg(windows)]
    fn read_some(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        std::os::windows::fs::FileExt::seek_read(&self.file, buffer, offset)
    }
}

/// A part of a file, read from its start.
#[derive(Debug, Clone)]
pub(crate) struct FileRange {
    at: Arc<PositionedFile>,
    next: u64,
    end: u64,
}

impl FileRange {
    /// Bytes `from` up to `from + length`, or up to the end of the file.
    pub fn new(at: &Arc<PositionedFile>, from: u64, length: u64) -> FileRange {
        FileRange { at: at.clone(), next: from, end: from.saturating_add(length).min(at.size) }
    }

    /// Passes over bytes.
    pub fn skip(&mut self, bytes: u64) {
        self.next = self.next.saturating_add(bytes);
    }
}

impl Read for FileRange {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.next)).unwrap_or(usize::MAX);
        let n = left.min(buffer.len());
        let read = self.at.read(self.next, buffer.get_mut(..n).unwrap_or_default())?;
        self.next += read as u64;
        Ok(read)
    }
}

/// Hashes a file beside its reading, until asked to stop.
///
/// # Errors
/// As [`ByteStream::open`] and [`ByteStream::finish`].
pub(crate) fn digest_unless(
    path: &Path,
    stop: &AtomicBool,
) -> Result<Option<crate::byte_stream::Digested>, IngestError> {
    let mut stream = ByteStream::open(path, Packing::Plain)?;
    let mut buffer = vec![0; CHUNK];
    while stream.fill(&mut buffer)? > 0 {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
    }
    stream.finish().map(Some)
}
