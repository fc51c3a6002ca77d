//! Results on standard output.

use super::options::OutputArgs;
use super::place;
use super::progress::{Display, Progress};
use super::stdout;
use crate::i18n::{Lang, Localize, Note, note};
use crate::output::Kind;
use crate::report::Results;
use crate::report::terminal::{self, Terminal};
use anstream::ColorChoice;
use std::path::{Path, PathBuf};

/// Width where standard output is no terminal and `COLUMNS` is not set.
const DEFAULT_WIDTH: usize = 100;
/// Narrowest width that a text is set for.
const LEAST_WIDTH: usize = 30;

/// Prints results: in a language, as text or JSON, or only where they are.
#[derive(Debug, Clone, Copy)]
pub struct Printer {
    /// Language of the text.
    pub lang: Lang,
    /// True where the record is printed and nothing else.
    record: bool,
    quiet: bool,
}

impl Printer {
    /// The printer that the options ask for.
    pub fn new(args: &OutputArgs, lang: Lang) -> Printer {
        Printer { lang, record: args.forms.only_record(), quiet: args.quiet }
    }

    /// Progress, unless nothing is to be said.
    pub fn progress(self) -> Progress {
        Progress::new(Display::unless(self.quiet), self.lang)
    }

    /// Prints a part of the outcome while the work goes on, where the outcome is printed as text.
    pub fn line(self, text: impl FnOnce(Terminal) -> String) {
        if !self.quiet && !self.record {
            stdout::write_styled(&text(standard_output()));
        }
    }

    /// Prints results that stand in a folder.
    ///
    /// # Errors
    /// The diagnostic, in words, where the record cannot be read back for JSON.
    pub fn outcome(self, folder: &Path, results: &Results) -> Result<(), String> {
        let kind = results.kind();
        if self.record {
            return record(folder, kind, self.lang);
        }
        let page = first_page(folder, kind);
        let key = if kind == Kind::DataSheet { "terminal.data_sheet" } else { "terminal.report" };
        let place = Note::new(key).with("place", place::shown(&page)).say(self.lang);
        let text = if self.quiet {
            String::new()
        } else {
            let (lang, on) = (self.lang, standard_output());
            format!("{}\n{}", terminal::results(results, lang, on), terminal::verdict(results, lang, on))
        };
        stdout::write_styled(&format!("{text}{place}\n"));
        Ok(())
    }

    /// Prints what to do next, unless only the result was asked for.
    pub fn next_step(self, step: Option<&Note>) {
        if let Some(step) = step.filter(|_| !self.quiet && !self.record) {
            place::print(&format!("{}\n", step.say(self.lang)));
        }
    }
}

/// Prints the record of results that stand in a folder.
///
/// # Errors
/// The diagnostic, in words, where it cannot be read back.
pub fn record(folder: &Path, kind: Kind, lang: Lang) -> Result<(), String> {
    let file = folder.join(kind.record_file());
    let contents = std::fs::read(&file).map_err(|e| {
        let (path, reason) = (file.display().to_string(), e.to_string());
        place::error(&note!("result_error.unreadable", path, reason), lang)
    })?;
    stdout::write(&contents);
    Ok(())
}

/// The page of results that is to be opened: of the forms that were written, the most readable; else the record.
fn first_page(folder: &Path, kind: Kind) -> PathBuf {
    let pages = ["html", "pdf", "md"].map(|form| folder.join(format!("{}.{form}", kind.page_stem())));
    pages.into_iter().find(|page| page.is_file()).unwrap_or_else(|| folder.join(kind.record_file()))
}

/// The width of standard output, and whether it shows colours.
pub fn standard_output() -> Terminal {
    let columns = || std::env::var("COLUMNS").ok()?.parse::<usize>().ok();
    let real = || terminal_size::terminal_size_of(std::io::stdout()).map(|(width, _)| usize::from(width.0));
    let width = columns().or_else(real).unwrap_or(DEFAULT_WIDTH).max(LEAST_WIDTH);
    Terminal { width, colour: stdout::choice() != ColorChoice::Never }
}
