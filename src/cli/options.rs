//! Options that several verbs have.

use super::place;
use super::writer::Writer;
use crate::i18n::{Lang, note};
use crate::noise::tau_grid::TauGrid;
use crate::report::Renderer;
use crate::report::pdf::PdfPages;
use clap::{Args, ValueEnum};
use std::path::Path;
use std::path::PathBuf;

/// Choice of the averaging times.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// Averaging times: octave, decade, all, or a list in seconds (1,10,100), each a multiple of the sample interval
    #[arg(long, value_name = "GRID")]
    pub taus: Option<String>,
    /// Sum every overlapping term at any length (8 bytes of memory per sample)
    #[arg(long)]
    pub exact: bool,
}

impl GridArgs {
    /// The averaging times asked for.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn grid(&self, lang: Lang) -> Result<Option<TauGrid>, String> {
        self.taus.as_deref().map(str::parse::<TauGrid>).transpose().map_err(|e| {
            let note = note!("cli.of_option", option = "--taus", what = e.note());
            place::error(&note, lang)
        })
    }
}

/// How results are written and printed.
#[derive(Debug, Args)]
pub struct OutputArgs {
    /// Replace an existing result made from different inputs
    #[arg(long)]
    pub force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    pub templates: Option<PathBuf>,
    /// Print the outcome as text, or the result as JSON and nothing else; pdf writes the report as PDF too
    #[arg(id = "print_format", long = "format", value_name = "FORMAT", default_value = "text")]
    pub format: PrintFormat,
    /// Print only errors and the path of the report
    #[arg(long, short)]
    pub quiet: bool,
    /// Pages of the PDF
    #[arg(long, value_name = "PAGES")]
    pub pages: Option<Pages>,
}

impl OutputArgs {
    /// How results are written.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn writer(&self, lang: Lang) -> Result<Writer, String> {
        if self.quiet && self.format == PrintFormat::Json {
            return Err(place::error(&"cli.quiet_json".into(), lang));
        }
        let pdf = pdf_pages(self.format == PrintFormat::Pdf, self.pages, lang)?;
        Writer::new(renderer(self.templates.as_deref(), lang)?, pdf, lang)
    }
}

/// The pages of a PDF, where one is asked for.
///
/// # Errors
/// The diagnostic, in words, where pages are named and no PDF is asked for.
pub fn pdf_pages(asked: bool, pages: Option<Pages>, lang: Lang) -> Result<Option<PdfPages>, String> {
    match (asked, pages) {
        (false, Some(_)) => Err(place::error(&"pdf.pages_without".into(), lang)),
        (false, None) => Ok(None),
        (true, Some(Pages::Summary)) => Ok(Some(PdfPages::Summary)),
        (true, _) => Ok(Some(PdfPages::All)),
    }
}

/// Pages of a PDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Pages {
    All,
    Summary,
}

/// What is printed on standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PrintFormat {
    Text,
    Json,
    Pdf,
}

/// The renderer with the user's templates, if any.
///
/// # Errors
/// The diagnostic, in words.
pub fn renderer(templates: Option<&Path>, lang: Lang) -> Result<Renderer, String> {
    templates
        .map_or_else(|| Ok(Renderer::new()), Renderer::with_overrides)
        .map_err(|e| place::error(&e.note(), lang))
}
