//! Numbers of fixed width as they stand in binary files, and their values.

use sagnac_core::units::Affine;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// Type of a number in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 24 bits.
    U24,
    /// Signed, 24 bits.
    I24,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 64 bits.
    U64,
    /// Signed, 64 bits.
    I64,
    /// IEEE 754, 16 bits.
    F16,
    /// IEEE 754, 32 bits.
    F32,
    /// IEEE 754, 64 bits.
    F64,
}

impl NumberType {
    /// Width, bytes.
    pub fn bytes(self) -> usize {
        match self {
            NumberType::U8 | NumberType::I8 => 1,
            NumberType::U16 | NumberType::I16 | NumberType::F16 => 2,
            NumberType::U24 | NumberType::I24 => 3,
            NumberType::U32 | NumberType::I32 | NumberType::F32 => 4,
            NumberType::U64 | NumberType::I64 | NumberType::F64 => 8,
        }
    }

    /// True for whole numbers.
    pub fn is_whole(self) -> bool {
        !matches!(self, NumberType::F16 | NumberType::F32 | NumberType::F64)
    }
}

/// Ticks of a clock, as NumPy's dates and durations are: whole numbers, of which one is no time at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ticks {
    /// Ticks at the zero of the values.
    pub zero: i64,
    /// Length of a tick, s, as numerator and denominator, one of which is 1, so that nothing is rounded twice.
    pub tick_s: (f64, f64),
}

/// A number at a fixed place of a record, and how its value follows from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// First byte in the record.
    pub offset: usize,
    /// Type.
    pub kind: NumberType,
    /// Order of the bytes.
    pub order: ByteOrder,
    /// Mask of the bits that are kept of a whole number, and the shift to the right that follows.
    pub bits: Option<(u64, u32)>,
    /// Ticks of a clock.
    pub ticks: Option<Ticks>,
    /// From the number stored to the value.
    pub conversion: Affine,
}

impl Field {
    /// A number that is its own value.
    pub fn plain(offset: usize, kind: NumberType, order: ByteOrder) -> Field {
        Field { offset, kind, order, bits: None, ticks: None, conversion: Affine::IDENTITY }
    }

    /// Appends the values of the field in records of `stride` bytes that follow each other.
    pub fn decode(&self, records: &[u8], stride: usize, out: &mut Vec<f64>) {
        let from = out.len();
        if let Some(ticks) = self.ticks {
            self.decode_ticks(ticks, records, stride, out);
        } else if let Some((mask, shift)) = self.bits {
            self.decode_bits(mask, shift, records, stride, out);
        } else {
            self.decode_plain(records, stride, out);
        }
        self.conversion.apply_all(out.get_mut(from..).unwrap_or_default());
    }

    fn decode_plain(&self, records: &[u8], stride: usize, out: &mut Vec<f64>) {
        use ByteOrder::{Big, Little};
        use NumberType as T;
        let at = (records, stride, self.offset);
        match (self.kind, self.order) {
            (T::U8, _) => each(at, out, |[b]: [u8; 1]| f64::from(b)),
            (T::I8, _) => each(at, out, |b: [u8; 1]| f64::from(i8::from_le_bytes(b))),
            (T::U16, Little) => each(at, out, |b| f64::from(u16::from_le_bytes(b))),
            (T::U16, Big) => each(at, out, |b| f64::from(u16::from_be_bytes(b))),
            (T::I16, Little) => each(at, out, |b| f64::from(i16::from_le_bytes(b))),
            (T::I16, Big) => each(at, out, |b| f64::from(i16::from_be_bytes(b))),
            (T::U24, Little) => each(at, out, |[a, b, c]| f64::from(u32::from_le_bytes([a, b, c, 0]))),
            (T::U24, Big) => each(at, out, |[a, b, c]| f64::from(u32::from_be_bytes([0, a, b, c]))),
            // The sign bit is brought to the top; shifting back repeats it.
            (T::I24, Little) => each(at, out, |[a, b, c]| f64::from(i32::from_le_bytes([0, a, b, c]) >> 8)),
            (T::I24, Big) => each(at, out, |[a, b, c]| f64::from(i32::from_be_bytes([a, b, c, 0]) >> 8)),
            (T::U32, Little) => each(at, out, |b| f64::from(u32::from_le_bytes(b))),
            (T::U32, Big) => each(at, out, |b| f64::from(u32::from_be_bytes(b))),
            (T::I32, Little) => each(at, out, |b| f64::from(i32::from_le_bytes(b))),
            (T::I32, Big) => each(at, out, |b| f64::from(i32::from_be_bytes(b))),
            (T::U64, Little) => each(at, out, |b| u64::from_le_bytes(b) as f64),
            (T::U64, Big) => each(at, out, |b| u64::from_be_bytes(b) as f64),
            (T::I64, Little) => each(at, out, |b| i64::from_le_bytes(b) as f64),
            (T::I64, Big) => each(at, out, |b| i64::from_be_bytes(b) as f64),
            (T::F16, Little) => each(at, out, |b| half(u16::from_le_bytes(b))),
            (T::F16, Big) => each(at, out, |b| half(u16::from_be_bytes(b))),
            (T::F32, Little) => each(at, out, |b| f64::from(f32::from_le_bytes(b))),
            (T::F32, Big) => each(at, out, |b| f64::from(f32::from_be_bytes(b))),
            (T::F64, Little) => each(at, out, f64::from_le_bytes),
            (T::F64, Big) => each(at, out, f64::from_be_bytes),
        }
    }

    fn decode_ticks(&self, ticks: Ticks, records: &[u8], stride: usize, out: &mut Vec<f64>) {
        let (factor, divisor) = ticks.tick_s;
        let value = |t: i64| match t {
            i64::MIN => f64::NAN,
            t => (i128::from(t) - i128::from(ticks.zero)) as f64 * factor / divisor,
        };
        let at = (records, stride, self.offset);
        match self.order {
            ByteOrder::Little => each(at, out, |b| value(i64::from_le_bytes(b))),
            ByteOrder::Big => each(at, out, |b| value(i64::from_be_bytes(b))),
        }
    }

    fn decode_bits(&self, mask: u64, shift: u32, records: &[u8], stride: usize, out: &mut Vec<f64>) {
        let width = self.kind.bytes();
        out.extend(records.chunks_exact(stride.max(1)).map(|record| {
            self.whole(record, width).map_or(f64::NAN, |raw| ((raw & mask) >> shift.min(63)) as f64)
        }));
    }

    /// The bits of the number in one record.
    pub fn whole(&self, record: &[u8], width: usize) -> Option<u64> {
        let bytes = record.get(self.offset..self.offset.checked_add(width)?)?;
        let push = |all: u64, byte: &u8| (all << 8) | u64::from(*byte);
        Some(match self.order {
            ByteOrder::Little => bytes.iter().rev().fold(0, push),
            ByteOrder::Big => bytes.iter().fold(0, push),
        })
    }
}

/// The numbers of `N` bytes at one place of every record.
#[inline(always)]
fn each<const N: usize>(
    (records, stride, offset): (&[u8], usize, usize),
    out: &mut Vec<f64>,
    number: impl Fn([u8; N]) -> f64,
) {
    let at = |record: &[u8]| record.get(offset..).and_then(<[u8]>::first_chunk::<N>).map(|b| number(*b));
    if stride == N && offset == 0 {
        out.extend(records.as_chunks::<N>().0.iter().map(|b| number(*b)));
    } else {
        out.extend(records.chunks_exact(stride.max(1)).map(|record| at(record).unwrap_or(f64::NAN)));
    }
}

/// The value of a half-precision number (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let fraction = f64::from(bits & 0x3ff);
    match exponent {
        0 => sign * fraction * 2f64.powi(-24),
        31 if fraction == 0.0 => sign * f64::INFINITY,
        31 => f64::NAN,
        e => sign * (1.0 + fraction / 1024.0) * 2f64.powi(e - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(kind: NumberType, order: ByteOrder, bytes: &[u8]) -> f64 {
        let mut out = Vec::new();
        Field::plain(0, kind, order).decode(bytes, bytes.len(), &mut out);
        assert_eq!(out.len(), 1);
        out[0]
    }

    #[test]
    fn every_type_is_read_in_both_orders() {
        use NumberType as T;
        // -2 and 300 and their like, written out by hand.
        for (kind, big, value) in [
            (T::U8, &[0xfe][..], 254.0),
            (T::I8, &[0xfe], -2.0),
            (T::U16, &[0x01, 0x2c], 300.0),
            (T::I16, &[0xff, 0xfe], -2.0),
            (T::U24, &[0x01, 0x00, 0x02], 65538.0),
            (T::I24, &[0xff, 0xff, 0xfe], -2.0),
            (T::I24, &[0x7f, 0xff, 0xff], 8388607.0),
            (T::U32, &[0x80, 0, 0, 1], 2147483649.0),
            (T::I32, &[0xff, 0xff, 0xff, 0xfe], -2.0),
            (T::U64, &[0, 0, 0, 1, 0, 0, 0, 0], 4294967296.0),
            (T::I64, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe], -2.0),
            (T::F16, &[0x3e, 0x00], 1.5),
            (T::F16, &[0xc0, 0x00], -2.0),
            (T::F16, &[0x00, 0x01], 5.960464477539063e-8),
            (T::F32, &[0x3f, 0xc0, 0, 0], 1.5),
            (T::F64, &[0x3f, 0xf8, 0, 0, 0, 0, 0, 0], 1.5),
        ] {
            assert_eq!(kind.bytes(), big.len());
            assert_eq!(one(kind, ByteOrder::Big, big), value, "{kind:?}");
            let little: Vec<u8> = big.iter().rev().copied().collect();
            assert_eq!(one(kind, ByteOrder::Little, &little), value, "{kind:?}");
        }
        assert!(one(T::F16, ByteOrder::Big, &[0x7e, 0]).is_nan());
        assert_eq!(one(T::F16, ByteOrder::Big, &[0xfc, 0]), f64::NEG_INFINITY);
    }

    #[test]
    fn bits_are_cut_out_and_shifted_down() {
        let mut field = Field::plain(1, NumberType::U16, ByteOrder::Big);
        field.bits = Some((0x0ff0, 4));
        field.conversion = Affine { factor: 0.5, offset: 1.0 };
        let mut out = Vec::new();
        // 0xabcd & 0x0ff0 >> 4 is 0xbc = 188.
        field.decode(&[0, 0xab, 0xcd], 3, &mut out);
        assert_eq!(out, [95.0]);
    }

    #[test]
    fn ticks_count_from_their_zero_without_rounding() {
        let zero = 1_700_000_000_000_000_000;
        let mut field = Field::plain(0, NumberType::I64, ByteOrder::Little);
        field.ticks = Some(Ticks { zero, tick_s: (1.0, 1e9) });
        let mut bytes = Vec::new();
        for t in [zero, zero + 1, i64::MIN, i64::MAX, i64::MIN + 1] {
            bytes.extend_from_slice(&i64::to_le_bytes(t));
        }
        let mut out = Vec::new();
        field.decode(&bytes, 8, &mut out);
        assert_eq!(out[..2], [0.0, 1e-9]);
        assert!(out[2].is_nan() && out[3] > 7e9 && out[4] < -1e10);
    }
}
