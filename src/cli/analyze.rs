//! `sagnac analyze`: the noise of a recording without a procedure.

use super::{AnalyzeArgs, exit, place, run};
use crate::ingest::{ReadOptions, Source, open_recording};
use crate::output::StagedFolder;
use crate::procedure::EffectiveLimits;
use crate::procedure::model::Procedure;
use crate::record::UnitUnderTest;
use crate::recording::guess::guess;
use crate::recording::{Channel, ColumnRef, Role};
use crate::run::{Request, analysis};
use crate::units::Unit;
use chrono::Utc;
use std::path::{Path, PathBuf};

pub fn main(args: &AnalyzeArgs) -> u8 {
    match attempt(args) {
        Ok(code) => code,
        Err(message) => {
            place::complain(&message);
            exit::ERROR
        }
    }
}

fn attempt(args: &AnalyzeArgs) -> Result<u8, String> {
    let taus = run::grid(&args.grid)?;
    if !(args.warm_up >= 0.0 && args.warm_up.is_finite()) {
        return Err(format!("error: --warm-up: {} is no time; give seconds, 0 or more\n", args.warm_up));
    }
    let renderer = run::renderer(args.templates.as_deref())?;
    let now = Utc::now();
    let stem = named(args).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = stem.split('.').next().unwrap_or_default().to_owned();
    let out = args.out.clone().unwrap_or_else(|| place::default_folder("analysis", Some(&stem), now));
    let folder = StagedFolder::begin(&out).map_err(|e| format!("error: {e}\n"))?;
    let recording = open_recording(&args.recording, &ReadOptions::default()).map_err(|e| format!("{e}\n"))?;
    let (source, manifest) = (recording.source, recording.manifest);
    let channels = channels(args, &source)?;
    let use_stamps = channels.iter().any(|c| c.role == Role::Time);
    if !use_stamps && args.sample_rate.is_none() {
        return Err(format!(
            "error: {}: no time column is used, so the sample rate is needed; give --sample-rate HZ\n",
            named(args).display()
        ));
    }
    let procedure: Procedure = analysis::procedure(channels, args.sample_rate, args.warm_up);
    let limits = EffectiveLimits::default();
    let request = Request {
        kind: "analyze",
        procedure: &procedure,
        procedure_record: None,
        limits: &limits,
        source: &source,
        use_stamps,
        unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
        operator: None,
        station: None,
        now,
        taus,
        exact: args.grid.exact,
    };
    run::finish(&request, folder, &renderer)
}

/// The recording as it was named first.
fn named(args: &AnalyzeArgs) -> &Path {
    args.recording.first().map_or(Path::new(""), PathBuf::as_path)
}

/// The channels: as named, else as their names tell.
fn channels(args: &AnalyzeArgs, source: &Source) -> Result<Vec<Channel>, String> {
    let unit =
        args.unit.as_deref().map(Unit::parse).transpose().map_err(|e| format!("error: --unit: {e}\n"))?;
    let mut channels = Vec::new();
    match args.time.as_deref() {
        Some("none") => {}
        Some(name) => channels.push(time(source, name)?),
        None => {
            let found = source.columns().iter().find(|c| {
                let g = guess(&c.name, c.unit.as_deref());
                c.numeric && g.role == Role::Time
            });
            if let Some(column) = found {
                channels.push(time(source, &column.name)?);
            }
        }
    }
    if let Some(name) = args.counter.as_deref() {
        let column = reference(name);
        source.resolve(&column).map_err(|e| format!("error: {e}\n"))?;
        let unit = Unit::parse("count").map_err(|e| e.to_string())?;
        channels.push(Channel { id: "counter".into(), column, role: Role::Counter, unit, scale: 1.0 });
    }
    let taken: Vec<ColumnRef> = channels.iter().map(|c| c.column.clone()).collect();
    let mut wanted: Vec<(String, ColumnRef)> = if args.rate.is_empty() && args.angle.is_empty() {
        let gyro = |name: &str, unit: Option<&str>| guess(name, unit).role.is_gyro();
        let columns = source.columns().iter().filter(|c| c.numeric && gyro(&c.name, c.unit.as_deref()));
        columns.map(|c| (c.name.clone(), ColumnRef::Name(c.name.clone()))).collect()
    } else {
        args.rate.iter().map(|name| (name.clone(), reference(name))).collect()
    };
    let rates = wanted.len();
    wanted.extend(args.angle.iter().map(|name| (name.clone(), reference(name))));
    for (place, (name, column)) in wanted.into_iter().enumerate() {
        let index = source.resolve(&column).map_err(|e| format!("error: {e}\n"))?;
        let found = &source.columns()[index];
        let guessed = guess(&found.name, found.unit.as_deref());
        let unit = match &unit {
            Some(unit) => unit.clone(),
            None if guessed.role.is_gyro() && guessed.unit_is_named => guessed.unit,
            None if place >= rates && guessed.unit_is_named && is_angle(&guessed.unit) => guessed.unit,
            None => {
                return Err(format!(
                    "error: {}: the name of column `{}` does not tell its unit; give --unit (for example deg/h or rad/s)\n",
                    named(args).display(),
                    found.name
                ));
            }
        };
        if wanted_twice(&channels, source, index) {
            return Err(format!(
                "error: {}: column `{}` is asked for twice; name each once\n",
                named(args).display(),
                found.name
            ));
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
        return Err(format!(
            "error: {}: no column looks like a gyro output; name it with --rate (columns: {})\n",
            named(args).display(),
            names.join(", ")
        ));
    }
    for column in source.columns().iter().filter(|c| c.numeric) {
        let g = guess(&column.name, column.unit.as_deref());
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

fn time(source: &Source, name: &str) -> Result<Channel, String> {
    let column = reference(name);
    let index = source.resolve(&column).map_err(|e| format!("error: {e}\n"))?;
    let found = &source.columns()[index];
    let g = guess(&found.name, found.unit.as_deref());
    let unit = if g.role == Role::Time { g.unit } else { Unit::parse("s").map_err(|e| e.to_string())? };
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
