//! `sagnac analyze`: the noise of a recording without a procedure.

use super::columns::{ColumnArgs, WarmUpArgs};
use super::evaluate::evaluate;
use super::job::{Frame, Job, Made, execute};
use super::join::JoinArgs;
use super::next_step;
use super::options::{GridArgs, OutputArgs};
use super::place::{self, OutputPlace};
use super::read::ReadArgs;
use crate::acceptance::Request;
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{channels, remarks};
use crate::config::procedure::EffectiveLimits;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::open_recording;
use crate::noise::tau_grid::TauGrid;
use crate::output::{Kind, StagedFolder};
use crate::record::UnitUnderTest;
use crate::report::Results;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct AnalyzeArgs {
    /// Recording: a file of any supported format, or a manifest; several files or a quoted pattern with --join
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    #[command(flatten)]
    join: JoinArgs,
    #[command(flatten)]
    columns: ColumnArgs,
    #[command(flatten)]
    start: WarmUpArgs,
    /// Output folder [default: named after the recording and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &AnalyzeArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |_| {
        args.join.check(&args.recording, "join.help.other", lang)?;
        let taus = args.grid.grid(lang)?;
        Ok(Analysis { args, taus })
    })
}

/// The analysis of a recording.
struct Analysis<'a> {
    args: &'a AnalyzeArgs,
    taus: Option<TauGrid>,
}

impl Job for Analysis<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let args = self.args;
        let stem = named(args).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let stem = stem.split('.').next().unwrap_or_default();
        let out = OutputPlace::new(args.out.as_deref(), "analysis", Some(stem), frame.now);
        let inputs = frame.inputs().recording_as_read(&args.recording, &args.read.options()).options(&(
            (
                &args.columns.rate,
                &args.columns.angle,
                &args.columns.unit,
                &args.columns.counter,
                &args.columns.time,
                (&args.columns.increment, args.columns.scale),
            ),
            (args.columns.sample_rate, args.start.warm_up.seconds, &args.grid, &args.read),
        ));
        inputs.begin(&out, Kind::Result, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let (args, lang) = (self.args, frame.lang);
        let say = |note: Note| place::error(&note, lang);
        let recording = open_recording(&args.recording, &args.read.options()).map_err(|e| e.say(lang))?;
        let (source, manifest) = (recording.source, recording.manifest);
        let choice = args.columns.choice(args.start.warm_up.seconds);
        let channels = channels(&choice, named(args), &source).map_err(say)?;
        for note in remarks(&choice, &channels, &source) {
            frame.warn(&note);
        }
        let prepared = Prepared::new(channels, &choice, named(args), &source).map_err(say)?;
        let limits = EffectiveLimits::default();
        let request = Request {
            unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
            taus: self.taus.clone(),
            exact: args.grid.exact,
            bench_checks: None,
            ..prepared.request(&source, &limits, frame.now)
        };
        let reading = note!("cli.reading").say(lang);
        Ok(evaluate(&request, None, &reading, &mut frame.progress).made(lang))
    }

    fn next_step(&self, _: &Results, _: &Path) -> Option<Note> {
        let options =
            [self.args.columns.as_typed(), self.args.start.as_typed(), self.args.read.as_typed()].concat();
        next_step::init(&self.args.recording, &options)
    }
}

/// The recording as it was named first.
fn named(args: &AnalyzeArgs) -> &Path {
    args.recording.first().map_or(Path::new(""), PathBuf::as_path)
}
