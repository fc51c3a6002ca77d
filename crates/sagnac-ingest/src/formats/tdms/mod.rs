//! TDMS, the files of LabVIEW test benches: the channels of one group as columns.
//!
//! The reader is our own: the crates at hand either hold the whole file or read little-endian files without scales
//! only.

mod bytes;
mod properties;
mod scale;
mod segments;
mod table;

use crate::byte_stream::io_error;
use crate::column_inference::infer;
use crate::error::{IngestError, IngestErrorKind};
use crate::metadata::Metadata;
use crate::open_file;
use crate::part_selection::{self, Part};
use crate::{Candidate, Column, Format, Opened};
use properties::{Properties, Value};
use sagnac_core::message::{Note, note};
use sagnac_core::recording::Role;
use segments::{Channel, Contents, Kind, Scanner};
use table::{Origin, TdmsTable};

/// TDMS.
pub(super) struct Tdms;

impl Format for Tdms {
    fn id(&self) -> &'static str {
        "tdms"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(b"TDSm")
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        part_selection::unpacked(file, "ingest.tdms.what")?;
        let path = &file.path;
        let handle = open_file(path).map_err(|e| io_error(path, &e))?;
        let contents = Scanner::scan(path, handle, file.bytes)?;
        let (parts, members) = groups(&contents);
        let (chosen, mut notes) = part_selection::choose(path, &parts, file.options.part.as_deref())?;
        let part = parts.get(chosen).cloned().unwrap_or_default();
        // A file that breaks off within a block has fewer values of the later channels: the rows that all have are read.
        let rows = match contents.broken_at {
            Some(at) => whole_rows(path, &contents, &part, at)?,
            None => part.common_rows().unwrap_or(0),
        };
        let cut = contents.broken_at.is_some();
        let channels: Vec<&Channel> = members
            .get(chosen)
            .map_or(&[][..], Vec::as_slice)
            .iter()
            .filter_map(|&i| contents.channels.get(i))
            .filter(|c| c.values == rows || cut && c.values > rows || !c.kind.is_number())
            .collect();
        notes.push(note!("ingest.tdms.segments", count = contents.segments));
        let broken = |at| note!("ingest.tdms.broken", at);
        let cut_off: Vec<Note> = contents.broken_at.map(broken).into_iter().collect();
        notes.extend(cut_off.iter().cloned());
        notes.extend(part_selection::odd_lengths(&part, rows).filter(|_| !cut));
        let group = contents.groups.get(&part.name).cloned().unwrap_or_default();
        let (mut columns, mut origins) = columns(path, &contents, &group, &channels, rows, &mut notes)?;
        let waveform = Waveform::of(&channels);
        let mut rate = None;
        if let Some(w) = &waveform {
            rate = Some(1.0 / w.increment_s);
            let key = if w.start.is_some() { "ingest.tdms.waveform_dated" } else { "ingest.tdms.waveform" };
            let start = w.start.as_ref().and_then(Value::words).unwrap_or_default();
            let has_time =
                columns.iter().any(|c| c.numeric && infer(&c.name, c.unit.as_deref()).role == Role::Time);
            if !has_time {
                notes.push(Note::new(key).with("increment", w.increment_s.to_string()).with("start", start));
                columns.insert(0, w.column());
                origins.insert(0, Origin::Waveform { offset_s: w.first_s(), increment_s: w.increment_s });
            }
        }
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: Some(rows),
            cut_off,
            notes,
            metadata: metadata(&contents.file, &group, &channels),
            stated_sample_rate_hz: rate,
            table: Box::new(TdmsTable { path: path.clone(), bytes: file.bytes, rows, origins }),
        })
    }
}

/// The groups with values as parts of the file, and the channels of each by their place in the contents.
fn groups(contents: &Contents) -> (Vec<Part>, Vec<Vec<usize>>) {
    let mut parts: Vec<Part> = Vec::new();
    let mut members: Vec<Vec<usize>> = Vec::new();
    for (i, channel) in contents.channels.iter().enumerate().filter(|(_, c)| c.values > 0) {
        let place = parts.iter().position(|p| p.name == channel.group).unwrap_or_else(|| {
            parts.push(Part { name: channel.group.clone(), columns: Vec::new() });
            members.push(Vec::new());
            parts.len() - 1
        });
        if let (Some(part), Some(list)) = (parts.get_mut(place), members.get_mut(place)) {
            part.columns.push((describe(contents, channel), channel.values));
            list.push(i);
        }
    }
    (parts, members)
}

/// The columns of channels with where their values come from.
fn columns(
    path: &std::path::Path,
    contents: &Contents,
    group: &Properties,
    channels: &[&Channel],
    rows: u64,
    notes: &mut Vec<Note>,
) -> Result<(Vec<Column>, Vec<Origin>), IngestError> {
    let (mut columns, mut origins) = (Vec::new(), Vec::new());
    for channel in channels {
        let mut column = describe(contents, channel);
        let name = channel.name.as_str();
        let steps = scale::steps([&channel.properties, group, &contents.file]).unwrap_or_else(|kind| {
            let kind = crate::error::shorten(&kind);
            notes.push(note!("ingest.tdms.scale_unknown", name, kind));
            Vec::new()
        });
        if !steps.is_empty() {
            notes.push(note!("ingest.tdms.scaled", name, count = steps.len()));
        }
        let mut base_s = 0;
        if channel.kind == Kind::Stamp && rows > 0 {
            base_s = table::first_stamp_s(path, channel)?;
            column.unit = Some("s".to_owned());
            column.epoch_s = Some(base_s as f64);
        }
        columns.push(column);
        origins.push(Origin::channel(channel, steps, base_s));
    }
    Ok((columns, origins))
}

/// Rows that every channel of numbers of a group still has where the file breaks off.
fn whole_rows(path: &std::path::Path, contents: &Contents, part: &Part, at: u64) -> Result<u64, IngestError> {
    let of_group = contents.channels.iter().filter(|c| c.group == part.name && c.kind.is_number());
    match of_group.map(|c| c.values).min() {
        Some(rows) if rows > 1 => Ok(rows),
        _ => {
            let note = note!("ingest.tdms.broken_before", at);
            Err(IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.cut_off"))
        }
    }
}

/// A channel as a column.
fn describe(contents: &Contents, channel: &Channel) -> Column {
    let none = Properties::default();
    let group = contents.groups.get(&channel.group).unwrap_or(&none);
    let scaled = scale::steps([&channel.properties, group, &contents.file]);
    let unit =
        channel.properties.text("unit_string").or_else(|| channel.properties.text("NI_UnitDescription"));
    Column {
        name: channel.name.clone(),
        numeric: channel.kind.is_number() && scaled.is_ok(),
        storage: match &scaled {
            Ok(_) => channel.kind.words(),
            Err(kind) => {
                format!("{} under the scale `{}`", channel.kind.words(), crate::error::shorten(kind))
            }
        },
        unit: unit.map(str::trim).filter(|u| !u.is_empty()).map(str::to_owned),
        epoch_s: None,
        rollover_s: None,
        judged: None,
    }
}

/// The time base that waveform channels carry.
struct Waveform {
    increment_s: f64,
    offset_s: f64,
    start: Option<Value>,
}

impl Waveform {
    /// The time base that all channels of numbers share.
    fn of(channels: &[&Channel]) -> Option<Waveform> {
        let mut shared: Option<(f64, f64, Option<&Value>)> = None;
        for p in channels.iter().filter(|c| c.kind.is_number()).map(|c| &c.properties) {
            let increment = p.number("wf_increment").filter(|i| i.is_finite() && *i > 0.0)?;
            let offset = p.number("wf_start_offset").filter(|o| o.is_finite()).unwrap_or(0.0);
            // A start of 1904 is the default of a logger without a clock.
            let start = p.get("wf_start_time").filter(|v| matches!(v, Value::Stamp(s, _) if *s > 0));
            match shared {
                None => shared = Some((increment, offset, start)),
                // A channel without a start begins with the others.
                Some((i, o, s))
                    if (i, o) == (increment, offset) && (s == start || s.is_none() || start.is_none()) =>
                {
                    shared = Some((i, o, s.or(start)));
                }
                Some(_) => return None,
            }
        }
        let (increment_s, offset_s, start) = shared?;
        Some(Waveform { increment_s, offset_s, start: start.cloned() })
    }

    /// Time of the first value after the full second of the start, s.
    fn first_s(&self) -> f64 {
        let fraction = match self.start {
            Some(Value::Stamp(_, fraction)) => fraction as f64 / 2f64.powi(64),
            _ => 0.0,
        };
        fraction + self.offset_s
    }

    fn column(&self) -> Column {
        Column {
            name: "time".to_owned(),
            numeric: true,
            storage: "waveform".to_owned(),
            unit: Some("s".to_owned()),
            epoch_s: match self.start {
                Some(Value::Stamp(seconds, _)) => Some(seconds as f64),
                _ => None,
            },
            rollover_s: None,
            judged: None,
        }
    }
}

/// Properties of the file, the group and, by name, of the channels, without those that are used up.
fn metadata(file: &Properties, group: &Properties, channels: &[&Channel]) -> Vec<(String, String)> {
    let mut metadata = Metadata::default();
    for (key, value) in file.iter().chain(group.iter()) {
        metadata.add(key, &value.words().unwrap_or_default());
    }
    for channel in channels {
        let used = |key: &str| ["NI_", "wf_", "unit_string"].iter().any(|u| key.starts_with(u));
        for (key, value) in channel.properties.iter().filter(|(k, _)| !used(k)) {
            metadata.add(&format!("{}.{key}", channel.name), &value.words().unwrap_or_default());
        }
    }
    let start = channels.iter().find_map(|c| c.properties.get("wf_start_time")?.words());
    metadata.add("wf_start_time", &start.unwrap_or_default());
    metadata.entries()
}
