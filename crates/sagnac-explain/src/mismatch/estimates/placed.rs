//! One course among the columns of its hypothesis: how well its numbers are known, the noise held.

use super::estimated::DROP_95;
use crate::effect::MeanModel;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::hypothesis::{PartModes, kept};
use crate::mismatch::nonlinear_search::LocalSearch;
use crate::mismatch::spectral_data::SpectralData;
use crate::mismatch::terms::MeanTerm;
use crate::numeric::least_squares::Normal;
use crate::numeric::range::Bounds;
use nalgebra::DMatrix;

/// The course, what stands beside it, and the data less what is fixed.
pub struct Placed<'a> {
    pub spectral: &'a SpectralData,
    course: &'static dyn MeanModel,
    pub inside: &'a MeanTerm,
    columns: Vec<(Vec<f64>, f64)>,
    data: Vec<f64>,
    powers: Vec<f64>,
}

impl<'a> Placed<'a> {
    /// The course at some place of a fitted hypothesis.
    pub fn new(
        course: &'static dyn MeanModel,
        index: usize,
        best: &'a FittedHypothesis,
        spectra: &'a SpectralDataSet,
    ) -> Placed<'a> {
        let spectral = spectra.of(course.resolution());
        // A coefficient is that of the rows alone, and scatters with what was drawn beside: both widen it.
        let wider = (1.0 - spectra.repeated_share).powi(-2);
        let mut powers = spectral.powers(&best.hypothesis.noise.densities(spectral));
        powers.iter_mut().for_each(|p| *p *= wider);
        let parts = spectra.part_modes(course.resolution(), &best.hypothesis.courses);
        let mut data = spectral.modes.clone();
        let mut columns: Vec<(Vec<f64>, f64)> =
            kept(spectral, &best.hypothesis.courses).iter().map(|n| (n.modes.clone(), n.deviation)).collect();
        for (j, part) in parts.into_iter().enumerate() {
            if j == index {
                continue;
            }
            if let Some(fixed) = &part.offset {
                data.iter_mut().zip(fixed).for_each(|(d, f)| *d -= f);
            }
            columns.extend(part.columns.into_iter().chain(part.nuisance).map(|c| (c, f64::INFINITY)));
        }
        Placed { spectral, course, inside: &best.hypothesis.courses[index], columns, data, powers }
    }

    fn regressors(&self, nonlinear_parameters: &[f64]) -> PartModes {
        PartModes::of_shape(self.course, nonlinear_parameters, self.spectral)
    }

    /// Penalised sum of squares over −2 for a shape: the log-likelihood with the noise held.
    pub fn log_likelihood(&self, nonlinear_parameters: &[f64]) -> (f64, Vec<f64>) {
        let parts = self.regressors(nonlinear_parameters);
        let mut data = self.data.clone();
        if let Some(fixed) = &parts.offset {
            data.iter_mut().zip(fixed).for_each(|(d, f)| *d -= f);
        }
        let mut columns: Vec<(&[f64], f64)> = self.columns.iter().map(|(c, s)| (c.as_slice(), *s)).collect();
        let others = columns.len();
        columns.extend(parts.columns.iter().chain(&parts.nuisance).map(|c| (c.as_slice(), f64::INFINITY)));
        let (coefficients, _, left) = Normal::new(&columns, &data, &self.powers).solve();
        (-0.5 * left, coefficients[others..others + parts.columns.len()].to_vec())
    }

    /// Covariance of shape and coefficients of the free columns, everything else free beside.
    pub fn covariance(&self, coefficients: &[f64]) -> DMatrix<f64> {
        let nonlinear_parameters = &self.inside.nonlinear_parameters;
        let parts = self.regressors(nonlinear_parameters);
        let bounds = self.course.bounds(&self.spectral.drivers);
        let slopes: Vec<Vec<f64>> =
            (0..nonlinear_parameters.len()).map(|i| self.slope(i, &bounds, coefficients)).collect();
        // A number that is whole, or held by its bounds, has no derivative and no part in the uncertainty.
        let moves = |i: &usize| !self.course.whole().contains(i) && slopes[*i].iter().any(|s| *s != 0.0);
        let active: Vec<usize> = (0..nonlinear_parameters.len()).filter(moves).collect();
        let columns: Vec<(&[f64], f64)> = active
            .iter()
            .map(|i| &slopes[*i])
            .chain(&parts.columns)
            .chain(&parts.nuisance)
            .map(|c| (c.as_slice(), f64::INFINITY))
            .chain(self.columns.iter().map(|(c, s)| (c.as_slice(), *s)))
            .collect();
        let (_, covariance, _) = Normal::new(&columns, &self.data, &self.powers).solve();
        let wanted = nonlinear_parameters.len() + parts.columns.len();
        let places: Vec<usize> = active.iter().copied().chain(nonlinear_parameters.len()..wanted).collect();
        let mut out = DMatrix::zeros(wanted, wanted);
        for (a, i) in places.iter().enumerate() {
            for (b, j) in places.iter().enumerate() {
                out[(*i, *j)] = covariance[(a, b)];
            }
        }
        out
    }

    /// Standard deviation that the rms of a course has from a nuisance of the claim that the course takes over: how much
    /// of the two is the claim's own is known no better than the claim states it.
    pub fn nuisance_deviation(&self, series: &[f64]) -> f64 {
        let Some(replaced) = self.course.replaces() else { return 0.0 };
        let Some(nuisance) = self.spectral.nuisances.iter().find(|n| n.nuisance == replaced) else {
            return 0.0;
        };
        let modes = self.spectral.transform(series);
        let square: f64 = modes.iter().map(|x| x * x).sum();
        let both: f64 = modes.iter().zip(&nuisance.modes).map(|(a, b)| a * b).sum();
        let n = self.spectral.drivers.samples.max(1) as f64;
        if square > 0.0 { nuisance.deviation * both.abs() / (square * n).sqrt() } else { 0.0 }
    }

    /// Relative standard deviation of the size of a course, were a factor on it free.
    pub fn size_deviation(&self, series: &[f64]) -> f64 {
        let beside = self.regressors(&self.inside.nonlinear_parameters).nuisance;
        let size = self.spectral.transform(series);
        let columns: Vec<(&[f64], f64)> = [&size]
            .into_iter()
            .chain(&beside)
            .map(|c| (c.as_slice(), f64::INFINITY))
            .chain(self.columns.iter().map(|(c, s)| (c.as_slice(), *s)))
            .collect();
        Normal::new(&columns, &self.data, &self.powers).solve().1[(0, 0)].max(0.0).sqrt()
    }

    /// Derivative of the course by a number of its shape, in modes.
    fn slope(&self, i: usize, bounds: &[Bounds], coefficients: &[f64]) -> Vec<f64> {
        let bounds = bounds.get(i).copied().unwrap_or(Bounds::new(f64::MIN, f64::MAX));
        let nonlinear_parameters = &self.inside.nonlinear_parameters;
        let step = (1e-3 * nonlinear_parameters[i].abs()).max(1e-6 * bounds.width().min(1e12)).max(1e-12);
        let at = |x: f64| {
            let mut moved = nonlinear_parameters.clone();
            moved[i] = bounds.clamp(x);
            let parts = self.regressors(&moved);
            let mut sum = parts.offset.unwrap_or_else(|| vec![0.0; self.data.len()]);
            for (column, c) in parts.columns.iter().zip(coefficients) {
                sum.iter_mut().zip(column).for_each(|(s, z)| *s += c * z);
            }
            (sum, moved[i])
        };
        let ((up, a), (down, b)) = (at(nonlinear_parameters[i] + step), at(nonlinear_parameters[i] - step));
        if a <= b {
            return vec![0.0; up.len()];
        }
        up.iter().zip(&down).map(|(u, d)| (u - d) / (a - b)).collect()
    }

    /// Position of the only number of a shape that is not whole.
    pub fn free_number(&self) -> Option<usize> {
        let mut free =
            (0..self.inside.nonlinear_parameters.len()).filter(|i| !self.course.whole().contains(i));
        free.next().filter(|_| free.next().is_none())
    }

    /// Shapes at the ends of the interval of the only number of a shape that is not whole, in which the profile log-likelihood over
    /// the forms of the law has not dropped.
    pub fn profile(&self, deviation: f64) -> Option<Vec<Vec<f64>>> {
        let i = self.free_number()?;
        let bounds = *self.course.bounds(&self.spectral.drivers).get(i)?;
        if bounds.width() <= 0.0 {
            return None;
        }
        let best = &self.inside.nonlinear_parameters;
        let top = self.log_likelihood(best).0;
        let first = if deviation.is_finite() && deviation > 0.0 { deviation } else { 0.01 * bounds.width() };
        let mut ends = self.ends_about(best, i, bounds, first, top).to_vec();
        for other in self.other_forms(i) {
            let dropped = top - self.log_likelihood(&other).0;
            if dropped < DROP_95 {
                ends.extend(self.ends_about(&other, i, bounds, first, top));
            }
        }
        Some(ends)
    }

    /// The likeliest shape of each other form of the law, the number at `i` refined.
    fn other_forms(&self, i: usize) -> Vec<Vec<f64>> {
        /// Ratio of the number of one form to that of another at most.
        const MAX_RATIO: f64 = 4.0;
        const RATIOS: usize = 17;
        /// Evaluations of the likelihood for each form.
        const EVALUATIONS: usize = 60;
        let Some((place, values)) = self.course.forms() else { return vec![] };
        let search = LocalSearch::of(self.course, &self.spectral.drivers);
        let best = &self.inside.nonlinear_parameters;
        let bounds = self.course.bounds(&self.spectral.drivers)[i];
        let of_form = |form: &f64| {
            let begin = |k: usize| {
                let mut shape = best.clone();
                shape[place] = *form;
                let ratio = MAX_RATIO.powf(2.0 * k as f64 / (RATIOS - 1) as f64 - 1.0);
                shape[i] = bounds.clamp(ratio * best[i]);
                shape
            };
            let gain = |shape: &[f64]| self.log_likelihood(shape).0;
            let start = (0..RATIOS).map(begin).max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
            Some(search.refine(&start, EVALUATIONS, gain).0)
        };
        values.iter().filter(|form| **form != best[place]).filter_map(of_form).collect()
    }

    /// Shapes below and above one, with the number at `i` moved until the log-likelihood has dropped below `top`.
    fn ends_about(&self, about: &[f64], i: usize, bounds: Bounds, first: f64, top: f64) -> [Vec<f64>; 2] {
        let shape = |x: f64| {
            let mut moved = about.to_vec();
            moved[i] = x;
            moved
        };
        let drop = |x: f64| top - self.log_likelihood(&shape(x)).0;
        let side = |sign: f64| {
            let (mut inside, mut step) = (about[i], first);
            let mut outside = None;
            for _ in 0..24 {
                let x = bounds.clamp(about[i] + sign * step);
                if drop(x) >= DROP_95 {
                    outside = Some(x);
                    break;
                }
                inside = x;
                if x == bounds.low || x == bounds.high {
                    break;
                }
                step *= 1.7;
            }
            let Some(mut outside) = outside else { return inside };
            for _ in 0..10 {
                let middle = 0.5 * (inside + outside);
                if drop(middle) >= DROP_95 { outside = middle } else { inside = middle }
            }
            0.5 * (inside + outside)
        };
        [-1.0, 1.0].map(|sign| shape(side(sign)))
    }
}
