//! A course as an addition: the best of its shapes with the noise held, then everything fitted together.

use crate::effect::{Effect, MeanModel, Resolution, SearchContext, plausible};
use crate::estimate::chi_square_tail;
use crate::mismatch::fitted_hypothesis::{
    Candidate, FittedHypothesis, SearchEffort, SpectralDataSet, bic_overcharge, effective_modes, own_odds,
    score_candidate,
};
use crate::mismatch::hypothesis::{self, Fit, Hypothesis, PartModes, columns, kept, less_fixed};
use crate::mismatch::noise_fit::{self, Noise};
use crate::mismatch::nonlinear_search::LocalSearch;
use crate::mismatch::several::least_of;
use crate::mismatch::spectral_data::SpectralData;
use crate::mismatch::terms::MeanTerm;
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::least_squares::{Normal, subtract};
use crate::numeric::order::SortByNumber;
use std::borrow::Cow;

/// Samples above which a course at the sample rate is tried by itself.
const LONG_SAMPLES: usize = 1 << 20;
/// Gain of a fit over that of its shapes, the noise held, from which the noise stood for the course.
const STOOD_FOR: f64 = 1.5;

/// Data that every course tried on a hypothesis shares.
pub(super) struct Baselines<'a> {
    /// `None` where only averages are looked at.
    full: Option<Baseline<'a>>,
    slow: Option<Baseline<'a>>,
    /// Log-likelihood by which the noise of the hypothesis is behind that of its fit.
    behind: f64,
}

impl<'a> Baselines<'a> {
    /// With the noise of the fit.
    pub fn fitted(before: &'a FittedHypothesis, spectra: &'a SpectralDataSet) -> Baselines<'a> {
        Baselines::new(before, spectra, true, 0.0)
    }

    /// With another noise than that of the fit. Of a long record only averages are looked at: what the noise moved for is slow.
    pub fn restated(restated: &'a FittedHypothesis, spectra: &'a SpectralDataSet) -> Baselines<'a> {
        let FittedHypothesis { hypothesis, fit, .. } = restated;
        let whittle =
            noise_fit::whittle(&spectra.full, &fit.observed, &hypothesis.noise.densities(&spectra.full));
        let behind = fit.log_likelihood - (whittle + hypothesis.noise.prior() + fit.mean.prior);
        Baselines::new(restated, spectra, spectra.full.length <= LONG_SAMPLES, behind)
    }

    fn new(
        before: &'a FittedHypothesis,
        spectra: &'a SpectralDataSet,
        at_full_rate: bool,
        behind: f64,
    ) -> Baselines<'a> {
        let courses = &before.hypothesis.courses;
        let baseline =
            |spectral, resolution| Baseline::new(before, spectral, spectra.part_modes(resolution, courses));
        let slow = spectra.slow.as_ref().map(|slow| baseline(slow, Resolution::Averaged));
        let full = (at_full_rate || slow.is_none()).then(|| baseline(&spectra.full, Resolution::FullRate));
        Baselines { full, slow, behind }
    }

    fn of(&self, resolution: Resolution) -> Option<&Baseline<'a>> {
        match (resolution, &self.slow) {
            (Resolution::Averaged, Some(slow)) => Some(slow),
            _ => self.full.as_ref(),
        }
    }

    /// True where a course of some resolution has more samples than fit into memory twice at once.
    pub fn is_long(&self, resolution: Resolution) -> bool {
        self.of(resolution).is_some_and(|g| g.spectral.length > LONG_SAMPLES)
    }
}

/// A hypothesis before spectral data, ready for columns to be added to it.
pub(super) struct Baseline<'a> {
    pub spectral: &'a SpectralData,
    before: &'a FittedHypothesis,
    parts: Vec<PartModes>,
    powers: Vec<f64>,
    /// The modes that are to be explained: everything fixed taken out.
    data: Cow<'a, [f64]>,
    residual: Vec<f64>,
    score: Vec<f64>,
    left: f64,
}

impl<'a> Baseline<'a> {
    fn new(before: &'a FittedHypothesis, spectral: &'a SpectralData, parts: Vec<PartModes>) -> Baseline<'a> {
        let densities = before.hypothesis.noise.densities(spectral);
        let powers = spectral.powers(&densities);
        let data = less_fixed(spectral, &parts);
        let mut out =
            Baseline { spectral, before, parts, powers, data, residual: vec![], score: vec![], left: 0.0 };
        let columns = out.columns(None);
        let normal = Normal::new(&columns, &out.data, &out.powers);
        let (coefficients, _, left) = normal.solve();
        let mut residual = out.data.to_vec();
        for ((column, _), c) in columns.iter().zip(&coefficients) {
            subtract(&mut residual, column, *c);
        }
        let weighted: Vec<f64> = residual.iter().zip(&out.powers).map(|(r, p)| r / p).collect();
        out.score = inverse_dct2(&weighted);
        out.residual = residual;
        out.left = left;
        out
    }

    /// The columns of the hypothesis with their priors, less the nuisance that a new course replaces.
    fn columns(&self, course: Option<&dyn MeanModel>) -> Vec<(&[f64], f64)> {
        let replaced = course.and_then(|c| c.replaces());
        let mut nuisances = kept(self.spectral, &self.before.hypothesis.courses);
        nuisances.retain(|n| Some(n.nuisance) != replaced);
        columns(&nuisances, &self.parts)
    }

    fn context(&self) -> SearchContext<'_> {
        SearchContext { score: &self.score, modes: &self.residual, powers: &self.powers }
    }
}

/// Gains of a course for its shapes, the noise held.
struct ShapeSearch<'a> {
    course: &'a dyn MeanModel,
    baseline: &'a Baseline<'a>,
    columns: Vec<(&'a [f64], f64)>,
    normal: Normal,
}

impl<'a> ShapeSearch<'a> {
    fn new(course: &'a dyn MeanModel, baseline: &'a Baseline<'a>) -> ShapeSearch<'a> {
        let columns = baseline.columns(Some(course));
        let normal = Normal::new(&columns, &baseline.data, &baseline.powers);
        ShapeSearch { course, baseline, columns, normal }
    }

    fn gain(&self, nonlinear_parameters: &[f64]) -> f64 {
        let baseline = self.baseline;
        let parts = PartModes::of_shape(self.course, nonlinear_parameters, baseline.spectral);
        if parts.offset.is_none() && parts.columns.is_empty() {
            return f64::NEG_INFINITY;
        }
        let mut data = Cow::Borrowed(&*baseline.data);
        if let Some(fixed) = &parts.offset {
            subtract(data.to_mut(), fixed, 1.0);
        }
        let new: Vec<&[f64]> = parts.columns.iter().chain(&parts.nuisance).map(Vec::as_slice).collect();
        let normal = self.normal.with(&self.columns, &new, &data, parts.offset.is_some(), &baseline.powers);
        0.5 * (baseline.left - normal.solve().2)
    }
}

/// A shape improved by a local search, with its gain.
fn refined(start: &[f64], local: &LocalSearch, search: &ShapeSearch<'_>) -> (Vec<f64>, f64) {
    const MAX_EVALUATIONS: usize = 60;
    local.refine(start, MAX_EVALUATIONS, |x| search.gain(x))
}

/// The best of the shapes that a course begins from, the noise held, each improved by a local search, with its gain.
fn best_shape(starts: &[Vec<f64>], local: &LocalSearch, search: &ShapeSearch<'_>) -> Option<(Vec<f64>, f64)> {
    let mut rough: Vec<(Vec<f64>, f64)> = starts.iter().map(|s| (s.clone(), search.gain(s))).collect();
    rough.sort_descending_by(|a| a.1);
    let leader = rough.first()?.1;
    let promising = rough.into_iter().filter(|(_, g)| *g > 0.7 * leader).take(2);
    promising
        .map(|(s, g)| if s.is_empty() { (s, g) } else { refined(&s, local, search) })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, gain)| !gain.is_nan() && *gain >= 0.5)
}

/// A hypothesis with one more course, and another noise.
fn with_course(
    before: &Hypothesis,
    effect: &'static dyn Effect,
    nonlinear_parameters: &[f64],
    noise: &Noise,
) -> Hypothesis {
    let mut hypothesis = Hypothesis { noise: noise.clone(), ..before.clone() };
    let nonlinear_parameters = nonlinear_parameters.to_vec();
    hypothesis.courses.push(MeanTerm { effect, nonlinear_parameters, coefficients: vec![], states: vec![] });
    hypothesis
}

/// Gain of the course of a parameter that is nothing at zero, taken for a column there: it needs no search, and is χ² of one degree of
/// freedom where the effect is not there. `None` for another effect.
fn score_gain(course: &dyn MeanModel, baseline: &Baseline<'_>) -> Option<f64> {
    let drivers = &baseline.spectral.drivers;
    let modes =
        baseline.spectral.transform(&course.regressors(&[course.score_step(drivers)?], drivers).offset?);
    let search = ShapeSearch::new(course, baseline);
    let normal = search.normal.with(&search.columns, &[&modes], &baseline.data, false, &baseline.powers);
    Some(0.5 * (baseline.left - normal.solve().2))
}

/// Probability of a gain that a search or a score test brought, whichever is less: two tests.
fn with_score_test(by_search: f64, score_gain: Option<f64>) -> f64 {
    let Some(gain) = score_gain else { return by_search };
    least_of(by_search.min(chi_square_tail(2.0 * gain.max(0.0), 1.0)), 2.0)
}

/// Information of each mode on a fitted course: its square over the variance of the mode.
fn informations(course: &dyn MeanModel, inside: &MeanTerm, baseline: &Baseline<'_>) -> Vec<f64> {
    let parts = PartModes::of_shape(course, &inside.nonlinear_parameters, baseline.spectral);
    let mut modes = parts.offset.map_or_else(|| vec![0.0; baseline.powers.len()], |fixed| fixed.to_vec());
    for (column, c) in parts.columns.iter().zip(&inside.coefficients) {
        subtract(&mut modes, column, -c);
    }
    modes.iter().zip(&baseline.powers).map(|(z, p)| z * z / p).collect()
}

/// A course that was fitted, on the baseline that its shape was found on.
struct FittedCourse<'a> {
    baseline: &'a Baseline<'a>,
    /// Independent places that were looked at for its shape.
    trials: f64,
    shape: Vec<f64>,
    /// Columns of the course, and numbers that are fitted besides.
    columns: usize,
    beside: usize,
    hypothesis: Hypothesis,
    fit: Fit,
}

/// The best addition of a course, over its shapes: sought with the noise as it was fitted and, where that has moved far from the
/// claim, with the noise as claimed. A noise that stands for the course hides it from its own search.
pub(super) fn try_course(
    effect: &'static dyn Effect,
    course: &'static dyn MeanModel,
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
    baselines: &[Option<Baselines<'_>>; 2],
) -> Option<Candidate> {
    let each = baselines.iter().flatten().filter_map(|baselines| {
        let baseline = baselines.of(course.resolution())?;
        fitted(effect, course, before, spectra, baseline, baselines.behind)
    });
    let best = each.max_by(|a, b| a.fit.log_likelihood.total_cmp(&b.fit.log_likelihood))?;
    let FittedCourse { baseline, trials, shape, columns, beside, hypothesis, fit } = best;
    let drivers = &baseline.spectral.drivers;
    let added = course.bic_parameters(columns) + beside;
    // A fit with a value that the effect cannot have (a zone that answers more than the rest) is another effect.
    let allowed = hypothesis.courses.last().is_none_or(|inside| {
        let parameters = || course.parameters(&inside.nonlinear_parameters, &inside.coefficients, drivers);
        inside.coefficients.len() != columns || plausible(effect, &parameters())
    });
    let relief = hypothesis.courses.last().map_or(0.0, |inside| {
        let modes = effective_modes(informations(course, inside, baseline).into_iter());
        bic_overcharge(added, modes, spectra.rows)
    });
    let tried = FittedHypothesis {
        hypothesis,
        fit,
        parameters: before.parameters + added,
        odds: before.odds_with(effect, course.odds(&shape, drivers) + own_odds(effect) + relief),
    };
    let effort = SearchEffort { numbers: columns + beside, trials };
    allowed.then(|| {
        let scored = score_candidate(effect, tried, before, effort, spectra.rows);
        Candidate { p_value: with_score_test(scored.p_value, score_gain(course, baseline)), ..scored }
    })
}

/// The best addition of a course whose shape is sought on one baseline, fitted from the noise of that baseline.
fn fitted<'a>(
    effect: &'static dyn Effect,
    course: &'static dyn MeanModel,
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
    baseline: &'a Baseline<'a>,
    behind: f64,
) -> Option<FittedCourse<'a>> {
    let repeated = before.hypothesis.courses.iter().any(|c| c.effect.kind() == effect.kind());
    let drivers = &baseline.spectral.drivers;
    if !course.applies(drivers) || effect.needs().iter().any(|c| drivers.column(*c).is_none()) {
        return None;
    }
    let starts = course.starts(drivers, &baseline.context());
    // A linear course twice is the same column twice.
    if repeated && starts.points.iter().all(Vec::is_empty) {
        return None;
    }
    let earlier = before.hypothesis.courses.iter().filter(|c| c.effect.kind() == effect.kind());
    let is_found =
        |point: &Vec<f64>| earlier.clone().any(|c| course.same_cause(&c.nonlinear_parameters, point));
    if starts.points.iter().all(is_found) && !starts.points.is_empty() && repeated {
        return None;
    }
    let local = LocalSearch::of(course, drivers);
    let (shape, gain) = best_shape(&starts.points, &local, &ShapeSearch::new(course, baseline))?;
    let parts = course.regressors(&shape, drivers);
    let (columns, beside) = (parts.columns.len(), parts.nuisance.len() + local.free());
    let noise = &baseline.before.hypothesis.noise;
    let mut hypothesis = with_course(&before.hypothesis, effect, &shape, noise);
    // The noise, fitted anew, can give at most about as much again.
    let price = (course.bic_parameters(columns) + beside) as f64 * (spectra.rows as f64).ln();
    let gain = gain - behind;
    let worth = 4.0 * gain - price;
    let mut fit =
        if worth > 0.0 { hypothesis::fit(&mut hypothesis, &spectra.full) } else { before.fit.raised(gain) };
    // Noise that had to stand for the course weighed the samples wrongly while its shape was sought.
    if !shape.is_empty() && fit.log_likelihood - before.fit.log_likelihood > STOOD_FOR * gain.max(0.0) {
        let noise = &hypothesis.noise;
        let quieter = FittedHypothesis {
            hypothesis: Hypothesis { noise: noise.clone(), ..before.hypothesis.clone() },
            ..before.clone()
        };
        let baseline = Baseline::new(&quieter, baseline.spectral, baseline.parts.clone());
        let (shape, _) = refined(&shape, &local, &ShapeSearch::new(course, &baseline));
        let mut again = with_course(&before.hypothesis, effect, &shape, noise);
        let better = hypothesis::fit(&mut again, &spectra.full);
        if better.log_likelihood > fit.log_likelihood {
            (hypothesis, fit) = (again, better);
        }
    }
    Some(FittedCourse { baseline, trials: starts.trials, shape, columns, beside, hypothesis, fit })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_parameter_that_is_nothing_at_zero_pays_for_no_search() {
        // 13.6 nats of one number: χ²₁ beyond 27.2 has 1.8e-7, whatever the search for a lag looked at.
        let p = with_score_test(1e-2, Some(13.6));
        assert!((p / 2.0 / 1.836e-7 - 1.0).abs() < 0.01, "{p}");
        // A lag that is far from zero shows in the search, which then has one look more to pay for.
        assert!((with_score_test(1e-9, Some(0.3)) / 2e-9 - 1.0).abs() < 1e-6);
        assert_eq!(with_score_test(1e-9, None), 1e-9);
        // 1 − 0.2².
        assert!((with_score_test(0.8, Some(0.0)) - 0.96).abs() < 1e-12);
    }
}
