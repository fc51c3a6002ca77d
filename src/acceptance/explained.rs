//! The recording of a run against the model of its family: a unit that passes its limits and yet behaves unlike its
//! siblings is what quality assurance wants to know of. The finding stands beside the verdict and is no part of it.

use crate::config::model::{self, Claim};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::ExplainSpec;
use crate::i18n::{Lang, Note};
use crate::mismatch::{self, Options, Outcome, Progress};
use crate::record::ExplainedRecord;
use crate::series::{SeriesOptions, load_series};
use std::path::PathBuf;

/// What came of it.
pub struct Explained {
    /// As the result keeps it.
    pub record: ExplainedRecord,
    /// The explanation with its claim and what must be known of the recording; `None` where there is none.
    pub outcome: Option<(Claim, Vec<Note>, Outcome)>,
}

/// Reads the model that a procedure names.
///
/// # Errors
/// Every problem of the file, as it is said to the user.
pub fn model(spec: &ExplainSpec, lang: Lang) -> Result<Claim, String> {
    model::load(&spec.model).map_err(|p| p.say(lang))
}

/// Explains a recording against the model of a procedure. What keeps the two from being compared is said in the record.
pub fn explain(
    spec: &ExplainSpec,
    claim: Claim,
    procedure: &Procedure,
    recording: &[PathBuf],
    progress: &mut dyn FnMut(Progress),
) -> Explained {
    let model = spec.model.display().to_string();
    match attempt(spec, &claim, procedure, recording, progress) {
        Ok((notes, outcome)) => Explained {
            record: ExplainedRecord { model, explanation: Some(outcome.explanation.clone()), error: None },
            outcome: Some((claim, notes, outcome)),
        },
        Err(error) => Explained {
            record: ExplainedRecord { model, explanation: None, error: Some(error.into()) },
            outcome: None,
        },
    }
}

fn attempt(
    spec: &ExplainSpec,
    claim: &Claim,
    procedure: &Procedure,
    recording: &[PathBuf],
    progress: &mut dyn FnMut(Progress),
) -> Result<(Vec<Note>, Outcome), Note> {
    let options = SeriesOptions {
        read: procedure.recording.read.clone(),
        channels: procedure.channels.iter().map(|c| c.channel.clone()).collect(),
        sample_rate_hz: Some(claim.sample_rate_hz),
        ..SeriesOptions::default()
    };
    let series = load_series(recording, &options, &mut |done, total| {
        progress(Progress { doing: "explain.progress.reading", done, total });
    })
    .map_err(|e| e.note())?;
    let wanted = Options { alpha: spec.alpha, max_effects: spec.max_effects, ..Options::default() };
    let notes = series.remarks();
    let outcome = mismatch::explain(series, claim, &wanted, progress)?;
    Ok((notes, outcome))
}
