//! A document as PDF, with the record that it shows and what the record was made from attached.

use super::figure_file::{self, FIGURES_FILE};
use super::history;
use super::signatures::SIGNATURES_SHOWN;
#[cfg(feature = "pdf")]
use super::translator::Translator;
use super::{Document, PageForm, Renderer, ReportError, file_name, svg};
use crate::acceptance::history::figures;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::output::{LIMITS_FILE, PROCEDURE_FILE};
use crate::record::HistoryRecord;
use std::collections::BTreeMap;

/// Whether this build makes PDF.
pub const MAKES_PDF: bool = cfg!(feature = "pdf");

/// Which pages of a PDF are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PdfPages {
    /// All.
    #[default]
    All,
    /// The summary alone.
    Summary,
}

/// A page of Markdown that becomes a PDF, and what goes with it.
pub struct Page<'a> {
    /// What the document is of, such as a serial number.
    pub subject: &'a str,
    /// When its record was made, RFC 3339.
    pub made_at: &'a str,
    /// The text.
    pub markdown: &'a str,
    /// Its drawings by the names that the text has for them.
    pub drawings: BTreeMap<String, Vec<u8>>,
    /// The record that it shows: name and bytes.
    pub record: (&'a str, &'a [u8]),
    /// What the record was made from: names and texts.
    pub sources: Vec<(&'a str, &'a str)>,
    /// What the page shows beside the record: names and texts. With it the page can be made anew.
    pub data: Vec<(&'a str, &'a str)>,
    /// Pages.
    pub pages: PdfPages,
}

impl Document<'_> {
    /// The document as PDF. `record` are the bytes of its record as they stand in its folder: their hash is on every page.
    ///
    /// # Errors
    /// [`ReportError::NoPdf`] in a build that makes none, [`ReportError::Pdf`] for what cannot be typeset, and a template that is
    /// wrong.
    pub fn pdf(&self, renderer: &Renderer, record: &[u8], pages: PdfPages) -> Result<Vec<u8>, ReportError> {
        if !MAKES_PDF {
            return Err(ReportError::NoPdf);
        }
        let markdown = self.text(PageForm::Paper, renderer)?;
        let figures = match self.own_figures() {
            [] => String::new(),
            own => figure_file::text(own).map_err(ReportError::Json)?,
        };
        let shown = renderer.signatures_text();
        let source = |(name, text): &'_ &(String, String)| {
            matches!(name.as_str(), PROCEDURE_FILE | LIMITS_FILE) && !text.is_empty()
        };
        // In the order of their names: a run has them in another order than a folder.
        let mut sources: Vec<(&str, &str)> =
            self.tables.iter().filter(source).map(|(n, t)| (n.as_str(), t.as_str())).collect();
        sources.sort_unstable();
        let page = Page {
            subject: self.subject(),
            made_at: self.made_at(),
            markdown: &markdown,
            drawings: self.figures.iter().map(|f| drawing(f, self.lang)).collect(),
            record: (self.kind().record_file(), record),
            sources,
            data: [(FIGURES_FILE, figures.as_str()), (SIGNATURES_SHOWN, shown.as_str())]
                .into_iter()
                .filter(|(_, text)| !text.is_empty())
                .collect(),
            pages,
        };
        typeset(&page, self.lang)
    }
}

/// The PDF of a history. `json` is the text that `--format json` prints.
///
/// # Errors
/// As [`Document::pdf`].
pub fn of_history(
    record: &HistoryRecord,
    json: &str,
    renderer: &Renderer,
    pages: PdfPages,
    lang: Lang,
) -> Result<Vec<u8>, ReportError> {
    if !MAKES_PDF {
        return Err(ReportError::NoPdf);
    }
    let figures = figures::all(record);
    let shown = history::page(record, &figures, lang);
    let page = Page {
        subject: "",
        // What is told depends on the store alone: the page is as old as the latest result in it.
        made_at: record.results.iter().map(|r| r.evaluated_at.as_str()).max().unwrap_or_default(),
        markdown: &PageForm::Paper.page(&shown, renderer, lang)?,
        drawings: figures.iter().map(|f| drawing(f, lang)).collect(),
        record: ("history.json", json.as_bytes()),
        sources: vec![],
        data: vec![],
        pages,
    };
    typeset(&page, lang)
}

/// A drawing by the name that a page has for it.
fn drawing(figure: &Figure, lang: Lang) -> (String, Vec<u8>) {
    (format!("figures/{}", file_name(&figure.id)), svg::render(figure, lang).into_bytes())
}

/// Typesets a page.
///
/// # Errors
/// As [`Document::pdf`].
#[cfg(feature = "pdf")]
pub fn typeset(page: &Page<'_>, lang: Lang) -> Result<Vec<u8>, ReportError> {
    use crate::output::sha256;
    use sagnac_pdf::{Attachment, Pages, Paper, Relation};

    let words = Translator { lang };
    let media_type =
        |name: &str| if name.ends_with(".json") { "application/json" } else { "application/toml" };
    let (record_name, record) = page.record;
    let description = words.t("pdf.record");
    let mut attachments = vec![Attachment {
        name: record_name,
        bytes: record,
        media_type: media_type(record_name),
        description: &description,
        relation: Relation::Data,
    }];
    let descriptions = [words.t("pdf.procedure"), words.t("pdf.limits")];
    attachments.extend(page.sources.iter().map(|(name, text)| Attachment {
        name,
        bytes: text.as_bytes(),
        media_type: media_type(name),
        description: &descriptions[usize::from(*name == LIMITS_FILE)],
        relation: Relation::Source,
    }));
    let shown = words.t("pdf.data");
    attachments.extend(page.data.iter().map(|(name, text)| Attachment {
        name,
        bytes: text.as_bytes(),
        media_type: media_type(name),
        description: &shown,
        relation: Relation::Data,
    }));
    let digest = sha256(record);
    let foot = words.with("pdf.foot", &[("file", record_name), ("hash", &digest[..DIGITS])]);
    let number = words.t("pdf.page");
    let paper = Paper {
        language: lang.code(),
        subject: page.subject,
        foot: &foot,
        page_number: &number,
        made_at: moment(page.made_at),
        markdown: page.markdown,
        drawings: &page.drawings,
        attachments: &attachments,
        marks: &marks(words),
        pages: match page.pages {
            PdfPages::All => Pages::All,
            PdfPages::Summary => Pages::Summary,
        },
    };
    sagnac_pdf::typeset(&paper).map_err(|e| ReportError::Pdf(e.to_string()))
}

/// The language of a PDF and the files that are attached to it, by their names.
///
/// # Errors
/// What is wrong with the PDF, in the words of the library; in a build that makes none, that.
pub fn attached(bytes: &[u8]) -> Result<(String, BTreeMap<String, Vec<u8>>), String> {
    #[cfg(feature = "pdf")]
    return sagnac_pdf::attached(bytes).map_err(|e| e.to_string());
    #[cfg(not(feature = "pdf"))]
    Err(format!("{} bytes: {}", bytes.len(), ReportError::NoPdf))
}

/// A build without the crate that typesets makes no page.
///
/// # Errors
/// Always [`ReportError::NoPdf`].
#[cfg(not(feature = "pdf"))]
pub fn typeset(_: &Page<'_>, _: Lang) -> Result<Vec<u8>, ReportError> {
    Err(ReportError::NoPdf)
}

/// Digits of the hash of the record on every page.
#[cfg(feature = "pdf")]
const DIGITS: usize = 16;

/// A moment of a record; the first of 1970 where it states none.
#[cfg(feature = "pdf")]
fn moment(stamp: &str) -> sagnac_pdf::Moment {
    use chrono::{DateTime, Datelike, Timelike};
    let at = DateTime::parse_from_rfc3339(stamp).map(|t| t.to_utc()).unwrap_or_default();
    // Each is far within the range of a byte.
    let byte = |n: u32| u8::try_from(n).unwrap_or_default();
    sagnac_pdf::Moment {
        year: at.year(),
        month: byte(at.month()),
        day: byte(at.day()),
        time: [byte(at.hour()), byte(at.minute()), byte(at.second())],
    }
}

/// Words of verdicts and states, and how they are coloured.
#[cfg(feature = "pdf")]
fn marks(words: Translator) -> Vec<(String, sagnac_pdf::Mark)> {
    use sagnac_pdf::Mark;
    let known = [
        ("verdict.pass", Mark::Good),
        ("verdict.fail", Mark::Bad),
        ("verdict.error", Mark::Bad),
        ("verdict.indeterminate", Mark::Open),
        ("status.ok", Mark::Good),
        ("status.remark", Mark::Open),
        ("status.invalid", Mark::Bad),
        ("explain.verdict.consistent", Mark::Good),
        ("explain.verdict.mismatch", Mark::Bad),
        ("explain.verdict.unknown", Mark::Open),
    ];
    let both = |(key, mark): (&str, Mark)| {
        let word = words.t(key);
        [(word.to_uppercase(), mark), (word, mark)]
    };
    known.into_iter().flat_map(both).collect()
}
