//! The elements of a MAT file, version 5: a tag with type and length before every piece of data, in order.

use crate::binary::column_stream::Unpacked;
use crate::layout::{ByteOrder, NumberType};
use std::io::{self, ErrorKind};

/// Type of an element that holds an array.
pub(super) const MATRIX: u32 = 14;

/// Type of an element that holds another one, packed.
pub(super) const COMPRESSED: u32 = 15;

/// Longest piece of data, such as a name, that is taken into memory, bytes.
const MAX_DATA_BYTES: u64 = 1 << 20;

/// The tag of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag {
    /// Type.
    pub kind: u32,
    /// Length of the data, bytes.
    pub bytes: u64,
    /// First byte of the data in the stream.
    pub at: u64,
    /// True when up to four bytes of data stand in the tag itself.
    small: bool,
}

/// A stream of elements.
pub(super) struct ElementReader {
    bytes: Unpacked,
    /// Bytes read so far.
    pub at: u64,
    pub order: ByteOrder,
}

impl ElementReader {
    pub fn new(bytes: Unpacked, order: ByteOrder) -> ElementReader {
        ElementReader { bytes, at: 0, order }
    }

    fn exact<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut buffer = [0; N];
        if self.bytes.fill(&mut buffer)? < N {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        self.at += N as u64;
        Ok(buffer)
    }

    /// Reads the next tag. Of a small element, the four bytes of data are left to be read.
    pub fn tag(&mut self) -> io::Result<Tag> {
        let first = self.whole()?;
        let (small, kind) = (first >> 16, first & 0xffff);
        if small > 0 {
            return match small {
                1..=4 => Ok(Tag { kind, bytes: u64::from(small), at: self.at, small: true }),
                _ => Err(damaged("a small element is longer than four bytes")),
            };
        }
        let bytes = u64::from(self.whole()?);
        Ok(Tag { kind, bytes, at: self.at, small: false })
    }

    fn whole(&mut self) -> io::Result<u32> {
        let bytes = self.exact()?;
        Ok(match self.order {
            ByteOrder::Little => u32::from_le_bytes(bytes),
            ByteOrder::Big => u32::from_be_bytes(bytes),
        })
    }

    /// Reads the data of an element, and goes on to the next.
    pub fn data(&mut self, tag: &Tag) -> io::Result<Vec<u8>> {
        if tag.bytes > MAX_DATA_BYTES {
            return Err(damaged("a name or size is too long"));
        }
        // Taken in pieces, so that memory grows with what is there and not with what is declared.
        let mut data = Vec::new();
        let mut left = tag.bytes as usize;
        while left > 0 {
            let mut piece = [0; 512];
            let n = left.min(piece.len());
            let read = self.bytes.fill(piece.get_mut(..n).unwrap_or_default())?;
            if read == 0 {
                return Err(ErrorKind::UnexpectedEof.into());
            }
            data.extend_from_slice(piece.get(..read).unwrap_or_default());
            self.at += read as u64;
            left -= read;
        }
        self.go_to(end(tag))?;
        Ok(data)
    }

    /// Goes on to the element after this one.
    pub fn pass(&mut self, tag: &Tag) -> io::Result<()> {
        self.go_to(end(tag))
    }

    /// Goes on to a byte of the stream.
    pub fn go_to(&mut self, at: u64) -> io::Result<()> {
        let ahead =
            at.checked_sub(self.at).ok_or_else(|| damaged("an element is longer than what holds it"))?;
        if !self.bytes.skip(ahead)? {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        self.at = at;
        Ok(())
    }
}

/// The end of an element with its padding to eight bytes.
fn end(tag: &Tag) -> u64 {
    if tag.small { tag.at + 4 } else { tag.at.saturating_add(tag.bytes.div_ceil(8) * 8) }
}

pub(super) fn damaged(reason: &'static str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, reason)
}

/// The whole numbers of four bytes in some data.
pub(super) fn wholes(data: &[u8], order: ByteOrder) -> Vec<u32> {
    let whole = |b: &[u8; 4]| match order {
        ByteOrder::Little => u32::from_le_bytes(*b),
        ByteOrder::Big => u32::from_be_bytes(*b),
    };
    data.as_chunks::<4>().0.iter().map(whole).collect()
}

/// The type of numbers of an element.
pub(super) fn number_type(kind: u32) -> Option<NumberType> {
    Some(match kind {
        1 => NumberType::I8,
        2 => NumberType::U8,
        3 => NumberType::I16,
        4 => NumberType::U16,
        5 => NumberType::I32,
        6 => NumberType::U32,
        7 => NumberType::F32,
        9 => NumberType::F64,
        12 => NumberType::I64,
        13 => NumberType::U64,
        _ => return None,
    })
}

/// The text of an element of characters.
pub(super) fn text(kind: u32, data: &[u8], order: ByteOrder) -> String {
    match kind {
        // 16-bit numbers and UTF-16.
        4 | 17 => {
            let unit = |b: &[u8; 2]| match order {
                ByteOrder::Little => u16::from_le_bytes(*b),
                ByteOrder::Big => u16::from_be_bytes(*b),
            };
            let units: Vec<u16> = data.as_chunks::<2>().0.iter().map(unit).collect();
            String::from_utf16_lossy(&units)
        }
        _ => String::from_utf8_lossy(data).into_owned(),
    }
}
