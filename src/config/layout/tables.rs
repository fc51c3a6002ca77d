//! The tables of a layout file.

use crate::config::spec::{Kind, Range, TableSpec, Word, optional, quantity, required, with_default};

/// Whole numbers that a double holds exactly.
const WHOLE: Range = Range::between(0.0, 9_007_199_254_740_992.0);

/// Types of a field.
pub const TYPES: &[Word] = &[
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
pub const CHECKSUMS: &[Word] = &[
    ("sum8", "sum of the bytes modulo 256"),
    ("xor8", "exclusive or of the bytes"),
    ("crc16-ccitt", "CRC-16, polynomial 1021, start FFFF (also called CCITT-FALSE)"),
    ("crc16-xmodem", "CRC-16, polynomial 1021, start 0000"),
    ("crc32", "CRC-32 of zip and Ethernet"),
];

/// A layout file as a whole.
pub static LAYOUT_FILE: TableSpec = TableSpec {
    name: "",
    doc: "Layout of the records of a raw binary recording. Every record has the same length and the same fields. \
          Bytes are counted from 0.",
    keys: &[
        required("format", Kind::Format("layout/1"), "\"layout/1\"", "Version of the format."),
        with_default(
            "header_bytes",
            Kind::Number(WHOLE),
            "0",
            "512",
            "Bytes before the first record; skipped.",
        ),
        optional(
            "record_bytes",
            Kind::Number(Range::between(1.0, 262_144.0)),
            "32",
            "Length of a record. Default: up to the end of the last field or checksum.",
        ),
        with_default(
            "byte_order",
            Kind::Choice(BYTE_ORDERS),
            "\"little\"",
            "\"big\"",
            "Byte order of every number.",
        ),
        optional(
            "sync",
            Kind::Text,
            "\"AA 55\"",
            "Bytes at the start of every record, hexadecimal. Where they are missing, the next record is \
             searched for; skipped records become rows without values, which are counted and located.",
        ),
        optional(
            "sample_rate",
            quantity("Hz", Range::POSITIVE),
            "\"2000 Hz\"",
            "Sample rate, used if there are no timestamps.",
        ),
        optional("checksum", Kind::Table(&CHECKSUM), "", "Checksum of every record."),
        required("field", Kind::Tables(&FIELD), "", "The fields of a record, one table each."),
    ],
};

static CHECKSUM: TableSpec = TableSpec {
    name: "checksum",
    doc: "Checksum of a record. A record whose checksum is wrong becomes a row without values, which is counted and \
          located.",
    keys: &[
        required("type", Kind::Choice(CHECKSUMS), "\"crc16-ccitt\"", "Which checksum."),
        optional(
            "offset",
            Kind::Number(WHOLE),
            "30",
            "First byte of the checksum in the record. Default: the last bytes of the record.",
        ),
        with_default("from", Kind::Number(WHOLE), "0", "2", "First byte covered by the checksum."),
        optional(
            "to",
            Kind::Number(WHOLE),
            "30",
            "Byte after the last one covered. Default: the first byte of the checksum.",
        ),
    ],
};

static FIELD: TableSpec = TableSpec {
    name: "field",
    doc: "A field of the record. Its value is `scale` times the number plus `offset_value`, in `unit`.",
    keys: &[
        required("name", Kind::Text, "\"rate_deg_h\"", "Name of the column."),
        required("type", Kind::Choice(TYPES), "\"i32\"", "Type of the number."),
        optional(
            "offset",
            Kind::Number(WHOLE),
            "4",
            "First byte in the record. Default: directly after the previous field, or after `sync`.",
        ),
        with_default(
            "count",
            Kind::Number(Range::between(1.0, 4096.0)),
            "1",
            "3",
            "Numbers of this type one after another; the columns are `name[0]`, `name[1]` and so on.",
        ),
        with_default("scale", Kind::Number(Range::ANY), "1", "0.001", "Size of one count."),
        with_default(
            "offset_value",
            Kind::Number(Range::ANY),
            "0",
            "25",
            "Offset added after scaling, in `unit`.",
        ),
        optional("unit", Kind::UnitText, "\"deg/h\"", "Unit of the value."),
        optional(
            "mask",
            Kind::Number(WHOLE),
            "0x0F",
            "Bits of an integer to keep, for flags packed into one number.",
        ),
        optional("shift", Kind::Number(Range::between(0.0, 63.0)), "4", "Right shift of the kept bits."),
        optional(
            "rolls_over",
            quantity("s", Range::POSITIVE),
            "\"4294.967296 s\"",
            "Time after which a timestamp restarts from zero.",
        ),
    ],
};
