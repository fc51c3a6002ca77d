//! `sagnac analyze`: the noise of a recording without a procedure.

use super::columns::ColumnArgs;
use super::finish::run_and_finish;
use super::inputs::Inputs;
use super::join::JoinArgs;
use super::next_step;
use super::options::{GridArgs, OutputArgs};
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::read::ReadArgs;
use crate::acceptance::Request;
use crate::acceptance::analysis::Prepared;
use crate::acceptance::column_choice::{channels, unit_contradictions};
use crate::config::procedure::EffectiveLimits;
use crate::i18n::{Lang, Note};
use crate::ingest::open_recording;
use crate::moment;
use crate::output::Kind;
use crate::record::UnitUnderTest;
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
    let say = |note: Note| place::error(&note, lang);
    args.join.check(&args.recording, "join.help.other", lang)?;
    let taus = args.grid.grid(lang)?;
    if !(args.columns.warm_up >= 0.0 && args.columns.warm_up.is_finite()) {
        return Err(say(Note::new("cli.warm_up").with("given", args.columns.warm_up.to_string())));
    }
    let writer = args.output.writer(lang)?;
    let now = moment::now();
    let stem = named(args).file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = stem.split('.').next().unwrap_or_default().to_owned();
    let out = OutputPlace::new(args.out.as_deref(), "analysis", Some(&stem), now);
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = Inputs::new(args.output.force)
        .recording_as_read(&args.recording, &args.read.options())
        .options(&(
            (
                &args.columns.rate,
                &args.columns.angle,
                &args.columns.unit,
                &args.columns.counter,
                &args.columns.time,
            ),
            (args.columns.sample_rate, args.columns.warm_up, &args.grid, &args.read),
        ))
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Result, lang)?;
    let recording = open_recording(&args.recording, &args.read.options()).map_err(|e| e.say(lang))?;
    let (source, manifest) = (recording.source, recording.manifest);
    let choice = args.columns.choice();
    let channels = channels(&choice, named(args), &source).map_err(say)?;
    for note in unit_contradictions(&channels, &source) {
        progress.beside(|| place::eprint_diagnostic(&place::warning(&note, lang)));
    }
    let prepared = Prepared::new(channels, &choice, named(args), &source).map_err(say)?;
    let limits = EffectiveLimits::default();
    let request = Request {
        unit: UnitUnderTest { serial: manifest.and_then(|m| m.serial), ..UnitUnderTest::default() },
        taus,
        exact: args.grid.exact,
        ..prepared.request(&source, &limits, now)
    };
    let code = run_and_finish(&request, folder, &writer, printer, progress)?;
    let options = format!("{}{}", args.columns.as_typed(), args.read.as_typed());
    printer.next_step(next_step::init(&args.recording, &options).as_ref());
    Ok(code)
}

/// The recording as it was named first.
fn named(args: &AnalyzeArgs) -> &Path {
    args.recording.first().map_or(Path::new(""), PathBuf::as_path)
}
