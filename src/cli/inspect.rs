//! `sagnac inspect`: what a recording holds.

use super::columns::ColumnArgs;
use super::join::JoinArgs;
use super::progress::{Display, Progress};
use super::read::ReadArgs;
use super::{exit, next_step, place};
use crate::acceptance::inspect::inspect_columns;
use crate::i18n::{Lang, Localize, note};
use crate::ingest::{RowMatch, open_recording};
use crate::recording::ColumnRef;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// Recording: a file of any supported format, or a manifest; several files or a quoted pattern with --join
    #[arg(required = true)]
    recording: Vec<PathBuf>,
    #[command(flatten)]
    join: JoinArgs,
    #[command(flatten)]
    columns: ColumnArgs,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &InspectArgs, lang: Lang) -> Result<u8, String> {
    args.join.check(&args.recording, "join.help.other", lang)?;
    let mut progress = Progress::new(Display::unless(false), lang);
    let reading = note!("cli.reading").say(lang);
    let mut options = args.read.options();
    let mut recording = open_recording(&args.recording, &options).map_err(|e| e.say(lang))?;
    // Of several sensors in one table, the first is shown.
    let sensors = recording.source.sensors().cloned();
    if let Some((column, value)) = sensors.as_ref().and_then(|s| Some((&s.column, s.values.first()?))) {
        options.only = Some(RowMatch { column: ColumnRef::Name(column.clone()), value: value.clone() });
        recording = open_recording(&args.recording, &options).map_err(|e| e.say(lang))?;
    }
    let report = inspect_columns(&recording.source, &args.columns.choice(0.0), lang, &mut |done, total| {
        progress.reading(&reading, done, total);
    });
    progress.finish();
    if let Some(sensors) = &sensors {
        let note = note!("inspect.sensors", what = sensors.note(), options = sensors.hint());
        place::print(&format!("{}\n\n", note.say(lang)));
    }
    place::print(&report.map_err(|e| place::error(&e.note(), lang))?);
    let typed = format!("{}{}", args.columns.as_typed(), args.read.as_typed());
    if let Some(step) = next_step::after_inspection(&args.recording, &recording.source, &typed) {
        place::print(&format!("\n{}\n", step.say(lang)));
    }
    Ok(exit::PASS)
}
