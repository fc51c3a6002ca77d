//! `sagnac compare`: Russian against Allan figures of any units, or the published tables.

use super::inputs::{self, Inputs};
use super::progress::Progress;
use super::{AnalyzeArgs, CompareArgs, GridArgs, analyze, exit, place, run};
use crate::acceptance::compare::published::checked;
use crate::acceptance::compare::{
    Comparison, Origin, Unit, csv, figures, not_compared, tell_apart, tell_repeated, units_of,
};
use crate::acceptance::run::{Request, analysis, execute};
use crate::config::procedure::limits::LimitSpec;
use crate::config::procedure::{EffectiveLimits, load_limits};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{RecordingError, each_of, open_recording};
use crate::output::{Kind, StagedFolder};
use crate::record::{RunKind, UnitUnderTest};
use crate::recording::Role;
use crate::report::compare::{CompareView, table};
use crate::report::{Renderer, svg};
use chrono::{DateTime, SecondsFormat, Utc};
use serde_json::Value;
use std::path::{Path, PathBuf};

pub fn main(args: &CompareArgs, lang: Lang) -> u8 {
    match attempt(args, lang) {
        Ok(()) => exit::PASS,
        Err(message) => {
            place::complain(&message);
            exit::ERROR
        }
    }
}

fn attempt(args: &CompareArgs, lang: Lang) -> Result<(), String> {
    let say = |note: Note| place::error(&note, lang);
    if !(args.warm_up >= 0.0 && args.warm_up.is_finite()) {
        return Err(say(Note::new("cli.warm_up").with("given", args.warm_up.to_string())));
    }
    if args.published && !args.recording.is_empty() {
        return Err(say("compare.error.published_alone".into()));
    }
    let renderer = run::renderer(args.templates.as_deref(), lang)?;
    let now = Utc::now();
    let stamp = now.to_rfc3339_opts(SecondsFormat::Secs, true);
    let first = args.recording.first().map_or_else(|| "published".to_owned(), |p| stem(p));
    let out = args.out.clone().unwrap_or_else(|| place::default_folder("comparison", Some(&first), now));
    let folder = Inputs::new(args.force)
        .recording(&read_for(&args.recording), &args.read.options())
        .file("limits", args.limits.as_deref())
        .options(&(
            (&args.rate, &args.angle, &args.unit, &args.counter, &args.time),
            (args.sample_rate, args.warm_up, args.published, &args.read),
        ))
        .beside(args.templates.as_deref())
        .begin(&out, Kind::Comparison, lang)?;
    if args.published {
        let checked = checked().ok_or_else(|| say("compare.error.tables".into()))?;
        let rows = csv::published(&checked);
        return finish(&Comparison::of_published(checked, stamp), &rows, &[], folder, &renderer, lang);
    }
    let limits = match args.limits.as_deref().map(load_limits).transpose() {
        Ok(file) => EffectiveLimits {
            set: file.map(|f| f.value.set).unwrap_or_default(),
            ..EffectiveLimits::default()
        },
        Err(problems) => return Err(problems.say(lang)),
    };
    let mut units: Vec<Unit> = vec![];
    for given in &args.recording {
        // Each file of a pattern is a unit; one recording in several files is a manifest.
        for path in each_of(given).map_err(|e| RecordingError::from(e).say(lang))? {
            units.extend(read(args, &path, &limits, now, lang)?);
        }
    }
    tell_apart(&mut units);
    tell_repeated(&mut units);
    let drawn = figures::all(&units);
    let rows = csv::units(&units);
    finish(&Comparison::of_units(units, stamp), &rows, &drawn, folder, &renderer, lang)
}

/// The name of a file or folder without its endings.
fn stem(path: &Path) -> String {
    let name = path.file_name().or_else(|| path.parent()?.file_name());
    let name = name.map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    if path.is_dir() {
        return name;
    }
    let packed = [".gz", ".zst", ".bz2", ".xz"];
    let name = packed.iter().find_map(|e| name.strip_suffix(e)).unwrap_or(&name);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}

/// The units of one argument: a result where it is one, else a recording that is analysed.
fn read(
    args: &CompareArgs,
    path: &Path,
    limits: &EffectiveLimits,
    now: DateTime<Utc>,
    lang: Lang,
) -> Result<Vec<Unit>, String> {
    let say = |note: Note| place::error(&note, lang);
    let shown = path.display().to_string();
    let mut otherwise = vec![];
    let (value, name, origin) = match result_file(path) {
        Some(file) => {
            let bytes = std::fs::read(&file).map_err(|e| {
                say(Note::new("compare.error.unreadable")
                    .with("path", file.display().to_string())
                    .with("reason", crate::i18n::io_reason(&e)))
            })?;
            let value: Value = serde_json::from_slice(&bytes).map_err(|e| {
                let key = if e.is_eof() { "compare.more.cut_short" } else { "compare.more.no_json" };
                say(Note::new(key)
                    .with("path", file.display().to_string())
                    .with("line", e.line() as u64)
                    .with("column", e.column() as u64))
            })?;
            // A result is named after its folder, for every one is called the same.
            let by = if file.file_name().is_some_and(|n| n == "result.json") {
                file.parent().filter(|p| p.file_name().is_some()).map_or_else(|| stem(&file), stem)
            } else {
                stem(&file)
            };
            (value, by, Origin::Result)
        }
        None if path.is_dir() => {
            return Err(say(Note::new("compare.more.no_result_in").with("path", shown)));
        }
        None => {
            let analysed = analysed(args, path, limits, now, lang)?;
            otherwise = analysed.otherwise;
            (analysed.result, analysed.name, Origin::Recording)
        }
    };
    let mut units = units_of(&value, &shown, &name, origin).map_err(|e| say(e.0))?;
    if origin == Origin::Recording {
        for unit in &mut units {
            let of_unit = |l: &&LimitSpec| l.channel.as_ref().is_none_or(|c| *c == unit.channel);
            let ids = limits.set.limits.iter().filter(of_unit).map(|l| l.measurand.id);
            unit.missing.extend(not_compared(ids));
            unit.missing.extend(otherwise.iter().cloned());
        }
    }
    Ok(units)
}

/// The files that are read for the units: that of a result in place of its folder.
fn read_for(named: &[PathBuf]) -> Vec<PathBuf> {
    let each = named.iter().flat_map(|p| each_of(p).unwrap_or_else(|_| vec![p.clone()]));
    each.map(|p| result_file(&p).unwrap_or(p)).collect()
}

/// The result that a path stands for.
fn result_file(path: &Path) -> Option<PathBuf> {
    let inside = path.join("result.json");
    if path.is_dir() {
        return inside.is_file().then_some(inside);
    }
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")).then(|| path.to_owned())
}

/// A recording that was analysed.
struct Analysed {
    /// The result, as `analyze` makes it.
    result: Value,
    /// Name of the unit.
    name: String,
    /// Columns that were read in another unit than their names state.
    otherwise: Vec<Note>,
}

fn analysed(
    args: &CompareArgs,
    path: &Path,
    limits: &EffectiveLimits,
    now: DateTime<Utc>,
    lang: Lang,
) -> Result<Analysed, String> {
    let say = |note: Note| place::error(&note, lang);
    let as_analyze = AnalyzeArgs {
        recording: vec![path.to_owned()],
        rate: args.rate.clone(),
        angle: args.angle.clone(),
        unit: args.unit.clone(),
        counter: args.counter.clone(),
        time: args.time.clone(),
        sample_rate: args.sample_rate,
        warm_up: args.warm_up,
        out: None,
        force: false,
        templates: None,
        grid: GridArgs { taus: None, exact: false },
        read: args.read.clone(),
    };
    let recording = open_recording(&as_analyze.recording, &args.read.options()).map_err(|e| e.say(lang))?;
    let (source, manifest) = (recording.source, recording.manifest);
    let channels = analyze::channels(&as_analyze, &source).map_err(say)?;
    let otherwise = analyze::named_otherwise(&channels, &source);
    let use_stamps = channels.iter().any(|c| c.role == Role::Time);
    let stated = source.stated_sample_rate_hz().filter(|_| !use_stamps);
    let sample_rate = args.sample_rate.or(stated);
    if !use_stamps && sample_rate.is_none() {
        return Err(say(Note::new("cli.no_time").with("path", path.display().to_string())));
    }
    let procedure = analysis::procedure(channels, sample_rate, args.warm_up);
    let request = Request {
        kind: RunKind::Analyze,
        procedure: &procedure,
        procedure_record: None,
        limits,
        source: &source,
        use_stamps,
        unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
        operator: None,
        station: None,
        now,
        taus: None,
        exact: false,
    };
    let mut progress = Progress::new();
    let reading = Note::new("cli.reading").say(lang);
    let outcome = execute(&request, &mut |done, total| progress.update(&reading, done, total));
    progress.finish();
    let outcome = outcome.map_err(|e| say(e.note()))?;
    let result = serde_json::to_value(&outcome.record)
        .map_err(|e| say(Note::new("system.other").with("reason", e.to_string())))?;
    Ok(Analysed { result, name: stem(path), otherwise })
}

/// Writes the folder and prints the table.
fn finish(
    comparison: &Comparison,
    rows: &str,
    figures: &[Figure],
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<(), String> {
    let say = |note: Note| place::error(&note, lang);
    let view = CompareView::new(comparison, figures, lang);
    let html = renderer.render_view("compare.html", &view, lang).map_err(|e| say(e.note()))?;
    let markdown = renderer.render_view("compare.md", &view, lang).map_err(|e| say(e.note()))?;
    let write = |name: &str, bytes: &[u8]| folder.write(name, bytes).map_err(|e| say(e.note()));
    write("comparison.html", html.as_bytes())?;
    write("comparison.md", markdown.as_bytes())?;
    write("comparison.csv", rows.as_bytes())?;
    for figure in figures {
        write(&format!("figures/{}.svg", figure.id), svg::render(figure, lang).as_bytes())?;
    }
    let folder = inputs::publish(folder, comparison, lang)?;
    place::print(&format!("{}{}\n", table(&view, lang), place::shown(&folder.join("comparison.html"))));
    Ok(())
}
