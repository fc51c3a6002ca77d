//! `sagnac report`: the report of a result anew, without its recording.

use super::finish::write;
use super::inputs::Inputs;
use super::options::renderer;
use super::{exit, place};
use crate::i18n::Lang;
use crate::report::StoredResults;
use crate::report::export::{EXPORTERS, Exporter};
use chrono::Utc;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Result: a result.json, explain.json or comparison.json, or the folder that holds one
    result: PathBuf,
    /// Forms to write, separated by commas; result.json is always written [default: all]
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', value_parser = formats())]
    format: Vec<String>,
    /// Output folder [default: named after the unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
}

fn formats() -> PossibleValuesParser {
    PossibleValuesParser::new(EXPORTERS.iter().map(|e| e.id()))
}

pub fn main(args: &ReportArgs, lang: Lang) -> Result<u8, String> {
    let renderer = renderer(args.templates.as_deref(), lang)?;
    let stored = StoredResults::open(&args.result).map_err(|note| place::error(&note, lang))?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| place::default_folder("report", stored.results.subject(), Utc::now()));
    let folder = Inputs::new(args.force)
        .of_result(stored.inputs)
        .beside(Some(&args.result))
        .beside(args.templates.as_deref())
        .begin(&out, stored.results.kind(), lang)?;
    for note in &stored.missing {
        place::eprint_diagnostic(&place::warning(note, lang));
    }
    let chosen = |e: &&&dyn Exporter| args.format.is_empty() || args.format.iter().any(|f| f == e.id());
    let exporters: Vec<&dyn Exporter> = EXPORTERS.iter().filter(chosen).copied().collect();
    let folder = write(&stored.results, folder, &exporters, &renderer, lang)?;
    place::print(&format!("{}\n", place::shown(&folder)));
    Ok(exit::PASS)
}
