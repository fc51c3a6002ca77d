//! Effects on the mean: a contribution to the rate that parameters and recorded columns determine.

use super::shared::reach::{places_of, varies};
use super::{Drivers, Effect, Param, Place, Sizing, StatedLine, Values, number};
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
    /// Part that the nonlinear parameters alone determine, deg/h; `None` for nothing.
    pub offset: Option<Vec<f64>>,
    /// Columns whose coefficients are fitted, deg/h for a coefficient of 1.
    pub columns: Vec<Vec<f64>>,
    /// Columns that are fitted beside the effect and are no part of it, such as an unknown initial state.
    pub nuisance: Vec<Vec<f64>>,
}

impl Regressors {
    /// Columns alone.
    pub fn columns(columns: impl IntoIterator<Item = Vec<f64>>) -> Regressors {
        Regressors { columns: columns.into_iter().collect(), ..Regressors::default() }
    }
}

/// Data for a search of nonlinear parameters. Every series has one value a sample, or a mode, of the drivers.
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

    /// True where score, modes and powers are of a record of so many samples.
    pub fn is_of(&self, samples: usize) -> bool {
        [self.score, self.modes, self.powers].iter().all(|series| series.len() == samples)
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

    /// No start: a record in which the model cannot be searched.
    pub fn none() -> Starts {
        Starts { points: vec![], trials: 1.0 }
    }

    /// The point of the largest score, among `trials` independent ones.
    pub fn best(scored: impl IntoIterator<Item = (f64, Vec<f64>)>, trials: f64) -> Starts {
        let best = scored.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        Starts { points: best.map(|(_, point)| point).into_iter().collect(), trials }
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

/// First value, such as the only coefficient; NaN where there is none.
pub(super) fn first(values: &[f64]) -> f64 {
    values.first().copied().unwrap_or(f64::NAN)
}

/// An effect that adds a course to the rate which its parameters and the recorded columns determine.
///
/// The defaults are those of the plainest model: one [`column`](MeanModel::column) times the first parameter. The further
/// parameters of such a model are the nonlinear ones, in the same order; most have none. A model of another form has its own
/// `regressors`, `parameters` and `course`.
pub trait MeanModel: Effect {
    /// False where the columns, or the claim, leave nothing to fit (a constant temperature, a table at rest). The columns that an
    /// effect needs must vary.
    fn applies(&self, drivers: &Drivers) -> bool {
        self.needs().iter().all(|column| varies(drivers.column(*column)))
    }

    /// Intervals in which it shows, principal one first, at most three: those of the quantity of its domain.
    fn places(&self, _nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        places_of(self.domain(), drivers)
    }

    /// The column of a model that has only one, deg/h for a coefficient of 1; `None` where a recorded column or a nonlinear
    /// parameter is missing.
    fn column(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Option<Vec<f64>> {
        None
    }

    /// The coefficient of the column that the claim itself has: the fit adds to it.
    fn claimed_coefficient(&self, _drivers: &Drivers) -> f64 {
        0.0
    }

    /// Columns beside the only one: an unknown state at the beginning of the record.
    fn initial_state(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Vec<Vec<f64>> {
        vec![]
    }

    /// The sampling at which it must be fitted.
    fn resolution(&self) -> Resolution {
        if self.is_slow() { Resolution::Averaged } else { Resolution::FullRate }
    }

    /// The value of the claim whose prior is given up when the effect is fitted, since both are the same column.
    fn replaces(&self) -> Option<Nuisance> {
        None
    }

    /// Bounds of each nonlinear parameter.
    fn bounds(&self, _drivers: &Drivers) -> Vec<Bounds> {
        vec![]
    }

    /// At most four points from which a local search of the nonlinear parameters begins, found over their whole range.
    fn starts(&self, _drivers: &Drivers, _context: &SearchContext<'_>) -> Starts {
        Starts::linear()
    }

    /// First step of the local search in each nonlinear parameter, where the likelihood has a peak much narrower than the
    /// bounds; empty: a hundredth of the bounds.
    fn steps(&self, _drivers: &Drivers) -> Vec<f64> {
        vec![]
    }

    /// Positions of nonlinear parameters that are whole numbers: tried by [`MeanModel::starts`] and not refined.
    fn whole(&self) -> &'static [usize] {
        &[]
    }

    /// The columns for given nonlinear parameters.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors {
            offset: None,
            columns: self.column(nonlinear_parameters, drivers).into_iter().collect(),
            nuisance: self.initial_state(nonlinear_parameters, drivers),
        }
    }

    /// Orthonormal cosine modes (DCT-II) of the columns, for a model that has nothing but columns and whose transform is known
    /// in closed form; `None`: they are transformed.
    fn modes(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Option<Vec<Vec<f64>>> {
        None
    }

    /// The parameters in the order of [`Effect::params`](super::Effect::params), from the nonlinear ones and the coefficients
    /// of the columns; NaN for one that the fit does not determine.
    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], drivers: &Drivers) -> Vec<f64> {
        let nonlinear = nonlinear_parameters.iter().copied().chain(std::iter::repeat(f64::NAN));
        let coefficient = first(coefficients) + self.claimed_coefficient(drivers);
        std::iter::once(coefficient).chain(nonlinear).take(self.params().len()).collect()
    }

    /// The course of claimed parameters, deg/h, one value a sample; `None` where a parameter or a column is missing.
    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let excess = number(values, self.params().first()?.name)? - self.claimed_coefficient(drivers);
        let column = self.column(&further_numbers(self.params(), values)?, drivers)?;
        Some(column.into_iter().map(|x| excess * x).collect())
    }

    /// Columns that are fitted when a claim states the effect: a state before the record that no claim can know.
    fn nuisance_columns(&self, values: &Values, drivers: &Drivers) -> Vec<Vec<f64>> {
        let nonlinear = further_numbers(self.params(), values);
        nonlinear.map_or_else(Vec::new, |parameters| self.initial_state(&parameters, drivers))
    }

    /// Name of the list of coefficients that the course is proportional to, where a claim states one.
    fn linear_list(&self) -> Option<&'static str> {
        None
    }

    /// Lists that a claim states beside the numbers, by name.
    fn lists(
        &self,
        _nonlinear_parameters: &[f64],
        coefficients: &[f64],
        _drivers: &Drivers,
    ) -> Vec<(&'static str, Vec<f64>)> {
        self.linear_list().map(|name| (name, coefficients.to_vec())).into_iter().collect()
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

    /// Uncertainty of the estimates beyond that of their fit: physics has more shapes than an effect that stands for any loop,
    /// any curve or any delay.
    fn unmodelled(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Unmodelled {
        Unmodelled::default()
    }

    /// Parameters that BIC counts for so many columns: one each, unless their coefficients are of a common size.
    fn bic_parameters(&self, columns: usize) -> usize {
        columns
    }

    /// True where one shape is the same cause as an earlier one of the same effect, so that the two are not found beside each
    /// other.
    fn same_cause(&self, _earlier: &[f64], _nonlinear_parameters: &[f64]) -> bool {
        false
    }

    /// Natural logarithm of the odds of this effect against others with the same course, from other evidence of the columns.
    fn odds(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> f64 {
        0.0
    }

    /// Samples within which the course is curved, so that the means of the columns do not determine it: they are left out of
    /// the fit. `parameters` in the order of [`Effect::params`](super::Effect::params).
    fn curvature_within_average(&self, _parameters: &[f64], _drivers: &Drivers) -> Vec<usize> {
        vec![]
    }

    /// The line that claimed parameters describe, for an effect that is one.
    fn claimed_line(&self, _values: &Values) -> Option<StatedLine> {
        None
    }

    /// Sizes to ask for when it is determined which size would have been noticed; one entry for each column that can drive it.
    /// Empty for an effect whose size is no single number. One column without nonlinear parameters is sized by its
    /// coefficient.
    fn sizings(&self, drivers: &Drivers) -> Vec<Sizing> {
        let coefficient = self.params().first().filter(|_| self.column(&[], drivers).is_some());
        coefficient
            .map(|p| Sizing::linear(p).claimed(self.claimed_coefficient(drivers)))
            .into_iter()
            .collect()
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

    /// Values by which a claim states a size at a place.
    fn claimed_size(&self, sizing: &Sizing, place: &Values, size: f64, _drivers: &Drivers) -> Values {
        sizing.values(place, size)
    }
}

/// The numbers that a claim states for all parameters but the first; `None` where one is missing.
fn further_numbers(params: &[Param], values: &Values) -> Option<Vec<f64>> {
    params.iter().skip(1).map(|p| number(values, p.name)).collect()
}
