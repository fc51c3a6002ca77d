//! Effects on the mean: what a parameter and the recorded columns add to the rate.

use super::{Drivers, Place, Values};
use crate::numeric::range::Bounds;

/// A nuisance of the claim: a value that it states with an uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Nuisance {
    /// Angle random walk N.
    AngleRandomWalk,
    /// Flicker B.
    Flicker,
    /// Rate random walk K.
    RateRandomWalk,
    /// Temperature coefficient.
    TemperatureCoefficient,
    /// Scale factor.
    ScaleFactor,
    /// A state before the record that an effect of the claim begins from; no claim can know it.
    InitialState,
}

/// Whether a course is seen at the sample rate, or whole in averages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resolution {
    /// Averages over many samples hold all of it.
    Averaged,
    /// It has to be fitted to the samples themselves.
    FullRate,
}

/// A course for one shape: `fixed + Σ coefficient·free + Σ coefficient·beside`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Regressors {
    /// What the shape alone determines, deg/h.
    pub offset: Option<Vec<f64>>,
    /// Columns of the effect, deg/h for a coefficient of 1.
    pub columns: Vec<Vec<f64>>,
    /// Columns that must be free for the fit to be right and are no part of the effect, as an unknown initial state.
    pub nuisance: Vec<Vec<f64>>,
}

/// What the search for a shape may look at. All series are on the grid of the drivers.
pub struct SearchContext<'a> {
    /// C⁻¹r in the time domain: the residual weighted by the inverse covariance of the noise.
    pub score: &'a [f64],
    /// Orthonormal cosine modes of the residual, deg/h.
    pub modes: &'a [f64],
    /// Variance of each mode under the current noise, (deg/h)²; that of mode 0 is infinite.
    pub powers: &'a [f64],
}

impl SearchContext<'_> {
    /// Log-likelihood gain of one column with a free coefficient, noise and everything else held.
    pub fn gain(&self, column: &[f64]) -> f64 {
        let modes = crate::numeric::cosine::dct2(column);
        let (mut zr, mut zz) = (0.0, 0.0);
        for ((z, x), p) in modes.iter().zip(self.modes).zip(self.powers).skip(1) {
            zr += z * x / p;
            zz += z * z / p;
        }
        if zz > 0.0 { 0.5 * zr * zr / zz } else { 0.0 }
    }
}

/// Shapes to begin a fit from.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// The shapes, the most promising first. One empty shape for a course that is linear in its coefficients.
    pub points: Vec<Vec<f64>>,
    /// How many independent places were looked at: what the p-value is multiplied by.
    pub trials: f64,
}

impl Starts {
    /// The only start of a course that has no shape.
    pub fn linear() -> Starts {
        Starts { points: vec![vec![]], trials: 1.0 }
    }
}

/// An effect that adds a determined course to the rate.
pub trait MeanModel: Sync {
    /// Whether averages hold all of it.
    fn resolution(&self) -> Resolution {
        Resolution::Averaged
    }

    /// The nuisance whose prior has to go when the effect is fitted, since both are the same column.
    fn replaces(&self) -> Option<Nuisance> {
        None
    }

    /// False where the columns, or the claim, leave nothing to fit (a constant temperature, a table at rest).
    fn applies(&self, drivers: &Drivers) -> bool;

    /// Where to begin the search of the shape.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts;

    /// Bounds of each number of the shape.
    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds>;

    /// The course for a shape.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors;

    /// Orthonormal cosine modes of the free columns over all samples of the grid, of a course that has nothing but these
    /// and whose transform is known in closed form.
    fn modes(&self, _shape: &[f64], _drivers: &Drivers) -> Option<Vec<Vec<f64>>> {
        None
    }

    /// The parameters in the order of [`Effect::params`], from a shape and the coefficients of `columns`; NaN for one that
    /// the fit does not determine.
    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64>;

    /// Lists that the forward model needs beside the numbers, by name.
    fn lists(
        &self,
        _shape: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        vec![]
    }

    /// The course that stated parameters give, deg/h. `None` where one that is needed is missing.
    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>>;

    /// Where it lives, principal first, at most three.
    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place>;

    /// First step of a local search in each number of the shape, where the likelihood has a peak much narrower than the
    /// bounds; empty: by the bounds.
    fn steps(&self, _drivers: &Drivers) -> Vec<f64> {
        vec![]
    }

    /// Positions of numbers of the shape that are whole: tried by [`MeanModel::starts`] and not refined.
    fn whole(&self) -> &'static [usize] {
        &[]
    }

    /// Samples of which averaged columns do not tell the course, since it bends within them; `parameters` in the order of
    /// [`Effect::params`].
    fn bends_within(&self, _parameters: &[f64], _drivers: &Drivers) -> Vec<usize> {
        vec![]
    }

    /// Columns that stay free when a claim states the effect: a state before the record that no claim can know.
    fn nuisance_columns(&self, _values: &Values, _drivers: &Drivers) -> Vec<Vec<f64>> {
        vec![]
    }

    /// Natural logarithm of the odds against kinds with the same course, from what else the columns show at that place.
    fn odds(&self, _shape: &[f64], _drivers: &Drivers) -> f64 {
        0.0
    }
}
