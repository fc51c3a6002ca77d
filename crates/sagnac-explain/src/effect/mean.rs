//! Data of the fit of effects on the mean: what a search is given, what it begins with, what an effect adds to the fit.

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
    /// Prior of each of these columns that is a state before the record, in their order; empty where none is.
    pub states: Vec<StatePrior>,
}

/// Prior of a state before the record: what the effect makes of the column's whole range is one standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatePrior {
    /// Column whose coefficient the state is proportional to; `None` for the fixed part.
    pub column: Option<usize>,
    /// Standard deviation for a coefficient of 1.
    pub deviation: f64,
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
