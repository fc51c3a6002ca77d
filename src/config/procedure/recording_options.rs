//! How the recording is to be read, where the procedure says so.

use super::reader::Reader;
use super::section::{Entry, Section};
use crate::config::recording_options;
use crate::i18n::Note;
use crate::recording::{ColumnRef, Role};
use sagnac_ingest::{ReadOptions, StampOptions, StampWriting};

/// The decisions of `[recording]` and of the time channels, but for the layout.
pub(super) fn options(
    section: Option<&Section>,
    channels: &[Section],
    reader: &mut Reader<'_>,
) -> ReadOptions {
    let mut options = section.map(|s| recording_options::read(s, reader)).unwrap_or_default();
    options.text.stamps = channels.iter().filter_map(|c| stamps(c, reader)).collect();
    options
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
