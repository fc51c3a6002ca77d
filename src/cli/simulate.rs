//! `sagnac simulate`: a recording from a model.

use super::join::JoinArgs;
use super::length::{self, Length};
use super::progress::{Display, Measure, Progress};
use super::{exit, place};
use crate::config::model::{DEFAULT_SEED, ModelFile, Profile, load_model};
use crate::config::schedule::{self, Schedule};
use crate::effect::Column;
use crate::i18n::{Arg, Lang, Localize, Note, note};
use crate::ingest::{ReadOptions, files_read};
use crate::output::StagedFile;
use crate::series::{Series, SeriesOptions, load_series};
use crate::simulate::{Format, Order, Over, Simulation, Written, write};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Model (TOML): the expected content of the recording
    #[arg(value_name = "FILE")]
    model: PathBuf,
    /// File to write, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    /// Seed, a whole number; equal seeds give equal recordings [default: as in the model, else 1]
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Length with its unit, such as 10h, 600s or "2 d" [default: as in the model]
    #[arg(long, value_name = "LENGTH", value_parser = length::above_zero)]
    duration: Option<Length>,
    /// Recording that provides rows and columns: timestamps, gaps, temperatures, table rates
    #[arg(long, value_name = "RECORDING")]
    like: Option<PathBuf>,
    /// Schedule (TOML) that gives length and columns: what chamber and table do, as `sagnac plan` writes it
    #[arg(long, value_name = "FILE")]
    schedule: Option<PathBuf>,
    #[command(flatten)]
    join: JoinArgs,
    /// Print only errors and the path of the file
    #[arg(long, short)]
    quiet: bool,
}

pub fn main(args: &SimulateArgs, lang: Lang) -> Result<u8, String> {
    place::print(&attempt(args, lang)?);
    Ok(exit::PASS)
}

fn attempt(args: &SimulateArgs, lang: Lang) -> Result<String, String> {
    let say = |note: &Note| place::error(note, lang);
    Format::of(&args.out).map_err(|e| say(e.note()))?;
    let like: Vec<PathBuf> = args.like.clone().into_iter().collect();
    args.join.check(&like, "join.help.other", lang)?;
    let mut read = files_read(&like, &ReadOptions::default());
    read.push(args.model.clone());
    read.extend(args.schedule.clone());
    if read.iter().any(|input| same(input, &args.out)) {
        let note = note!("simulate.onto_itself", path = args.out.display().to_string());
        return Err(say(&note));
    }
    let asked_s = args.duration.map(|d| d.seconds);
    if asked_s.is_some() && args.like.is_some() {
        return Err(say(&note!("simulate.both")));
    }
    if args.schedule.is_some() && (asked_s.is_some() || args.like.is_some()) {
        return Err(say(&note!("simulate.schedule_and")));
    }
    let mut model = load_model(&args.model).map_err(|problems| problems.say(lang))?;
    if let Some(path) = &args.schedule {
        let schedule = schedule::load(path).map_err(|problems| problems.say(lang))?;
        follow(&schedule, &mut model);
    }
    let mut progress = Progress::new(Display::unless(args.quiet), lang);
    let mut series = None;
    if let Some(path) = &args.like {
        let reading = note!("cli.reading").say(lang);
        let options = SeriesOptions {
            sample_rate_hz: Some(model.claim.sample_rate_hz),
            any_rate: true,
            ..SeriesOptions::default()
        };
        let read = load_series(std::slice::from_ref(path), &options, &mut |done, total| {
            progress.reading(&reading, done, total);
        });
        series = Some(read.map_err(|e| e.say(lang))?);
    }
    let seed = args.seed.or(model.simulation.seed).unwrap_or(DEFAULT_SEED);
    let over = match (&series, asked_s.or(model.simulation.duration_s)) {
        (Some(series), _) => Over::Like(series),
        (None, Some(duration_s)) => {
            Over::Duration { duration_s, start_s: model.simulation.start_s, drivers: &model.drivers }
        }
        (None, None) => return Err(say(&note!("simulate.no_duration"))),
    };
    let simulation =
        Simulation::begin(Order { claim: &model.claim, seed, over }).map_err(|e| say(e.note()))?;
    let writing = note!("simulate.writing").say(lang);
    let replaced = args.force && args.out.exists();
    let staged = StagedFile::begin(&args.out, &read, args.force).map_err(|e| say(&e.note()))?;
    let written = write(simulation, staged, &mut |done, total| {
        progress.update(&writing, Measure::Rows, done, total);
    });
    progress.finish();
    let written = written.map_err(|e| say(&e.note()))?;
    if replaced {
        let note = note!("output_file.replaces", path = args.out.display().to_string());
        place::eprint_diagnostic(&format!("{}\n", note.say(lang)));
    }
    if args.quiet {
        return Ok(format!("{}\n", place::shown(&args.out)));
    }
    Ok(summary(args, &model, series.as_ref(), &written, seed, lang))
}

/// Gives a model the length and the columns of a schedule. The noise of a sensor, and columns that the schedule does not
/// speak of, stay those of the model.
fn follow(schedule: &Schedule, model: &mut ModelFile) {
    let of = |column: Column| model.drivers.iter().find(|d| d.column == column);
    let noise = |column: Column| of(column).map_or(0.0, |d| d.noise);
    let mut drivers = schedule.profiles(model.simulation.start_s, noise);
    let kept = model.drivers.iter().filter(|d| !drivers.iter().any(|own| own.column == d.column));
    let kept: Vec<Profile> = kept.cloned().collect();
    drivers.extend(kept);
    model.drivers = drivers;
    model.simulation.duration_s = Some(schedule.duration_s());
}

/// True when both paths are one file.
fn same(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}

/// The recording that was made, in a few lines.
fn summary(
    args: &SimulateArgs,
    model: &ModelFile,
    series: Option<&Series>,
    written: &Written,
    seed: u64,
    lang: Lang,
) -> String {
    let mut lines = vec![
        note!(
            "simulate.written",
            path = args.out.display().to_string(),
            rows = written.rows,
            length = length(written.length_s),
            rate = Arg::rounded(model.claim.sample_rate_hz, 6),
            columns = written.columns.join(", ")
        ),
        note!("simulate.seed", seed),
    ];
    if !model.claim.effects.is_empty() {
        let kinds: Vec<&str> = model.claim.effects.iter().map(|e| e.effect.kind()).collect();
        lines.push(note!("simulate.effects", kinds = kinds.join(", ")));
    }
    let idle: Vec<&str> = model
        .claim
        .columns
        .iter()
        .flatten()
        .map(|c| c.name())
        .filter(|name| !written.columns.contains(name))
        .collect();
    if !idle.is_empty() {
        let key = if series.is_some() { "simulate.not_recorded" } else { "simulate.not_driven" };
        lines.push(Note::new(key).with("columns", idle.join(", ")));
    }
    if let Some(series) = series {
        let faults = &series.faults;
        if !model.drivers.is_empty() {
            lines.push(note!("simulate.drivers_idle"));
        }
        if faults.without_time + faults.without_rate > 0 {
            let left = note!("simulate.left_out", rows = faults.rows);
            lines.push(left.with("time", faults.without_time).with("rate", faults.without_rate));
        }
        if faults.missing > 0 {
            lines.push(note!("simulate.gaps", missing = faults.missing));
        }
        for (column, count) in &faults.interpolated {
            let note = note!("simulate.interpolated", column = column.name());
            lines.push(note.with("count", *count));
        }
    }
    lines.iter().map(|line| line.say(lang) + "\n").collect()
}

/// A length in the unit that reads best.
fn length(seconds: f64) -> Note {
    let (key, value) = match seconds {
        s if s >= 2.0 * 86_400.0 => ("simulate.length_d", s / 86_400.0),
        s if s >= 3600.0 => ("simulate.length_h", s / 3600.0),
        s if s >= 300.0 => ("simulate.length_min", s / 60.0),
        s => ("simulate.length_s", s),
    };
    Note::new(key).with("value", Arg::rounded(value, 6))
}
