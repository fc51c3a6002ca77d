//! A PDF on its own against the record that is attached to it.

use super::finding::Finding;
use super::verdict::verdict;
use crate::i18n::{Lang, note};
use crate::output::{Kind, is_plain};
use crate::record::{self, RunRecord};
use crate::report::pdf::{MAKES_PDF, PdfPages, attached};
use crate::report::signatures::shown;
use crate::report::{Renderer, StoredResults};
use std::fs;
use std::path::Path;

/// Typesets a PDF anew from what is attached to it and compares byte by byte. `scratch` is an empty folder for the attached files.
pub fn pdf(bytes: &[u8], scratch: &Path) -> Vec<Finding> {
    if !MAKES_PDF {
        return vec![Finding::Undone("pdf.none".into())];
    }
    let (language, files) = match attached(bytes) {
        Ok(found) => found,
        Err(reason) => {
            return vec![Finding::Differs(note!("verify.pdf_unreadable", reason))];
        }
    };
    for (name, contents) in files.iter().filter(|(name, _)| is_plain(name)) {
        let path = scratch.join(name);
        let written =
            path.parent().map(fs::create_dir_all).transpose().and_then(|_| fs::write(&path, contents));
        if written.is_err() {
            return vec![Finding::Undone("verify.no_scratch".into())];
        }
    }
    let record = Kind::ALL.iter().find_map(|k| files.get(k.record_file()));
    let (Some(record), Ok(stored)) = (record, StoredResults::open(scratch)) else {
        return vec![Finding::Differs("verify.pdf_without".into())];
    };
    let run: Option<RunRecord> = record::read::open(&scratch.join(Kind::Result.record_file())).ok();
    // The figures of phases stand in folders of their own, which no document has with it.
    if run.as_ref().is_some_and(|r| !r.phases.is_empty()) {
        return vec![Finding::Undone("verify.pdf_parts".into())];
    }
    let lang = Lang::from_code(&language).unwrap_or_default();
    let renderer = Renderer::new().with_signatures(shown(scratch));
    // The same record is attached to its report and to its certificate.
    let certificate = stored.results.certificate(lang).ok();
    let documents: Vec<_> = std::iter::once(stored.results.whole(lang)).chain(certificate).collect();
    // An update, such as a signature within the PDF, stands behind what was typeset, and can change what is shown.
    let appended = documents.iter().find_map(|document| {
        [PdfPages::All, PdfPages::Summary].into_iter().find_map(|pages| {
            let made = document.pdf(&renderer, record, pages).ok()?;
            bytes.strip_prefix(made.as_slice()).map(<[u8]>::len)
        })
    });
    let mut findings = vec![match appended {
        Some(0) => Finding::Agrees("verify.pdf".into()),
        Some(n) => Finding::Differs(note!("verify.pdf_appended", n)),
        None => Finding::Differs("verify.pdf_differs".into()),
    }];
    findings.extend(run.iter().flat_map(verdict));
    findings
}
