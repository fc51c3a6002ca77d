//! Several recordings of one unit against one claim: what they share is fitted to all of them with one set of parameters, so
//! that they find together what none finds alone.
//!
//! Each recording keeps its own noise, its own nuisances and its own events. An effect of the unit, such as a temperature
//! coefficient or an error of the scale factor, is the same in all. Scores and informations of its coefficients add up over
//! the recordings; whether the recordings agree is Cochran's test, and each recording is predicted from the others.
//!
//! | file | what it has |
//! |---|---|
//! | `record` | what `joint.json` holds |
//! | `law` | an effect of which everything but its coefficients is chosen |
//! | `baseline` | what one recording says of a law |
//! | `fit` | a law fitted to all recordings |
//! | `select` | the law that explains most |

mod baseline;
mod fit;
mod law;
pub mod record;
mod select;

use self::baseline::Baseline;
use self::fit::FittedLaw;
use self::law::{Coefficients, Law, of_stated, of_the_unit};
use self::record::{Brief, JOINT_FORMAT, JointExplanation, JointRecording, SharedEffect, SharedIn};
use super::engine::{explain, on_grid, uncoarsened};
use super::finding::{Explanation, MismatchVerdict, ParameterValue};
use super::fitted_hypothesis::FittedHypothesis;
use super::named::SampleFindings;
use super::options::{Options, Progress};
use super::outcome::Outcome;
use super::problem::Problem;
use super::samples;
use crate::claim::{Claim, Stated};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::message::Note;
use crate::series::Series;
use std::collections::BTreeMap;

/// Rounds of explaining the recordings beside the laws, and of fitting the laws beside what that found.
const MAX_ROUNDS: usize = 3;
/// A law has moved where a coefficient changed by this many of its deviations.
const MIN_MOVED_SIGMAS: f64 = 0.1;
/// A recording and how it is called.
pub struct Recording {
    /// Name in the report.
    pub name: String,
    /// Folder of its own explanation.
    pub folder: String,
    /// The recording.
    pub series: Series,
}

/// Result of a joint explanation.
pub struct JointOutcome {
    /// `joint.json`.
    pub explanation: JointExplanation,
    /// The explanation of each recording beside the claim with the shared effects.
    pub recordings: Vec<Outcome>,
    /// The claim with the shared effects.
    pub augmented: Claim,
}

/// Reason why recordings cannot be explained together.
#[derive(Debug)]
pub struct JointError {
    /// The recording, counted from 0.
    pub recording: usize,
    /// The reason.
    pub note: Note,
}

/// Progress of the work, and the recording that it is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointProgress {
    /// The recording, counted from 0; `None` while all are fitted together.
    pub recording: Option<usize>,
    /// Progress of the work on it.
    pub of: Progress,
}

/// Explains several recordings of one unit against one claim.
///
/// A correct claim is called a mismatch with the probability of `options`, over all recordings together: it is divided
/// between them and what they share.
///
/// # Errors
/// A recording that cannot be compared with the claim, and why.
pub fn explain_jointly(
    recordings: Vec<Recording>,
    claim: &Claim,
    options: &Options,
    progress: &mut dyn FnMut(JointProgress),
) -> Result<JointOutcome, JointError> {
    let each = Options { alpha: options.alpha / (recordings.len() + 1) as f64, ..options.clone() };
    let explained = |claim: &Claim, progress: &mut dyn FnMut(JointProgress)| {
        let of = |(i, recording): (usize, &Recording)| {
            let mut tell = |of: Progress| progress(JointProgress { recording: Some(i), of });
            explain(recording.series.clone(), claim, &each, &mut tell)
                .map_err(|note| JointError { recording: i, note })
        };
        recordings.iter().enumerate().map(of).collect::<Result<Vec<Outcome>, _>>()
    };
    let alone = explained(claim, progress)?;
    let mut shared = shared(&recordings, &alone, claim, &each, progress)?;
    let briefs: Vec<Brief> = alone.iter().map(|o| brief(&o.explanation)).collect();
    let mut together = alone;
    for _ in 0..if shared.laws.is_empty() { 0 } else { MAX_ROUNDS } {
        together = explained(&shared.claim, progress)?;
        if !refit(&mut shared, &recordings, &together, claim, &each)? {
            break;
        }
    }
    let Shared { laws, unlike, claim: augmented, .. } = shared;
    let laws: Vec<SharedEffect> = laws.into_iter().map(|l| l.told).collect();
    let of = recordings.iter().zip(briefs).zip(&together);
    let recordings = of.map(|((r, alone), outcome)| JointRecording {
        name: r.name.clone(),
        folder: r.folder.clone(),
        alone,
        together: brief(&outcome.explanation),
    });
    let recordings: Vec<JointRecording> = recordings.collect();
    let explanation = JointExplanation {
        format: JOINT_FORMAT.to_owned(),
        case: claim.case.clone(),
        verdict: verdict(&laws, &recordings),
        alpha: options.alpha,
        shared: laws,
        unlike,
        recordings,
    };
    Ok(JointOutcome { explanation, recordings: together, augmented })
}

fn brief(explanation: &Explanation) -> Brief {
    Brief {
        verdict: explanation.verdict,
        effects: explanation.effects.iter().map(|f| f.effect_id().to_owned()).collect(),
        p_value: explanation.family_p_value,
    }
}

fn verdict(shared: &[SharedEffect], recordings: &[JointRecording]) -> MismatchVerdict {
    let of = |verdict| recordings.iter().any(|r| r.together.verdict == verdict);
    if of(MismatchVerdict::UnknownMismatch) {
        MismatchVerdict::UnknownMismatch
    } else if of(MismatchVerdict::Mismatch) || !shared.is_empty() {
        MismatchVerdict::Mismatch
    } else {
        MismatchVerdict::Consistent
    }
}

/// Laws that the recordings share.
struct Shared {
    laws: Vec<SharedLaw>,
    unlike: Vec<SharedEffect>,
    /// The claim with the laws, in their order behind its own effects.
    claim: Claim,
    rows: usize,
}

/// A law that the recordings share.
struct SharedLaw {
    fitted: FittedLaw,
    told: SharedEffect,
    /// Causes that were looked at to find it.
    family: f64,
}

fn shared(
    recordings: &[Recording],
    alone: &[Outcome],
    claim: &Claim,
    options: &Options,
    progress: &mut dyn FnMut(JointProgress),
) -> Result<Shared, JointError> {
    let found: Vec<Law> = alone
        .iter()
        .flat_map(|o| added(o, claim))
        .filter(|s| of_the_unit(s.effect).is_some())
        .filter_map(of_stated)
        .collect();
    let rows = recordings.iter().map(|r| r.series.time_s.len()).sum();
    let mut out = Shared { laws: vec![], unlike: vec![], claim: claim.clone(), rows };
    let mut taken = vec![];
    for done in 0..options.max_effects {
        let of = Progress {
            doing: "explain.progress.together",
            done: done as u64,
            total: options.max_effects as u64,
        };
        progress(JointProgress { recording: None, of });
        let problems = problems(recordings, alone, claim, &out.claim, options)?;
        let baselines: Vec<Baseline<'_>> = problems.iter().map(|(p, b)| Baseline::new(p, b)).collect();
        let look = select::look(&baselines, &found, &taken, rows, options);
        let told = |f: &FittedLaw| told(f, &baselines, rows, look.family);
        out.unlike = look.unlike.iter().map(&told).collect();
        let Some(best) = look.best else { break };
        let Some(stated) = stated(&best, &baselines) else { break };
        taken.push(best.law.cause());
        out.laws.push(SharedLaw { told: told(&best), fitted: best, family: look.family });
        out.claim.effects.push(stated);
    }
    Ok(out)
}

/// Fits the laws anew, each beside the others and beside what the explanations with them found in single recordings: what a
/// recording alone took for an event of its own may have been part of a law. True where a law moved.
fn refit(
    shared: &mut Shared,
    recordings: &[Recording],
    together: &[Outcome],
    claim: &Claim,
    options: &Options,
) -> Result<bool, JointError> {
    let mut moved = false;
    for i in 0..shared.laws.len() {
        let at = claim.effects.len() + i;
        let mut without = shared.claim.clone();
        without.effects.remove(at);
        let problems = problems(recordings, together, &shared.claim, &without, options)?;
        let baselines: Vec<Baseline<'_>> = problems.iter().map(|(p, b)| Baseline::new(p, b)).collect();
        let (Some(law), rows) = (shared.laws.get_mut(i), shared.rows) else { continue };
        let Some(again) = fit::fit(&law.fitted.law, &baselines) else { continue };
        let again = fit::refined(again, &baselines);
        let Some(stated) = stated(&again, &baselines) else { continue };
        moved |= again.is_apart_from(&law.fitted, MIN_MOVED_SIGMAS);
        law.told = told(&again, &baselines, rows, law.family);
        law.fitted = again;
        shared.claim.effects[at] = stated;
    }
    Ok(moved)
}

/// Effects that the explanation of a recording adds to the claim.
fn added<'a>(outcome: &'a Outcome, claim: &Claim) -> impl Iterator<Item = &'a Stated> {
    outcome.augmented.effects.iter().skip(claim.effects.len())
}

/// Each recording against the claim with what is shared, its noise and its own events as its explanation found them.
fn problems(
    recordings: &[Recording],
    alone: &[Outcome],
    given: &Claim,
    claim: &Claim,
    options: &Options,
) -> Result<Vec<(Problem, FittedHypothesis)>, JointError> {
    let of = |(i, (recording, outcome)): (usize, (&Recording, &Outcome))| {
        let own = added(outcome, given).filter(|s| of_the_unit(s.effect).is_none());
        let claim = Claim {
            noise: outcome.augmented.noise,
            effects: claim.effects.iter().chain(own).cloned().collect(),
            ..claim.clone()
        };
        let fail = |note| JointError { recording: i, note };
        let mut regular = on_grid(recording.series.clone(), &claim, options).map_err(fail)?;
        let mut found = SampleFindings::default();
        samples::take_invalid(&mut regular, &claim, &mut found, options);
        let problem = uncoarsened(&regular, &claim, &mut found, options);
        let base = problem.baseline();
        Ok((problem, base))
    };
    recordings.iter().zip(alone).enumerate().map(of).collect()
}

/// A shared law as a claim states it.
fn stated(best: &FittedLaw, baselines: &[Baseline<'_>]) -> Option<Stated> {
    let told = baselines.iter().zip(&best.shares).find(|(_, s)| s.is_some())?.0;
    Some(best.law.stated(best.coefficients.as_slice(), &told.problem.drivers))
}

fn told(fitted: &FittedLaw, baselines: &[Baseline<'_>], rows: usize, family: f64) -> SharedEffect {
    let law = &fitted.law;
    let of = (0..baselines.len()).filter_map(|i| {
        let alone = fitted.alone(i).and_then(|(c, deviation)| coefficient(law, c, deviation));
        Some(SharedIn {
            recording: i + 1,
            gain: fitted.gain_in(i)?,
            predicted_gain: fitted.predicted_gain(i)?,
            alone: alone.map(|(_, value)| value),
        })
    });
    let of: Vec<SharedIn> = of.collect();
    SharedEffect {
        kind: law.effect.reported_kind().to_owned(),
        effect: (!law.effect.in_format()).then(|| law.effect.kind().to_owned()),
        column: law.column().map(|c| c.name().to_owned()),
        parameters: parameters(fitted, baselines),
        gain: fitted.gain,
        delta_bic: fitted.delta_bic(rows),
        p_value: fitted.p_value(family),
        agreement_p_value: fitted.agreement(),
        predicted_gain: of.iter().map(|o| o.predicted_gain).sum(),
        of,
    }
}

/// The coefficient of a law of one, with its name.
fn coefficient(law: &Law, value: f64, deviation: f64) -> Option<(&'static str, ParameterValue)> {
    let Coefficients::Number(sizing) = &law.coefficients else { return None };
    let value = sizing.claimed + value;
    let half = SCORE_TWO_SIDED_95 * deviation;
    let told =
        ParameterValue { value, unit: sizing.parameter.unit.to_owned(), ci95: [value - half, value + half] };
    Some((sizing.parameter.name, told))
}

/// The reported parameters: the coefficient, wider by what the numbers that were searched for leave open, and those numbers.
fn parameters(fitted: &FittedLaw, baselines: &[Baseline<'_>]) -> BTreeMap<String, ParameterValue> {
    let law = &fitted.law;
    let searched = law.searched();
    let deviations = if matches!(law.coefficients, Coefficients::List(..)) {
        vec![]
    } else {
        fitted.deviations_of_searched(baselines)
    };
    let mut out = BTreeMap::new();
    let mut variance = fitted.covariance.get((0, 0)).copied().unwrap_or(0.0);
    let at: Vec<f64> = searched.iter().map(|(_, v)| *v).collect();
    for (i, ((param, value), deviation)) in searched.iter().zip(&deviations).enumerate() {
        if !deviation.is_finite() {
            continue;
        }
        let mut moved = at.clone();
        moved[i] += deviation;
        if let Some(other) = fit::fit(&law.at(&moved), baselines)
            && let (Some(a), Some(b)) = (other.coefficients.get(0), fitted.coefficients.get(0))
        {
            variance += (a - b).powi(2);
        }
        if param.reported {
            let half = SCORE_TWO_SIDED_95 * deviation;
            let told = ParameterValue {
                value: *value,
                unit: param.unit.to_owned(),
                ci95: [value - half, value + half],
            };
            out.insert(param.name.to_owned(), told);
        }
    }
    if let Some(value) = fitted.coefficients.get(0)
        && let Some((name, told)) = coefficient(law, *value, variance.sqrt())
    {
        out.insert(name.to_owned(), told);
    }
    if let Some(rms) = fitted.rms(baselines) {
        // Along what was fitted, twice the gain is the squared ratio of a size to its deviation.
        let half = rms * SCORE_TWO_SIDED_95 / (2.0 * fitted.gain).sqrt();
        let told = ParameterValue {
            value: rms,
            unit: "deg/h".to_owned(),
            ci95: [(rms - half).max(0.0), rms + half],
        };
        out.insert("rms_deg_h".to_owned(), told);
    }
    out
}

#[cfg(test)]
mod tests;
