//! `sagnac inspect`: what a recording holds.

use super::progress::Progress;
use super::read::ReadArgs;
use super::{exit, next_step, place};
use crate::acceptance::inspect::inspect_source;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::open_recording;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    /// Sample rate, if the recording has no time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &InspectArgs, lang: Lang) -> Result<u8, String> {
    let mut progress = Progress::new();
    let reading = Note::new("cli.reading").say(lang);
    let recording = open_recording(&args.recording, &args.read.options()).map_err(|e| e.say(lang))?;
    let report = inspect_source(&recording.source, args.sample_rate, lang, &mut |done, total| {
        progress.update(&reading, done, total);
    });
    progress.finish();
    place::print(&report.map_err(|e| place::error(&e.note(), lang))?);
    if let Some(step) = next_step::after_inspection(&args.recording, &recording.source) {
        place::print(&format!("\n{}\n", step.say(lang)));
    }
    Ok(exit::PASS)
}
