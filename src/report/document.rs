//! What is exported: a record with its figures and tables, in one language.

use super::files::{ExplainFile, JointFile, PlanFile};
use super::page::{self, Block, Page};
use super::render::{page_context, paper_context, run_context};
use super::translator::Translator;
use super::view::{self, Part, Phase};
use super::{Renderer, ReportError};
use crate::acceptance::Outcome;
use crate::acceptance::compare::Comparison;
use crate::acceptance::phases::figures as phase_figures;
use crate::figure::Figure;
use crate::i18n::{Lang, Note};
use crate::output::{CERTIFICATE_STEM, Kind};
use crate::record::{DataSheet, DayRecord, LotRecord, ProofRecord, RehearsalRecord, RunRecord};
use minijinja::value::Value;
use serde::Serialize;
use std::borrow::Cow;

/// A record that has a document: what its folder is, and what its pages show.
pub trait Documented: Send + Sync {
    /// The record, for a JSON file.
    fn record(&self) -> Record<'_>;
    /// What the folder of the document holds.
    fn kind(&self) -> Kind;
    /// What the document is of, for the head of a page: the unit, the case, the procedure or the model.
    fn subject(&self) -> Option<&str>;
    /// When the record was made, RFC 3339.
    fn made_at(&self) -> &str;
    /// The page, with the figures drawn.
    fn page(&self, figures: &[Figure], lang: Lang) -> Page;

    /// What a folder is named after that the document is written into.
    fn folder_name(&self) -> Option<&str> {
        self.subject()
    }

    /// Version of the program that wrote the record; `None` where the record does not tell it.
    fn program_version(&self) -> Option<&str> {
        None
    }

    /// What a terminal shows of it; nothing where the terminal has a text of its own.
    fn on_terminal(&self, _: Lang) -> Vec<Block> {
        vec![]
    }
}

/// The record that the JSON file of a document holds.
#[derive(Clone, Copy, Serialize)]
#[serde(untagged)]
pub enum Record<'a> {
    /// Of a run or an analysis.
    Run(&'a RunRecord),
    /// Of an explanation.
    Explanation(&'a ExplainFile),
    /// Of a comparison.
    Comparison(&'a Comparison),
    /// Of a lot.
    Lot(&'a LotRecord),
    /// Of several recordings that are explained together.
    Joint(&'a JointFile),
    /// Of a plan.
    Plan(&'a PlanFile),
    /// Of a data sheet.
    DataSheet(&'a DataSheet),
    /// Of a proof.
    Proof(&'a ProofRecord),
    /// Of a day of a watched folder.
    Day(&'a DayRecord),
    /// Of a rehearsal.
    Rehearsal(&'a RehearsalRecord),
}

/// A form of a page that is made of a template.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PageForm {
    /// HTML.
    Html,
    /// Markdown.
    Markdown,
    /// Markdown that is typeset.
    Paper,
}

impl PageForm {
    /// Ending of the file of its template.
    fn ending(self) -> &'static str {
        match self {
            PageForm::Html => "html",
            PageForm::Markdown | PageForm::Paper => "md",
        }
    }

    /// The text of a page of blocks.
    ///
    /// # Errors
    /// [`ReportError`] when a template is wrong.
    pub fn page(self, page: &Page, renderer: &Renderer, lang: Lang) -> Result<String, ReportError> {
        self.rendered("page", page_context(self.seen(page), lang), renderer, lang)
    }

    /// A page of blocks as the templates of the form see it.
    fn seen(self, page: &Page) -> Value {
        match self {
            PageForm::Html => page::seen(page, &page::Html),
            PageForm::Markdown | PageForm::Paper => page::seen(page, &page::Markdown),
        }
    }

    /// The text of a template, named without the ending of its file.
    fn rendered(
        self,
        template: &str,
        context: Value,
        renderer: &Renderer,
        lang: Lang,
    ) -> Result<String, ReportError> {
        let context = if self == PageForm::Paper { paper_context(context) } else { context };
        renderer.render(&format!("{template}.{}", self.ending()), &context, lang)
    }
}

/// What every exporter is given.
pub struct Document<'a> {
    /// The language of words and numbers. Records and tables are the same in every language.
    pub lang: Lang,
    /// The figures, in the order of the page.
    pub figures: Cow<'a, [Figure]>,
    /// Tables and other data files, the same in every language: name and contents.
    pub tables: &'a [(String, String)],
    of: &'a dyn Documented,
    shown: Page,
    stem: &'static str,
}

impl<'a> Document<'a> {
    /// The document of a record.
    pub fn new(
        of: &'a dyn Documented,
        figures: &'a [Figure],
        tables: &'a [(String, String)],
        lang: Lang,
    ) -> Document<'a> {
        let (shown, stem) = (of.page(figures, lang), of.kind().page_stem());
        Document { lang, shown, stem, figures: figures.into(), tables, of }
    }

    /// The document of a run or an analysis.
    pub fn of_run(outcome: &'a Outcome, lang: Lang) -> Document<'a> {
        Document::new(&outcome.record, &outcome.figures, &outcome.tables, lang)
    }

    /// The document of a test of several phases, whose outcomes stand in the order of the phases of `record`; `None` for
    /// one that was not recorded.
    pub fn of_phases(record: &'a RunRecord, phases: &[Option<Outcome>], lang: Lang) -> Document<'a> {
        Document::phased(record, phases, lang, view::page)
    }

    /// A page of a test of several phases.
    fn phased(
        record: &'a RunRecord,
        phases: &[Option<Outcome>],
        lang: Lang,
        page: impl Fn(&Part<'_>, &[Phase<'_>]) -> Page,
    ) -> Document<'a> {
        let figures: Vec<Vec<Figure>> =
            record.phases.iter().zip(phases).map(|(p, o)| phase_figures(&p.id, o.as_ref())).collect();
        let words = Translator { lang };
        let parts = record.phases.iter().zip(phases).zip(&figures).zip(1..);
        let parts: Vec<Phase<'_>> = parts
            .map(|(((phase, outcome), figures), number)| {
                let part = outcome.as_ref().map(|o| Part::of_phase(phase, &o.record, figures, words));
                Phase { phase, number, part }
            })
            .collect();
        let shown = page(&Part::new(record, &[], words), &parts);
        let stem = Kind::Result.page_stem();
        Document { lang, shown, stem, figures: figures.concat().into(), tables: &[], of: record }
    }

    /// The certificate of conformity of a run; of a test of several phases with their outcomes.
    ///
    /// # Errors
    /// Why the record states no conformity.
    pub fn certificate(
        outcome: &'a Outcome,
        phases: &[Option<Outcome>],
        lang: Lang,
    ) -> Result<Document<'a>, Note> {
        let record = &outcome.record;
        if let Some(note) = view::refusal(record) {
            return Err(note);
        }
        let document = if record.phases.is_empty() {
            let part = Part::new(record, &outcome.figures, Translator { lang });
            Document { shown: view::certificate(&part, &[]), ..Document::of_run(outcome, lang) }
        } else {
            Document::phased(record, phases, lang, view::certificate)
        };
        Ok(Document { stem: CERTIFICATE_STEM, ..document })
    }

    /// The lot that the document is of.
    pub fn lot(&self) -> Option<&'a LotRecord> {
        match self.of.record() {
            Record::Lot(lot) => Some(lot),
            _ => None,
        }
    }

    /// The run that the document is of.
    pub fn run(&self) -> Option<&'a RunRecord> {
        match self.of.record() {
            Record::Run(run) => Some(run),
            _ => None,
        }
    }

    /// What the folder of the document holds.
    pub fn kind(&self) -> Kind {
        self.of.kind()
    }

    /// The blocks of the page.
    pub(super) fn shown(&self) -> &Page {
        &self.shown
    }

    /// Name of a page, such as `report.html`, by the ending of its file.
    pub fn page(&self, ending: &str) -> String {
        format!("{}.{ending}", self.stem)
    }

    /// The text of the page in a form.
    ///
    /// # Errors
    /// [`ReportError`] when a template is wrong.
    pub fn text(&self, form: PageForm, renderer: &Renderer) -> Result<String, ReportError> {
        match self.of.record() {
            Record::Run(run) => {
                let context = run_context(form.seen(&self.shown), run, self.lang);
                form.rendered("report", context, renderer, self.lang)
            }
            _ => form.page(&self.shown, renderer, self.lang),
        }
    }

    /// What the document is of, for the head of a page: the unit, the case, the procedure or the model.
    pub fn subject(&self) -> &'a str {
        self.of.subject().unwrap_or_default()
    }

    /// When the record was made, RFC 3339.
    pub fn made_at(&self) -> &'a str {
        self.of.made_at()
    }

    /// The record, for a JSON file.
    pub fn record(&self) -> Record<'a> {
        self.of.record()
    }

    /// The figures whose data are to be kept beside the record. A phase keeps its own.
    pub fn own_figures(&self) -> &[Figure] {
        match self.of.record() {
            Record::Run(run) if !run.phases.is_empty() => &[],
            _ => &self.figures,
        }
    }
}

/// Renders the HTML report of a run: one file that needs no other.
///
/// # Errors
/// [`ReportError::Template`] when a template is wrong.
pub fn render_html(
    record: &RunRecord,
    figures: &[Figure],
    lang: Lang,
    renderer: &Renderer,
) -> Result<String, ReportError> {
    Document::new(record, figures, &[], lang).text(PageForm::Html, renderer)
}

/// Renders the Markdown report of a run, with links to `figures/*.svg`.
///
/// # Errors
/// [`ReportError::Template`] when a template is wrong.
pub fn render_markdown(
    record: &RunRecord,
    figures: &[Figure],
    lang: Lang,
    renderer: &Renderer,
) -> Result<String, ReportError> {
    Document::new(record, figures, &[], lang).text(PageForm::Markdown, renderer)
}

impl Documented for RunRecord {
    fn record(&self) -> Record<'_> {
        Record::Run(self)
    }

    fn kind(&self) -> Kind {
        Kind::Result
    }

    fn subject(&self) -> Option<&str> {
        self.unit_under_test.serial.as_deref()
    }

    fn made_at(&self) -> &str {
        &self.session.evaluated_at
    }

    fn program_version(&self) -> Option<&str> {
        Some(&self.program.version)
    }

    fn page(&self, figures: &[Figure], lang: Lang) -> Page {
        view::page(&Part::new(self, figures, Translator { lang }), &[])
    }
}
