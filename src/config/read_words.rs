//! The words by which procedures, manifests and options say how a text file is written.

use crate::config::spec::Word;
use sagnac_ingest::Encoding;

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
