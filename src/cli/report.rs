//! `sagnac report`: the report of a result anew, without its recording.

use super::finish::{write, write_files};
use super::inputs::Inputs;
use super::options::renderer;
use super::progress::{Display, Progress};
use super::{exit, place};
use crate::i18n::{Lang, Note};
use crate::output::{Kind, StagedFolder, StagedPart};
use crate::record::LotUnit;
use crate::report::export::{EXPORTERS, Exporter};
use crate::report::{Renderer, Results, StoredResults};
use chrono::Utc;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::{Component, Path, PathBuf};

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Result: a result.json, explain.json, comparison.json, index.json or plan.json, or the folder that holds one
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
    let out = place::OutputPlace::new(args.out.as_deref(), "report", stored.results.subject(), Utc::now());
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
    let mut progress = Progress::new(Display::unless(false), lang);
    progress.stage("progress.writing");
    if let Results::Lot(lot, _) = &stored.results {
        let from = if args.result.is_dir() { Some(args.result.as_path()) } else { args.result.parent() };
        for unit in &lot.units {
            let written =
                unit_anew(unit, from.unwrap_or(Path::new("")), &folder, &exporters, &renderer, lang);
            if let Some(note) = written? {
                progress.beside(|| place::eprint_diagnostic(&place::warning(&note, lang)));
            }
        }
    }
    let folder = write(&stored.results, folder, &exporters, &renderer, lang)?;
    drop(progress);
    place::print(&format!("{}\n", place::shown(&folder)));
    Ok(exit::PASS)
}

/// Writes the results of a unit of a lot into the folder of the lot; gives why not where they are not there any more.
fn unit_anew(
    unit: &LotUnit,
    lot: &Path,
    folder: &StagedFolder,
    exporters: &[&dyn Exporter],
    renderer: &Renderer,
    lang: Lang,
) -> Result<Option<Note>, String> {
    // A lot leads to no place outside its folder.
    let name = Path::new(&unit.folder);
    let plain =
        name.components().count() == 1 && name.components().all(|c| matches!(c, Component::Normal(_)));
    let at = lot.join(name);
    let missing = || Note::new("result_error.no_result_in").with("path", at.display().to_string());
    let stored = match StoredResults::open(&at) {
        _ if !plain => return Ok(Some(missing())),
        Ok(stored) if stored.results.kind() == Kind::Result => stored,
        Ok(_) => return Ok(Some(missing())),
        Err(note) => return Ok(Some(note)),
    };
    let part = StagedPart::begin(folder, &unit.folder, stored.inputs);
    let put = |name: &str, contents: &[u8]| part.write(name, contents);
    write_files(&stored.results, &put, exporters, renderer, lang)?;
    part.finish(stored.results.whole(lang).record()).map_err(|e| place::error(&e.note(), lang))?;
    Ok(None)
}
