//! Detections of effects on single samples in a record, and their consequences.

use super::departures::Departure;
use super::fitted_hypothesis::FittedHypothesis;
use super::flat::flat;
use super::hypothesis::fit;
use super::named::{NamedEffect, SampleFindings, significant_delta_bic};
use super::options::Options;
use super::problem::Problem;
use super::regular::Regular;
use super::select::MIN_DELTA_BIC;
use crate::claim::Claim;
use crate::effect::{
    Detection, Detector, EFFECTS, Effect, FlatResidual, Law, Level, LevelLaw, OutlierDetector, Outliers,
    Reported, RowsFound, Value,
};
use crate::estimate::chi_square_tail;
use crate::numeric::order::SortByNumber;

/// Laws that compete: forms over time, over columns, over the rate.
pub const COMPETING_LAWS: f64 = 16.0;
/// Fewest samples from which a level is determined.
const MIN_LEVEL_SAMPLES: usize = 128;

/// The detectors that are asked: those of effects that are considered, and of those that the claim states. `true` with the
/// latter: they are taken out and not reported.
fn asked<'a>(
    claim: &'a Claim,
    options: &'a Options,
) -> impl Iterator<Item = (&'static dyn Effect, Detector, bool)> + 'a {
    EFFECTS.iter().filter_map(move |effect| {
        let stated = claim.states(*effect);
        let detector = effect.detector().filter(|_| stated || options.allows(effect.kind()))?;
        Some((*effect, detector, stated))
    })
}

/// Sets rows aside that hold no value of their own. The tests that they fail, where the claim does not state them.
pub fn take_invalid(
    regular: &mut Regular,
    claim: &Claim,
    found: &mut SampleFindings,
    options: &Options,
) -> Vec<Departure> {
    let mut out = vec![];
    for (effect, detector, stated) in asked(claim, options) {
        let Detector::Invalid { test, rows: detector } = detector else { continue };
        let Some(RowsFound { rows, detection }) = detector.find(&regular.rows()) else { continue };
        let count = regular.grid.present.iter().filter(|p| **p).count();
        let Detection { gain, parameters, p_value, .. } = detection;
        let Some(delta_bic) = significant_delta_bic(gain, parameters, p_value, count, options.alpha) else {
            continue;
        };
        for row in &rows {
            regular.grid.present[*row] = false;
        }
        let Some(place) = detection.places.first().copied().filter(|_| !stated) else { continue };
        found.named.push(NamedEffect::detected(effect, &detection, delta_bic));
        out.push(Departure { test, place, beside: None, ln_p: -gain, shape: None });
    }
    out
}

/// Groups of outlying samples in the residual of a hypothesis.
pub fn outliers(
    detector: &dyn OutlierDetector,
    problem: &Problem,
    tried: &FittedHypothesis,
) -> Option<Outliers> {
    detector.find(&flat(tried, problem))
}

/// Sets outliers aside; the claim's fit without them. `moved` is the hypothesis that they are judged on.
pub fn take_outliers(
    problem: &mut Problem,
    base: &FittedHypothesis,
    moved: &FittedHypothesis,
    found: &mut SampleFindings,
    options: &Options,
) -> FittedHypothesis {
    let rows = problem.spectra.rows;
    let mut start = base.clone();
    let claim = problem.claim.clone();
    for (effect, detector, stated) in asked(&claim, options) {
        let Detector::Outliers(detector) = detector else { continue };
        let Some(outliers) = outliers(detector, problem, moved) else { continue };
        let (gain, parameters, p_value) = (outliers.gain, outliers.parameters, outliers.p_value);
        let Some(delta_bic) = significant_delta_bic(gain, parameters, p_value, rows, options.alpha) else {
            continue;
        };
        let whole = problem.residual.clone();
        problem.without(&outliers.samples, moved);
        if !stated {
            let removed: Vec<f64> = whole.iter().zip(&problem.residual).map(|(w, r)| w - r).collect();
            let detection = detector.describe(&outliers, &removed, &problem.drivers);
            found.named.extend(detection.map(|d| NamedEffect::detected(effect, &d, delta_bic)));
            found.take(removed);
        }
        start = problem.refitted(base);
    }
    start
}

/// Every law of the level of the noise that says more than one level does, the best by BIC first.
pub fn levels(problem: &Problem, tried: &FittedHypothesis) -> Vec<Level> {
    let residual = flat(tried, problem);
    let samples: Vec<usize> = (0..residual.flat.len()).filter(|i| residual.counts(*i)).collect();
    // Where rounding is coarse, the size of the residual says how near the rate is to a step.
    if samples.len() < MIN_LEVEL_SAMPLES || residual.rounding_step > FlatResidual::COARSE_STEPS {
        return vec![];
    }
    let mut out = vec![];
    for effect in EFFECTS {
        let Some(Detector::Level(detector)) = effect.detector() else { continue };
        let laws = detector.laws(&residual, &samples).into_iter();
        out.extend(laws.filter_map(|law| rated(*effect, law, &residual, &samples)));
    }
    let rows = (samples.len() as f64).ln();
    let score = |l: &Level| 2.0 * l.gain - l.parameters as f64 * rows;
    out.sort_descending_by(|a| score(a));
    recorded_first(&mut out, score);
    out
}

/// Moves the best law of a recorded column before a course of time that bends more and explains hardly more: what readings
/// of the column lose by rounding and noise, such a course does not.
fn recorded_first(levels: &mut [Level], score: impl Fn(&Level) -> f64) {
    /// Share of what a course of time explains that it must explain beyond a column.
    const MIN_BENT_SHARE: f64 = 0.1;
    let Some(best) = levels.first().filter(|l| matches!(l.law, Law::Time(_))) else { return };
    let is_plainer = |l: &Level| {
        let recorded = matches!(l.law, Law::Column(..) | Law::Rate { .. });
        recorded && l.parameters < best.parameters && score(l) > (1.0 - MIN_BENT_SHARE) * score(best)
    };
    if let Some(at) = levels.iter().position(is_plainer) {
        levels[..=at].rotate_right(1);
    }
}

/// Finds what the level of the noise follows, where the claim states nothing of it: the claim's fit with N free, since the
/// level is not the claimed one everywhere.
pub fn take_level(
    problem: &Problem,
    start: FittedHypothesis,
    moved: &FittedHypothesis,
    found: &mut SampleFindings,
    options: &Options,
) -> FittedHypothesis {
    let rows = problem.spectra.rows;
    let mut levels = levels(problem, moved);
    levels.retain(|l| options.allows(l.effect.kind()));
    let passing = levels
        .first()
        .and_then(|l| significant_delta_bic(l.gain, l.parameters, l.p_value, rows, options.alpha));
    let Some(delta_bic) = passing else { return start };
    found.named.extend(level_named(&levels, delta_bic, problem));
    found.level = levels.into_iter().next().map(|l| l.profile);
    with_free_level(&start, problem)
}

/// The leading law as a finding. The second best law of another effect is its equivalent when it is near.
fn level_named(levels: &[Level], delta_bic: f64, problem: &Problem) -> Option<NamedEffect> {
    let best = levels.first()?;
    let Some(Detector::Level(detector)) = best.effect.detector() else { return None };
    let ratio = best.effect.params().first()?;
    let rows = (problem.spectra.rows as f64).ln();
    let score = |l: &Level| 2.0 * l.gain - l.parameters as f64 * rows;
    let mut others = levels.iter().skip(1).filter(|l| l.effect.kind() != best.effect.kind());
    let equivalent = others.find(|l| score(l) > score(best) - MIN_DELTA_BIC).map(|l| l.effect.kind());
    let mut stated = detector.stated(best, &problem.drivers);
    stated.insert(ratio.name.to_owned(), Value::Number(best.ratio));
    let detection = Detection {
        reported: vec![Reported::new(ratio.name, ratio.unit, best.ratio, best.ci95)],
        stated,
        places: best.places.clone(),
        gain: best.gain,
        parameters: best.parameters,
        p_value: best.p_value,
    };
    let equivalents = equivalent.into_iter().collect();
    Some(NamedEffect { equivalents, ..NamedEffect::detected(best.effect, &detection, delta_bic) })
}

/// A law held against single samples; `None` for one that they do not bear out.
fn rated(
    effect: &'static dyn Effect,
    mut found: LevelLaw,
    residual: &FlatResidual<'_>,
    samples: &[usize],
) -> Option<Level> {
    let n = found.profile.len() as f64;
    let root = (found.profile.iter().map(|g| g * g).sum::<f64>() / n).sqrt();
    found.profile.iter_mut().for_each(|g| *g /= root);
    match &mut found.law {
        Law::Time(knots) | Law::Column(_, knots) => knots.iter_mut().for_each(|k| k.value /= root),
        Law::Rate { .. } => {}
    }
    let sample = |i: &usize| (residual.white[*i], found.profile[*i]);
    let on_white = gain_of(samples.iter().map(sample));
    let difference = |i: &usize| {
        let last = i.checked_sub(1)?;
        Some((residual.flat[*i] - residual.flat[last], (found.profile[*i] * found.profile[last]).sqrt()))
    };
    let on_differences = gain_of(samples.iter().filter_map(difference));
    // What the whitened residual does not show, or shows for another reason, is not counted; nor is a smooth course,
    // which differences do not have.
    let gain = found.gain.min(on_white).min(on_differences);
    let tail = chi_square_tail(2.0 * gain.max(0.0) / found.dispersion, found.free as f64);
    let p_value = (COMPETING_LAWS * found.trials * tail).min(1.0);
    let keep = gain.is_finite() && gain > 0.5 * found.free as f64 && p_value < 0.05;
    keep.then_some(Level {
        effect,
        law: found.law,
        profile: found.profile,
        gain,
        parameters: found.parameters,
        p_value,
        ratio: found.ratio,
        ci95: found.ci95,
        places: vec![found.place],
    })
}

/// Gain of log-likelihood of values by their relative deviations, each side with a level of its own.
fn gain_of(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut before, mut after, mut logs, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (e, g) in values {
        before += e * e;
        after += (e / g).powi(2);
        logs += g.ln();
        count += 1.0;
    }
    -logs - 0.5 * count * (after / before).ln()
}

/// Rows that are missing on the grid of the claim and that it does not state, effect by effect.
pub fn missing(problem: &Problem, claim: &Claim) -> Vec<(&'static dyn Effect, Detection)> {
    let one = |effect: &&'static dyn Effect| {
        let Some(Detector::Missing(detector)) = effect.detector() else { return None };
        if claim.states(*effect) {
            return None;
        }
        detector.find(&problem.grid.rows(&[])).map(|found| (*effect, found.detection))
    };
    EFFECTS.iter().filter_map(one).collect()
}

/// The same hypothesis with N unconstrained, for a level of the noise that is not the claimed one everywhere.
pub fn with_free_level(base: &FittedHypothesis, problem: &Problem) -> FittedHypothesis {
    let mut hypothesis = base.hypothesis.clone();
    hypothesis.noise.unconstrained[0] = true;
    let fit = fit(&mut hypothesis, &problem.spectra.full);
    FittedHypothesis { hypothesis, fit, parameters: base.parameters + 1, odds: base.odds.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(law: Law, gain: f64, parameters: usize) -> Level {
        Level {
            effect: EFFECTS[0],
            law,
            profile: vec![],
            gain,
            parameters,
            p_value: 0.0,
            ratio: 1.0,
            ci95: [1.0; 2],
            places: vec![],
        }
    }

    #[test]
    fn a_column_comes_before_a_course_of_time_that_bends_more_and_says_hardly_more() {
        let column = |gain, parameters| {
            level(Law::Column(crate::effect::Column::of_name("p"), vec![]), gain, parameters)
        };
        let first = |time: Level, column: Level| {
            let mut levels = vec![time, column];
            recorded_first(&mut levels, |l| 2.0 * l.gain);
            matches!(levels[0].law, Law::Column(..))
        };
        assert!(first(level(Law::Time(vec![]), 249.0, 4), column(230.0, 2)));
        // A course as plain as the law of the column, and one that says clearly more.
        assert!(!first(level(Law::Time(vec![]), 249.0, 2), column(230.0, 2)));
        assert!(!first(level(Law::Time(vec![]), 249.0, 4), column(200.0, 2)));
    }

    #[test]
    fn the_gain_of_known_deviations_is_that_of_their_likelihood() {
        // Deviations 1 and 3 in turns, each value one of its deviation: with one level for all, of mean square 5, the
        // likelihood is lower by ½ n ln 5 − Σ ln g.
        let values = (0..200).map(|i| if i % 2 == 0 { (1.0, 1.0) } else { (-3.0, 3.0) });
        let expected = 100.0 * 5f64.ln() - 100.0 * 3f64.ln();
        assert!((gain_of(values) - expected).abs() < 1e-9);
        // A level that values do not follow loses what they would have gained by its inverse.
        let wrong = (0..200).map(|i| if i % 2 == 0 { (1.0, 2.0) } else { (1.0, 1.0) });
        assert!(gain_of(wrong) < 0.0);
    }
}
