//! A law fitted to all recordings: their scores and informations add up, since their noises are independent.

use super::baseline::{Baseline, LawInformation};
use super::law::{Coefficients, Law};
use crate::estimate::chi_square_tail;
use crate::numeric::optimize::pattern_search;
use crate::numeric::parallel;
use crate::numeric::range::Bounds;
use nalgebra::{DMatrix, DVector};

/// Evaluations of a search for the numbers of a law, and the loss of log-likelihood below which it stops.
const SEARCH_LIMITS: (usize, f64) = (120, 1e-4);

/// A law with what all recordings say of it.
#[derive(Clone)]
pub(super) struct FittedLaw {
    pub law: Law,
    /// Coefficients of the law over all recordings.
    pub coefficients: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Gain of log-likelihood over all recordings, nats.
    pub gain: f64,
    /// Information of each recording; `None` for one that lacks what the law needs.
    pub shares: Vec<Option<LawInformation>>,
}

/// Fits a law; `None` where fewer than two recordings tell of it.
pub(super) fn fit(law: &Law, baselines: &[Baseline<'_>]) -> Option<FittedLaw> {
    let shares: Vec<Option<LawInformation>> = parallel::map_items(baselines, |g| g.information(law));
    if shares.iter().flatten().count() < 2 {
        return None;
    }
    let (score, information) = total(shares.iter().flatten())?;
    let fixed: f64 = shares.iter().flatten().map(fixed_gain).sum();
    let covariance =
        if score.is_empty() { DMatrix::zeros(0, 0) } else { information.clone().try_inverse()? };
    let coefficients = &covariance * &score;
    let deviation = baselines.iter().map(|g| g.prior_deviation(law)).fold(0.0, f64::max);
    // A value that the claim knows with an uncertainty is one value in all recordings: what its prior allows is no gain.
    let allowed = DMatrix::identity(score.len(), score.len()) * deviation.powi(2);
    let gain = match (&covariance + allowed).try_inverse() {
        Some(weight) if !score.is_empty() => {
            0.5 * (coefficients.transpose() * weight * &coefficients)[(0, 0)]
        }
        _ => 0.0,
    };
    let gain = gain + fixed;
    gain.is_finite().then_some(FittedLaw { law: law.clone(), coefficients, covariance, gain, shares })
}

/// Fits a law with the numbers that it has beside its coefficients searched for.
pub(super) fn refined(fitted: FittedLaw, baselines: &[Baseline<'_>]) -> FittedLaw {
    let searched = fitted.law.searched();
    if searched.is_empty() || matches!(fitted.law.coefficients, Coefficients::List(..)) {
        return fitted;
    }
    let start: Vec<f64> = searched.iter().map(|(_, at)| *at).collect();
    let bounds: Vec<Bounds> = searched.iter().map(|(p, _)| Bounds::new(p.lower, p.upper)).collect();
    let first: Vec<Option<f64>> = searched
        .iter()
        .map(|(p, at)| (p.lower <= 0.0 || p.upper / p.lower <= 20.0).then(|| 0.2 * at.abs().max(1e-12)))
        .collect();
    let gain =
        |numbers: &[f64]| fit(&fitted.law.at(numbers), baselines).map_or(f64::NEG_INFINITY, |f| f.gain);
    let (numbers, _) = pattern_search(&start, &bounds, &first, SEARCH_LIMITS, gain);
    fit(&fitted.law.at(&numbers), baselines).filter(|f| f.gain > fitted.gain).unwrap_or(fitted)
}

/// Scores and informations summed.
fn total<'a>(shares: impl Iterator<Item = &'a LawInformation>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let mut sum: Option<(DVector<f64>, DMatrix<f64>)> = None;
    for share in shares {
        let LawInformation::Quadratic { score, information } = share else { continue };
        sum = Some(match sum {
            None => (score.clone(), information.clone()),
            Some((s, i)) if s.len() == score.len() => (s + score, i + information),
            Some(_) => return None,
        });
    }
    Some(sum.unwrap_or_else(|| (DVector::zeros(0), DMatrix::zeros(0, 0))))
}

fn fixed_gain(share: &LawInformation) -> f64 {
    match share {
        LawInformation::Gain(gain) => *gain,
        LawInformation::Quadratic { .. } => 0.0,
    }
}

impl FittedLaw {
    /// Gain of one recording by the law with given coefficients, nats.
    fn gain_of(share: &LawInformation, coefficients: &DVector<f64>) -> f64 {
        match share {
            LawInformation::Gain(gain) => *gain,
            LawInformation::Quadratic { score, information } => {
                score.dot(coefficients)
                    - 0.5 * (coefficients.transpose() * information * coefficients)[(0, 0)]
            }
        }
    }

    /// Gain of a recording by the law of all, nats.
    pub fn gain_in(&self, recording: usize) -> Option<f64> {
        let share = self.shares.get(recording)?.as_ref()?;
        Some(FittedLaw::gain_of(share, &self.coefficients))
    }

    /// Gain of a recording by the law as the others alone have it, nats.
    pub fn predicted_gain(&self, recording: usize) -> Option<f64> {
        let share = self.shares.get(recording)?.as_ref()?;
        let others = self.shares.iter().enumerate().filter(|(i, _)| *i != recording);
        let (score, information) = total(others.filter_map(|(_, s)| s.as_ref()))?;
        let coefficients = information.try_inverse().map(|c| c * score);
        Some(FittedLaw::gain_of(
            share,
            &coefficients.unwrap_or_else(|| DVector::zeros(self.coefficients.len())),
        ))
    }

    /// Contribution of the law, rms about its mean in each recording, over all of them, deg/h.
    pub fn rms(&self, baselines: &[Baseline<'_>]) -> Option<f64> {
        let told = baselines.iter().zip(&self.shares).filter(|(_, s)| s.is_some());
        let courses = told.filter_map(|(g, _)| g.course(&self.law, self.coefficients.as_slice()));
        let (mut squares, mut samples) = (0.0, 0usize);
        for course in courses {
            let mean = course.iter().sum::<f64>() / course.len().max(1) as f64;
            squares += course.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            samples += course.len();
        }
        (samples > 0).then(|| (squares / samples as f64).sqrt())
    }

    /// The coefficient of a law of one, as a recording alone has it, with its deviation.
    pub fn alone(&self, recording: usize) -> Option<(f64, f64)> {
        let LawInformation::Quadratic { score, information } = self.shares.get(recording)?.as_ref()? else {
            return None;
        };
        let information = (score.len() == 1).then(|| information[(0, 0)]).filter(|i| *i > 0.0)?;
        Some((score[0] / information, information.powf(-0.5)))
    }

    /// True where a coefficient, or a number that was searched for, differs from that of another fit of the law: by some of its
    /// deviations, or by a hundredth.
    pub fn is_apart_from(&self, other: &FittedLaw, deviations: f64) -> bool {
        let away = |i: usize| (self.coefficients[i] - other.coefficients[i]).abs();
        let same_law = self.coefficients.len() == other.coefficients.len();
        let moved =
            (0..self.coefficients.len()).any(|i| away(i) > deviations * self.covariance[(i, i)].sqrt());
        let numbers = self.law.searched().into_iter().zip(other.law.searched());
        let elsewhere = numbers.into_iter().any(|((_, a), (_, b))| (a - b).abs() > 0.01 * a.abs());
        !same_law || moved || elsewhere
    }

    /// Probability of coefficients that differ so much between recordings that have the same: Cochran's Q, which is χ²
    /// distributed.
    pub fn agreement(&self) -> f64 {
        let own = self.shares.iter().flatten().filter_map(|share| {
            let LawInformation::Quadratic { score, information } = share else { return None };
            let away = information.clone().try_inverse()? * score - &self.coefficients;
            Some((away.transpose() * information * &away)[(0, 0)])
        });
        let own: Vec<f64> = own.collect();
        let freedom = own.len().saturating_sub(1) * self.coefficients.len();
        if freedom == 0 { 1.0 } else { chi_square_tail(own.iter().sum(), freedom as f64) }
    }

    /// BIC without the law less BIC with it.
    pub fn delta_bic(&self, rows: usize) -> f64 {
        2.0 * self.gain - self.law.numbers as f64 * (rows.max(1) as f64).ln()
    }

    /// Probability of such a gain by chance, everything that was looked at counted: `family` causes.
    pub fn p_value(&self, family: f64) -> f64 {
        let chance = chi_square_tail(2.0 * self.gain.max(0.0), self.law.numbers.max(1) as f64);
        (chance * self.law.trials.max(1.0) * family).min(1.0)
    }

    /// Standard deviations of the numbers that were searched for, in the order of [`Law::searched`], by the curvature of the
    /// gain; NaN where it has no peak.
    pub fn deviations_of_searched(&self, baselines: &[Baseline<'_>]) -> Vec<f64> {
        let at: Vec<f64> = self.law.searched().iter().map(|(_, v)| *v).collect();
        let gain = |numbers: &[f64]| fit(&self.law.at(numbers), baselines).map_or(f64::NAN, |f| f.gain);
        let steps: Vec<f64> = (0..at.len()).map(|i| step(&at, i, self.gain, gain)).collect();
        let moved = |i: usize, a: f64, j: usize, b: f64| {
            let mut to = at.clone();
            to[i] += a * steps[i];
            to[j] += b * steps[j];
            gain(&to)
        };
        let count = at.len();
        let curvature = DMatrix::from_fn(count, count, |i, j| {
            let second = if i == j {
                2.0 * self.gain - moved(i, 1.0, i, 0.0) - moved(i, -1.0, i, 0.0)
            } else {
                0.25 * (moved(i, 1.0, j, -1.0) + moved(i, -1.0, j, 1.0)
                    - moved(i, 1.0, j, 1.0)
                    - moved(i, -1.0, j, -1.0))
            };
            second / (steps[i] * steps[j])
        });
        match curvature.try_inverse() {
            Some(covariance) => (0..count).map(|i| covariance[(i, i)].sqrt()).collect(),
            None => vec![f64::NAN; count],
        }
    }
}

/// A step from a number at which about half a nat is lost.
fn step(at: &[f64], i: usize, top: f64, gain: impl Fn(&[f64]) -> f64) -> f64 {
    let mut step = 0.05 * at[i].abs().max(1e-12);
    for _ in 0..12 {
        let mut to = at.to_vec();
        to[i] += step;
        let lost = top - gain(&to);
        if (0.2..1.0).contains(&lost) {
            break;
        }
        // The loss grows with the square of a step.
        let factor = if lost > 0.0 { (0.5 / lost).sqrt() } else { 3.0 };
        step *= factor.clamp(0.1, 3.0);
    }
    step
}
