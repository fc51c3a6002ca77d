//! The keys by which procedures and manifests say how a recording is to be read, and the words of their values, which
//! the options of the command line share.

use crate::config::reader::{Reader, shorten};
use crate::config::section::Section;
use crate::config::spec::Word;
use crate::config::table::Table;
use crate::i18n::{Note, note};
use sagnac_ingest::{Encoding, FORMATS, ReadOptions, RowMatch, TextOptions};

/// How a recording is to be read.
#[derive(Table)]
pub(crate) struct RecordingKeys {
    /// Id of the file format; detected if omitted.
    #[key(example = "csv")]
    format: Option<String>,
    /// Character encoding of a text file; detected if omitted.
    #[key(choice = ENCODING_WORDS, example = "windows-1251")]
    encoding: Option<&'static str>,
    /// Field delimiter of a text file; detected if omitted.
    #[key(choice = DELIMITER_WORDS, example = "semicolon")]
    delimiter: Option<&'static str>,
    /// Decimal mark of a text file; detected if omitted.
    #[key(choice = DECIMAL_WORDS, example = "comma")]
    decimal: Option<&'static str>,
    /// Line with the column names of a text file, counted from 1; 0: none; detected if omitted.
    #[key(min = 0, max = 1e6, example = 4)]
    header_line: Option<f64>,
    /// First data line of a text file, counted from 1; detected if omitted.
    #[key(min = 1, max = 1e6, example = 6)]
    first_line: Option<f64>,
    /// Start of comment lines of a text file. Default: `#`, `%`, `//`, and `;` where it is not the delimiter.
    #[key(example = "#")]
    comment: Option<String>,
    /// Part of a container that holds the recording: a dataset, a variable, a topic.
    #[key(example = "/imu/gyro")]
    part: Option<String>,
    /// Only the rows in which a column has this value, where several sensors share a table.
    #[key(name = "where", example = "sensor=0")]
    only: Option<String>,
    /// First and last row to read, counted from 1; all if omitted.
    #[key(example = "1-600")]
    rows: Option<String>,
}

impl RecordingKeys {
    /// What the keys decide, with the problems of their table. The layout is left to the caller: each kind of file has its
    /// own rule where it may stand.
    pub(crate) fn options(self, section: &Section, reader: &mut Reader<'_>) -> ReadOptions {
        if let Some(unknown) = self.format.as_deref().filter(|id| !FORMATS.iter().any(|f| f.id() == *id)) {
            let ids: Vec<&str> = FORMATS.iter().map(|f| f.id()).collect();
            let at = reader.source.inside_quotes(&section.span_of("format"));
            let message = note!("reading.no_format", format = shorten(unknown));
            reader.error(&at, message, Some(note!("reading.formats", formats = ids.join(", "))));
        }
        let mut line = |number: Option<f64>, key: &str| {
            if number?.fract() == 0.0 {
                return number.map(|line| line as u64);
            }
            reader.error(&section.span_of(key), note!("reading.whole", key), None);
            None
        };
        let header_line = line(self.header_line, "header_line");
        let first_line = line(self.first_line, "first_line");
        if let Some((header, first)) = header_line.zip(first_line).filter(|(header, first)| header >= first) {
            let message = note!("reading.lines", first, header);
            reader.error(&section.span_of("first_line"), message, Some("reading.below".into()));
        }
        let text = TextOptions {
            encoding: self.encoding.and_then(encoding),
            delimiter: self.delimiter.and_then(delimiter),
            decimal: self.decimal.and_then(decimal),
            header_line,
            first_line,
            comment: self.comment,
            stamps: Vec::new(),
        };
        if text.delimiter == Some(b',') && text.decimal == Some(b',') {
            let help = Some("reading.comma_quotes".into());
            reader.error(&section.span_of("decimal"), "reading.comma_twice", help);
        }
        let mut known = |key: &str, text: &Option<String>, is_read: bool, message: &'static str| {
            if let Some(text) = text.as_deref().filter(|_| !is_read) {
                reader.error(&section.span_of(key), Note::new(message).with("given", shorten(text)), None);
            }
        };
        let (only, rows) =
            (self.only.as_deref().and_then(RowMatch::parse), self.rows.as_deref().and_then(rows));
        known("where", &self.only, only.is_some(), "reading.where");
        known("rows", &self.rows, rows.is_some(), "reading.rows");
        ReadOptions { format: self.format, text, part: self.part, only, rows, ..ReadOptions::default() }
    }
}

/// Character encodings of text files.
pub const ENCODING_WORDS: &[Word] = &[
    ("utf-8", "UTF-8, with or without byte-order mark"),
    ("utf-16le", "UTF-16, little endian"),
    ("utf-16be", "UTF-16, big endian"),
    ("windows-1251", "Windows-1251, Cyrillic"),
];

/// Separators of fields, as words and as characters.
pub const DELIMITER_WORDS: &[Word] = &[
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
pub const DECIMAL_WORDS: &[Word] = &[("point", "`.`"), ("comma", "`,`")];

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

/// First and last row of a range such as `1-600`; `257-` has no end.
pub fn rows(text: &str) -> Option<(u64, u64)> {
    let (first, last) = text.trim().split_once('-')?;
    let first: u64 = first.trim().parse().ok()?;
    let last = if last.trim().is_empty() { u64::MAX } else { last.trim().parse().ok()? };
    (first > 0 && first <= last).then_some((first, last))
}
