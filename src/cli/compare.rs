//! `sagnac compare`: Russian against Allan figures of any units, or the published tables.

use super::columns::ColumnArgs;
use super::finish::with_progress;
use super::inputs::Inputs;
use super::options::OutputArgs;
use super::printer::Printer;
use super::progress::Progress;
use super::read::ReadArgs;
use super::writer::Writer;
use super::{exit, place};
use crate::acceptance::Request;
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{channels, unit_contradictions};
use crate::acceptance::compare::published_checks::checked;
use crate::acceptance::compare::{
    Comparison, Origin, Unit, mark_repeated, name_apart, not_compared, units_of,
};
use crate::config::procedure::limits::LimitSpec;
use crate::config::procedure::{EffectiveLimits, load_limits};
use crate::i18n::{Lang, Localize, Note, visible_lines};
use crate::ingest::{RecordingError, each_of, open_recording};
use crate::moment;
use crate::output::{Kind, StagedFolder};
use crate::record::{RunRecord, UnitUnderTest, read};
use crate::report::Results;
use crate::report::compare::{CompareView, table};
use chrono::{DateTime, SecondsFormat, Utc};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Units: one recording each, in any supported format; or a result.json, or its folder
    #[arg(required_unless_present = "published")]
    recording: Vec<PathBuf>,
    /// Check the published tables of Russian and Allan figures
    #[arg(long)]
    published: bool,
    #[command(flatten)]
    columns: ColumnArgs,
    /// Limits file: each limit applies to the figure it names; a result keeps its own limits
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Output folder [default: named after the first unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &CompareArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    if !(args.columns.warm_up >= 0.0 && args.columns.warm_up.is_finite()) {
        return Err(say(Note::new("cli.warm_up").with("given", args.columns.warm_up.to_string())));
    }
    if args.published && !args.recording.is_empty() {
        return Err(say("compare.error.published_alone".into()));
    }
    let writer = args.output.writer(lang)?;
    let printer = Printer::new(&args.output, lang);
    let now = moment::now();
    let stamp = now.to_rfc3339_opts(SecondsFormat::Secs, true);
    let first = args.recording.first().map_or_else(|| "published".to_owned(), |p| stem(p));
    let out = place::OutputPlace::new(args.out.as_deref(), "comparison", Some(&first), now);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = Inputs::new(args.output.force)
        .recording(&read_for(&args.recording), &args.read.options())
        .file("limits", args.limits.as_deref())
        .options(&(
            (
                &args.columns.rate,
                &args.columns.angle,
                &args.columns.unit,
                &args.columns.counter,
                &args.columns.time,
            ),
            (args.columns.sample_rate, args.columns.warm_up, args.published, &args.read),
        ))
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Comparison, lang)?;
    if args.published {
        let checked = checked().ok_or_else(|| say("compare.error.tables".into()))?;
        return finish(Comparison::of_published(checked, stamp), folder, &writer, printer);
    }
    let limits = match args.limits.as_deref().map(load_limits).transpose() {
        Ok(file) => EffectiveLimits {
            set: file.map(|f| f.value.set).unwrap_or_default(),
            ..EffectiveLimits::default()
        },
        Err(problems) => return Err(problems.say(lang)),
    };
    // Each file of a pattern is a unit; one recording in several files is a manifest.
    let mut paths: Vec<PathBuf> = vec![];
    for given in &args.recording {
        paths.extend(each_of(given).map_err(|e| RecordingError::from(e).say(lang))?);
    }
    let mut units: Vec<Unit> = vec![];
    for (i, path) in paths.iter().enumerate() {
        let label = Note::new("progress.of_unit").with("n", i + 1).with("all", paths.len()).say(lang);
        units.extend(read_units(args, path, &limits, now, (&label, &mut progress))?);
    }
    drop(progress);
    name_apart(&mut units);
    mark_repeated(&mut units);
    finish(Comparison::of_units(units, stamp), folder, &writer, printer)
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
fn read_units(
    args: &CompareArgs,
    path: &Path,
    limits: &EffectiveLimits,
    now: DateTime<Utc>,
    watch: (&str, &mut Progress),
) -> Result<Vec<Unit>, String> {
    let lang = watch.1.lang();
    let say = |note: Note| place::error(&note, lang);
    let shown = path.display().to_string();
    let mut otherwise = vec![];
    let (record, name, origin) = match result_file(path) {
        Some(file) => {
            let record = read::open(&file).map_err(|e| say(e.note(&file)))?;
            // A result is named after its folder, for every one is called the same.
            let by = if file.file_name().is_some_and(|n| n == "result.json") {
                file.parent().filter(|p| p.file_name().is_some()).map_or_else(|| stem(&file), stem)
            } else {
                stem(&file)
            };
            (record, by, Origin::Result)
        }
        None if path.is_dir() => {
            return Err(say(Note::new("result_error.no_result_in").with("path", shown)));
        }
        None => {
            let analysed = analysed(args, path, limits, now, watch)?;
            otherwise = analysed.otherwise;
            (analysed.record, analysed.name, Origin::Recording)
        }
    };
    let mut units = units_of(&record, &shown, &name, origin).map_err(say)?;
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
    record: RunRecord,
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
    (label, progress): (&str, &mut Progress),
) -> Result<Analysed, String> {
    let lang = progress.lang();
    let say = |note: Note| place::error(&note, lang);
    let recording = open_recording(&[path.to_owned()], &args.read.options()).map_err(|e| e.say(lang))?;
    let (source, manifest) = (recording.source, recording.manifest);
    let choice = args.columns.choice();
    let channels = channels(&choice, path, &source).map_err(say)?;
    let otherwise = unit_contradictions(&channels, &source);
    let prepared = Prepared::new(channels, &choice, path, &source).map_err(say)?;
    let request = Request {
        unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
        ..prepared.request(&source, limits, now)
    };
    let outcome = with_progress(&request, label, progress).map_err(|e| say(e.note()))?;
    Ok(Analysed { record: outcome.record, name: stem(path), otherwise })
}

/// Writes the folder and prints the table.
fn finish(
    comparison: Comparison,
    folder: StagedFolder,
    writer: &Writer,
    printer: Printer,
) -> Result<u8, String> {
    let lang = printer.lang;
    let table = table(&CompareView::new(&comparison, &[], lang), lang);
    let folder = writer.publish(&Results::of_comparison(comparison), folder)?;
    printer.outcome(&folder, Kind::Comparison, |_| visible_lines(&table).into_owned())?;
    Ok(exit::PASS)
}
