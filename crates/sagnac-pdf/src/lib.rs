//! Typesets a page of Markdown with its drawings as a PDF that is kept for decades and read aloud: PDF/A-3a and PDF/UA-1 at
//! once, with files attached. The same input gives the same bytes.
//!
//! The comment `<!-- page -->` on a line of its own begins a new page; what stands before the first one, or before the first
//! `<!-- summary -->`, is the summary.

mod attached;
mod drawing;
mod fonts;
mod layout;
mod markup;
mod world;

pub use attached::attached;
pub use drawing::{Drawing, drawing_as_pdf, drawing_as_png};

use std::collections::BTreeMap;
use typst::diag::{SourceDiagnostic, Warned};
use typst::foundations::{Datetime, Smart};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, PdfStandard, PdfStandards, Timestamp};
use world::InMemory;

/// The text to typeset.
#[derive(Debug, Clone)]
pub struct Paper<'a> {
    /// Language of its text: `en` or `ru`.
    pub language: &'a str,
    /// Subject of the document, on the right of the head of every page. On the left stands its title: its first heading.
    pub subject: &'a str,
    /// Left of the foot of every page.
    pub foot: &'a str,
    /// Number of the page in the foot, such as `page {n} of {m}`.
    pub page_number: &'a str,
    /// When the document was made, UTC.
    pub made_at: Moment,
    /// The text, as Markdown with tables.
    pub markdown: &'a str,
    /// Drawings (SVG) by the names under which the text links to them.
    pub drawings: &'a BTreeMap<String, Vec<u8>>,
    /// Files that go with the document.
    pub attachments: &'a [Attachment<'a>],
    /// Words that are coloured where a cell, or a text in bold, holds nothing else.
    pub marks: &'a [(String, Mark)],
    /// Pages that are made.
    pub pages: Pages,
}

/// Which pages are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pages {
    /// All.
    #[default]
    All,
    /// Headings before the end of the summary; all where none is stated.
    Summary,
}

/// A moment, UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moment {
    /// Year.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u8,
    /// Day of the month, from 1.
    pub day: u8,
    /// Hour, minute and second.
    pub time: [u8; 3],
}

/// A file that goes with a document.
#[derive(Debug, Clone, Copy)]
pub struct Attachment<'a> {
    /// Name of the file.
    pub name: &'a str,
    /// Its contents.
    pub bytes: &'a [u8],
    /// Media type, such as `application/json`.
    pub media_type: &'a str,
    /// Description in words.
    pub description: &'a str,
    /// Its relation to the document.
    pub relation: Relation,
}

/// Relation of an attached file to the document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// The document was made from it.
    Source,
    /// It holds data that the document shows.
    Data,
}

/// How a word is coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Something is as asked.
    Good,
    /// Something is not as asked.
    Bad,
    /// It is not known.
    Open,
}

/// Why a document could not be typeset.
#[derive(Debug, thiserror::Error)]
#[error("{}", .0.join("; "))]
pub struct PdfError(Vec<String>);

/// Typesets a document.
///
/// # Errors
/// [`PdfError`] with what the typesetter says: a drawing that cannot be read, or a text that no standard allows.
pub fn typeset(paper: &Paper<'_>) -> Result<Vec<u8>, PdfError> {
    let world = InMemory::of_paper(paper);
    let Warned { output, .. } = typst::compile::<PagedDocument>(&world);
    let document = output.map_err(|errors| said(&errors))?;
    let standards = PdfStandards::new(&[PdfStandard::A_3a, PdfStandard::Ua_1])
        .map_err(|e| PdfError(vec![e.message().to_string()]))?;
    let options = PdfOptions {
        // Two documents of the same record are the same document.
        ident: Smart::Custom(format!("{}\n{}\n{}", paper.subject, paper.foot, paper.language)),
        creator: Smart::Custom(Some("sagnac".into())),
        timestamp: paper.made_at.datetime().map(Timestamp::new_utc),
        standards,
        ..PdfOptions::default()
    };
    let bytes = typst_pdf::pdf(&document, &options).map_err(|errors| said(&errors));
    // The memory of earlier documents helps none that come.
    comemo::evict(1);
    bytes
}

impl Moment {
    fn datetime(self) -> Option<Datetime> {
        let [hour, minute, second] = self.time;
        Datetime::from_ymd_hms(self.year, self.month, self.day, hour, minute, second)
    }
}

/// What the typesetter says.
fn said(errors: &[SourceDiagnostic]) -> PdfError {
    PdfError(errors.iter().map(|e| e.message.to_string()).collect())
}
