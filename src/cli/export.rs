//! `sagnac export`: the parameters of a unit for an estimator, an autopilot or a simulator.

use super::{exit, place, stdout};
use crate::i18n::{Lang, note};
use crate::output::StagedFile;
use crate::record;
use crate::report::parameters::{self, Choices, TARGETS};
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Result: a result.json, or the folder that holds one
    result: PathBuf,
    /// Program that takes the parameters
    #[arg(long = "for", value_name = "PROGRAM", value_parser = PossibleValuesParser::new(TARGETS.iter().map(|t| t.id)))]
    target: String,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Channels of x, y and z, separated by commas [default: those of the result in their order]
    #[arg(long, value_name = "CHANNELS", value_delimiter = ',')]
    channels: Vec<String>,
    /// Rate in Hz at which the program steps its model [default: its own, or that of the recording]
    #[arg(long, value_name = "HZ")]
    step_rate: Option<f64>,
    /// Multiply all noise by the factor with which the deviation is nowhere understated
    #[arg(long)]
    inflate: bool,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    /// Print only errors and the path of the file
    #[arg(long, short)]
    quiet: bool,
}

pub fn main(args: &ExportArgs, lang: Lang) -> Result<u8, String> {
    if let Some(rate) = args.step_rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        return Err(place::error(&note!("export.step_rate", rate), lang));
    }
    let Some(target) = parameters::find(&args.target) else {
        return Err(place::error(&note!("export.no_target", target = args.target.as_str()), lang));
    };
    let file = if args.result.is_dir() { args.result.join("result.json") } else { args.result.clone() };
    let begin = |out: &Path| {
        let staged = StagedFile::begin(out, std::slice::from_ref(&file), args.force);
        staged.map_err(|e| place::error(&e.note(), lang))
    };
    let staged = args.out.as_deref().map(begin).transpose()?;
    let record = record::read::open(&file).map_err(|e| place::error(&e.note(&file), lang))?;
    let choices =
        Choices { channels: args.channels.clone(), step_rate_hz: args.step_rate, inflate: args.inflate };
    let exported = parameters::export(&record, target, &choices, lang);
    let exported = exported.map_err(|note| place::error(&note, lang))?;
    let Some(staged) = staged else {
        // The file as it is, with its tabs.
        stdout::write(exported.text.as_bytes());
        return Ok(exit::PASS);
    };
    let path = staged.publish_with(exported.text.as_bytes());
    let path = path.map_err(|e| place::error(&e.note(), lang))?;
    place::print(&format!("{}\n", place::shown(&path)));
    if !args.quiet {
        exported.head.iter().for_each(|line| place::print(&format!("{line}\n")));
    }
    Ok(exit::PASS)
}
