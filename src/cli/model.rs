//! `sagnac model`: what a recording, or its result, shows, as a claim that others are held against.

use super::part::PartArgs;
use super::progress::{Display, Progress};
use super::read::ReadArgs;
use super::{exit, next_step, place};
use crate::acceptance::claimed;
use crate::claim::Claim;
use crate::config::model;
use crate::i18n::{Lang, LocalText, Localize, Note, note};
use crate::mismatch::{self, Options};
use crate::output::StagedFile;
use crate::record::{self, RunRecord};
use crate::series::{SeriesOptions, load_series};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct ModelArgs {
    /// Recording, or the result.json of one
    #[arg(value_name = "RECORDING")]
    from_what: PathBuf,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    part: PartArgs,
    /// Name of the case in the model
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// Rate column by name or position, or channel of a result [default: the only one]
    #[arg(long, value_name = "COLUMN")]
    rate: Option<String>,
    /// Unit of the rate column [default: from its name]
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Print only errors and the path of the file
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    read: ReadArgs,
}

pub fn main(args: &ModelArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let staged = StagedFile::begin(&args.out, std::slice::from_ref(&args.from_what), args.force)
        .map_err(|e| say(e.note()))?;
    let (mut claim, notes) = match result_of(&args.from_what) {
        Some(file) => of_result(args, &file, lang)?,
        None => (of_recording(args, lang)?, vec![]),
    };
    claim.case = args.case.clone().unwrap_or_default();
    let named = args.from_what.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    claim.description = LocalText::from(named);
    for note in notes {
        place::eprint_diagnostic(&place::warning(&note, lang));
    }
    staged.publish_with(model::write(&claim).as_bytes()).map_err(|e| say(e.note()))?;
    place::print(&format!("{}\n", place::shown(&args.out)));
    if !args.quiet {
        place::print(&format!("{}\n", next_step::after_model(&args.out).say(lang)));
    }
    Ok(exit::PASS)
}

/// The result file that a path stands for, where it stands for one.
fn result_of(path: &Path) -> Option<PathBuf> {
    let file = if path.is_dir() { path.join("result.json") } else { path.to_owned() };
    let is_record = file.extension().is_some_and(|e| e == "json");
    (is_record && file.is_file()).then_some(file)
}

fn of_result(args: &ModelArgs, file: &Path, lang: Lang) -> Result<(Claim, Vec<Note>), String> {
    let say = |note: Note| place::error(&note, lang);
    if !args.part.is_whole() {
        return Err(say("model_verb.part_of_result".into()));
    }
    let record: RunRecord = record::read::open(file).map_err(|e| say(e.note(file)))?;
    claimed::claim(&record, args.rate.as_deref()).map_err(say)
}

fn of_recording(args: &ModelArgs, lang: Lang) -> Result<Claim, String> {
    let say = |note: Note| place::error(&note, lang);
    let mut progress = Progress::new(Display::unless(args.quiet), lang);
    let options = SeriesOptions {
        read: args.read.options(),
        rate: args.rate.clone(),
        unit: args.unit.clone(),
        any_rate: false,
        channels: vec![],
        sample_rate_hz: args.sample_rate,
    };
    let reading = note!("cli.reading").say(lang);
    let series = load_series(std::slice::from_ref(&args.from_what), &options, &mut |done, total| {
        progress.reading(&reading, done, total);
    });
    let series = args.part.of(series.map_err(|e| e.say(lang))?).map_err(say)?;
    let claim = mismatch::identify(&series, &mut |p| progress.explaining(p));
    let claim = claim.and_then(|claim| {
        let found = mismatch::explain(series, &claim, &Options::default(), &mut |p| progress.explaining(p));
        let found = found?;
        Ok(claimed::with_lasting(claim, &found.augmented, found.skewness))
    });
    progress.finish();
    claim.map_err(say)
}
