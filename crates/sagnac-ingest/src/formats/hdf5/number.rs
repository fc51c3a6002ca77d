//! Numbers of any HDF5 type as f64.

use hdf5_reader::error::Error;
use hdf5_reader::{ByteOrder, Datatype, H5Type, dtype_element_size};

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Storage {
    bytes: usize,
    kind: Kind,
    big_endian: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Signed,
    Unsigned,
    Float,
}

impl Storage {
    /// The storage of a type that holds one number.
    pub fn of(datatype: &Datatype) -> Option<Storage> {
        let (size, kind, order) = match datatype {
            Datatype::FixedPoint { size, signed: true, byte_order } => (*size, Kind::Signed, *byte_order),
            Datatype::FixedPoint { size, signed: false, byte_order } => (*size, Kind::Unsigned, *byte_order),
            Datatype::FloatingPoint { size, byte_order } => (*size, Kind::Float, *byte_order),
            Datatype::Enum { base, .. } => return Storage::of(base),
            _ => return None,
        };
        let known = match kind {
            Kind::Float => matches!(size, 4 | 8),
            _ => matches!(size, 1 | 2 | 4 | 8),
        };
        known.then_some(Storage { bytes: size.into(), kind, big_endian: order == ByteOrder::BigEndian })
    }

    /// Size of a number, bytes.
    pub fn bytes(self) -> usize {
        self.bytes
    }

    /// True for whole numbers that f64 may not hold exactly.
    pub fn is_wide_integer(self) -> bool {
        self.bytes == 8 && self.kind != Kind::Float
    }

    /// Type in words, for example `f64` or `i16, big endian`.
    pub fn words(self) -> String {
        let letter = match self.kind {
            Kind::Signed => 'i',
            Kind::Unsigned => 'u',
            Kind::Float => 'f',
        };
        let order = if self.big_endian { ", big endian" } else { "" };
        format!("{letter}{}{order}", self.bytes * 8)
    }

    fn word(self, bytes: &[u8]) -> u64 {
        let push = |word: u64, b: &u8| word << 8 | u64::from(*b);
        let bytes = bytes.get(..self.bytes).unwrap_or_default();
        if self.big_endian { bytes.iter().fold(0, push) } else { bytes.iter().rev().fold(0, push) }
    }

    /// The whole number in the bytes; 0 for a fraction.
    pub fn integer(self, bytes: &[u8]) -> i128 {
        let word = self.word(bytes);
        match self.kind {
            Kind::Unsigned => i128::from(word),
            Kind::Signed => {
                let shift = 64 - 8 * self.bytes as u32;
                i128::from(((word << shift) as i64) >> shift)
            }
            Kind::Float => 0,
        }
    }

    /// The number in the bytes.
    #[inline]
    pub fn number(self, bytes: &[u8]) -> f64 {
        if bytes.len() < self.bytes {
            return f64::NAN;
        }
        match (self.kind, self.bytes) {
            (Kind::Float, 8) => f64::from_bits(self.word(bytes)),
            (Kind::Float, _) => f64::from(f32::from_bits(self.word(bytes) as u32)),
            (Kind::Unsigned, _) => self.word(bytes) as f64,
            (Kind::Signed, _) => self.integer(bytes) as f64,
        }
    }
}

/// A number of any type.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number(pub f64);

impl H5Type for Number {
    fn hdf5_type() -> Datatype {
        Datatype::FloatingPoint { size: 8, byte_order: ByteOrder::LittleEndian }
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> Result<Number, Error> {
        let storage = Storage::of(datatype).ok_or_else(|| Error::Other("no number".to_owned()))?;
        Ok(Number(storage.number(bytes)))
    }

    fn element_size(datatype: &Datatype) -> usize {
        dtype_element_size(datatype).unwrap_or(8)
    }

    fn decode_vec(raw: &[u8], datatype: &Datatype, count: usize) -> Option<Result<Vec<Number>, Error>> {
        let storage = Storage::of(datatype)?;
        let raw = raw.get(..count.checked_mul(storage.bytes)?)?;
        let numbers: Vec<Number> = if storage.kind == Kind::Float && storage.bytes == 8 && !storage.big_endian
        {
            raw.as_chunks::<8>().0.iter().map(|b| Number(f64::from_le_bytes(*b))).collect()
        } else {
            raw.chunks_exact(storage.bytes).map(|b| Number(storage.number(b))).collect()
        };
        Some(Ok(numbers))
    }
}

/// A whole number of any type, for stamps that f64 cannot hold.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whole(pub i128);

impl H5Type for Whole {
    fn hdf5_type() -> Datatype {
        Datatype::FixedPoint { size: 8, signed: true, byte_order: ByteOrder::LittleEndian }
    }

    fn from_bytes(bytes: &[u8], datatype: &Datatype) -> Result<Whole, Error> {
        let storage = Storage::of(datatype).ok_or_else(|| Error::Other("no number".to_owned()))?;
        Ok(Whole(storage.integer(bytes)))
    }

    fn element_size(datatype: &Datatype) -> usize {
        dtype_element_size(datatype).unwrap_or(8)
    }

    fn decode_vec(raw: &[u8], datatype: &Datatype, count: usize) -> Option<Result<Vec<Whole>, Error>> {
        let storage = Storage::of(datatype)?;
        let raw = raw.get(..count.checked_mul(storage.bytes)?)?;
        Some(Ok(raw.chunks_exact(storage.bytes).map(|b| Whole(storage.integer(b))).collect()))
    }
}

/// The bytes of a record.
#[derive(Debug, Clone)]
pub(super) struct Bytes(pub Box<[u8]>);

impl H5Type for Bytes {
    fn hdf5_type() -> Datatype {
        Datatype::Opaque { size: 1, tag: String::new() }
    }

    fn from_bytes(bytes: &[u8], _: &Datatype) -> Result<Bytes, Error> {
        Ok(Bytes(bytes.into()))
    }

    fn element_size(datatype: &Datatype) -> usize {
        dtype_element_size(datatype).unwrap_or(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn storage(size: u8, signed: Option<bool>, big: bool) -> Storage {
        let byte_order = if big { ByteOrder::BigEndian } else { ByteOrder::LittleEndian };
        let datatype = match signed {
            Some(signed) => Datatype::FixedPoint { size, signed, byte_order },
            None => Datatype::FloatingPoint { size, byte_order },
        };
        Storage::of(&datatype).unwrap()
    }

    #[test]
    fn every_width_and_order_is_read() {
        assert_eq!(storage(1, Some(true), false).number(&[0xff]), -1.0);
        assert_eq!(storage(1, Some(false), false).number(&[0xff]), 255.0);
        assert_eq!(storage(2, Some(true), true).number(&[0xff, 0xfe]), -2.0);
        assert_eq!(storage(2, Some(true), false).number(&[0xfe, 0xff]), -2.0);
        assert_eq!(storage(4, Some(false), true).number(&[0, 1, 0, 2]), 65538.0);
        assert_eq!(storage(8, Some(true), false).integer(&[0xff; 8]), -1);
        assert_eq!(storage(8, Some(false), true).integer(&[0xff; 8]), (1 << 64) - 1);
        assert_eq!(storage(4, None, true).number(&[0x3f, 0x80, 0, 0]), 1.0);
        assert_eq!(storage(8, None, false).number(&[0, 0, 0, 0, 0, 0, 0xf0, 0x3f]), 1.0);
        assert!(storage(8, None, false).number(&[0; 7]).is_nan());
        assert!(
            Storage::of(&Datatype::FloatingPoint { size: 2, byte_order: ByteOrder::LittleEndian }).is_none()
        );
    }
}
