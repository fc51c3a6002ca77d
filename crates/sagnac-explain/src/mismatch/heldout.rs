//! Held-out figures: ten blocks of equal time, the parameters from blocks 1, 3, 5, 7, 9, judged on 2, 4, 6, 8, 10. The
//! likelihood of each block is that about its own mean, the rms is about the mean of all that are held out.

use super::fitted_hypothesis::FittedHypothesis;
use super::hypothesis::{Hypothesis, LeastSquares, PartModes, columns, fit, kept, less_fixed, part_modes};
use super::noise_fit::whittle;
use super::nonlinear_search::LocalSearch;
use super::problem::Problem;
use super::spectral_data::SpectralData;
use crate::numeric::cosine::inverse_dct2;
use crate::numeric::least_squares::{Normal, subtract};

/// Blocks.
const HELD_OUT_BLOCKS: usize = 10;
/// Bins of the held-out residual in a block.
const BLOCK_BINS: usize = 200;

/// Figures of one hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Log-likelihood of the held-out blocks.
    pub log_likelihood: f64,
    /// Rms of the held-out residual in bins, deg/h.
    pub rms_deg_h: f64,
}

/// The two halves of a problem.
pub struct Halves {
    train: SpectralData,
    test: SpectralData,
    /// Mean residual of each block of the second, deg/h.
    means: Vec<f64>,
    bin: usize,
}

impl Halves {
    /// Cuts a problem.
    pub fn new(problem: &Problem) -> Halves {
        let length = problem.drivers.samples / HELD_OUT_BLOCKS;
        let spectral = |odd: usize| {
            let blocks = (0..HELD_OUT_BLOCKS).filter(|b| b % 2 == odd).map(|b| b * length).collect();
            let drivers = problem.drivers.clone();
            let deviations = problem.deviations();
            SpectralData::of_blocks(drivers, &problem.residual, &deviations, blocks, length)
                .with_states(&problem.claim)
        };
        let test = spectral(1);
        let means = test.block_means(&problem.residual);
        Halves { train: spectral(0), test, means, bin: (length / BLOCK_BINS).max(1) }
    }

    /// Length of the bins, s.
    pub fn bin_s(&self) -> f64 {
        self.bin as f64 * self.train.drivers.dt_s
    }

    /// Fits a hypothesis to one half, beginning from its fit to everything, and judges it on the other.
    pub fn judge(&self, tried: &FittedHypothesis) -> HeldOut {
        let mut hypothesis = tried.hypothesis.clone();
        refine_shapes(&mut hypothesis, &self.train);
        let trained = fit(&mut hypothesis, &self.train);
        let (mut residual, mut means) = (self.test.modes.clone(), self.means.clone());
        let known = known(&trained.mean, &tried.fit.mean);
        let mut coefficients = known.iter();
        let mut coefficient = || coefficients.next().copied().unwrap_or(0.0);
        let mut take = |modes: &[f64], block_means: &[f64], c: f64| {
            subtract(&mut residual, modes, c);
            subtract(&mut means, block_means, c);
        };
        for nuisance in kept(&self.test, &hypothesis.courses) {
            take(&nuisance.modes, &nuisance.block_means, coefficient());
        }
        for course in &hypothesis.courses {
            let Some(model) = course.course() else { continue };
            let parts = model.regressors(&course.nonlinear_parameters, &self.test.drivers);
            if let Some(fixed) = &parts.offset {
                take(&self.test.transform(fixed), &self.test.block_means(fixed), 1.0);
            }
            for column in parts.columns.iter().chain(&parts.nuisance) {
                take(&self.test.transform(column), &self.test.block_means(column), coefficient());
            }
        }
        let densities = hypothesis.noise.densities(&self.test);
        let log_likelihood = whittle(&self.test, &self.test.observed(&residual), &densities);
        HeldOut { log_likelihood, rms_deg_h: self.rms(&residual, &means) }
    }

    fn rms(&self, residual: &[f64], means: &[f64]) -> f64 {
        let blocks = residual.chunks_exact(self.test.length).zip(means);
        let in_bins = |(block, mean): (&[f64], &f64)| -> Vec<f64> {
            crate::effect::averages(&inverse_dct2(block), self.bin).into_iter().map(|b| b + mean).collect()
        };
        let bins: Vec<f64> = blocks.flat_map(in_bins).collect();
        let n = bins.len().max(1) as f64;
        let mean = bins.iter().sum::<f64>() / n;
        (bins.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / n).sqrt()
    }
}

/// The coefficients that the training half knows. One whose column it hardly holds, as of a step in a block held out, is
/// taken for nothing.
fn known(trained: &LeastSquares, whole: &LeastSquares) -> Vec<f64> {
    const MAX_DEVIATION_RATIO: f64 = 1e3;
    let deviation =
        |fit: &LeastSquares, i: usize| fit.covariance.get((i, i)).map_or(0.0, |v| v.max(0.0).sqrt());
    let one = |(i, c): (usize, &f64)| {
        let told = deviation(trained, i) <= MAX_DEVIATION_RATIO * deviation(whole, i);
        if told && c.is_finite() { *c } else { 0.0 }
    };
    trained.coefficients.iter().enumerate().map(one).collect()
}

/// Moves each shape to where the training half has it.
fn refine_shapes(hypothesis: &mut Hypothesis, spectral: &SpectralData) {
    let powers = spectral.powers(&hypothesis.noise.densities(spectral));
    for i in 0..hypothesis.courses.len() {
        let Some(course) = hypothesis.courses[i].course() else { continue };
        if hypothesis.courses[i].nonlinear_parameters.is_empty() {
            continue;
        }
        let others = part_modes(spectral, &hypothesis.courses);
        let nuisances = kept(spectral, &hypothesis.courses);
        let gain = |nonlinear_parameters: &[f64]| {
            let own = PartModes::of_shape(course, nonlinear_parameters, spectral);
            let parts = || others.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, p)| p).chain([&own]);
            let data = less_fixed(spectral, parts());
            -0.5 * Normal::new(&columns(&nuisances, parts()), &data, &powers).solve().2
        };
        const MAX_EVALUATIONS: usize = 40;
        let start = &hypothesis.courses[i].nonlinear_parameters;
        let local = LocalSearch::of(course, &spectral.drivers);
        let (nonlinear_parameters, _) = local.refine(start, MAX_EVALUATIONS, gain);
        hypothesis.courses[i].nonlinear_parameters = nonlinear_parameters;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coefficient_that_the_training_half_hardly_holds_is_nothing() {
        let fitted = |deviations: [f64; 2]| LeastSquares {
            coefficients: vec![3.0, -2.0],
            covariance: nalgebra::DMatrix::from_diagonal(&deviations.map(|d| d * d).to_vec().into()),
            prior: 0.0,
        };
        let whole = fitted([0.1, 0.1]);
        assert_eq!(known(&fitted([99.0, 0.2]), &whole), [3.0, -2.0]);
        assert_eq!(known(&fitted([101.0, 0.2]), &whole), [0.0, -2.0]);
        assert_eq!(known(&fitted([f64::NAN, 0.2]), &whole)[1], -2.0);
    }
}
