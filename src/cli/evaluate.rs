//! A request evaluated: its results, and the reasons where there are none.

use super::job::{Made, Refusal};
use super::place;
use super::progress::Progress;
use crate::acceptance::{Outcome, Request, RunError, execute, explained, failed};
use crate::config::diagnostics::Problems;
use crate::config::model::Claim;
use crate::i18n::{Lang, Note};
use crate::report::explain::Context;
use crate::report::{ExplanationResults, Results, RunResults};
use chrono::SecondsFormat;
use std::path::PathBuf;

/// A model that a recording is explained against.
pub struct Against<'a> {
    /// The model.
    pub claim: Claim,
    /// The recording as named.
    pub recording: &'a [PathBuf],
}

/// The results of a request.
pub struct Evaluated {
    /// Record, figures and tables; the verdict is an error where the recording could not be evaluated.
    pub results: RunResults,
    /// The reason why the recording could not be evaluated.
    pub refused: Option<Note>,
    /// Diagnostics that tell more than that, such as each column that is missing at the line that asks for it.
    pub problems: Option<Problems>,
}

impl Evaluated {
    /// A request that could not be carried out.
    pub fn refused(request: &Request<'_>, error: &RunError) -> Evaluated {
        let outcome = Outcome { record: failed(request, error), figures: vec![], tables: vec![] };
        Evaluated { results: outcome.into(), refused: Some(error.note()), problems: None }
    }

    /// The same as a job gives it, with the diagnostics in words.
    pub fn made(self, lang: Lang) -> Made {
        let Evaluated { results, refused, problems } = self;
        let why = refused.map(|note| match problems {
            Some(problems) => format!("{}\n", problems.say(lang)),
            None => place::error(&note, lang),
        });
        let refusal = why.map(|why| Refusal { why, advice: String::new() });
        Made { results: Results::Run(Box::new(results)), refusal }
    }
}

/// Runs a request, and explains the recording where there is a model. `label` says what is read.
pub fn evaluate(
    request: &Request<'_>,
    against: Option<Against<'_>>,
    label: &str,
    progress: &mut Progress,
) -> Evaluated {
    match with_progress(request, label, progress) {
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
