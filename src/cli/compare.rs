//! `sagnac compare`: Russian against Allan figures of any units, or the published tables; two results of one unit against each other.

use super::columns::{ColumnArgs, WarmUpArgs};
use super::compare_laboratories::laboratories;
use super::evaluate::with_progress;
use super::job::{Frame, Job, Made, execute};
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use super::progress::Progress;
use super::read::ReadArgs;
use crate::acceptance::Request;
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{channels, remarks};
use crate::acceptance::compare::published_checks::checked;
use crate::acceptance::compare::{
    Comparison, Origin, Unit, mark_repeated, name_apart, not_compared, units_of,
};
use crate::config::procedure::limits::LimitSpec;
use crate::config::procedure::{EffectiveLimits, load_limits};
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::{RecordingError, each_of, open_recording};
use crate::output::{Kind, StagedFolder};
use crate::record::{RunRecord, UnitUnderTest, read};
use crate::report::Results;
use chrono::{DateTime, Utc};
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
    #[command(flatten)]
    start: WarmUpArgs,
    /// Limits file: each limit applies to the figure it names; a result keeps its own limits
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Of two results of one unit: their recordings, in the same order, which are evaluated under both procedures [default: the
    /// files that the results name]
    #[arg(long, value_name = "FILE")]
    data: Vec<PathBuf>,
    /// Output folder [default: named after the first unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &CompareArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |_| {
        if args.published && !args.recording.is_empty() {
            return Err(place::error(&"compare.error.published_alone".into(), lang));
        }
        Ok(args)
    })
}

impl Job for &CompareArgs {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let first = self.recording.first().map_or_else(|| "published".to_owned(), |p| stem(p));
        let out = OutputPlace::new(self.out.as_deref(), "comparison", Some(&first), frame.now);
        let mut read = read_for(&self.recording);
        read.extend(self.data.iter().cloned());
        let inputs = frame.inputs().recording(&read, &self.read.options());
        let inputs = inputs.file("limits", self.limits.as_deref()).options(&(
            (
                &self.columns.rate,
                &self.columns.angle,
                &self.columns.unit,
                &self.columns.counter,
                &self.columns.time,
                (&self.columns.increment, self.columns.scale),
            ),
            (self.columns.sample_rate, self.start.warm_up.seconds, self.published, &self.read),
        ));
        inputs.begin(&out, Kind::Comparison, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let (lang, now, stamp) = (frame.lang, frame.now, frame.stamp());
        if self.published {
            let checked = checked().ok_or_else(|| place::error(&"compare.error.tables".into(), lang))?;
            return Ok(Results::of_comparison(Comparison::of_published(checked, stamp)).into());
        }
        let limits = match self.limits.as_deref().map(load_limits).transpose() {
            Ok(file) => EffectiveLimits {
                set: file.map(|f| f.value.set).unwrap_or_default(),
                ..EffectiveLimits::default()
            },
            Err(problems) => return Err(problems.say(lang)),
        };
        // Each file of a pattern is a unit; one recording in several files is a manifest.
        let mut paths: Vec<PathBuf> = vec![];
        for given in &self.recording {
            paths.extend(each_of(given).map_err(|e| RecordingError::from(e).say(lang))?);
        }
        let files: Vec<Option<PathBuf>> = paths.iter().map(|path| result_file(path)).collect();
        let laboratories = laboratories(&self.data, &files, frame)?;
        let mut units: Vec<Unit> = vec![];
        for (i, path) in paths.iter().enumerate() {
            let label = note!("progress.of_unit", n = i + 1, all = paths.len()).say(lang);
            match read_units(self, path, &limits, now, (&label, &mut frame.progress)) {
                // Two results of one unit need have no Russian or Allan figures.
                Err(_) if laboratories.is_some() => {}
                found => units.extend(found?),
            }
        }
        name_apart(&mut units);
        mark_repeated(&mut units);
        let comparison = Comparison { laboratories, ..Comparison::of_units(units, stamp) };
        Ok(Results::of_comparison(comparison).into())
    }
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
            return Err(say(note!("result_error.no_result_in", path = shown)));
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
    let choice = args.columns.choice(args.start.warm_up.seconds);
    let channels = channels(&choice, path, &source).map_err(say)?;
    let otherwise = remarks(&choice, &channels, &source);
    let prepared = Prepared::new(channels, &choice, path, &source).map_err(say)?;
    let request = Request {
        unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
        ..prepared.request(&source, limits, now)
    };
    let outcome = with_progress(&request, label, progress).map_err(|e| say(e.note()))?;
    Ok(Analysed { record: outcome.record, name: stem(path), otherwise })
}
