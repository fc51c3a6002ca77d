//! Every effect of the catalogue, tried as an addition to a hypothesis.

mod course;
mod spectrum;

use super::fitted_hypothesis::{Candidate, FittedHypothesis, SpectralDataSet};
use super::options::Options;
use crate::effect::{EFFECTS, Effect, Model};
use crate::numeric::order::SortByNumber;
use crate::numeric::parallel;
use course::{Baselines, try_course};
use spectrum::try_spectrum;

/// The hypothesis with its noise as the claim states it, where the fit moved it far from there: it may stand for a course.
fn restated(before: &FittedHypothesis) -> Option<FittedHypothesis> {
    /// Logarithm of the prior from which noise has moved: √8 of its stated deviations, were it one coefficient.
    const MOVED_LOG_PRIOR: f64 = -4.0;
    (before.hypothesis.noise.prior() < MOVED_LOG_PRIOR).then(|| {
        let mut out = before.clone();
        out.hypothesis.noise.restate();
        out
    })
}

/// Fits every effect that is considered and not in the hypothesis yet as an addition to it; those that gain something,
/// the largest ΔBIC first.
pub fn all(before: &FittedHypothesis, spectra: &SpectralDataSet, options: &Options) -> Vec<Candidate> {
    among(before, spectra, |e| options.allows(e.kind()))
}

/// [`all`] for the wanted effects only.
pub fn among(
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
    wanted: impl Fn(&dyn Effect) -> bool + Sync,
) -> Vec<Candidate> {
    // Baselines take transforms of the whole record, and a search for filters alone needs none.
    let any_course = EFFECTS.iter().any(|e| wanted(*e) && matches!(e.model(), Model::Mean(_)));
    let restated = restated(before).filter(|_| any_course);
    let baselines = [
        any_course.then(|| Baselines::fitted(before, spectra)),
        restated.as_ref().map(|restated| Baselines::restated(restated, spectra)),
    ];
    let tried = |effect: &&'static dyn Effect| match effect.model() {
        Model::Mean(course) => try_course(*effect, course, before, spectra, &baselines),
        Model::Spectrum(spectrum) => try_spectrum(*effect, spectrum, before, spectra),
        Model::Samples(_) => None,
    };
    // Two long ones at once would not fit into the memory that a record is granted.
    let long = |effect: &&'static dyn Effect| {
        let resolution = match effect.model() {
            Model::Mean(course) => course.resolution(),
            _ => return false,
        };
        baselines.iter().flatten().any(|g| g.is_long(resolution))
    };
    let (alone, together): (Vec<_>, Vec<_>) = EFFECTS.iter().filter(|e| wanted(**e)).partition(|e| long(e));
    let mut found: Vec<Candidate> =
        parallel::map_items(&together, |e| tried(*e)).into_iter().flatten().collect();
    found.extend(alone.into_iter().filter_map(tried));
    // Kinds with the same course are ordered by what else speaks for them.
    found.sort_ascending_by(|a| a.tried.rank(spectra.rows));
    found
}
