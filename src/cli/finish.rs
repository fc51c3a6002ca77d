//! From a request to the folder of its results and the words on the terminal.

use super::keep::Keeper;
use super::printer::Printer;
use super::progress::Progress;
use super::writer::Writer;
use super::{exit, place};
use crate::acceptance::{Outcome, Request, RunError, execute, explained, failed};
use crate::config::diagnostics::Problems;
use crate::config::model::Claim;
use crate::i18n::{Lang, Localize, Note};
use crate::output::{Kind, StagedFolder};
use crate::report::explain::Context;
use crate::report::view::{PhasePart, View};
use crate::report::{ExplanationResults, Results, RunResults, terminal};
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
    folder: StagedFolder,
    writer: &Writer,
    printer: Printer,
    mut progress: Progress,
) -> Result<u8, String> {
    let evaluated = evaluate(request, None, &mut progress);
    let keeper = Keeper::none(printer.lang);
    settle(evaluated, folder, &keeper, writer, printer, progress)
}

/// What came of a request.
pub struct Evaluated {
    /// Record, figures and tables; the verdict is an error where the recording could not be evaluated.
    pub results: RunResults,
    /// Why the recording could not be evaluated.
    pub refused: Option<Note>,
    /// Diagnostics that tell more than that, such as each column that is missing at the line that asks for it.
    pub problems: Option<Problems>,
}

impl Evaluated {
    /// A request that could not be carried out.
    pub fn refused(request: &Request<'_>, error: &RunError) -> Evaluated {
        Evaluated { results: not_run(request, error).into(), refused: Some(error.note()), problems: None }
    }
}

/// Runs a request, and explains the recording where there is a model.
pub fn evaluate(request: &Request<'_>, against: Option<Against<'_>>, progress: &mut Progress) -> Evaluated {
    let lang = progress.lang();
    match with_progress(request, &Note::new("cli.reading").say(lang), progress) {
        Ok(outcome) => {
            let mut results = RunResults::from(outcome);
            if let Some(against) = against {
                explain(request, against, &mut results, progress);
            }
            Evaluated { results, refused: None, problems: None }
        }
        Err(error) => Evaluated::refused(request, &error),
    }
}

/// Writes the folder of what was evaluated and prints the outcome; gives the exit code.
///
/// # Errors
/// The diagnostic, in words. Where the recording could not be evaluated, a report that says so is written all the same.
pub fn settle(
    evaluated: Evaluated,
    folder: StagedFolder,
    keeper: &Keeper,
    writer: &Writer,
    printer: Printer,
    progress: Progress,
) -> Result<u8, String> {
    match evaluated.refused {
        None => finish(evaluated.results, folder, keeper, writer, printer, progress),
        Some(note) => {
            let lang = printer.lang;
            let mut results = evaluated.results;
            keeper.place_among_others(&mut results.outcome.record)?;
            let results = Results::Run(Box::new(results));
            let place = writer.publish(&results, folder)?;
            let report = Note::new("cli.report_says_so").with("place", place.display().to_string());
            let why = match &evaluated.problems {
                Some(problems) => format!("{}\n", problems.say(lang)),
                None => place::error(&note, lang),
            };
            let why = format!("{why}{}\n", report.say(lang));
            let kept = keeper.keep(&place, printer);
            Err(why + &kept.err().unwrap_or_default())
        }
    }
}

/// Runs a request and says how far it is.
///
/// # Errors
/// As [`execute`].
pub fn with_progress(
    request: &Request<'_>,
    label: &str,
    progress: &mut Progress,
) -> Result<Outcome, RunError> {
    execute(request, &mut |done, total| progress.reading(label, done, total))
}

/// Explains a recording against the model of its procedure.
fn explain(request: &Request<'_>, against: Against<'_>, results: &mut RunResults, progress: &mut Progress) {
    let Some(spec) = &request.procedure.explain else { return };
    let Against { claim, recording } = against;
    let out = explained::explain(spec, claim, request.procedure, recording, &mut |p| progress.explaining(p));
    results.explanation = out.outcome.map(|(claim, notes, outcome)| {
        let names: Vec<String> = recording.iter().map(|p| p.display().to_string()).collect();
        let context = Context {
            recording: names.join(", "),
            claim: out.record.model.clone(),
            identified: false,
            description: Some(claim.description),
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
    mut results: RunResults,
    folder: StagedFolder,
    keeper: &Keeper,
    writer: &Writer,
    printer: Printer,
    mut progress: Progress,
) -> Result<u8, String> {
    let code = exit::code(results.outcome.record.verdict);
    let lang = printer.lang;
    progress.stage("progress.writing");
    keeper.place_among_others(&mut results.outcome.record)?;
    let view = view(&results, lang);
    let place = writer.publish(&Results::Run(Box::new(results)), folder)?;
    drop(progress);
    printer.outcome(&place, Kind::Result, |terminal| terminal::run(&view, lang, terminal))?;
    keeper.keep(&place, printer)?;
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

/// The outcome of a run that could not be carried out.
pub fn not_run(request: &Request<'_>, error: &RunError) -> Outcome {
    Outcome { record: failed(request, error), figures: vec![], tables: vec![] }
}
