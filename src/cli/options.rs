//! Options that several verbs have.

use super::writer::Writer;
use super::{length, place};
use crate::i18n::{Lang, note};
use crate::noise::tau_grid::TauGrid;
use crate::report::Renderer;
use crate::report::export::{CERTIFICATE_FORM, Dcc, EXPORTERS, Exporter, FURTHER, Json};
use crate::report::pdf::PdfPages;
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Choice of the averaging times.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// Averaging times: octave, decade, all, or a list (1s,10s,5min; without a unit in seconds), each a multiple of the sample interval
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
        let taus = self.taus.as_deref().map(in_seconds);
        taus.as_deref().map(str::parse::<TauGrid>).transpose().map_err(|e| {
            let note = note!("cli.of_option", option = "--taus", what = e.note());
            place::error(&note, lang)
        })
    }
}

/// A list of times as the grid takes it, in seconds; what is no time with its unit stays as it is.
fn in_seconds(taus: &str) -> String {
    let time =
        |text: &str| length::from_zero(text).map_or_else(|_| text.to_owned(), |l| l.seconds.to_string());
    taus.split(',').map(time).collect::<Vec<_>>().join(",")
}

/// Forms in which results are written: one option with one meaning in every verb that writes pages.
#[derive(Debug, Args)]
pub struct FormArgs {
    /// Forms to write, separated by commas; the record is always written, and json alone prints it [default: html, md, csv, json, svg, junit]
    #[arg(long = "format", value_name = "FORM", value_delimiter = ',', value_parser = form_ids())]
    forms: Vec<String>,
    /// Pages of the PDF
    #[arg(long, value_name = "PAGES")]
    pages: Option<Pages>,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    pub templates: Option<PathBuf>,
}

/// The form that is made of the others.
const PDF_FORM: &str = "pdf";

fn form_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(
        EXPORTERS.iter().chain(FURTHER).map(|e| e.id()).chain([CERTIFICATE_FORM, PDF_FORM]),
    )
}

impl FormArgs {
    /// The options as they are given to another run of the program.
    pub fn arguments(&self) -> Vec<OsString> {
        let mut out = vec![];
        let mut option = |name: &str, value: OsString| out.extend([OsString::from(name), value]);
        if !self.forms.is_empty() {
            option("--format", self.forms.join(",").into());
        }
        if let Some(pages) = self.pages.and_then(|p| p.to_possible_value()) {
            option("--pages", pages.get_name().into());
        }
        if let Some(templates) = &self.templates {
            option("--templates", templates.into());
        }
        out
    }

    /// True where a form is named.
    pub fn names(&self, id: &str) -> bool {
        self.forms.iter().any(|form| form == id)
    }

    /// True where the record is the only form that is named, so that it is printed.
    pub fn only_record(&self) -> bool {
        !self.forms.is_empty() && self.forms.iter().all(|form| form == Json.id())
    }

    /// The writer of the forms.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn writer(&self, lang: Lang) -> Result<Writer, String> {
        let pdf = pdf_pages(self.names(PDF_FORM), self.pages, lang)?;
        let writer =
            Writer::new(renderer(self.templates.as_deref(), lang)?, pdf, lang)?.of_forms(&self.forms);
        Ok(if self.names(CERTIFICATE_FORM) {
            writer.with_certificate(Dcc { laboratory: None })
        } else {
            writer
        })
    }
}

/// How results are written and printed.
#[derive(Debug, Args)]
pub struct OutputArgs {
    /// Replace an existing result made from different inputs
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub forms: FormArgs,
    /// Print only errors and the path of the report
    #[arg(long, short)]
    pub quiet: bool,
}

impl OutputArgs {
    /// How results are written.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn writer(&self, lang: Lang) -> Result<Writer, String> {
        if self.quiet && self.forms.only_record() {
            return Err(place::error(&"cli.quiet_json".into(), lang));
        }
        self.forms.writer(lang)
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

/// The renderer with the user's templates, if any.
///
/// # Errors
/// The diagnostic, in words.
pub fn renderer(templates: Option<&Path>, lang: Lang) -> Result<Renderer, String> {
    templates
        .map_or_else(|| Ok(Renderer::new()), Renderer::with_overrides)
        .map_err(|e| place::error(&e.note(), lang))
}
