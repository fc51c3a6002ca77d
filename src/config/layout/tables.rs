//! The tables of a layout file.

use crate::config::section::Section;
use crate::config::spec::{Range, TableSpec, Word};
use crate::config::table::Table;
use crate::units::Unit;

/// Whole numbers that a double holds exactly.
const EXACT_WHOLE_NUMBERS: Range = Range::between(0.0, 9_007_199_254_740_992.0);

/// Types of a field.
pub const NUMBER_TYPES: &[Word] = &[
    ("u8", "whole number, 1 byte"),
    ("i8", "whole number with sign, 1 byte"),
    ("u16", "2 bytes"),
    ("i16", "with sign, 2 bytes"),
    ("u24", "3 bytes"),
    ("i24", "with sign, 3 bytes"),
    ("u32", "4 bytes"),
    ("i32", "with sign, 4 bytes"),
    ("u64", "8 bytes"),
    ("i64", "with sign, 8 bytes"),
    ("f32", "IEEE 754 single precision"),
    ("f64", "IEEE 754 double precision"),
];

/// Orders of the bytes of a number.
pub const BYTE_ORDERS: &[Word] =
    &[("little", "least significant byte first"), ("big", "most significant byte first")];

/// Checksums.
pub const CHECKSUM_KINDS: &[Word] = &[
    ("sum8", "sum of the bytes modulo 256"),
    ("xor8", "exclusive or of the bytes"),
    ("crc16-ccitt", "CRC-16, polynomial 1021, start FFFF (also called CCITT-FALSE)"),
    ("crc16-xmodem", "CRC-16, polynomial 1021, start 0000"),
    ("crc32", "CRC-32 of zip and Ethernet"),
];

/// A layout file as a whole.
pub static LAYOUT_FILE: TableSpec = *LayoutTables::SPEC;

/// Layout of the records of a raw binary recording. Every record has the same length and the same fields. Bytes are
/// counted from 0.
#[derive(Table)]
#[table("", format = "layout/1")]
pub(super) struct LayoutTables {
    /// Bytes before the first record; skipped.
    #[key(range = EXACT_WHOLE_NUMBERS, default = 0, example = 512)]
    pub header_bytes: Option<f64>,
    /// Length of a record. Default: up to the end of the last field or checksum.
    #[key(min = 1, max = 262_144, example = 32)]
    pub record_bytes: Option<f64>,
    /// Byte order of every number.
    #[key(choice = BYTE_ORDERS, default = "little", example = "big")]
    pub byte_order: &'static str,
    /// Bytes at the start of every record, hexadecimal. Where they are missing, the next record is searched for;
    /// skipped records become rows without values, which are counted and located.
    #[key(example = "AA 55")]
    pub sync: Option<String>,
    /// Sample rate, used if there are no timestamps.
    #[key(quantity = "Hz", above = 0, example = "2000 Hz")]
    pub sample_rate_hz: Option<f64>,
    /// Checksum of every record.
    pub checksum: Option<ChecksumKeys>,
    /// The fields of a record, one table each.
    #[key(name = "field", required)]
    pub fields: Vec<FieldKeys>,
}

/// Checksum of a record. A record whose checksum is wrong becomes a row without values, which is counted and
/// located.
#[derive(Table)]
#[table("checksum")]
pub(super) struct ChecksumKeys {
    /// Which checksum.
    #[key(name = "type", choice = CHECKSUM_KINDS, required, example = "crc16-ccitt")]
    pub sum: Option<&'static str>,
    /// First byte of the checksum in the record. Default: the last bytes of the record.
    #[key(range = EXACT_WHOLE_NUMBERS, example = 30)]
    pub offset: Option<f64>,
    /// First byte covered by the checksum.
    #[key(range = EXACT_WHOLE_NUMBERS, default = 0, example = 2)]
    pub from: Option<f64>,
    /// Byte after the last one covered. Default: the first byte of the checksum.
    #[key(range = EXACT_WHOLE_NUMBERS, example = 30)]
    pub to: Option<f64>,
    #[key(section)]
    pub section: Section,
}

/// A field of the record. Its value is `scale` times the number plus `offset_value`, in `unit`.
#[derive(Table)]
#[table("field")]
pub(super) struct FieldKeys {
    /// Name of the column.
    #[key(required, example = "rate_deg_h")]
    pub name: Option<String>,
    /// Type of the number.
    #[key(name = "type", choice = NUMBER_TYPES, required, example = "i32")]
    pub number_type: Option<&'static str>,
    /// First byte in the record. Default: directly after the previous field, or after `sync`.
    #[key(range = EXACT_WHOLE_NUMBERS, example = 4)]
    pub offset: Option<f64>,
    /// Numbers of this type one after another; the columns are `name[0]`, `name[1]` and so on.
    #[key(min = 1, max = 4096, default = 1, example = 3)]
    pub count: Option<f64>,
    /// Size of one count.
    #[key(default = 1, example = 0.001)]
    pub scale: Option<f64>,
    /// Offset added after scaling, in `unit`.
    #[key(default = 0, example = 25)]
    pub offset_value: f64,
    /// Unit of the value.
    #[key(example = "deg/h")]
    pub unit: Option<Unit>,
    /// Bits of an integer to keep, for flags packed into one number.
    #[key(range = EXACT_WHOLE_NUMBERS, example = 0x0F)]
    pub mask: Option<f64>,
    /// Right shift of the kept bits.
    #[key(min = 0, max = 63, example = 4)]
    pub shift: Option<f64>,
    /// Time after which a timestamp restarts from zero.
    #[key(quantity = "s", above = 0, example = "4294.967296 s")]
    pub rolls_over_s: Option<f64>,
    #[key(section)]
    pub section: Section,
}
