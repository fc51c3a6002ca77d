//! A hypothesis, the claim plus effects, and its fit to a record: noise by Whittle, courses by generalised least squares,
//! in turns until neither moves.

use super::noise_fit::{self, Noise, NoiseFit};
use super::spectral_data::{NuisanceColumn, SpectralData};
use super::terms::MeanTerm;
use crate::effect::{MeanModel, Regressors, Resolution, StatePrior, averages};
use crate::numeric::least_squares::{Normal, subtract};
use crate::numeric::parallel;
use nalgebra::DMatrix;
use std::borrow::Cow;

/// The claim plus effects.
#[derive(Clone)]
pub struct Hypothesis {
    /// Noise.
    pub noise: Noise,
    /// Courses.
    pub courses: Vec<MeanTerm>,
}

/// Cosine modes of the parts of a course.
#[derive(Debug, Clone, Default)]
pub struct PartModes {
    /// Modes of the fixed part.
    pub offset: Option<Vec<f64>>,
    /// Modes of the free columns.
    pub columns: Vec<Vec<f64>>,
    /// Modes of the columns beside.
    pub nuisance: Vec<Vec<f64>>,
    /// Priors of those that are states before the record.
    pub states: Vec<StatePrior>,
}

impl PartModes {
    /// Modes of a mean model.
    pub fn of_shape(
        course: &dyn MeanModel,
        nonlinear_parameters: &[f64],
        spectral: &SpectralData,
    ) -> PartModes {
        let closed =
            if spectral.is_whole() { course.modes(nonlinear_parameters, &spectral.drivers) } else { None };
        match closed {
            Some(mut free) => {
                free.iter_mut().filter_map(|m| m.first_mut()).for_each(|first| *first = 0.0);
                PartModes { columns: free, ..PartModes::default() }
            }
            None => PartModes::of(course.regressors(nonlinear_parameters, &spectral.drivers), spectral),
        }
    }

    /// Transforms the parts, those of a kind side by side.
    fn of(parts: Regressors, spectral: &SpectralData) -> PartModes {
        let modes = |column: &Vec<f64>| spectral.transform(column);
        PartModes {
            offset: parts.offset.as_ref().map(modes),
            columns: parallel::map_items(&parts.columns, modes),
            nuisance: parallel::map_items(&parts.nuisance, modes),
            states: parts.states,
        }
    }
}

/// Result of generalised least squares.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    /// Coefficients: nuisances, then of each course its free and its beside columns.
    pub coefficients: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// −½ Σ c²/σ² of the nuisances.
    pub prior: f64,
}

/// A fit of a hypothesis to spectral data.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Penalised log-likelihood.
    pub log_likelihood: f64,
    /// Of the noise.
    pub noise: NoiseFit,
    /// Of the mean.
    pub mean: LeastSquares,
    /// Density of each bin, (deg/h)²/Hz.
    pub densities: Vec<f64>,
    /// Density of what the mean leaves, as observed in each bin, (deg/h)²/Hz.
    pub observed: Vec<f64>,
}

impl Fit {
    /// The same with so much more log-likelihood: stands for a fit that would not change the decision.
    pub fn raised(&self, gain: f64) -> Fit {
        Fit { log_likelihood: self.log_likelihood + gain, ..self.clone() }
    }
}

/// Nuisance columns that keep their prior under the courses of a hypothesis.
pub fn kept<'a>(spectral: &'a SpectralData, courses: &[MeanTerm]) -> Vec<&'a NuisanceColumn> {
    let replaced: Vec<_> = courses.iter().filter_map(|c| c.course()?.replaces()).collect();
    spectral.nuisances.iter().filter(|n| !replaced.contains(&n.nuisance)).collect()
}

/// Columns of nuisances and of everything in `regressors` (one entry a course), each with its prior deviation.
pub fn columns<'a>(
    nuisances: &[&'a NuisanceColumn],
    parts: impl IntoIterator<Item = &'a PartModes>,
) -> Vec<(&'a [f64], f64)> {
    let mut columns: Vec<(&[f64], f64)> =
        nuisances.iter().map(|n| (n.modes.as_slice(), n.deviation)).collect();
    for part in parts {
        columns.extend(part.columns.iter().chain(&part.nuisance).map(|c| (c.as_slice(), f64::INFINITY)));
    }
    columns
}

/// Modes of a record less the fixed parts.
pub fn less_fixed<'a, 'b>(
    spectral: &'a SpectralData,
    parts: impl IntoIterator<Item = &'b PartModes>,
) -> Cow<'a, [f64]> {
    let mut data = Cow::Borrowed(spectral.modes.as_slice());
    for fixed in parts.into_iter().filter_map(|p| p.offset.as_ref()) {
        subtract(data.to_mut(), fixed, 1.0);
    }
    data
}

/// Rounds in which the states before the record follow the coefficients of their laws.
const STATE_ROUNDS: usize = 2;

/// Sets the prior deviations of states before the record to what their laws with these coefficients make of the whole range of their
/// columns. The columns of the parts begin at `at`.
fn set_states(columns: &mut [(&[f64], f64)], mut at: usize, parts: &[PartModes], coefficients: &[f64]) {
    for part in parts {
        for (state, i) in part.states.iter().zip(at + part.columns.len()..) {
            let coefficient = state.column.map_or(Some(1.0), |c| coefficients.get(at + c).copied());
            let deviation = coefficient.unwrap_or(0.0).abs() * state.deviation;
            if let Some((_, prior)) = columns.get_mut(i) {
                *prior = deviation.max(f64::MIN_POSITIVE.sqrt());
            }
        }
        at += part.columns.len() + part.nuisance.len();
    }
}

/// Generalised least squares of everything in `regressors` (one entry a course) and the kept nuisances, and the modes of what
/// it leaves.
fn least_squares<'a>(
    spectral: &'a SpectralData,
    hypothesis: &Hypothesis,
    parts: &[PartModes],
    powers: &[f64],
) -> (LeastSquares, Cow<'a, [f64]>) {
    let mut data = less_fixed(spectral, parts);
    let nuisances = kept(spectral, &hypothesis.courses);
    let mut columns = columns(&nuisances, parts);
    let (mut coefficients, mut covariance, _) = Normal::new(&columns, &data, powers).solve();
    // A state before the record is as large as the law makes it, which the first solution says.
    for _ in 0..if parts.iter().any(|p| !p.states.is_empty()) { STATE_ROUNDS } else { 0 } {
        set_states(&mut columns, nuisances.len(), parts, &coefficients);
        (coefficients, covariance, _) = Normal::new(&columns, &data, powers).solve();
    }
    for ((column, _), c) in columns.iter().zip(&coefficients) {
        subtract(data.to_mut(), column, *c);
    }
    let prior = -0.5 * columns.iter().zip(&coefficients).map(|((_, d), c)| (c / d).powi(2)).sum::<f64>();
    (LeastSquares { coefficients, covariance, prior }, data)
}

/// Modes of what a fitted hypothesis leaves of the data it was fitted to. Not kept with the fit, since many fits are
/// held at once and a long record has many modes.
pub fn residual(spectral: &SpectralData, hypothesis: &Hypothesis, mean: &LeastSquares) -> Vec<f64> {
    let parts = part_modes(spectral, &hypothesis.courses);
    let mut data = less_fixed(spectral, &parts).into_owned();
    let nuisances = kept(spectral, &hypothesis.courses);
    for ((column, _), c) in columns(&nuisances, &parts).iter().zip(&mean.coefficients) {
        subtract(&mut data, column, *c);
    }
    data
}

/// Modes of every course of a hypothesis.
pub fn part_modes(spectral: &SpectralData, courses: &[MeanTerm]) -> Vec<PartModes> {
    let one = |c: &MeanTerm| {
        c.course().map(|x| PartModes::of_shape(x, &c.nonlinear_parameters, spectral)).unwrap_or_default()
    };
    courses.iter().map(one).collect()
}

/// As [`part_modes`] on averages. A fast course is worked out sample by sample and averaged then: that of averaged
/// columns is another one.
pub fn part_modes_of_averages(
    spectral: &SpectralData,
    full: &SpectralData,
    courses: &[MeanTerm],
) -> Vec<PartModes> {
    let samples_each = spectral.drivers.averaged / full.drivers.averaged.max(1);
    let averaged = |column: Vec<f64>| {
        let mut means = averages(&column, samples_each);
        means.truncate(spectral.length);
        means
    };
    let all = |columns: Vec<Vec<f64>>| columns.into_iter().map(averaged).collect();
    let one = |c: &MeanTerm| {
        let Some(course) = c.course() else { return PartModes::default() };
        let parts = match course.resolution() {
            Resolution::Averaged => course.regressors(&c.nonlinear_parameters, &spectral.drivers),
            Resolution::FullRate => {
                let parts = course.regressors(&c.nonlinear_parameters, &full.drivers);
                Regressors {
                    offset: parts.offset.map(averaged),
                    columns: all(parts.columns),
                    nuisance: all(parts.nuisance),
                    states: parts.states,
                }
            }
        };
        PartModes::of(parts, spectral)
    };
    courses.iter().map(one).collect()
}

/// Fits a hypothesis: its noise parameters and the coefficients of its courses are changed to the best.
pub fn fit(hypothesis: &mut Hypothesis, spectral: &SpectralData) -> Fit {
    let parts = part_modes(spectral, &hypothesis.courses);
    fit_with(hypothesis, spectral, &parts)
}

/// As [`fit`], with the modes of the courses at hand.
pub fn fit_with(hypothesis: &mut Hypothesis, spectral: &SpectralData, parts: &[PartModes]) -> Fit {
    let columns =
        parts.iter().map(|p| p.columns.len() + p.nuisance.len()).sum::<usize>() + spectral.nuisances.len();
    let mut fit = turn(hypothesis, spectral, parts);
    for _ in 0..if columns == 0 { 0 } else { 5 } {
        let next = turn(hypothesis, spectral, parts);
        let settled = (next.log_likelihood - fit.log_likelihood).abs() < 1e-3;
        fit = next;
        if settled {
            break;
        }
    }
    let mut at = kept(spectral, &hypothesis.courses).len();
    for (course, part) in hypothesis.courses.iter_mut().zip(parts) {
        let of = |from: usize, count: usize| {
            fit.mean.coefficients.get(from..from + count).unwrap_or_default().to_vec()
        };
        course.coefficients = of(at, part.columns.len());
        course.states = of(at + part.columns.len(), part.states.len());
        at += part.columns.len() + part.nuisance.len();
    }
    fit
}

/// Mean for the noise at hand, then noise for that mean.
fn turn(hypothesis: &mut Hypothesis, spectral: &SpectralData, parts: &[PartModes]) -> Fit {
    let densities = hypothesis.noise.densities(spectral);
    let (mean, residual) = least_squares(spectral, hypothesis, parts, &spectral.powers(&densities));
    let observed = spectral.observed(&residual);
    let noise = noise_fit::fit(&mut hypothesis.noise, spectral, &observed);
    let densities = hypothesis.noise.densities(spectral);
    Fit { log_likelihood: noise.log_likelihood + mean.prior, noise, mean, densities, observed }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::effect::{Drivers, find};

    #[test]
    fn a_ramp_in_known_noise_is_fitted_with_its_slope_and_its_deviation() {
        let n = 2000;
        let drivers = Drivers { dt_s: 3.6, samples: n, averaged: 1, ..Drivers::default() };
        // Two hours; 0.3 deg/h/h.
        let hours = |i: usize| (i as f64 * 3.6 - 3600.0) / 3600.0;
        let residual: Vec<f64> = (0..n).map(|i| 0.3 * hours(i)).collect();
        let spectral = SpectralData::new(drivers, &residual, &[]);
        // N = √3.6/60 deg/√h is a deviation of 1 deg/h a sample of 3.6 s, and no parameter.
        let base = [1.0 / 60.0 * 3.6f64.sqrt(), 0.0, 0.0];
        let noise = Noise {
            base,
            claimed: base,
            deviation: [0.0; 3],
            bound: [0.0; 3],
            unconstrained: [false; 3],
            quantization_arcsec: 0.0,
            spectra: vec![],
            discrepancy: None,
        };
        let ramp = MeanTerm {
            effect: find("rate_ramp").unwrap(),
            nonlinear_parameters: vec![],
            coefficients: vec![],
            states: vec![],
        };
        let mut hypothesis = Hypothesis { noise, courses: vec![ramp] };
        let fitted = fit(&mut hypothesis, &spectral);
        assert!((hypothesis.courses[0].coefficients[0] - 0.3).abs() < 1e-6);
        // 1 over Σ (t − mean)²: n · (2 h)²/12.
        let variance = 12.0 / (4.0 * n as f64);
        assert!((fitted.mean.covariance[(0, 0)] / variance - 1.0).abs() < 1e-3, "{}", fitted.mean.covariance);
        let left = super::residual(&spectral, &hypothesis, &fitted.mean);
        assert!(left.iter().all(|x| x.abs() < 1e-5));
        assert_eq!(fitted.raised(2.0).log_likelihood, fitted.log_likelihood + 2.0);
    }
}
