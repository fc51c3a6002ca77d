//! Numbers and texts out of the metadata of a TDMS file.

use sagnac_core::message::Note;

/// Why metadata cannot be read.
#[derive(Debug)]
pub(super) enum MetadataFault {
    /// They end early, or hold what is none of the format.
    Short,
    /// Values that only the driver of the device can scale.
    Daqmx(String),
    /// Anything else.
    Note(Box<Note>),
}

impl MetadataFault {
    /// A fault of the object at a path.
    pub fn note(key: &'static str, path: &str) -> MetadataFault {
        MetadataFault::Note(Box::new(Note::new(key).with("name", crate::error::shorten(path))))
    }
}

/// Takes values from bytes, one after the other.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8], big_endian: bool) -> Reader<'a> {
        Reader { bytes, at: 0, big_endian }
    }

    /// Bytes taken so far.
    pub fn position(&self) -> usize {
        self.at
    }

    /// The next bytes as they stand.
    pub fn take(&mut self, len: usize) -> Result<&'a [u8], MetadataFault> {
        let end = self.at.checked_add(len).ok_or(MetadataFault::Short)?;
        let taken = self.bytes.get(self.at..end).ok_or(MetadataFault::Short)?;
        self.at = end;
        Ok(taken)
    }

    /// The next bytes as a word, whatever their number up to 8.
    pub fn word(&mut self, len: usize) -> Result<u64, MetadataFault> {
        let big_endian = self.big_endian;
        Ok(word(self.take(len)?, big_endian))
    }

    pub fn u32(&mut self) -> Result<u32, MetadataFault> {
        self.word(4).map(|w| w as u32)
    }

    pub fn u64(&mut self) -> Result<u64, MetadataFault> {
        self.word(8)
    }

    /// A text with its length before it.
    pub fn text(&mut self) -> Result<String, MetadataFault> {
        let len = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(len)?).into_owned())
    }

    /// A stamp: seconds from 1904 and 2^-64 of a second.
    pub fn stamp(&mut self) -> Result<(i64, u64), MetadataFault> {
        let big_endian = self.big_endian;
        Ok(stamp(self.take(16)?, big_endian))
    }
}

/// At most 8 bytes as a word.
#[inline]
pub(super) fn word(bytes: &[u8], big_endian: bool) -> u64 {
    let push = |word: u64, b: &u8| word << 8 | u64::from(*b);
    if big_endian { bytes.iter().fold(0, push) } else { bytes.iter().rev().fold(0, push) }
}

/// 16 bytes as seconds from 1904 and 2^-64 of a second.
pub(super) fn stamp(bytes: &[u8], big_endian: bool) -> (i64, u64) {
    let (first, second) = bytes.split_at_checked(8).unwrap_or_default();
    let (first, second) = (word(first, big_endian), word(second, big_endian));
    if big_endian { (first as i64, second) } else { (second as i64, first) }
}
