//! How the recording is to be read, where the procedure says so.

use super::reader::Reader;
use super::tables::{ChannelKeys, RecordingTable};
use crate::i18n::note;
use crate::recording::{ColumnRef, Role};
use sagnac_ingest::{ReadOptions, StampOptions};

/// The decisions of `[recording]` and of the time channels, but for the layout.
pub(super) fn options(
    recording: RecordingTable,
    channels: &[ChannelKeys],
    reader: &mut Reader<'_>,
) -> ReadOptions {
    let mut options = recording.reading.options(&recording.section, reader);
    options.text.stamps = channels.iter().filter_map(|c| stamps(c, reader)).collect();
    options
}

/// Stamps as a channel declares them.
fn stamps(channel: &ChannelKeys, reader: &mut Reader<'_>) -> Option<StampOptions> {
    let section = &channel.section;
    let key = ["stamp", "date_column", "week_column"].into_iter().find(|k| section.entry(k).is_some())?;
    if let Some(role) = channel.role.filter(|role| *role != Role::Time) {
        let message = note!("reading.not_time", key, role = role.id());
        reader.error(&section.span_of(key), message, None);
        return None;
    }
    if channel.date_column.is_some() && channel.week_column.is_some() {
        reader.error(&section.span_of("week_column"), "reading.date_or_week", None);
        return None;
    }
    stamp_options(channel)
}

fn stamp_options(channel: &ChannelKeys) -> Option<StampOptions> {
    Some(StampOptions {
        column: channel.column.clone()?,
        writing: channel.stamp,
        date_column: channel.date_column.clone(),
        week_column: channel.week_column.clone(),
    })
}

/// The column a channel is read from: the joined one where its stamps stand in two.
pub(super) fn column(channel: &ChannelKeys) -> Option<ColumnRef> {
    let options = stamp_options(channel)?;
    Some(options.joined_name().map_or(options.column, ColumnRef::Name))
}
