//! The columns of a recording without a procedure: as named, else as their names tell.

use crate::i18n::{Arg, Note, note};
use crate::ingest::{Column, IngestErrorKind, Source, TimeBaseSpec, prepare};
use crate::recording::{Channel, ColumnRef, Role};
use crate::units::Unit;
use std::path::Path;

/// Choice of the columns. A column is given by its name or by its position, counted from 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnChoice {
    /// Rate columns; empty: every column that looks like a gyro output.
    pub rate: Vec<String>,
    /// Columns of accumulated angle, differenced to a rate.
    pub angle: Vec<String>,
    /// Columns of angle increments, divided by the sample interval.
    pub increment: Vec<String>,
    /// Unit of the rate columns; `None`: from their names.
    pub unit: Option<String>,
    /// Factor from the numbers of the rate columns to that unit; `None`: as the file states, else 1.
    pub scale: Option<f64>,
    /// Sample counter, which tells lost and repeated samples, or `none`; `None`: one that the names tell, where no time
    /// column serves.
    pub counter: Option<String>,
    /// Time column, or `none` to use only the sample rate; `None`: from the names.
    pub time: Option<String>,
    /// Sample rate, Hz, required without a time column.
    pub sample_rate_hz: Option<f64>,
    /// Time excluded at the start, s.
    pub warm_up_s: f64,
}

/// A sentence about a recording.
pub fn about(path: &Path, key: &'static str) -> Note {
    Note::new(key).with("path", path.display().to_string())
}

/// The channels: as named, else as their names tell. `path` is how sentences name the recording.
///
/// # Errors
/// A sentence about what is not there, not told, or named twice.
pub fn channels(args: &ColumnChoice, path: &Path, source: &Source) -> Result<Vec<Channel>, Note> {
    let unit = args.unit.as_deref().map(Unit::parse).transpose();
    let unit = unit.map_err(|e| note!("cli.of_option", option = "--unit", what = e.note()))?;
    let mut channels = Vec::new();
    let stamps = named_time(args, source)?;
    if let Some(time) =
        stamps.filter(|time| args.rate_hz(source).is_none() || unusable(source, time).is_none())
    {
        channels.push(time);
    }
    let counter = match args.counter.as_deref() {
        Some("none") => None,
        Some(name) => Some(name.to_owned()),
        None if channels.is_empty() => counter_by_name(source),
        None => None,
    };
    if let Some(name) = counter.as_deref() {
        let column = reference(name);
        source.resolve(&column).map_err(|e| e.note())?;
        let unit = Unit::parse("count").map_err(|e| e.note())?;
        channels.push(Channel { id: "counter".into(), column, role: Role::Counter, unit, scale: 1.0 });
    }
    let taken: Vec<ColumnRef> = channels.iter().map(|c| c.column.clone()).collect();
    for Wanted { name, column, as_role } in wanted(args, source) {
        let index = source.resolve(&column).map_err(|e| e.note())?;
        let found = &source.columns()[index];
        let guessed = found.inferred();
        let angle = as_role.is_some() && guessed.unit_is_named && is_angle(&guessed.unit);
        let (unit, scale) = match &unit {
            // What the header states of the numbers is in its own unit.
            Some(unit) => (unit.clone(), args.scale.unwrap_or(1.0)),
            None if angle || (guessed.role.is_gyro() && guessed.unit_is_named) => {
                (guessed.unit, args.scale.unwrap_or(guessed.scale))
            }
            None => {
                let counts = guessed.counts_of_a_gyro(&found.name);
                let key = if counts { "cli.counts_without_size" } else { "cli.unit_not_told" };
                return Err(about(path, key).with("column", found.name.as_str()));
            }
        };
        if Unit::parse("count").is_ok_and(|count| count.same_dimension(&unit)) {
            return Err(about(path, "cli.counts_without_size").with("column", found.name.as_str()));
        }
        if wanted_twice(&channels, source, index) {
            return Err(about(path, "cli.column_twice").with("column", found.name.as_str()));
        }
        let by_unit = if is_angle(&unit) { Role::AngleIncrement } else { Role::Rate };
        let id = unused(id(&name, &found.name), &channels);
        channels.push(Channel { id, column, role: as_role.unwrap_or(by_unit), unit, scale });
    }
    if !channels.iter().any(|c| c.role.is_gyro()) {
        let names: Vec<&str> = source.columns().iter().map(|c| c.name.as_str()).collect();
        return Err(about(path, "cli.no_gyro").with("columns", names.join(", ")));
    }
    for column in source.columns().iter().filter(|c| c.numeric) {
        let g = column.inferred();
        let reference = ColumnRef::Name(column.name.clone());
        if g.role == Role::Temperature && g.unit_is_named && !taken.contains(&reference) {
            channels.push(Channel {
                id: column.name.clone(),
                column: reference,
                role: g.role,
                unit: g.unit,
                scale: g.scale,
            });
        }
    }
    Ok(channels)
}

/// A gyro column that is asked for.
struct Wanted {
    name: String,
    column: ColumnRef,
    /// The role that the user gives it; `None`: by its unit.
    as_role: Option<Role>,
}

/// The gyro columns that are asked for: those that are named, else every one that looks like a gyro output, else, with the
/// size of a count, those that hold counts of a gyro.
fn wanted(args: &ColumnChoice, source: &Source) -> Vec<Wanted> {
    let named = |names: &[String], as_role: Option<Role>| -> Vec<Wanted> {
        names.iter().map(|name| Wanted { name: name.clone(), column: reference(name), as_role }).collect()
    };
    if !(args.rate.is_empty() && args.angle.is_empty() && args.increment.is_empty()) {
        let mut all = named(&args.rate, None);
        all.extend(named(&args.angle, Some(Role::AccumulatedAngle)));
        all.extend(named(&args.increment, Some(Role::AngleIncrement)));
        return all;
    }
    let like = |fits: &dyn Fn(&Column) -> bool| -> Vec<String> {
        source.columns().iter().filter(|c| c.numeric && fits(c)).map(|c| c.name.clone()).collect()
    };
    let mut names = like(&|c| c.inferred().role.is_gyro());
    if names.is_empty() && args.scale.is_some() {
        names = like(&|c| c.inferred().counts_of_a_gyro(&c.name));
    }
    let whole = |name: String| Wanted { column: ColumnRef::Name(name.clone()), name, as_role: None };
    names.into_iter().map(whole).collect()
}

/// The time column that is named, else the one that the names tell.
fn named_time(args: &ColumnChoice, source: &Source) -> Result<Option<Channel>, Note> {
    match args.time.as_deref() {
        Some("none") => Ok(None),
        Some(name) => time(source, name).map(Some),
        None => {
            let column = source.time_column().and_then(|i| source.columns().get(i));
            column.map(|c| time(source, &c.name)).transpose()
        }
    }
}

/// Why the stamps of a time column tell no clock; `None` where they do, or where the file cannot be read at all.
pub(crate) fn unusable(source: &Source, time: &Channel) -> Option<Note> {
    match prepare(source, std::slice::from_ref(time), TimeBaseSpec::default()) {
        Err(e) if matches!(e.kind(), IngestErrorKind::TimeBase | IngestErrorKind::NotNumeric) => {
            Some(e.message().clone())
        }
        _ => None,
    }
}

/// The only column that counts the samples, by name and value.
fn counter_by_name(source: &Source) -> Option<String> {
    let mut counters = source.columns().iter().filter(|c| c.numeric && c.inferred().role == Role::Counter);
    let one = counters.next().filter(|_| counters.next().is_none())?;
    Some(one.name.clone())
}

impl ColumnChoice {
    /// Sample rate where no stamps tell it, Hz: as given, else as the file states it.
    fn rate_hz(&self, source: &Source) -> Option<f64> {
        source.rate_without_stamps_hz(self.sample_rate_hz)
    }
}

/// What must be known of the way a recording is read: units against what columns state, stamps that were left, decisions by
/// the first values, rows that were left out.
pub fn remarks(args: &ColumnChoice, channels: &[Channel], source: &Source) -> Vec<Note> {
    let mut notes = unit_contradictions(channels, source);
    if !channels.iter().any(|c| c.role == Role::Time)
        && let Ok(Some(time)) = named_time(args, source)
        && let Some(why) = unusable(source, &time)
        && let Some(hz) = args.rate_hz(source)
    {
        let column = source.resolve(&time.column).ok().and_then(|i| source.columns().get(i));
        let name = column.map_or("", |c| c.name.as_str());
        notes.push(note!("cli.time_left", column = name, why, hz = Arg::Stated(hz)));
    }
    if args.sample_rate_hz.is_none()
        && !channels.iter().any(|c| c.role == Role::Time)
        && let Some(hz) = source.stated_sample_rate_hz()
    {
        notes.push(note!("cli.rate_stated", hz = Arg::Stated(hz)));
    }
    let counter = channels.iter().find(|c| c.role == Role::Counter).filter(|_| args.counter.is_none());
    if let Some(column) = counter.and_then(|c| source.columns().get(source.resolve(&c.column).ok()?)) {
        notes.push(note!("cli.counter_found", column = column.name.as_str()));
    }
    notes.extend(source.notes().iter().filter(|n| n.id.starts_with("ingest.judged.")).cloned());
    notes.extend(source.bad_blocks().iter().map(|b| b.note.clone()));
    notes
}

/// Said of each gyro channel whose column states another unit than it is read in: `--unit` counts, and may be wrong.
pub fn unit_contradictions(channels: &[Channel], source: &Source) -> Vec<Note> {
    let gyro = channels.iter().filter(|c| c.role.is_gyro());
    gyro.filter_map(|channel| {
        let column = source.columns().get(source.resolve(&channel.column).ok()?)?;
        let stated = column.inferred();
        let factor = stated.unit.factor_to(&channel.unit).unwrap_or(f64::NAN);
        (stated.unit_is_named && factor != 1.0).then(|| {
            note!(
                "cli.unit_otherwise",
                column = column.name.as_str(),
                stated = stated.unit.text(),
                unit = channel.unit.text()
            )
        })
    })
    .collect()
}

fn time(source: &Source, name: &str) -> Result<Channel, Note> {
    let column = reference(name);
    let index = source.resolve(&column).map_err(|e| e.note())?;
    let found = &source.columns()[index];
    let g = found.inferred();
    let (unit, scale) = match source.time_unit() {
        Some(unit) => (unit.clone(), 1.0),
        None if g.role == Role::Time => (g.unit, g.scale),
        None => (Unit::parse("s").map_err(|e| e.note())?, 1.0),
    };
    Ok(Channel { id: "time".into(), column, role: Role::Time, unit, scale })
}

fn is_angle(unit: &Unit) -> bool {
    Unit::parse("deg").is_ok_and(|angle| angle.same_dimension(unit))
}

/// A number is a position, anything else a name.
fn reference(name: &str) -> ColumnRef {
    name.parse().map_or_else(|_| ColumnRef::Name(name.to_owned()), ColumnRef::Position)
}

/// True when a channel already reads a column.
fn wanted_twice(channels: &[Channel], source: &Source, index: usize) -> bool {
    channels.iter().any(|c| source.resolve(&c.column).is_ok_and(|i| i == index))
}

/// An id that no channel has: two columns may differ only in signs that file names cannot hold.
fn unused(id: String, channels: &[Channel]) -> String {
    let taken = |id: &str| channels.iter().any(|c| c.id == id);
    if !taken(&id) {
        return id;
    }
    (2..).map(|n| format!("{id}_{n}")).find(|candidate| !taken(candidate)).unwrap_or(id)
}

/// A channel id that is safe in file names.
fn id(given: &str, column: &str) -> String {
    let name = if given.parse::<usize>().is_ok() { column } else { given };
    name.chars().map(|c| if c.is_alphanumeric() || c == '_' || c == '-' { c } else { '_' }).collect()
}
