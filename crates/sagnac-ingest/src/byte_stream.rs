//! The bytes of a file: decompressed where needed, hashed and counted while they are read.

use super::error::{IngestError, IngestErrorKind};
use crate::{FileFault, io_reason, open_file};
use sagnac_core::message::note;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

/// How a file is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    /// Not compressed.
    Plain,
    /// gzip, RFC 1952.
    Gzip,
    /// Zstandard, RFC 8878.
    Zstd,
}

impl Packing {
    /// Recognises the compression by the first bytes of a file.
    pub fn of(head: &[u8]) -> Packing {
        match head {
            [0x1f, 0x8b, ..] => Packing::Gzip,
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Packing::Zstd,
            _ => Packing::Plain,
        }
    }

    /// Identifier in results: `plain`, `gzip` or `zstd`.
    pub fn id(self) -> &'static str {
        match self {
            Packing::Plain => "plain",
            Packing::Gzip => "gzip",
            Packing::Zstd => "zstd",
        }
    }
}

/// Unpacked size from which the ratio is watched, bytes.
const BOMB_FROM: u64 = 16 << 20;

/// Unpacked bytes per packed byte beyond which a file is refused. Real recordings stay under 50; gzip itself cannot
/// exceed 1032.
const BOMB_RATIO: u64 = 500;

/// A file that hashes and counts what is read from it.
struct Hashed {
    file: File,
    hash: Sha256,
    bytes: u64,
}

impl Read for Hashed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.hash.update(&buffer[..n.min(buffer.len())]);
        self.bytes += n as u64;
        Ok(n)
    }
}

enum Inner {
    Plain(Hashed),
    /// Boxed: with some builds of its library it is far larger than the others.
    Gzip(Box<flate2::bufread::MultiGzDecoder<BufReader<Hashed>>>),
    Zstd(zstd::stream::read::Decoder<'static, BufReader<Hashed>>),
}

impl Inner {
    fn hashed(&mut self) -> &mut Hashed {
        match self {
            Inner::Plain(h) => h,
            Inner::Gzip(d) => d.get_mut().get_mut(),
            Inner::Zstd(d) => d.get_mut().get_mut(),
        }
    }
}

/// Reads the decompressed bytes of a file in order.
pub struct ByteStream {
    path: std::path::PathBuf,
    inner: Inner,
    /// Size of the file when it was opened, bytes.
    size: u64,
    unpacked: u64,
}

/// Hash and size of a file, known once all bytes were read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digested {
    /// SHA-256 of the bytes of the file, hexadecimal.
    pub sha256: String,
    /// Size of the file, bytes.
    pub bytes: u64,
}

impl ByteStream {
    /// Opens a file with the given compression.
    ///
    /// # Errors
    /// [`IngestErrorKind::Io`] when it cannot be opened, [`IngestErrorKind::Damaged`] when the packing is broken.
    pub fn open(path: &Path, packing: Packing) -> Result<ByteStream, IngestError> {
        let file = open_file(path).map_err(|e| io_error(path, &e))?;
        let size = file.metadata().map_err(|e| io_error(path, &e))?.len();
        let hashed = Hashed { file, hash: Sha256::new(), bytes: 0 };
        let buffered = |h| BufReader::with_capacity(1 << 18, h);
        let inner = match packing {
            Packing::Plain => Inner::Plain(hashed),
            Packing::Gzip => Inner::Gzip(Box::new(flate2::bufread::MultiGzDecoder::new(buffered(hashed)))),
            Packing::Zstd => Inner::Zstd(
                zstd::stream::read::Decoder::with_buffer(buffered(hashed))
                    .map_err(|e| unpack_error(path, &e, 0))?,
            ),
        };
        Ok(ByteStream { path: path.to_owned(), inner, size, unpacked: 0 })
    }

    /// Fills the buffer; returns the number of bytes, which is less than its length only at the end of the file.
    ///
    /// # Errors
    /// As [`ByteStream::open`], and [`IngestErrorKind::Bomb`].
    pub fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, IngestError> {
        let mut done = 0;
        while let Some(rest) = buffer.get_mut(done..).filter(|r| !r.is_empty()) {
            let read = match &mut self.inner {
                Inner::Plain(r) => r.read(rest),
                Inner::Gzip(r) => r.read(rest),
                Inner::Zstd(r) => r.read(rest),
            };
            match read {
                Ok(0) => break,
                Ok(n) => done += n,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => {
                    return Err(match self.inner {
                        Inner::Plain(_) => io_error(&self.path, &e),
                        _ => unpack_error(&self.path, &e, self.unpacked + done as u64),
                    });
                }
            }
        }
        self.unpacked += done as u64;
        let packed = self.file_bytes().max(1);
        if self.unpacked > BOMB_FROM && self.unpacked / packed > BOMB_RATIO {
            return Err(IngestError::new(
                IngestErrorKind::Bomb,
                &self.path,
                note!("ingest.bomb", packed, unpacked = self.unpacked),
            )
            .hint("ingest.hint.bomb"));
        }
        Ok(done)
    }

    /// Bytes of the file read so far.
    pub fn file_bytes(&mut self) -> u64 {
        self.inner.hashed().bytes
    }

    /// Reads what is left of the file and returns its hash.
    ///
    /// # Errors
    /// [`IngestErrorKind::Changed`] when the file's size changed since it was opened.
    pub fn finish(mut self) -> Result<Digested, IngestError> {
        let hashed = self.inner.hashed();
        io::copy(hashed, &mut io::sink()).map_err(|e| io_error(&self.path, &e))?;
        let bytes = hashed.bytes;
        let now = hashed.file.metadata().map_err(|e| io_error(&self.path, &e))?.len();
        unchanged(&self.path, self.size, bytes, now)?;
        Ok(Digested { sha256: hex(&std::mem::take(&mut hashed.hash).finalize()), bytes })
    }
}

/// Computes the SHA-256 of a file as it stands, compressed or not.
///
/// # Errors
/// As [`ByteStream::open`] and [`ByteStream::finish`].
pub fn digest(path: &Path) -> Result<Digested, IngestError> {
    let mut stream = ByteStream::open(path, Packing::Plain)?;
    let mut buffer = vec![0; 1 << 18];
    while stream.fill(&mut buffer)? > 0 {}
    stream.finish()
}

/// SHA-256 of files, one after the other.
///
/// # Errors
/// As [`digest`].
pub(crate) fn digest_of_all(paths: &[&PathBuf]) -> Result<String, IngestError> {
    if let [one] = paths {
        return Ok(digest(one)?.sha256);
    }
    let mut hash = Sha256::new();
    for path in paths {
        hash.update(std::fs::read(path).map_err(|e| io_error(path, &e))?);
    }
    Ok(hex(&hash.finalize()))
}

/// Compares the sizes of a file when it was opened, as read, and now.
pub(super) fn unchanged(path: &Path, at_open: u64, read: u64, now: u64) -> Result<(), IngestError> {
    if at_open == read && read == now {
        return Ok(());
    }
    Err(IngestError::new(IngestErrorKind::Changed, path, note!("ingest.changed", at_open, read, now))
        .hint("ingest.hint.wait"))
}

fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write;
    bytes.iter().fold(String::with_capacity(64), |mut s, b| {
        let _ = write!(s, "{b:02x}");
        s
    })
}

/// The diagnostic of an operating-system error.
pub(crate) fn io_error(path: &Path, error: &io::Error) -> IngestError {
    let hint = match error.kind() {
        _ if FileFault::of(error).is_some() => "ingest.hint.save_as_file",
        io::ErrorKind::NotFound => "ingest.hint.check_path",
        io::ErrorKind::PermissionDenied => "ingest.hint.permissions",
        _ => "ingest.hint.disk",
    };
    IngestError::new(IngestErrorKind::Io, path, note!("ingest.io", reason = io_reason(error))).hint(hint)
}

fn unpack_error(path: &Path, error: &io::Error, at: u64) -> IngestError {
    let (message, hint) = if error.kind() == io::ErrorKind::UnexpectedEof {
        (note!("ingest.packed_short", bytes = at), "ingest.hint.cut_off")
    } else {
        (note!("ingest.packed_damaged", bytes = at, reason = error.to_string()), "ingest.hint.copy_again")
    };
    IngestError::new(IngestErrorKind::Damaged, path, message).hint(hint)
}
