//! `sagnac report`: the report of a result anew, without its recording.

use super::inputs::Inputs;
use super::options::FormArgs;
use super::printer::record;
use super::progress::{Display, Progress};
use super::writer::{Paper, Writer};
use super::{exit, place};
use crate::config::laboratory;
use crate::i18n::{Lang, Note, note};
use crate::moment;
use crate::output::{Kind, StagedFolder, StagedPart};
use crate::record::LotUnit;
use crate::report::export::{CERTIFICATE_FORM, Dcc};
use crate::report::signatures::{self, SIGNATURES_SHOWN, Signature};
use crate::report::{Record, StoredResults};
use crate::signing;
use crate::verify::{Folder, stated_hashes};
use clap::Args;
use std::path::{Component, Path, PathBuf};

#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Result: a result.json, explain.json, comparison.json, index.json or plan.json, or the folder that holds one
    result: PathBuf,
    /// Document to write; a certificate states the conformity of a unit that passed
    #[arg(long, value_name = "DOCUMENT", value_enum, default_value_t)]
    document: Paper,
    #[command(flatten)]
    forms: FormArgs,
    /// Laboratory, customer and persons, for the form dcc (laboratory.toml)
    #[arg(long, value_name = "FILE")]
    laboratory: Option<PathBuf>,
    /// Output folder [default: named after the unit and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace an existing result made from different inputs
    #[arg(long)]
    force: bool,
}

pub fn main(args: &ReportArgs, lang: Lang) -> Result<u8, String> {
    let signatures = signatures_of(&args.result);
    let writer = args.forms.writer(lang)?.with_signatures(signatures.clone()).of(args.document);
    let laboratory = args.laboratory.as_deref().map(laboratory::load).transpose().map_err(|p| p.say(lang))?;
    let writer =
        if args.forms.names(CERTIFICATE_FORM) { writer.with_certificate(Dcc { laboratory }) } else { writer };
    let stored = StoredResults::open(&args.result).map_err(|note| place::error(&note, lang))?;
    // Refused before anything is begun.
    writer.whole(&stored.results)?;
    let out = place::OutputPlace::new(args.out.as_deref(), "report", stored.results.subject(), moment::now());
    let folder = Inputs::new(args.force)
        .of_result(stored.inputs)
        .beside(Some(&args.result))
        .beside(args.forms.templates.as_deref())
        .begin(&out, stored.results.kind(), lang)?;
    for note in &stored.missing {
        place::eprint_diagnostic(&place::warning(note, lang));
    }
    let mut progress = Progress::new(Display::unless(false), lang);
    progress.stage("progress.writing");
    if let Record::Lot(lot) = stored.results.record().record() {
        let from = if args.result.is_dir() { Some(args.result.as_path()) } else { args.result.parent() };
        for unit in &lot.units {
            let written = unit_anew(unit, from.unwrap_or(Path::new("")), &folder, &writer, lang);
            if let Some(note) = written? {
                progress.beside(|| place::eprint_diagnostic(&place::warning(&note, lang)));
            }
        }
    }
    if !signatures.is_empty() {
        let shown = serde_json::to_vec_pretty(&signatures).unwrap_or_default();
        folder.write(SIGNATURES_SHOWN, &shown).map_err(|e| place::error(&e.note(), lang))?;
    }
    let folder = writer.publish(&stored.results, folder)?;
    drop(progress);
    if args.forms.only_record() {
        record(&folder, stored.results.kind(), lang)?;
    } else {
        place::print(&format!("{}\n", place::shown(&folder)));
    }
    Ok(exit::PASS)
}

/// The signatures of the folder that a result is in, as they are found; else those that its pages showed.
fn signatures_of(result: &Path) -> Vec<Signature> {
    let Ok(folder) = Folder::at(result) else { return vec![] };
    let files = signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys());
    let links = signing::chain(&folder.path, &files);
    if links.is_empty() { signatures::shown(&folder.path) } else { Signature::of_chain(&links) }
}

/// Writes the results of a unit of a lot into the folder of the lot; gives why not where they are not there any more.
fn unit_anew(
    unit: &LotUnit,
    lot: &Path,
    folder: &StagedFolder,
    writer: &Writer,
    lang: Lang,
) -> Result<Option<Note>, String> {
    // A lot leads to no place outside its folder.
    let name = Path::new(&unit.folder);
    let plain =
        name.components().count() == 1 && name.components().all(|c| matches!(c, Component::Normal(_)));
    let at = lot.join(name);
    let missing = || note!("result_error.no_result_in", path = at.display().to_string());
    let stored = match StoredResults::open(&at) {
        _ if !plain => return Ok(Some(missing())),
        Ok(stored) if stored.results.kind() == Kind::Result => stored,
        Ok(_) => return Ok(Some(missing())),
        Err(note) => return Ok(Some(note)),
    };
    let part = StagedPart::begin(folder, &unit.folder, stored.inputs);
    writer.files(&stored.results, &part)?;
    part.finish(stored.results.whole(lang).record()).map_err(|e| place::error(&e.note(), lang))?;
    Ok(None)
}
