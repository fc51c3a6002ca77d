//! Checksums of records.

use super::number_type::ByteOrder;

/// A kind of checksum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sum {
    /// Sum of the bytes, modulo 256.
    Sum8,
    /// Exclusive or of the bytes.
    Xor8,
    /// CRC-16 with the polynomial 1021 and a start value.
    Crc16(u16),
    /// CRC-32 as in Ethernet and zip.
    Crc32,
}

/// The checksum of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Checksum {
    /// Kind.
    pub sum: Sum,
    /// Its name in the layout.
    pub word: &'static str,
    /// First byte of the checksum.
    pub at: usize,
    /// First byte that the checksum covers.
    pub from: usize,
    /// End of the bytes that it covers, exclusive.
    pub to: usize,
    /// Order of its bytes.
    pub order: ByteOrder,
}

impl Sum {
    /// The kind of checksum by its name in a layout.
    pub fn of(word: &str) -> Option<Sum> {
        Some(match word {
            "sum8" => Sum::Sum8,
            "xor8" => Sum::Xor8,
            "crc16-ccitt" => Sum::Crc16(0xffff),
            "crc16-xmodem" => Sum::Crc16(0),
            "crc32" => Sum::Crc32,
            _ => return None,
        })
    }

    /// Length, bytes.
    pub fn bytes(self) -> usize {
        match self {
            Sum::Sum8 | Sum::Xor8 => 1,
            Sum::Crc16(_) => 2,
            Sum::Crc32 => 4,
        }
    }

    fn over(self, bytes: &[u8]) -> u32 {
        match self {
            Sum::Sum8 => u32::from(bytes.iter().fold(0u8, |all, b| all.wrapping_add(*b))),
            Sum::Xor8 => u32::from(bytes.iter().fold(0u8, |all, b| all ^ b)),
            Sum::Crc16(start) => u32::from(bytes.iter().fold(start, |all, b| {
                let top = usize::from(all >> 8) ^ usize::from(*b);
                (all << 8) ^ CRC16.get(top).copied().unwrap_or(0)
            })),
            Sum::Crc32 => {
                let mut crc = flate2::Crc::new();
                crc.update(bytes);
                crc.sum()
            }
        }
    }
}

impl Checksum {
    /// The computed and the stored checksum of a record if they differ.
    pub fn differs(&self, record: &[u8]) -> Option<(u32, u32)> {
        let stands = record.get(self.at..self.at + self.sum.bytes()).unwrap_or_default();
        let push = |all: u32, b: &u8| (all << 8) | u32::from(*b);
        let stands = match self.order {
            ByteOrder::Little => stands.iter().rev().fold(0, push),
            ByteOrder::Big => stands.iter().fold(0, push),
        };
        let made = self.sum.over(record.get(self.from..self.to).unwrap_or_default());
        (made != stands).then_some((made, stands))
    }
}

/// CRC-16 of every byte, polynomial 1021.
static CRC16: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = (byte as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_values_of_the_catalogue_are_met() {
        // The check values over "123456789" of the catalogue of parametrised CRC algorithms; sums by hand.
        let of = |word: &str| Sum::of(word).unwrap().over(b"123456789");
        assert_eq!(of("crc16-ccitt"), 0x29b1);
        assert_eq!(of("crc16-xmodem"), 0x31c3);
        assert_eq!(of("crc32"), 0xcbf4_3926);
        assert_eq!(of("sum8"), 477 % 256);
        assert_eq!(of("xor8"), 0x31);
    }
}
