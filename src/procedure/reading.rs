//! How the recording is to be read, where the procedure says so.

use super::reader::Reader;
use super::section::{Entry, Section};
use crate::ingest::read_words::{decimal, delimiter, encoding};
use crate::ingest::{FORMATS, ReadOptions, StampOptions, StampWriting, TextOptions};
use crate::recording::{ColumnRef, Role};
use crate::text::Note;
use std::path::PathBuf;

/// The decisions of `[recording]` and of the time channels.
pub(super) fn options(
    section: Option<&Section>,
    channels: &[Section],
    reader: &mut Reader<'_>,
) -> ReadOptions {
    let stamps = channels.iter().filter_map(|c| stamps(c, reader)).collect();
    let Some(section) = section else {
        return ReadOptions {
            text: TextOptions { stamps, ..TextOptions::default() },
            ..ReadOptions::default()
        };
    };
    let format = section.text("format");
    if let Some(unknown) = format.as_deref().filter(|id| !FORMATS.iter().any(|f| f.id() == *id)) {
        let ids: Vec<&str> = FORMATS.iter().map(|f| f.id()).collect();
        let message = Note::new("reading.no_format").with("format", super::reader::shorten(unknown));
        let help = Note::new("reading.formats").with("formats", ids.join(", "));
        reader.error(&section.span_of("format"), message, Some(help));
    }
    let mut line = |key: &str| {
        let number = section.number(key)?;
        if number.fract() != 0.0 {
            reader.error(&section.span_of(key), Note::new("reading.whole").with("key", key), None);
        }
        Some(number as u64)
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
        stamps,
    };
    if text.delimiter == Some(b',') && text.decimal == Some(b',') {
        let help = Some("reading.comma_quotes".into());
        reader.error(&section.span_of("decimal"), "reading.comma_twice", help);
    }
    ReadOptions {
        format,
        text,
        part: section.text("part"),
        layout: section.text("layout").map(PathBuf::from),
    }
}

/// What a channel says of its stamps.
fn stamps(section: &Section, reader: &mut Reader<'_>) -> Option<StampOptions> {
    let column = |key: &str| match section.entry(key) {
        Some(Entry::Column(column)) => Some(column.clone()),
        _ => None,
    };
    let (date_column, week_column) = (column("date_column"), column("week_column"));
    let writing = section.word("stamp").map(|word| match word {
        "iso8601" => StampWriting::Iso8601,
        "day_first" => StampWriting::DayFirst,
        "month_first" => StampWriting::MonthFirst,
        "clock" => StampWriting::Clock,
        "gps_week_seconds" => StampWriting::GpsWeekSeconds,
        _ => StampWriting::Number,
    });
    let key = ["stamp", "date_column", "week_column"].into_iter().find(|k| section.entry(k).is_some())?;
    if let Some(role) = section.word("role").filter(|r| *r != Role::Time.id()) {
        let message = Note::new("reading.not_time").with("key", key).with("role", role);
        reader.error(&section.span_of(key), message, None);
        return None;
    }
    if date_column.is_some() && week_column.is_some() {
        reader.error(&section.span_of("week_column"), "reading.date_or_week", None);
        return None;
    }
    Some(StampOptions { column: column("column")?, writing, date_column, week_column })
}

/// The column a channel is read from: the joined one where its stamps stand in two.
pub(super) fn column(section: &Section, column: ColumnRef) -> ColumnRef {
    let of = |key: &str| match section.entry(key) {
        Some(Entry::Column(column)) => Some(column.clone()),
        _ => None,
    };
    let options = StampOptions {
        column: column.clone(),
        writing: None,
        date_column: of("date_column"),
        week_column: of("week_column"),
    };
    options.joined_name().map_or(column, ColumnRef::Name)
}
