//! `sagnac inspect`: what a recording holds.

use super::join::JoinArgs;
use super::progress::{Display, Progress};
use super::read::ReadArgs;
use super::{exit, next_step, place};
use crate::acceptance::inspect::inspect_source;
use crate::i18n::{Lang, Localize, note};
use crate::ingest::open_recording;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Recording: a file of any supported format, or a manifest; several files or a quoted pattern with --join
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    #[command(flatten)]
    join: JoinArgs,
    /// Sample rate, if the recording has no time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &InspectArgs, lang: Lang) -> Result<u8, String> {
    args.join.check(&args.recording, "join.help.other", lang)?;
    let mut progress = Progress::new(Display::unless(false), lang);
    let reading = note!("cli.reading").say(lang);
    let recording = open_recording(&args.recording, &args.read.options()).map_err(|e| e.say(lang))?;
    let report = inspect_source(&recording.source, args.sample_rate, lang, &mut |done, total| {
        progress.reading(&reading, done, total);
    });
    progress.finish();
    place::print(&report.map_err(|e| place::error(&e.note(), lang))?);
    if let Some(step) = next_step::after_inspection(&args.recording, &recording.source, &args.read.as_typed())
    {
        place::print(&format!("\n{}\n", step.say(lang)));
    }
    Ok(exit::PASS)
}
