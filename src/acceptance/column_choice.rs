//! The columns of a recording without a procedure: as named, else as their names tell.

use crate::i18n::{Note, note};
use crate::ingest::Source;
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
    /// Unit of the rate columns; `None`: from their names.
    pub unit: Option<String>,
    /// Sample counter, which tells lost and repeated samples.
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
    match args.time.as_deref() {
        Some("none") => {}
        Some(name) => channels.push(time(source, name)?),
        None => {
            if let Some(column) = source.time_column().and_then(|i| source.columns().get(i)) {
                channels.push(time(source, &column.name)?);
            }
        }
    }
    if let Some(name) = args.counter.as_deref() {
        let column = reference(name);
        source.resolve(&column).map_err(|e| e.note())?;
        let unit = Unit::parse("count").map_err(|e| e.note())?;
        channels.push(Channel { id: "counter".into(), column, role: Role::Counter, unit, scale: 1.0 });
    }
    let taken: Vec<ColumnRef> = channels.iter().map(|c| c.column.clone()).collect();
    let mut wanted: Vec<(String, ColumnRef)> = if args.rate.is_empty() && args.angle.is_empty() {
        let columns = source.columns().iter().filter(|c| c.numeric && c.inferred().role.is_gyro());
        columns.map(|c| (c.name.clone(), ColumnRef::Name(c.name.clone()))).collect()
    } else {
        args.rate.iter().map(|name| (name.clone(), reference(name))).collect()
    };
    let rates = wanted.len();
    wanted.extend(args.angle.iter().map(|name| (name.clone(), reference(name))));
    for (place, (name, column)) in wanted.into_iter().enumerate() {
        let index = source.resolve(&column).map_err(|e| e.note())?;
        let found = &source.columns()[index];
        let guessed = found.inferred();
        let unit = match &unit {
            Some(unit) => unit.clone(),
            None if guessed.role.is_gyro() && guessed.unit_is_named => guessed.unit,
            None if place >= rates && guessed.unit_is_named && is_angle(&guessed.unit) => guessed.unit,
            None => {
                return Err(about(path, "cli.unit_not_told").with("column", found.name.as_str()));
            }
        };
        if wanted_twice(&channels, source, index) {
            return Err(about(path, "cli.column_twice").with("column", found.name.as_str()));
        }
        let role = if place >= rates {
            Role::AccumulatedAngle
        } else if is_angle(&unit) {
            Role::AngleIncrement
        } else {
            Role::Rate
        };
        let id = unused(id(&name, &found.name), &channels);
        channels.push(Channel { id, column, role, unit, scale: 1.0 });
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
                scale: 1.0,
            });
        }
    }
    Ok(channels)
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
    let unit = if g.role == Role::Time { g.unit } else { Unit::parse("s").map_err(|e| e.note())? };
    Ok(Channel { id: "time".into(), column, role: Role::Time, unit, scale: 1.0 })
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
