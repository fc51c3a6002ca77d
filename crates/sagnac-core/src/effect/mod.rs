//! The catalogue of physics that a simulation can leave out: one file an effect.
//!
//! An effect says what its parameters are and how it acts. There is one forward model of each: simulation, fitting and
//! the stated effects of a claim all go through it. What a reader is told of it (mechanism, signature, the experiment
//! that would confirm it, source) stands under `effect.<kind>` of the locale tables, not here.

mod drivers;
mod kinds;
mod low_pass;
mod spectral;

pub use drivers::{ClaimedMean, Column, Drivers, Earth, Temperature, averages};
pub use kinds::{EFFECTS, find};
pub use low_pass::LowPass;
pub use spectral::{ModeBin, SpectralContext, Spectrum, SpectrumAct};

use crate::numeric::range::Bounds;
use std::collections::BTreeMap;

/// Kind of a cause that the format of explanations has no name for.
pub const UNKNOWN: &str = "unknown";

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Param {
    /// Name, with its unit in it.
    pub name: &'static str,
    /// Unit as reports show it; empty for a pure number.
    pub unit: &'static str,
    /// Lowest plausible value.
    pub lower: f64,
    /// Highest plausible value.
    pub upper: f64,
    /// True when a report of an explanation gives it; others serve the forward model alone.
    pub reported: bool,
    /// True when it has a direction: a report prints its plus.
    pub signed: bool,
    /// True when it is a whole number: a report prints it without decimals.
    pub whole: bool,
    /// True when a claim states the same quantity, so that the effect corrects a stated value and adds nothing new.
    pub corrects_claim: bool,
}

impl Param {
    /// A parameter that reports give.
    pub const fn reported(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Param {
        Param { name, unit, lower, upper, reported: true, signed: false, whole: false, corrects_claim: false }
    }

    /// A parameter that the forward model needs beside them.
    pub const fn inner(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Param {
        Param { reported: false, ..Param::reported(name, unit, lower, upper) }
    }

    /// The same, with a direction.
    pub const fn signed(self) -> Param {
        Param { signed: true, ..self }
    }

    /// The same, a whole number.
    pub const fn whole(self) -> Param {
        Param { whole: true, ..self }
    }

    /// The same, the correction of a value that a claim states under this name.
    pub const fn corrects_claim(self) -> Param {
        Param { corrects_claim: true, ..self }
    }
}

/// What a mismatch is located in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Domain {
    /// `time_s`, s.
    Time,
    /// Hz.
    Frequency,
    /// Autocorrelation lag, or delay between columns, s.
    Lag,
    /// °C.
    Temperature,
    /// °C/min.
    TemperatureRate,
    /// Rate of the table about the input axis, deg/s.
    InputRate,
    /// Rate of the table's other axis, deg/s.
    OuterRate,
    /// Table angle, or period of the sensed angle, deg.
    Angle,
    /// Size of the residual, deg/h.
    Amplitude,
    /// Where `time_s` itself is at fault, s.
    Timestamps,
    /// V.
    Supply,
}

impl Domain {
    /// Every domain.
    pub const ALL: &'static [Domain] = &[
        Domain::Time,
        Domain::Frequency,
        Domain::Lag,
        Domain::Temperature,
        Domain::TemperatureRate,
        Domain::InputRate,
        Domain::OuterRate,
        Domain::Angle,
        Domain::Amplitude,
        Domain::Timestamps,
        Domain::Supply,
    ];

    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            Domain::Time => "time",
            Domain::Frequency => "frequency",
            Domain::Lag => "lag",
            Domain::Temperature => "temperature",
            Domain::TemperatureRate => "temperature_rate",
            Domain::InputRate => "input_rate",
            Domain::OuterRate => "outer_rate",
            Domain::Angle => "angle",
            Domain::Amplitude => "amplitude",
            Domain::Timestamps => "timestamps",
            Domain::Supply => "supply",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Domain::Time | Domain::Lag | Domain::Timestamps => "s",
            Domain::Frequency => "Hz",
            Domain::Temperature => "degC",
            Domain::TemperatureRate => "degC/min",
            Domain::InputRate | Domain::OuterRate => "deg/s",
            Domain::Angle => "deg",
            Domain::Amplitude => "deg/h",
            Domain::Supply => "V",
        }
    }

    /// The domain of an id.
    pub fn of_id(id: &str) -> Option<Domain> {
        Domain::ALL.iter().copied().find(|d| d.id() == id)
    }
}

/// An interval of a domain, in the domain's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The domain.
    pub domain: Domain,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

/// A stated value of a parameter: a number, or a list for courses without a short formula.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A list.
    List(Vec<f64>),
}

/// Parameters by name.
pub type Values = BTreeMap<String, Value>;

/// The number of that name, if there.
pub fn number(values: &Values, name: &str) -> Option<f64> {
    match values.get(name) {
        Some(Value::Number(x)) => Some(*x),
        _ => None,
    }
}

/// The list of that name; empty if not there.
pub fn list<'a>(values: &'a Values, name: &str) -> &'a [f64] {
    match values.get(name) {
        Some(Value::List(x)) => x,
        _ => &[],
    }
}

/// The parameter of that name of whichever effect has one. Effects that share a name share unit, sign and kind of number.
pub fn parameter(name: &str) -> Option<&'static Param> {
    EFFECTS.iter().flat_map(|e| e.params()).find(|p| p.name == name)
}

/// Whether numbers in the order of an effect's parameters are within what it allows; one that is not known is.
pub fn plausible(effect: &dyn Effect, parameters: &[f64]) -> bool {
    let within = |(p, v): (&Param, &f64)| v.is_nan() || (p.lower..=p.upper).contains(v);
    effect.params().iter().zip(parameters).all(within)
}

/// Values as a claim may state them: within the bounds of their parameters, those that are no numbers left out.
pub fn stateable(effect: &dyn Effect, values: Values) -> Values {
    let param = |name: &str| effect.params().iter().chain(effect.list_params()).find(|p| p.name == name);
    let one = |(name, value): (String, Value)| {
        let Some(p) = param(&name) else { return Some((name, value)) };
        let value = match value {
            Value::Number(v) => Value::Number(Some(v.clamp(p.lower, p.upper)).filter(|v| !v.is_nan())?),
            Value::List(list) if list.iter().any(|v| v.is_nan()) => return None,
            Value::List(list) => Value::List(list.iter().map(|v| v.clamp(p.lower, p.upper)).collect()),
        };
        Some((name, value))
    };
    values.into_iter().filter_map(one).collect()
}

/// One piece of physics.
pub trait Effect: Sync {
    /// Its kind in files.
    fn kind(&self) -> &'static str;
    /// Its kind in the format of explanations; `unknown` for an effect of this catalogue that has none there.
    fn reported_kind(&self) -> &'static str {
        if kinds::is_own(self.kind()) { UNKNOWN } else { self.kind() }
    }
    /// Its parameters.
    fn params(&self) -> &'static [Param];
    /// Lists that its stated form may carry beside the numbers, by name; the bounds are those of every value.
    fn list_params(&self) -> &'static [Param] {
        &[]
    }
    /// Columns without which it cannot be seen.
    fn needs(&self) -> &'static [Column] {
        &[]
    }
    /// The view where it shows first.
    fn domain(&self) -> Domain;
    /// Kinds it is most easily taken for, the nearest first.
    fn confusers(&self) -> &'static [&'static str];
    /// How it acts.
    fn model(&self) -> Model;
    /// The course that stated parameters give where the effect is no [`MeanModel`] for fitting, deg/h; `None` where they
    /// give none.
    fn stated_course(&self, _values: &Values, _drivers: &Drivers) -> Option<Vec<f64>> {
        None
    }
}

/// How an effect acts on the output.
#[derive(Clone, Copy)]
pub enum Model {
    /// Adds a course to the rate that its parameters and the columns determine.
    Mean(&'static dyn MeanModel),
    /// Changes the spectrum of the noise.
    Spectrum(&'static dyn Spectrum),
    /// Acts on single samples: rows, outliers, jumps, the level of the noise.
    Samples(&'static dyn Samples),
}

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

/// An effect on single samples. The engine knows how each is found; here is what it does.
pub trait Samples: Sync {
    /// Applies the effect to a simulated rate, deg/h, on the grid of the drivers; `seed` fixes every draw. Rows of which
    /// `keep` becomes false are not written.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], keep: &mut [bool]);
}
