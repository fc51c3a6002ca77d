//! The pages and drawings of a folder against what its record gives when it is rendered anew.

use super::Finding;
use super::folder::Folder;
use crate::i18n::{Lang, Note};
use crate::report::export::{EXPORTERS, export};
use crate::report::signatures::shown;
use crate::report::{Renderer, StoredResults};
use std::fs;

/// Renders the results of a folder anew and compares byte by byte, with the templates given.
pub fn pages(folder: &Folder, renderer: &Renderer) -> Vec<Finding> {
    let renderer = &renderer.clone().with_signatures(shown(&folder.path));
    let stored = match StoredResults::open(&folder.path) {
        Ok(stored) => stored,
        Err(note) => return vec![Finding::Differs(note)],
    };
    // Another version may say the same in other words.
    let this = env!("CARGO_PKG_VERSION");
    if let Some(other) = stored.results.program_version().filter(|v| *v != this) {
        let note = Note::new("verify.other_version").with("written", other).with("this", this);
        return vec![Finding::Unchecked(note)];
    }
    if stored.lacks_figures() {
        return vec![Finding::Unchecked("verify.no_figures".into())];
    }
    let lang = language(folder);
    let whole = stored.results.whole(lang);
    let mut files = vec![];
    for (below, document) in std::iter::once((String::new(), whole)).chain(stored.results.parts(lang)) {
        let record = document.kind().record_file();
        match export(&document, EXPORTERS, renderer) {
            Ok(made) => {
                let before = if below.is_empty() { String::new() } else { format!("{below}/") };
                let all = made.into_iter().filter(|(name, _)| name != record);
                files.extend(all.map(|(name, bytes)| (format!("{before}{name}"), bytes)));
            }
            Err(e) => return vec![Finding::Differs(e.note())],
        }
    }
    let (mut same, mut findings) = (0_usize, vec![]);
    for (name, bytes) in files {
        // A form that was not chosen is not there.
        match fs::read(folder.path.join(&name)) {
            Ok(found) if found == bytes => same += 1,
            Ok(_) => findings.push(Finding::Differs(Note::new("verify.rendered_differs").with("name", name))),
            Err(_) => {}
        }
    }
    if findings.is_empty() {
        findings.push(Finding::Agrees(Note::new("verify.rendered").with("n", same)));
    }
    findings
}

/// The language in which the pages of a folder were made.
fn language(folder: &Folder) -> Lang {
    let stem = folder.kind.page_stem();
    let of_html = fs::read_to_string(folder.path.join(format!("{stem}.html"))).ok();
    let russian = of_html.is_some_and(|text| text.contains("<html lang=\"ru\""));
    if russian { Lang::Ru } else { Lang::En }
}
