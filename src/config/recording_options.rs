//! How a file is to be read, as the keys say that procedures and manifests share.

use super::recording_keys::{decimal, delimiter, encoding};
use crate::config::reader::{Reader, shorten};
use crate::config::section::Section;
use crate::i18n::Note;
use sagnac_ingest::{FORMATS, ReadOptions, TextOptions};

/// What the keys of [`super::recording_keys`] decide. The layout is left to the caller: each kind of file has its own rule where it may stand.
pub(crate) fn read(section: &Section, reader: &mut Reader<'_>) -> ReadOptions {
    let format = section.text("format");
    if let Some(unknown) = format.as_deref().filter(|id| !FORMATS.iter().any(|f| f.id() == *id)) {
        let ids: Vec<&str> = FORMATS.iter().map(|f| f.id()).collect();
        let at = reader.source.inside_quotes(&section.span_of("format"));
        let message = Note::new("reading.no_format").with("format", shorten(unknown));
        reader.error(&at, message, Some(Note::new("reading.formats").with("formats", ids.join(", "))));
    }
    let mut line = |key: &str| {
        let number = section.number(key)?;
        if number.fract() == 0.0 {
            return Some(number as u64);
        }
        reader.error(&section.span_of(key), Note::new("reading.whole").with("key", key), None);
        None
    };
    let (header_line, first_line) = (line("header_line"), line("first_line"));
    if let Some((header, first)) = header_line.zip(first_line).filter(|(header, first)| header >= first) {
        let message = Note::new("reading.lines").with("first", first).with("header", header);
        reader.error(&section.span_of("first_line"), message, Some("reading.below".into()));
    }
    let text = TextOptions {
        encoding: section.word("encoding").and_then(encoding),
        delimiter: section.word("delimiter").and_then(delimiter),
        decimal: section.word("decimal").and_then(decimal),
        header_line,
        first_line,
        comment: section.text("comment"),
        stamps: Vec::new(),
    };
    if text.delimiter == Some(b',') && text.decimal == Some(b',') {
        let help = Some("reading.comma_quotes".into());
        reader.error(&section.span_of("decimal"), "reading.comma_twice", help);
    }
    ReadOptions { format, text, part: section.text("part"), layout: None }
}
