//! The pages, drawings and tables of a folder against what its record gives when they are made anew.

use super::finding::Finding;
use super::folder::Folder;
use crate::acceptance::tables::{Follows, follows};
use crate::i18n::{Lang, Note, note};
use crate::output::{CHECKSUMS_FILE, Kind, NotRead, read_below};
use crate::record::read::MAX_BYTES;
use crate::report::export::{Docx, EXPORTERS, Exporter, FURTHER, Html, Markdown, export};
use crate::report::pdf::{MAKES_PDF, PdfPages};
use crate::report::signatures::{SIGNATURES_SHOWN, shown};
use crate::report::{Document, FIGURES_FILE, Renderer, StoredResults};
use std::collections::{BTreeMap, BTreeSet};

/// Names the files that only the recording gives.
pub(super) const FROM_RECORDING: &str = "verify.from_recording";

/// Files that were made anew, by their names in the folder.
type Made = BTreeMap<String, Vec<u8>>;

/// Makes the pages, drawings and tables of the results of a folder anew and compares byte by byte, with the templates given. What only
/// the recording could give is named.
pub fn pages(folder: &Folder, renderer: &Renderer) -> Vec<Finding> {
    let renderer = &renderer.clone().with_signatures(shown(&folder.path));
    let stored = match StoredResults::open(&folder.path) {
        Ok(stored) => stored,
        Err(note) => return vec![Finding::Differs(note)],
    };
    // Another version may say the same in other words.
    let this = env!("CARGO_PKG_VERSION");
    if let Some(other) = stored.results.program_version().filter(|v| *v != this) {
        let note = note!("verify.other_version", written = other, this);
        return vec![Finding::Undone(note)];
    }
    // Without pages and drawings, the data of figures are not needed.
    let shows_figures =
        |name: &String| [".html", ".md", ".svg", ".pdf", ".docx"].iter().any(|end| name.ends_with(end));
    if stored.lacks_figures() && stored.files.iter().any(shows_figures) {
        return vec![Finding::Undone("verify.no_figures".into())];
    }
    let compared = languages(folder).into_iter().map(|lang| compare(folder, &stored, renderer, lang));
    // Where no page tells its language, that in which less differs is its own.
    compared.min_by_key(|findings| findings.iter().filter(|f| f.differs()).count()).unwrap_or_default()
}

fn compare(folder: &Folder, stored: &StoredResults, renderer: &Renderer, lang: Lang) -> Vec<Finding> {
    let (mut made, mut findings, mut from_recording) = (Made::new(), vec![], BTreeSet::new());
    let whole = stored.results.whole(lang);
    for (below, document) in std::iter::once((String::new(), whole)).chain(stored.results.parts(lang)) {
        let below = if below.is_empty() { below } else { format!("{below}/") };
        let record = document.kind().record_file();
        let mut files = match export(&document, EXPORTERS, renderer) {
            Ok(files) => files,
            Err(e) => return vec![Finding::Differs(e.note())],
        };
        // Forms that are made on demand; of some results there are none.
        for exporter in FURTHER {
            files.extend(export(&document, &[*exporter], renderer).unwrap_or_default());
        }
        let others = files.into_iter().filter(|(name, _)| name != record);
        made.extend(others.map(|(name, bytes)| (format!("{below}{name}"), bytes)));
        if is_read_back(document.kind()) {
            from_recording.insert(format!("{below}{FIGURES_FILE}"));
            for (name, text) in document.tables.iter().filter(|(name, _)| !is_text(name)) {
                let follows = document.run().map_or(Follows::Unknown, |run| follows(name, text, run));
                let name = format!("{below}{name}");
                match follows {
                    Follows::Wholly => {}
                    Follows::Not => {
                        findings.push(Finding::Differs(note!("verify.rendered_differs", name)));
                    }
                    Follows::Partly | Follows::Unknown => {
                        from_recording.insert(name);
                    }
                }
            }
        }
        findings.extend(pdf(folder, &below, &document, renderer));
    }
    if let Ok(certificate) = stored.results.certificate(lang) {
        made.extend(certificates(folder, &certificate, renderer));
        findings.extend(pdf(folder, "", &certificate, renderer));
    }
    let (mut same, mut not_made) = (0_usize, vec![]);
    for (name, bytes) in &made {
        // A form that was not chosen is not there.
        match read_below(&folder.path, name, MAX_BYTES as u64) {
            Ok(found) if found != *bytes => {
                findings.push(Finding::Differs(note!("verify.rendered_differs", name = name.as_str())));
            }
            Ok(_) if from_recording.contains(name) => not_made.push(name.clone()),
            Ok(_) => same += 1,
            Err(_) => {}
        }
    }
    not_made.extend(further(folder, stored, &made));
    if !findings.iter().any(Finding::differs) {
        findings.insert(0, Finding::Agrees(note!("verify.rendered", n = same)));
    }
    if !not_made.is_empty() {
        let note = Note::new(FROM_RECORDING).with("names", not_made.join(", "));
        findings.push(Finding::Unchecked(note));
    }
    findings
}

/// The pages of a certificate of conformity that a folder has.
fn certificates(folder: &Folder, certificate: &Document<'_>, renderer: &Renderer) -> Made {
    let pages: [&dyn Exporter; 3] = [&Html, &Markdown, &Docx];
    let mut made = Made::new();
    for (exporter, ending) in pages.into_iter().zip(["html", "md", "docx"]) {
        let name = certificate.page(ending);
        if folder.path.join(&name).exists() {
            let files = export(certificate, &[exporter], renderer).unwrap_or_default();
            made.extend(files.into_iter().filter(|(made, _)| *made == name));
        }
    }
    made
}

/// True for results whose tables and figures are read back from their folder: their record alone does not give them.
fn is_read_back(kind: Kind) -> bool {
    matches!(kind, Kind::Result | Kind::Explanation | Kind::Joint | Kind::Proof)
}

/// True for the copies of procedure and limits, which the record names by their hashes.
fn is_text(name: &str) -> bool {
    matches!(name, crate::output::PROCEDURE_FILE | crate::output::LIMITS_FILE)
}

/// Files that the results list and that nothing here makes, such as a calibration certificate.
fn further(folder: &Folder, stored: &StoredResults, made: &Made) -> Vec<String> {
    let is_record = |name: &str| {
        let last = name.rsplit('/').next().unwrap_or(name);
        Kind::ALL.iter().any(|k| k.record_file() == last)
    };
    let is_aside = |name: &str| name == CHECKSUMS_FILE || name == SIGNATURES_SHOWN || name.ends_with(".pdf");
    let of_unit = |name: &str| folder.kind == Kind::Lot && name.contains('/');
    let others = stored
        .files
        .iter()
        .filter(|name| !made.contains_key(*name) && !is_record(name) && !is_aside(name) && !of_unit(name));
    others.cloned().collect()
}

/// The PDF of a document, if its folder has one.
fn pdf(folder: &Folder, below: &str, document: &Document<'_>, renderer: &Renderer) -> Option<Finding> {
    let name = format!("{below}{}", document.page("pdf"));
    let of = |key: &'static str| Note::new(key).with("name", name.as_str());
    let found = match read_below(&folder.path, &name, MAX_BYTES as u64) {
        Ok(found) => found,
        Err(NotRead::Missing) => return None,
        // Named where the hashes were computed.
        Err(_) => return Some(Finding::Undone(of("verify.pdf_not_made"))),
    };
    if !MAKES_PDF {
        return Some(Finding::Undone(of("verify.pdf_not_made")));
    }
    let record_name = format!("{below}{}", document.kind().record_file());
    let record = read_below(&folder.path, &record_name, MAX_BYTES as u64).ok()?;
    let is_it = |pages| document.pdf(renderer, &record, pages).is_ok_and(|made| made == found);
    let same = [PdfPages::All, PdfPages::Summary].into_iter().any(is_it);
    (!same).then(|| Finding::Differs(of("verify.rendered_differs")))
}

/// The language in which the pages of a folder were made; any where no page tells it.
pub(super) fn languages(folder: &Folder) -> Vec<Lang> {
    let page = format!("{}.html", folder.kind.page_stem());
    match read_below(&folder.path, &page, MAX_BYTES as u64).map(|b| String::from_utf8_lossy(&b).into_owned())
    {
        Ok(text) if text.contains("<html lang=\"ru\"") => vec![Lang::Ru],
        Ok(_) => vec![Lang::En],
        Err(_) => Lang::ALL.to_vec(),
    }
}
