//! `sagnac pack`: everything that goes with a unit, in one archive.

use super::options::renderer;
use super::{exit, place};
use crate::acceptance::claimed;
use crate::config::model;
use crate::i18n::{Lang, LocalText, Localize, Note, note};
use crate::output::{
    CHECKSUMS_FILE, Kind, MAX_RECORD_BYTES, SIGNATURES_FOLDER, StagedFile, archive, checksums, found_below,
    read_below, sha256,
};
use crate::report::export::{Docx, Exporter, Html, export};
use crate::report::parameters::{self, Choices, TARGETS};
use crate::report::pdf::{MAKES_PDF, PdfPages};
use crate::report::signatures::Signature;
use crate::report::{Document, Record, Renderer, StoredResults};
use crate::signing;
use crate::verify::{Folder, hashes, stated_hashes};
use clap::Args;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct PackArgs {
    /// Result: the folder of a test, or its result.json
    result: PathBuf,
    /// Archive to write (ZIP) [default: named after the unit]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// Replace an existing file with different content
    #[arg(long)]
    force: bool,
    /// Print only errors and the path of the file
    #[arg(long, short)]
    quiet: bool,
}

/// Files of an archive, by their names in it.
type Files = BTreeMap<String, Vec<u8>>;

/// Folder of the archive with the folder of the result, byte for byte.
const RESULT: &str = "result";

pub fn main(args: &PackArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let stored = StoredResults::open(&args.result).map_err(say)?;
    let folder = Folder::at(&args.result).map_err(say)?;
    if folder.kind != Kind::Result {
        return Err(say(note!("pack.no_result", path = folder.path.display().to_string())));
    }
    let named = stored.results.subject().unwrap_or("pack");
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.zip", file_stem(named))));
    let staged = StagedFile::begin(&out, &[folder.record_file()], args.force).map_err(|e| say(e.note()))?;

    let mut files = of_folder(&folder).map_err(say)?;
    let chain = signing::chain(
        &folder.path,
        &signing::files_of(&folder.path, stated_hashes(&folder.path).into_keys()),
    );
    let renderer = renderer(args.templates.as_deref(), lang)?.with_signatures(Signature::of_chain(&chain));
    let record = files.get(&format!("{RESULT}/{}", Kind::Result.record_file())).cloned().unwrap_or_default();
    files.extend(pages(&stored.results.whole(lang), &record, &renderer).map_err(say)?);
    let mut left_out = vec![];
    match stored.results.certificate(lang) {
        Ok(certificate) => files.extend(pages(&certificate, &record, &renderer).map_err(say)?),
        Err(why) => left_out.push(("certificate".to_owned(), why)),
    }
    if let Record::Run(run) = stored.results.record().record() {
        let serial = LocalText::from(named);
        match claimed::claim(run, None) {
            Ok((claim, _)) => {
                let claim = crate::claim::Claim { description: serial, ..claim };
                files.insert("model.toml".to_owned(), model::write(&claim).into_bytes());
            }
            Err(why) => left_out.push(("model.toml".to_owned(), why)),
        }
        for target in TARGETS {
            match parameters::export(run, target, &Choices::default(), lang) {
                Ok(exported) => {
                    files.insert(format!("parameters/{}.txt", target.id), exported.text.into_bytes());
                }
                Err(why) => left_out.push((format!("parameters/{}.txt", target.id), why)),
            }
        }
    }
    let sums = files.iter().map(|(name, bytes)| (name.clone(), sha256(bytes))).collect();
    files.insert(CHECKSUMS_FILE.to_owned(), checksums(&sums).into_bytes());
    let bytes = archive(&files).map_err(|e| say(note!("system.other", reason = e.to_string())))?;
    let path = staged.publish_with(&bytes).map_err(|e| say(e.note()))?;

    place::print(&format!("{}\n", place::shown(&path)));
    if !args.quiet {
        place::print(&format!("{}\n", note!("pack.holds", n = files.len()).say(lang)));
        for (name, why) in left_out {
            place::print(&format!("{}\n", note!("pack.left_out", name, why).say(lang)));
        }
    }
    Ok(exit::PASS)
}

/// The name of a unit as the name of a file.
fn file_stem(named: &str) -> String {
    let kept = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '-' };
    named.chars().map(kept).collect()
}

/// The files of a folder and the signatures beside them; each as its hash says, or none.
fn of_folder(folder: &Folder) -> Result<Files, Note> {
    if let Some(finding) = hashes(folder, SIGNATURES_FOLDER).into_iter().find(|f| f.differs()) {
        let path = folder.path.display().to_string();
        return Err(note!("pack.changed", path, why = finding.note().clone()));
    }
    let unread = |name: &str| note!("pack.unread", name);
    let signatures = found_below(&folder.path).map_err(|_| unread(SIGNATURES_FOLDER))?;
    let signatures = signatures.into_iter().map(|(name, _)| name);
    let is_signature = |name: &String| name.split('/').next() == Some(SIGNATURES_FOLDER);
    let names = stated_hashes(&folder.path).into_keys().chain([CHECKSUMS_FILE.to_owned()]);
    names
        .chain(signatures.filter(is_signature))
        .map(|name| {
            let bytes = read_below(&folder.path, &name, MAX_RECORD_BYTES).map_err(|_| unread(&name))?;
            Ok((format!("{RESULT}/{name}"), bytes))
        })
        .collect()
}

/// The pages of a document: HTML, for word processors, and PDF where this build makes it.
fn pages(document: &Document<'_>, record: &[u8], renderer: &Renderer) -> Result<Files, Note> {
    let forms: [&dyn Exporter; 2] = [&Html, &Docx];
    let mut files = export(document, &forms, renderer).map_err(|e| e.note())?;
    // The drawings stand in the folder of the result.
    files.retain(|name, _| !name.contains('/'));
    if MAKES_PDF {
        let pdf = document.pdf(renderer, record, PdfPages::All).map_err(|e| e.note())?;
        files.insert(document.page("pdf"), pdf);
    }
    Ok(files)
}
