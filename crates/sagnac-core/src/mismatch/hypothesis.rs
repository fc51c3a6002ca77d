//! A hypothesis, the claim plus effects, and its fit to a scene: noise by Whittle, courses by generalised least squares,
//! in turns until neither moves.

use super::noise_fit::{self, Noise, NoiseFit};
use super::spectral_data::{NuisanceColumn, SpectralData};
use crate::effect::{Effect, MeanModel, Model, Regressors, Resolution, averages};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;

/// A course in a hypothesis.
#[derive(Clone)]
pub struct CourseIn {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its shape.
    pub nonlinear_parameters: Vec<f64>,
    /// Coefficients of its free columns, from the last fit.
    pub coefficients: Vec<f64>,
}

impl CourseIn {
    /// The forward model.
    pub fn course(&self) -> Option<&'static dyn MeanModel> {
        match self.effect.model() {
            Model::Mean(c) => Some(c),
            _ => None,
        }
    }
}

/// The claim plus effects.
#[derive(Clone)]
pub struct Hypothesis {
    /// Noise.
    pub noise: Noise,
    /// Courses.
    pub courses: Vec<CourseIn>,
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
}

impl PartModes {
    /// Modes of a course on a scene.
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
        let modes = |column: Vec<f64>| spectral.transform(&column);
        PartModes {
            offset: parts.offset.map(modes),
            columns: parts.columns.into_par_iter().map(modes).collect(),
            nuisance: parts.nuisance.into_par_iter().map(modes).collect(),
        }
    }
}

/// What generalised least squares gave.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    /// Coefficients: nuisances, then of each course its free and its beside columns.
    pub coefficients: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// −½ Σ c²/σ² of the nuisances.
    pub prior: f64,
}

/// A fit of a hypothesis to a scene.
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
    /// The same with so much more log-likelihood: stands for a fit that is not worth making.
    pub fn raised(&self, gain: f64) -> Fit {
        Fit { log_likelihood: self.log_likelihood + gain, ..self.clone() }
    }
}

/// Nuisance columns that keep their prior under the courses of a hypothesis.
pub fn kept<'a>(spectral: &'a SpectralData, courses: &[CourseIn]) -> Vec<&'a NuisanceColumn> {
    let replaced: Vec<_> = courses.iter().filter_map(|c| c.course()?.replaces()).collect();
    spectral.nuisances.iter().filter(|n| !replaced.contains(&n.nuisance)).collect()
}

/// Weighted normal equations of some columns.
pub struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    total: f64,
}

/// Σ a b/p. In four sums, none of which waits for the other.
fn inner(a: &[f64], b: &[f64], powers: &[f64]) -> f64 {
    let n = a.len().min(b.len()).min(powers.len());
    let mut sums = [0.0; 4];
    let (a, b, powers) = (&a[..n], &b[..n], &powers[..n]);
    for ((x, y), p) in a.chunks(4).zip(b.chunks(4)).zip(powers.chunks(4)) {
        for (sum, ((x, y), p)) in sums.iter_mut().zip(x.iter().zip(y).zip(p)) {
            *sum += x * y / p;
        }
    }
    sums.iter().sum()
}

impl Normal {
    /// The equations for `columns` with prior deviations (infinite for none).
    pub fn new(columns: &[(&[f64], f64)], data: &[f64], powers: &[f64]) -> Normal {
        let p = columns.len();
        let mut matrix = DMatrix::zeros(p, p);
        let mut right = DVector::zeros(p);
        for (i, (a, deviation)) in columns.iter().enumerate() {
            for (j, (b, _)) in columns.iter().enumerate().take(i + 1) {
                let value = inner(a, b, powers);
                matrix[(i, j)] = value;
                matrix[(j, i)] = value;
            }
            matrix[(i, i)] += deviation.powi(-2);
            right[i] = inner(a, data, powers);
        }
        Normal { matrix, right, total: inner(data, data, powers) }
    }

    /// The equations with more columns, against the same data less a fixed part.
    pub fn with(
        &self,
        old: &[(&[f64], f64)],
        new: &[&[f64]],
        data: &[f64],
        fixed: bool,
        powers: &[f64],
    ) -> Normal {
        let (p, q) = (old.len(), new.len());
        let mut matrix = DMatrix::zeros(p + q, p + q);
        matrix.view_mut((0, 0), (p, p)).copy_from(&self.matrix);
        let mut right = DVector::zeros(p + q);
        for (i, (a, _)) in old.iter().enumerate() {
            right[i] = if fixed { inner(a, data, powers) } else { self.right[i] };
        }
        let known = |j: usize| if j < p { old[j].0 } else { new[j - p] };
        let rows: Vec<Vec<f64>> = (0..q)
            .into_par_iter()
            .map(|i| {
                let against = (0..=p + i).map(|j| inner(new[i], known(j), powers));
                against.chain(std::iter::once(inner(new[i], data, powers))).collect()
            })
            .collect();
        for (i, row) in rows.into_iter().enumerate() {
            for (j, value) in row[..=p + i].iter().enumerate() {
                matrix[(p + i, j)] = *value;
                matrix[(j, p + i)] = *value;
            }
            right[p + i] = row[p + i + 1];
        }
        let total = if fixed { inner(data, data, powers) } else { self.total };
        Normal { matrix, right, total }
    }

    /// Coefficients, covariance, and the penalised sum of squares that is left. Columns that others hold already get
    /// no coefficient.
    pub fn solve(&self) -> (Vec<f64>, DMatrix<f64>, f64) {
        let p = self.right.len();
        if p == 0 {
            return (vec![], DMatrix::zeros(0, 0), self.total);
        }
        // Scaled to a unit diagonal; a ridge far below any information keeps collinear columns finite.
        let scale: Vec<f64> = (0..p).map(|i| self.matrix[(i, i)].max(1e-300).sqrt()).collect();
        let mut scaled = self.matrix.clone();
        for i in 0..p {
            for j in 0..p {
                scaled[(i, j)] /= scale[i] * scale[j];
            }
            scaled[(i, i)] += 1e-9;
        }
        let Some(factor) = scaled.cholesky() else {
            return (vec![0.0; p], DMatrix::zeros(p, p), self.total);
        };
        let right = DVector::from_fn(p, |i, _| self.right[i] / scale[i]);
        let solution = factor.solve(&right);
        let left = self.total - right.dot(&solution);
        let mut covariance = factor.inverse();
        for i in 0..p {
            for j in 0..p {
                covariance[(i, j)] /= scale[i] * scale[j];
            }
        }
        ((0..p).map(|i| solution[i] / scale[i]).collect(), covariance, left)
    }
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

/// Modes of a scene less the fixed parts.
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
    let columns = columns(&nuisances, parts);
    let (coefficients, covariance, _) = Normal::new(&columns, &data, powers).solve();
    for ((column, _), c) in columns.iter().zip(&coefficients) {
        subtract(data.to_mut(), column, *c);
    }
    let priors = nuisances.iter().zip(&coefficients);
    let prior = -0.5 * priors.map(|(n, c)| (c / n.deviation).powi(2)).sum::<f64>();
    (LeastSquares { coefficients, covariance, prior }, data)
}

/// Modes of what a fitted hypothesis leaves of the scene it was fitted to. Not kept with the fit, since many fits are
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

/// Takes a column times a coefficient out of data.
pub fn subtract(data: &mut [f64], column: &[f64], coefficient: f64) {
    if coefficient != 0.0 {
        data.iter_mut().zip(column).for_each(|(d, c)| *d -= coefficient * c);
    }
}

/// Modes of every course of a hypothesis on a scene.
pub fn part_modes(spectral: &SpectralData, courses: &[CourseIn]) -> Vec<PartModes> {
    let one = |c: &CourseIn| {
        c.course().map(|x| PartModes::of_shape(x, &c.nonlinear_parameters, spectral)).unwrap_or_default()
    };
    courses.iter().map(one).collect()
}

/// As [`part_modes`] on a scene of averages. A fast course is worked out sample by sample and averaged then: that of averaged
/// columns is another one.
pub fn part_modes_of_averages(
    spectral: &SpectralData,
    full: &SpectralData,
    courses: &[CourseIn],
) -> Vec<PartModes> {
    let samples_each = spectral.drivers.averaged / full.drivers.averaged.max(1);
    let averaged = |column: Vec<f64>| {
        let mut means = averages(&column, samples_each);
        means.truncate(spectral.length);
        means
    };
    let all = |columns: Vec<Vec<f64>>| columns.into_iter().map(averaged).collect();
    let one = |c: &CourseIn| {
        let Some(course) = c.course() else { return PartModes::default() };
        let parts = match course.resolution() {
            Resolution::Averaged => course.regressors(&c.nonlinear_parameters, &spectral.drivers),
            Resolution::FullRate => {
                let parts = course.regressors(&c.nonlinear_parameters, &full.drivers);
                Regressors {
                    offset: parts.offset.map(averaged),
                    columns: all(parts.columns),
                    nuisance: all(parts.nuisance),
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
        course.coefficients =
            fit.mean.coefficients.get(at..at + part.columns.len()).unwrap_or_default().to_vec();
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
