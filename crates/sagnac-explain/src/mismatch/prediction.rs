//! Recorded columns that predict, before processes that cannot.
//!
//! A raised process fits anything slow and predicts nothing; a course that follows a recorded column predicts stretches of the
//! record that it was not fitted to. Where a process explains more by some nats and the column predicts more of the stretches
//! held out, the column is the likelier cause by what it predicts.

use super::fitted_hypothesis::Candidate;
use super::heldout::Halves;
use crate::effect::{Domain, Effect, Model};
use crate::numeric::order::SortByNumber;

/// Part of the gain of the process from which a course is compared with it.
const COMPARED_GAIN_SHARE: f64 = 0.4;
/// Courses that are compared.
const MAX_COMPARED: usize = 2;
/// Least predictive gain of a course over the process, nats: less comes from the choice of its terms, which saw the whole record.
const MIN_PREDICTION_GAIN: f64 = 4.0;

/// True for a process that fits anything slow.
pub(super) fn is_process(effect: &dyn Effect) -> bool {
    matches!(effect.model(), Model::Spectrum(spectrum) if spectrum.has_course())
}

/// True for an effect that follows a recorded column.
fn follows_column(effect: &dyn Effect) -> bool {
    let recorded = !effect.needs().is_empty() || effect.domain() == Domain::Driver;
    recorded && matches!(effect.model(), Model::Mean(_))
}

/// Lowers the odds of processes by what a course of a recorded column predicts more than the leading one, and puts the candidates in
/// order again. The courses keep their order among one another: which of them is the law, their likelihoods say. `passes` says which
/// additions may be made.
pub(super) fn weigh(
    found: &mut [Candidate],
    halves: &Halves,
    rows: usize,
    passes: impl Fn(&Candidate) -> bool,
) {
    let Some(leader) = found.first().filter(|c| is_process(c.effect)) else { return };
    let least = COMPARED_GAIN_SHARE * leader.gain;
    let compared = |c: &Candidate| c.gain >= least && follows_column(c.effect) && passes(c);
    let courses: Vec<usize> = (1..found.len()).filter(|i| compared(&found[*i])).take(MAX_COMPARED).collect();
    if courses.is_empty() {
        return;
    }
    let of_process = halves.judge(&leader.tried).log_likelihood;
    let predicted = courses.into_iter().map(|i| halves.judge(&found[i].tried).log_likelihood - of_process);
    let more = predicted.fold(0.0, f64::max);
    if more < MIN_PREDICTION_GAIN {
        return;
    }
    for process in found.iter_mut().filter(|c| is_process(c.effect)) {
        if let Some((_, odds)) = process.tried.odds.last_mut() {
            *odds -= more;
        }
    }
    found.sort_ascending_by(|a| a.tried.rank(rows));
}
