//! Results as files: forms, templates, language.

use super::{inputs, place};
use crate::i18n::{Lang, Note};
use crate::output::{Kind, LIMITS_FILE, OutputError, PROCEDURE_FILE, StagedFolder, StagedPart};
use crate::report::export::{Dcc, EXPORTERS, Exporter, FURTHER, export, record_bytes};
use crate::report::pdf::{MAKES_PDF, PdfPages};
use crate::report::signatures::Signature;
use crate::report::{Document, Renderer, ReportError, Results};
use clap::ValueEnum;
use std::path::PathBuf;

/// Writes results in some forms.
pub struct Writer {
    /// Templates.
    pub renderer: Renderer,
    exporters: Vec<&'static dyn Exporter>,
    certificate: Option<Dcc>,
    pdf: Option<PdfPages>,
    paper: Paper,
    lang: Lang,
}

/// What a result is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Paper {
    /// The report.
    #[default]
    Report,
    /// The certificate of conformity.
    Certificate,
}

impl Writer {
    /// A writer of every form but PDF, and of that where pages of it are asked for.
    ///
    /// # Errors
    /// The diagnostic, in words, where this build makes no PDF.
    pub fn new(renderer: Renderer, pdf: Option<PdfPages>, lang: Lang) -> Result<Writer, String> {
        if pdf.is_some() && !MAKES_PDF {
            return Err(place::error(&ReportError::NoPdf.note(), lang));
        }
        Ok(Writer {
            renderer,
            exporters: EXPORTERS.to_vec(),
            certificate: None,
            pdf,
            paper: Paper::Report,
            lang,
        })
    }

    /// A writer of the forms that are named; of those that are written unasked where none is.
    #[must_use]
    pub fn of_forms(mut self, named: &[String]) -> Writer {
        if !named.is_empty() {
            let all = EXPORTERS.iter().chain(FURTHER).copied();
            self.exporters = all.filter(|e| named.iter().any(|n| n == e.id())).collect();
        }
        self
    }

    /// The same, its pages with the signatures that a folder has.
    #[must_use]
    pub fn with_signatures(mut self, signatures: Vec<Signature>) -> Writer {
        self.renderer = self.renderer.with_signatures(signatures);
        self
    }

    /// The same, and a calibration certificate.
    #[must_use]
    pub fn with_certificate(mut self, certificate: Dcc) -> Writer {
        self.certificate = Some(certificate);
        self
    }

    /// The same, of another document.
    #[must_use]
    pub fn of(mut self, paper: Paper) -> Writer {
        self.paper = paper;
        self
    }

    /// The document of the whole.
    ///
    /// # Errors
    /// The diagnostic, in words, where there is no such document.
    pub fn whole<'r>(&self, results: &'r Results) -> Result<Document<'r>, String> {
        match self.paper {
            Paper::Report => Ok(results.whole(self.lang)),
            Paper::Certificate => results.certificate(self.lang).map_err(|note| self.said(&note)),
        }
    }

    /// Writes the files of results, all but the record of the whole.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn files(&self, results: &Results, folder: &StagedPart<'_>) -> Result<(), String> {
        let whole = self.whole(results)?;
        self.part(&whole, "", folder)?;
        for (below, part) in results.parts(self.lang) {
            self.part(&part, &format!("{below}/"), folder)?;
        }
        if let Some(pages) = self.pdf {
            let name = whole.page("pdf");
            let record = folder.record_with(whole.record(), &[&name]).map_err(|e| self.refused(&e))?;
            let pdf = whole.pdf(&self.renderer, &record, pages).map_err(|e| self.said(&e.note()))?;
            folder.write(&name, &pdf).map_err(|e| self.refused(&e))?;
        }
        Ok(())
    }

    /// Writes the files of a document below a part of the folder; the record of the whole comes last of all, with its list.
    fn part(&self, document: &Document<'_>, below: &str, folder: &StagedPart<'_>) -> Result<(), String> {
        let whole = below.is_empty();
        let record_file = document.kind().record_file();
        let certificate = self.certificate.iter().map(|c| c as &dyn Exporter);
        let exporters: Vec<&dyn Exporter> = self.exporters.iter().copied().chain(certificate).collect();
        let files = export(document, &exporters, &self.renderer).map_err(|e| self.said(&e.note()))?;
        for (name, contents) in &files {
            if name != record_file {
                folder.write(&format!("{below}{name}"), contents).map_err(|e| self.refused(&e))?;
            }
        }
        // What the test was made by stays with its results in every form: it tells which signatures are asked for.
        for (name, text) in document.tables.iter().filter(|(name, _)| !files.contains_key(name)) {
            if matches!(name.as_str(), PROCEDURE_FILE | LIMITS_FILE) && document.kind() == Kind::Result {
                folder.write(&format!("{below}{name}"), text.as_bytes()).map_err(|e| self.refused(&e))?;
            }
        }
        if whole {
            return Ok(());
        }
        // The record of a part is written in every form, as that of the whole is; the hash on its pages is that of the record.
        let record = record_bytes(document).map_err(|e| self.said(&e.note()))?;
        folder.write(&format!("{below}{record_file}"), &record).map_err(|e| self.refused(&e))?;
        if let Some(pages) = self.pdf {
            let pdf = document.pdf(&self.renderer, &record, pages).map_err(|e| self.said(&e.note()))?;
            let name = format!("{below}{}", document.page("pdf"));
            folder.write(&name, &pdf).map_err(|e| self.refused(&e))?;
        }
        Ok(())
    }

    /// Writes results and puts their folder in its place.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn publish(&self, results: &Results, mut folder: StagedFolder) -> Result<PathBuf, String> {
        folder.were_read(results.files_read());
        self.files(results, &StagedPart::all_of(&folder))?;
        inputs::publish(folder, results.whole(self.lang).record(), self.lang)
    }

    fn refused(&self, error: &OutputError) -> String {
        self.said(&error.note())
    }

    fn said(&self, note: &Note) -> String {
        place::error(note, self.lang)
    }
}
