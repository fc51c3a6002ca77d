//! The keys by which procedures and manifests say how a recording is to be read, and the words of their values, which
//! the options of the command line share.

use crate::config::spec::{KeySpec, Kind, Range, Word, optional};
use sagnac_ingest::Encoding;

pub(crate) const FORMAT: KeySpec =
    optional("format", Kind::Text, "\"csv\"", "Id of the file format; detected if omitted.");

pub(crate) const ENCODING: KeySpec = optional(
    "encoding",
    Kind::Choice(ENCODINGS),
    "\"windows-1251\"",
    "Character encoding of a text file; detected if omitted.",
);

pub(crate) const DELIMITER: KeySpec = optional(
    "delimiter",
    Kind::Choice(DELIMITERS),
    "\"semicolon\"",
    "Field delimiter of a text file; detected if omitted.",
);

pub(crate) const DECIMAL: KeySpec = optional(
    "decimal",
    Kind::Choice(DECIMALS),
    "\"comma\"",
    "Decimal mark of a text file; detected if omitted.",
);

pub(crate) const HEADER_LINE: KeySpec = optional(
    "header_line",
    Kind::Number(Range::between(0.0, 1e6)),
    "4",
    "Line with the column names of a text file, counted from 1; 0: none; detected if omitted.",
);

pub(crate) const FIRST_LINE: KeySpec = optional(
    "first_line",
    Kind::Number(Range::between(1.0, 1e6)),
    "6",
    "First data line of a text file, counted from 1; detected if omitted.",
);

pub(crate) const COMMENT: KeySpec = optional(
    "comment",
    Kind::Text,
    "\"#\"",
    "Start of comment lines of a text file. Default: `#`, `%`, `//`, and `;` where it is not the delimiter.",
);

pub(crate) const PART: KeySpec = optional(
    "part",
    Kind::Text,
    "\"/imu/gyro\"",
    "Part of a container that holds the recording: a dataset, a variable, a topic.",
);

/// Character encodings of text files.
pub const ENCODINGS: &[Word] = &[
    ("utf-8", "UTF-8, with or without byte-order mark"),
    ("utf-16le", "UTF-16, little endian"),
    ("utf-16be", "UTF-16, big endian"),
    ("windows-1251", "Windows-1251, Cyrillic"),
];

/// Separators of fields, as words and as characters.
pub const DELIMITERS: &[Word] = &[
    ("comma", "`,`"),
    ("semicolon", "`;`"),
    ("tab", "a tab"),
    ("space", "runs of spaces or tabs"),
    ("pipe", "`|`"),
    (",", "as `comma`"),
    (";", "as `semicolon`"),
    ("|", "as `pipe`"),
];

/// Decimal signs.
pub const DECIMALS: &[Word] = &[("point", "`.`"), ("comma", "`,`")];

/// The encoding of a word.
pub fn encoding(word: &str) -> Option<Encoding> {
    match word {
        "utf-8" => Some(Encoding::Utf8),
        "utf-16le" => Some(Encoding::Utf16Le),
        "utf-16be" => Some(Encoding::Utf16Be),
        "windows-1251" => Some(Encoding::Windows1251),
        _ => None,
    }
}

/// The character that separates, by its word or itself.
pub fn delimiter(word: &str) -> Option<u8> {
    match word {
        "comma" | "," => Some(b','),
        "semicolon" | ";" => Some(b';'),
        "tab" | "\t" => Some(b'\t'),
        "space" | " " => Some(b' '),
        "pipe" | "|" => Some(b'|'),
        _ => None,
    }
}

/// The decimal sign of a word.
pub fn decimal(word: &str) -> Option<u8> {
    match word {
        "point" | "." => Some(b'.'),
        "comma" | "," => Some(b','),
        _ => None,
    }
}
