//! Effects on the mean: what a parameter and the recorded columns add to the rate.

use super::{Drivers, Place, Sizing, StatedLine, Values};
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

/// The sampling at which a mean model must be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resolution {
    /// Averages over many samples hold all of it: long records are fitted in averages.
    Averaged,
    /// It changes within such averages and is fitted to the samples themselves.
    FullRate,
}

/// A mean model for given nonlinear parameters: `offset + Σ coefficient·column + Σ coefficient·nuisance`. Every series has
/// one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Regressors {
    /// What the nonlinear parameters alone determine, deg/h; `None` for nothing.
    pub offset: Option<Vec<f64>>,
    /// Columns whose coefficients are fitted, deg/h for a coefficient of 1.
    pub columns: Vec<Vec<f64>>,
    /// Columns that are fitted beside the effect and are no part of it, such as an unknown initial state.
    pub nuisance: Vec<Vec<f64>>,
}

/// What a search for nonlinear parameters may use. Every series has one value a sample, or a mode, of the drivers.
pub struct SearchContext<'a> {
    /// C⁻¹r in the time domain: the residual weighted by the inverse covariance of the noise.
    pub score: &'a [f64],
    /// Orthonormal cosine modes of the residual, deg/h.
    pub modes: &'a [f64],
    /// Variance of each mode under the current noise, (deg/h)²; that of mode 0 is infinite.
    pub powers: &'a [f64],
}

impl SearchContext<'_> {
    /// Gain of log-likelihood, nats, by one column with a fitted coefficient; the noise and everything else stay.
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

/// Points that a local search begins from.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// Nonlinear parameters, the most promising point first. One empty point for a model that has none.
    pub points: Vec<Vec<f64>>,
    /// Independent points that the search looked at: the p-value is multiplied by their number (look-elsewhere effect).
    pub trials: f64,
}

impl Starts {
    /// The start of a model without nonlinear parameters.
    pub fn linear() -> Starts {
        Starts { points: vec![vec![]], trials: 1.0 }
    }
}

/// Relative standard deviations of estimates beside those of their fit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unmodelled {
    /// Of the first parameter.
    pub first_parameter: f64,
    /// Of the rms of the course.
    pub rms: f64,
}

/// An effect that adds a course to the rate which its parameters and the recorded columns determine.
pub trait MeanModel: Sync {
    /// The sampling at which it must be fitted.
    fn resolution(&self) -> Resolution {
        Resolution::Averaged
    }

    /// The value of the claim whose prior is given up when the effect is fitted, since both are the same column.
    fn replaces(&self) -> Option<Nuisance> {
        None
    }

    /// False where the columns, or the claim, leave nothing to fit (a constant temperature, a table at rest).
    fn applies(&self, drivers: &Drivers) -> bool;

    /// At most four points from which a local search of the nonlinear parameters begins, found over their whole range.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts;

    /// Bounds of each nonlinear parameter.
    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds>;

    /// The columns for given nonlinear parameters.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors;

    /// Orthonormal cosine modes (DCT-II) of the columns, for a model that has nothing but columns and whose transform is known
    /// in closed form; `None`: they are transformed.
    fn modes(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Option<Vec<Vec<f64>>> {
        None
    }

    /// The parameters in the order of [`Effect::params`](super::Effect::params), from the nonlinear ones and the coefficients
    /// of the columns; NaN for one that the fit does not determine.
    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64>;

    /// Lists that a claim states beside the numbers, by name.
    fn lists(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        vec![]
    }

    /// What the estimates do not know beside what their fit tells: physics has more shapes than an effect that stands for any loop,
    /// any curve or any delay.
    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        Unmodelled::default()
    }

    /// How many parameters BIC counts for so many columns: as many, where each has a coefficient of its own size.
    fn counted(&self, columns: usize) -> usize {
        columns
    }

    /// Whether one shape is the same cause as an earlier one of the same effect, so that the two are not found beside each
    /// other.
    fn same_cause(&self, _earlier: &[f64], _nonlinear_parameters: &[f64]) -> bool {
        false
    }

    /// Texts that a claim states beside the numbers and a finding reports, by name.
    fn texts(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Vec<(&'static str, String)> {
        vec![]
    }

    /// The fitted law as a formula in the units of the columns, for an effect whose law is found and not given.
    fn formula(
        &self,
        _nonlinear_parameters: &[f64],
        _coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Option<String> {
        None
    }

    /// The course of stated parameters, deg/h, one value a sample; `None` where a parameter or a column is missing.
    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>>;

    /// Where it shows, principal place first, at most three.
    fn places(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<Place>;

    /// First step of the local search in each nonlinear parameter, where the likelihood has a peak much narrower than the
    /// bounds; empty: a hundredth of the bounds.
    fn steps(&self, _drivers: &Drivers) -> Vec<f64> {
        vec![]
    }

    /// Positions of nonlinear parameters that are whole numbers: tried by [`MeanModel::starts`] and not refined.
    fn whole(&self) -> &'static [usize] {
        &[]
    }

    /// Samples within which the course bends, so that the means of the columns do not determine it: they are left out of the
    /// fit. `parameters` in the order of [`Effect::params`](super::Effect::params).
    fn bends_within(&self, _parameters: &[f64], _drivers: &Drivers) -> Vec<usize> {
        vec![]
    }

    /// Columns that are fitted when a claim states the effect: a state before the record that no claim can know.
    fn nuisance_columns(&self, _values: &Values, _drivers: &Drivers) -> Vec<Vec<f64>> {
        vec![]
    }

    /// The line that stated parameters describe, for an effect that is one.
    fn stated_line(&self, _values: &Values) -> Option<StatedLine> {
        None
    }

    /// How large it is and where that is asked, to tell which size would have been noticed; one entry for each column that
    /// can drive it. Empty for an effect whose size no single number tells.
    fn sizings(&self, _drivers: &Drivers) -> Vec<Sizing> {
        vec![]
    }

    /// The course of a size at a place, deg/h, one value a sample.
    fn sized_course(
        &self,
        sizing: &Sizing,
        place: &Values,
        size: f64,
        drivers: &Drivers,
    ) -> Option<Vec<f64>> {
        self.course(&sizing.values(place, size), drivers)
    }

    /// What a claim states of a size at a place.
    fn stated_size(&self, sizing: &Sizing, place: &Values, size: f64, _drivers: &Drivers) -> Values {
        sizing.values(place, size)
    }

    /// Name of the list of coefficients that the course is proportional to, where a claim states one.
    fn linear_list(&self) -> Option<&'static str> {
        None
    }

    /// Natural logarithm of the odds of this effect against others with the same course, from what else the columns show.
    fn odds(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> f64 {
        0.0
    }
}
