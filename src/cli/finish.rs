//! From a request to the folder of its results and the words on the terminal.

use super::inputs;
use super::printer::Printer;
use super::progress::{Progress, Watch};
use super::{exit, place};
use crate::acceptance::{Outcome, Request, RunError, execute, explained, failed};
use crate::config::model::Claim;
use crate::i18n::{Lang, Localize, Note};
use crate::output::{Kind, StagedFolder};
use crate::report::explain::Context;
use crate::report::export::{EXPORTERS, Exporter, export};
use crate::report::view::{PhasePart, View};
use crate::report::{ExplanationResults, Renderer, Results, RunResults, terminal};
use chrono::SecondsFormat;
use std::path::PathBuf;

/// A model that a recording is explained against.
pub struct Against<'a> {
    /// The model.
    pub claim: Claim,
    /// The recording as named.
    pub recording: &'a [PathBuf],
}

/// Runs a request, writes its folder and prints the outcome; gives the exit code.
///
/// # Errors
/// The diagnostic, in words. Where the recording could not be evaluated, a report that says so is written all the same.
pub fn run_and_finish(
    request: &Request<'_>,
    against: Option<Against<'_>>,
    folder: StagedFolder,
    renderer: &Renderer,
    printer: Printer,
) -> Result<u8, String> {
    let lang = printer.lang;
    let outcome = match with_progress(request, &Note::new("cli.reading").say(lang)) {
        Ok(outcome) => outcome,
        Err(error) => return Err(report_failure(request, &error, folder, renderer, lang)?),
    };
    let mut results = RunResults::from(outcome);
    if let Some(against) = against {
        explain(request, against, &mut results, lang);
    }
    finish(results, folder, renderer, printer)
}

/// Runs a request with a progress bar.
///
/// # Errors
/// As [`execute`].
pub fn with_progress(request: &Request<'_>, label: &str) -> Result<Outcome, RunError> {
    let mut progress = Progress::new();
    let outcome = execute(request, &mut |done, total| progress.update(label, done, total));
    progress.finish();
    outcome
}

/// Explains a recording against the model of its procedure.
fn explain(request: &Request<'_>, against: Against<'_>, results: &mut RunResults, lang: Lang) {
    let Some(spec) = &request.procedure.explain else { return };
    let mut watch = Watch::new(lang);
    let Against { claim, recording } = against;
    let out = explained::explain(spec, claim, request.procedure, recording, &mut |p| watch.of(p));
    watch.finish();
    results.explanation = out.outcome.map(|(claim, notes, outcome)| {
        let names: Vec<String> = recording.iter().map(|p| p.display().to_string()).collect();
        let context = Context {
            recording: names.join(", "),
            claim: out.record.model.clone(),
            identified: false,
            description: claim.description,
            explained_at: request.now.to_rfc3339_opts(SecondsFormat::Secs, true),
            correction: outcome.correction.is_some(),
            notes,
        };
        ExplanationResults::new(&outcome, context)
    });
    results.outcome.record.explained = Some(out.record);
}

/// Writes the folder of a run and prints the outcome; gives the exit code.
///
/// # Errors
/// The diagnostic, in words.
pub fn finish(
    results: RunResults,
    folder: StagedFolder,
    renderer: &Renderer,
    printer: Printer,
) -> Result<u8, String> {
    let code = exit::code(results.outcome.record.verdict);
    let lang = printer.lang;
    let view = view(&results, lang);
    let place = write(&Results::Run(Box::new(results)), folder, EXPORTERS, renderer, lang)?;
    printer.outcome(&place, Kind::Result, |terminal| terminal::run(&view, lang, terminal))?;
    Ok(code)
}

/// The view of a run, with its phases where it has some.
fn view(results: &RunResults, lang: Lang) -> View {
    let record = &results.outcome.record;
    let parts: Vec<PhasePart<'_>> = record
        .phases
        .iter()
        .zip(&results.phases)
        .map(|(phase, outcome)| PhasePart {
            phase,
            record: outcome.as_ref().map(|o| &o.record),
            figures: &[],
        })
        .collect();
    View::of_phases(record, &parts, lang)
}

/// Writes the report of a run that could not be carried out, and gives the message for the terminal.
///
/// # Errors
/// The diagnostic, in words, where not even that can be written.
pub fn report_failure(
    request: &Request<'_>,
    error: &RunError,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<String, String> {
    let report = write_failure(request, error, folder, renderer, lang)?;
    Ok(format!("{}{report}", place::error(&error.note(), lang)))
}

/// Writes the report of a run that could not be carried out, and gives the line that says where it is.
///
/// # Errors
/// As [`report_failure`].
pub fn write_failure(
    request: &Request<'_>,
    error: &RunError,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<String, String> {
    let results = Results::Run(Box::new(not_run(request, error).into()));
    let place = write(&results, folder, EXPORTERS, renderer, lang)?;
    let report = Note::new("cli.report_says_so").with("place", place.display().to_string());
    Ok(format!("{}\n", report.say(lang)))
}

/// The outcome of a run that could not be carried out.
pub fn not_run(request: &Request<'_>, error: &RunError) -> Outcome {
    Outcome { record: failed(request, error), figures: vec![], tables: vec![] }
}

/// Writes results in some forms and puts their folder in its place. The record is always written: it lists the files.
///
/// # Errors
/// The diagnostic, in words.
pub fn write(
    results: &Results,
    folder: StagedFolder,
    exporters: &[&dyn Exporter],
    renderer: &Renderer,
    lang: Lang,
) -> Result<PathBuf, String> {
    let whole = results.whole(lang);
    let record_file = whole.kind().record_file();
    for (name, contents) in export(&whole, exporters, renderer).map_err(|e| place::error(&e.note(), lang))? {
        if name != record_file {
            folder.write(&name, &contents).map_err(|e| place::error(&e.note(), lang))?;
        }
    }
    for (below, part) in results.parts(lang) {
        for (name, contents) in
            export(&part, exporters, renderer).map_err(|e| place::error(&e.note(), lang))?
        {
            folder.write(&format!("{below}/{name}"), &contents).map_err(|e| place::error(&e.note(), lang))?;
        }
    }
    inputs::publish(folder, whole.record(), lang)
}
