//! Information of one recording on a law: score and information of its coefficients under the noise of the recording, the
//! nuisances of the claim fitted beside them.

use super::law::{Courses, Law};
use crate::effect::Resolution;
use crate::mismatch::fitted_hypothesis::FittedHypothesis;
use crate::mismatch::hypothesis::kept;
use crate::mismatch::problem::Problem;
use crate::mismatch::spectral_data::{NuisanceColumn, SpectralData};
use crate::numeric::least_squares::{Normal, subtract};
use nalgebra::{DMatrix, DVector};

/// A recording with the noise that it was found to have.
pub(super) struct Baseline<'a> {
    pub problem: &'a Problem,
    base: &'a FittedHypothesis,
    full: Vec<f64>,
    averaged: Vec<f64>,
}

/// Information of one recording on a law.
#[derive(Clone)]
pub(super) enum LawInformation {
    /// Of its coefficients.
    Quadratic { score: DVector<f64>, information: DMatrix<f64> },
    /// Gain of log-likelihood by a course without coefficients, nats.
    Gain(f64),
}

impl<'a> Baseline<'a> {
    pub fn new(problem: &'a Problem, base: &'a FittedHypothesis) -> Baseline<'a> {
        let powers = |spectral: &SpectralData| spectral.powers(&base.hypothesis.noise.densities(spectral));
        let full = powers(&problem.spectra.full);
        let averaged = powers(problem.spectra.of(Resolution::Averaged));
        Baseline { problem, base, full, averaged }
    }

    /// The data that a law is fitted to.
    pub fn spectral(&self, law: &Law) -> &'a SpectralData {
        self.problem.spectra.of(law.model.resolution())
    }

    /// Its information on a law; `None` where it lacks what the law needs.
    pub fn information(&self, law: &Law) -> Option<LawInformation> {
        let resolution = law.model.resolution();
        let spectral = self.problem.spectra.of(resolution);
        let powers = if resolution == Resolution::Averaged { &self.averaged } else { &self.full };
        let courses = law.courses(&spectral.drivers)?;
        let nuisances = self.nuisances(law, spectral);
        let beside = law.model.nuisance_columns(&law.values, &spectral.drivers);
        let beside: Vec<Vec<f64>> = beside.iter().map(|c| spectral.transform(c)).collect();
        let mut columns: Vec<(&[f64], f64)> =
            nuisances.iter().map(|n| (n.modes.as_slice(), n.deviation)).collect();
        columns.extend(beside.iter().map(|c| (c.as_slice(), f64::INFINITY)));
        match courses {
            Courses::Fixed(course) => {
                let before = Normal::new(&columns, &spectral.modes, powers).solve().2;
                let mut left = spectral.modes.clone();
                subtract(&mut left, &spectral.transform(&course), 1.0);
                let after = Normal::new(&columns, &left, powers).solve().2;
                Some(LawInformation::Gain(0.5 * (before - after))).filter(|_| after.is_finite())
            }
            Courses::Columns(all) => {
                let own: Vec<Vec<f64>> = all.iter().map(|c| spectral.transform(c)).collect();
                let first = columns.len();
                columns.extend(own.iter().map(|c| (c.as_slice(), f64::INFINITY)));
                let (fitted, covariance, _) = Normal::new(&columns, &spectral.modes, powers).solve();
                let count = own.len();
                let covariance = covariance.view((first, first), (count, count)).into_owned();
                let fitted = DVector::from_column_slice(fitted.get(first..)?);
                let information = covariance.try_inverse()?;
                let finite = information.iter().chain(fitted.iter()).all(|x| x.is_finite());
                finite.then(|| LawInformation::Quadratic { score: &information * fitted, information })
            }
        }
    }

    /// The course of a law over the recording, deg/h.
    pub fn course(&self, law: &Law, coefficients: &[f64]) -> Option<Vec<f64>> {
        match law.courses(&self.spectral(law).drivers)? {
            Courses::Fixed(course) => Some(course),
            Courses::Columns(columns) => {
                let mut sum = vec![0.0; columns.first()?.len()];
                for (column, coefficient) in columns.iter().zip(coefficients) {
                    subtract(&mut sum, column, -coefficient);
                }
                Some(sum)
            }
        }
    }

    /// Nuisances that are fitted beside a law: not the one that it replaces.
    fn nuisances(&self, law: &Law, spectral: &'a SpectralData) -> Vec<&'a NuisanceColumn> {
        let all = kept(spectral, &self.base.hypothesis.courses);
        all.into_iter().filter(|n| Some(n.nuisance) != law.model.replaces()).collect()
    }

    /// Prior deviation of the coefficient of a law that corrects a value of the claim, in its own unit; 0 for any other.
    pub fn prior_deviation(&self, law: &Law) -> f64 {
        let Some(own) = law.model.replaces() else { return 0.0 };
        let spectral = self.spectral(law);
        let column = spectral.nuisances.iter().find(|n| n.nuisance == own);
        let (Some(column), Some(Courses::Columns(courses))) = (column, law.courses(&spectral.drivers)) else {
            return 0.0;
        };
        let modes = courses.first().map(|c| spectral.transform(c)).unwrap_or_default();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let factor = dot(&modes, &column.modes) / dot(&column.modes, &column.modes);
        if factor.is_finite() && factor != 0.0 { column.deviation / factor.abs() } else { 0.0 }
    }
}
