//! A recording that was found: whether it is complete, and whose it is.

use super::folder::Stamp;
use crate::config::watch::{Completeness, WatchRule};
use crate::i18n::{Note, note};
use crate::ingest::lot::{LotError, folder_name, members};
use crate::ingest::serial::SerialPattern;
use crate::ingest::{ReadOptions, RecordingError, Source, open_recording};
use crate::record::SerialSource;
use crate::recording::ColumnRef;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Formats that end with a footer, without which they cannot be opened or are found to be cut off.
const FORMATS_WITH_FOOTER: [&str; 2] = ["parquet", "mcap"];
/// Longest serial number, characters.
const MAX_SERIAL_CHARACTERS: usize = 200;

/// A serial number and where it is from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identified {
    /// Serial number.
    pub serial: String,
    /// Where it was taken from.
    pub from: SerialSource,
    /// Name for a folder, safe in any file system.
    pub folder: String,
}

/// Whether a recording is complete, before it is opened.
///
/// # Errors
/// A note on what is still missing.
pub fn stands(rule: &WatchRule, path: &Path, still: Option<Duration>) -> Result<(), Note> {
    match rule.complete {
        Completeness::Name | Completeness::Footer => Ok(()),
        Completeness::Marker => {
            let mut marker = path.as_os_str().to_owned();
            marker.push(&rule.marker);
            let is_there = PathBuf::from(marker).symlink_metadata().is_ok_and(|m| m.is_file());
            if is_there { Ok(()) } else { Err(note!("watch.no_marker", ending = rule.marker.as_str())) }
        }
        Completeness::Still => match still {
            Some(still) if still >= rule.after => Ok(()),
            _ => Err(note!("watch.not_still", seconds = rule.after.as_secs_f64())),
        },
    }
}

/// Opens a recording and looks at its end.
///
/// # Errors
/// A note on why it is not complete. A marker or a name says that the writer is done: whatever is wrong then is a finding of
/// the test.
pub fn whole(rule: &WatchRule, path: &Path, options: &ReadOptions) -> Result<Option<Source>, Note> {
    let opened = open_recording(&[path.to_owned()], options).map(|r| r.source);
    match (rule.complete, opened) {
        (Completeness::Marker | Completeness::Name, opened) => Ok(opened.ok()),
        (_, Err(RecordingError::File(e))) => Err(note!("watch.not_opened", reason = e.note())),
        (_, Err(e @ RecordingError::Manifest(_))) => {
            Err(note!("watch.not_opened", reason = e.into_ingest(path).note()))
        }
        (complete, Ok(source)) => {
            if let Some(end) = source.cut_off().first() {
                return Err(note!("watch.cut_off", end = end.clone()));
            }
            if complete == Completeness::Footer && !FORMATS_WITH_FOOTER.contains(&source.format()) {
                return Err(note!("watch.no_footer", format = source.format()));
            }
            Ok(Some(source))
        }
    }
}

/// The serial number of the unit of a recording.
///
/// # Errors
/// A note where the rule does not tell it.
pub fn identified(
    rule: &WatchRule,
    name: &str,
    path: &Path,
    source: Option<&Source>,
    options: &ReadOptions,
) -> Result<Identified, Note> {
    let (serial, from) = if rule.names_serial() {
        let serial = SerialPattern::parse(&rule.pattern)?.serial_of(Path::new(name))?;
        (serial, SerialSource::Pattern)
    } else if let Some(column) = &rule.serial_column {
        let source = source.ok_or_else(|| note!("watch.no_serial_column", column = shown(column)))?;
        (in_column(source, column)?, SerialSource::Recording)
    } else {
        let all = members(&[path.to_owned()], options, None).map_err(|e| match e {
            LotError::Recording(e) => e.into_ingest(path).note(),
            LotError::Serial { help, .. } => help,
        })?;
        let member = all.into_iter().next().ok_or_else(|| Note::new("watch.no_serial"))?;
        (member.serial, member.serial_from)
    };
    let serial = serial.trim().to_owned();
    let is_wrong = serial.is_empty()
        || serial.chars().any(char::is_control)
        || serial.chars().count() > MAX_SERIAL_CHARACTERS;
    if is_wrong {
        return Err("watch.no_serial".into());
    }
    Ok(Identified { folder: folder_name(&serial), serial, from })
}

/// The serial number in a column of a recording: a text, or a whole number, the same in the first rows.
fn in_column(source: &Source, column: &ColumnRef) -> Result<String, Note> {
    let lacks = || note!("watch.no_serial_column", column = shown(column));
    let at = match column {
        ColumnRef::Position(at) => at.checked_sub(1).filter(|i| *i < source.columns().len()),
        ColumnRef::Name(name) => source.columns().iter().position(|c| c.name == *name),
    };
    let at = at.ok_or_else(lacks)?;
    let fields = source.first_fields(&[at]).map_err(|e| e.note())?;
    let fields = fields.into_iter().next().unwrap_or_default();
    if let Some(text) = fields.first_text.filter(|_| fields.numbers == 0) {
        return Ok(text);
    }
    let (mut first, mut several) = (None, false);
    source
        .read(&[at], &mut |block| {
            for value in block.columns.first().into_iter().flatten().filter(|v| v.is_finite()) {
                several |= first.is_some_and(|first| first != *value);
                first = first.or(Some(*value));
            }
            if several { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .map_err(|e| e.note())?;
    match first {
        Some(_) if several => Err(note!("watch.several_serials", column = shown(column))),
        Some(value) if value.fract() == 0.0 && fields.texts == 0 => Ok(format!("{value:.0}")),
        _ => Err(lacks()),
    }
}

/// A column as a rule names it.
fn shown(column: &ColumnRef) -> String {
    match column {
        ColumnRef::Name(name) => name.clone(),
        ColumnRef::Position(at) => at.to_string(),
    }
}

/// True where a recording is as it was.
pub fn is_unchanged(files: &[PathBuf], stamp: Stamp) -> bool {
    Stamp::of_all(files).is_ok_and(|now| now == stamp)
}
