//! The frame of every verb that writes a folder of results: folder, work, pages, words on the terminal, exit code.

use super::inputs::Inputs;
use super::options::OutputArgs;
use super::printer::Printer;
use super::progress::Progress;
use super::writer::Writer;
use super::{exit, place};
use crate::i18n::{Lang, Localize, Note, note};
use crate::mismatch;
use crate::moment;
use crate::output::StagedFolder;
use crate::report::Results;
use crate::series::{Series, SeriesOptions, load_series};
use chrono::{DateTime, SecondsFormat, Utc};
use std::path::{Path, PathBuf};

/// A verb that makes results and writes them into a folder. Its files are read before: a mistake in one is said at once.
pub trait Job {
    /// Begins the folder of the results.
    ///
    /// # Errors
    /// The diagnostic, in words.
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String>;

    /// Makes the results. `folder` is for parts that are written before the whole.
    ///
    /// # Errors
    /// The diagnostic, in words, where there are no results to be written.
    fn run(&self, folder: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String>;

    /// Keeps the results, which are in their place, in a store.
    ///
    /// # Errors
    /// The diagnostic, in words.
    fn keep(&self, _place: &Path, _printer: Printer) -> Result<(), String> {
        Ok(())
    }

    /// The exit code of the results.
    fn exit_code(&self, results: &Results) -> u8 {
        exit::of(results)
    }

    /// The advice that is printed last.
    fn next_step(&self, _results: &Results, _place: &Path) -> Option<Note> {
        None
    }
}

/// The results of a job.
pub struct Made {
    /// The results, which are written.
    pub results: Results,
    /// Diagnostics of a recording that could not be evaluated; the results say so too.
    pub refusal: Option<Refusal>,
}

impl From<Results> for Made {
    fn from(results: Results) -> Made {
        Made { results, refusal: None }
    }
}

/// Diagnostics of a recording that could not be evaluated.
pub struct Refusal {
    /// The reasons, in words.
    pub why: String,
    /// A way out, in words; empty where none is known.
    pub advice: String,
}

/// Everything that a job needs beside its own options.
pub struct Frame<'a> {
    /// Language of the messages.
    pub lang: Lang,
    /// The moment that the results state and default folders are named after.
    pub now: DateTime<Utc>,
    /// Prints the results.
    pub printer: Printer,
    /// Shows how far the work is.
    pub progress: Progress,
    /// Writes the results.
    pub writer: Writer,
    output: &'a OutputArgs,
}

impl Frame<'_> {
    /// The inputs of the results: those that every verb has.
    pub fn inputs(&self) -> Inputs {
        Inputs::new(self.output.force).beside(self.output.forms.templates.as_deref())
    }

    /// The moment of the results as records state it.
    pub fn stamp(&self) -> String {
        self.now.to_rfc3339_opts(SecondsFormat::Secs, true)
    }

    /// Prints a warning.
    pub fn warn(&self, note: &Note) {
        self.progress.beside(|| place::eprint_diagnostic(&place::warning(note, self.lang)));
    }

    /// Reads a recording as one series.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn series(&mut self, paths: &[PathBuf], options: &SeriesOptions) -> Result<Series, String> {
        let series = load_series(paths, options, &mut |done, total| {
            self.progress.explaining(mismatch::Progress { doing: "explain.progress.reading", done, total });
        });
        series.map_err(|e| e.say(self.lang))
    }
}

/// Carries out a job: begins its folder, makes and writes the results, prints them; gives the exit code. `load` reads the files
/// that its options name.
///
/// # Errors
/// The diagnostic, in words. Where a recording could not be evaluated, a report that says so is written all the same.
pub fn execute<J: Job>(
    output: &OutputArgs,
    lang: Lang,
    load: impl FnOnce(&mut Frame<'_>) -> Result<J, String>,
) -> Result<u8, String> {
    let writer = output.writer(lang)?;
    let printer = Printer::new(output, lang);
    let mut frame = Frame { lang, now: moment::now(), printer, progress: printer.progress(), writer, output };
    let job = load(&mut frame)?;
    frame.progress.stage("progress.inputs");
    let folder = job.begin(&frame)?;
    let Made { results, refusal } = job.run(&folder, &mut frame)?;
    frame.progress.stage("progress.writing");
    let place = frame.writer.publish(&results, folder)?;
    frame.progress.finish();
    if let Some(Refusal { why, advice }) = refusal {
        let report = note!("cli.report_says_so", place = place.display().to_string()).say(lang);
        let not_kept = job.keep(&place, printer).err().unwrap_or_default();
        return Err(format!("{why}{report}\n{not_kept}{advice}"));
    }
    printer.outcome(&place, &results)?;
    job.keep(&place, printer)?;
    printer.next_step(job.next_step(&results, &place).as_ref());
    Ok(job.exit_code(&results))
}
