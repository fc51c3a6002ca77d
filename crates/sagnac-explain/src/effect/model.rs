//! Description of an effect: id, parameters, class, properties; and of effects on single samples, their action on a simulated
//! recording and their detection in a recorded one.
//!
//! The search for a mismatch knows no effect by name. It asks an effect on samples for its [`Detector`], whose class determines
//! the data that are searched and the consequence of a detection.

use super::detection::{
    Background, Detection, FlatResidual, Jumps, Law, LevelLaw, OutlierDetector, Rounding, RowDetector,
};
use super::mean::{Nuisance, Regressors, Resolution, SearchContext, Starts, StatePrior, Unmodelled, first};
use super::shared::power_law::power_law_places;
use super::shared::reach::{places_of, varies};
use super::{
    ClaimedMean, Column, Domain, Drivers, Knot, LowPass, ModeBin, Param, Place, ResponseLaw, Sizing,
    SpectralContext, SpectralSizing, SpectrumAct, StatedLine, Value, Values, number,
};
use crate::noise::composite::{Composite, Damped};
use crate::numeric::range::Bounds;

/// Kind, in `explain.json`, of a cause that the format has no kind for.
pub const UNKNOWN: &str = "unknown";

/// One piece of physics that a simulation can leave out.
///
/// The defaults are those of a plain effect. A search, a claim or a report that treats some effects differently asks for one of
/// these properties and never for a name.
pub trait Effect: Sync {
    /// Its id in files, on the command line and in the locale tables.
    fn kind(&self) -> &'static str;
    /// Its parameters, in the order in which reports list them.
    fn params(&self) -> &'static [Param];
    /// The view in which it is clearest.
    fn domain(&self) -> Domain;
    /// Recorded columns without which it cannot be found.
    fn needs(&self) -> &'static [Column];
    /// Effects that it is most easily confused with, the nearest first.
    fn confusers(&self) -> &'static [&'static dyn Effect];
    /// Its class and forward model.
    fn model(&self) -> Model;
    /// True where format `explain/1` has a kind for it. It is named only where nothing that has one explains nearly as much.
    fn in_format(&self) -> bool {
        true
    }
    /// Its kind in `explain.json`: [`UNKNOWN`] for an effect that the format has no kind for.
    fn reported_kind(&self) -> &'static str {
        if self.in_format() { self.kind() } else { UNKNOWN }
    }
    /// Lists that a claim may state beside the numbers; the bounds are those of every value.
    fn list_params(&self) -> &'static [Param] {
        &[]
    }
    /// Texts that a claim may state beside the numbers, by name.
    fn text_params(&self) -> &'static [&'static str] {
        &[]
    }
    /// True for an effect on the mean that averages over many samples determine: it is fitted to averages of a long record.
    fn is_slow(&self) -> bool {
        false
    }
    /// True for an effect that a claim carries over from the recording that it was identified in: a property of the unit, which
    /// its other recordings show too, and no event or state of one recording.
    fn is_carried_over(&self) -> bool {
        false
    }
    /// The law by which the bias follows a column with a role, as reports name it; `None` for an effect of another form.
    fn law(&self) -> Option<ResponseLaw> {
        None
    }
    /// For a response that is described by terms: the effects whose laws give the finding its name. Empty for an effect that
    /// has a name of its own.
    fn named_by_law(&self) -> &'static [&'static dyn Effect] {
        &[]
    }
    /// True for an effect whose course or spectrum no mechanism fixes, so that it bends to what another law leaves: it is named
    /// only where the plain laws of the others do not explain the record.
    fn is_free_form(&self) -> bool {
        false
    }
    /// True for the effect by which the bias follows any column without a role of its own, whatever the law.
    fn follows_any_column(&self) -> bool {
        false
    }
    /// Detector in single samples; `None` for an effect that is fitted to the whole record.
    fn detector(&self) -> Option<Detector> {
        match self.model() {
            Model::Samples(samples) => Some(samples.detector()),
            _ => None,
        }
    }
    /// True for an effect that multiplies the noise of each sample.
    fn sets_level(&self) -> bool {
        matches!(self.detector(), Some(Detector::Level(_)))
    }
    /// True for an effect of short events, of which many may be each too weak to be found alone.
    fn is_short_events(&self) -> bool {
        false
    }
    /// For an effect that rounds the output: how the step is claimed and found.
    fn rounding(&self) -> Option<&'static dyn Rounding> {
        None
    }
    /// The family of effects of which several at once are one cause without a name; `None` for an effect that stands alone.
    fn family(&self) -> Option<Family> {
        None
    }
    /// The effect that two of this kind are together, where the second reverses the first.
    fn reversed_pair(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// For an effect that oscillates at `frequency_hz`: the effect that a record of few cycles cannot distinguish from it.
    fn if_few_cycles(&self) -> Option<&'static dyn Effect> {
        None
    }
    /// For an effect that is fitted as a process and claimed as the course that the process took.
    fn claimed_by_course(&self) -> Option<&'static dyn ClaimedByCourse> {
        None
    }
    /// The course of claimed parameters of an effect that is no [`MeanModel`], deg/h, one value a sample; `None` where they
    /// determine none.
    fn claimed_course(&self, _values: &Values, _drivers: &Drivers) -> Option<Vec<f64>> {
        None
    }
    /// Trace of it in a later recording of the same unit. `claim` is the mean that the unit is claimed to have.
    fn later(&self, _values: &Values, _claim: &ClaimedMean) -> Later {
        Later::Same
    }
}

/// Trace of an effect in a later recording of the unit.
#[derive(Clone)]
pub enum Later {
    /// The same effect: its cause is still there.
    Same,
    /// Nothing: it happened once, and the bias holds it.
    Nothing,
    /// Another effect, the state in which it left the unit.
    As(&'static dyn Effect, Values),
}

/// Effects of one form. Several of one family at once are one cause: lines side by side are a line that is modulated,
/// many lines a periodic course, several changes of the spectrum a spectrum that no effect has, several jumps a staircase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Coherent sinusoids.
    Line,
    /// Changes of the spectrum of the noise. Rounding has a shape of its own, and is none.
    Spectrum,
    /// Single jumps.
    Jump,
}

/// An effect that is fitted as a process, and claimed as the course that the process took.
pub trait ClaimedByCourse: Sync {
    /// Values by which a claim states a course through knots of `time_s` and deg/h.
    fn values(&self, knots: &[Knot]) -> Values;

    /// Fitted parameters of a process with the rms and the rate of change of a claimed course; `None` for a course of few knots.
    fn process(&self, claimed: &Values) -> Option<Vec<f64>>;
}

/// The class of an effect, with its forward model.
#[derive(Clone, Copy)]
pub enum Model {
    /// Adds to the rate what its parameters and the recorded columns determine.
    Mean(&'static dyn MeanModel),
    /// Changes the spectrum of the noise.
    Spectrum(&'static dyn Spectrum),
    /// Acts on single samples: rows, outliers, jumps, the level of the noise.
    Samples(&'static dyn Samples),
}

/// True where numbers, in the order of an effect's parameters, are within their bounds. NaN, a value that is not known, is.
pub fn plausible(effect: &dyn Effect, parameters: &[f64]) -> bool {
    let within = |(p, v): (&Param, &f64)| v.is_nan() || (p.lower..=p.upper).contains(v);
    effect.params().iter().zip(parameters).all(within)
}

/// Values as a claim may state them: clamped to the bounds of their parameters, NaN left out.
pub fn stateable(effect: &dyn Effect, values: Values) -> Values {
    let param = |name: &str| effect.params().iter().chain(effect.list_params()).find(|p| p.name == name);
    let one = |(name, value): (String, Value)| {
        let Some(p) = param(&name) else { return Some((name, value)) };
        let value = match value {
            Value::Number(v) => Value::Number(Some(v.clamp(p.lower, p.upper)).filter(|v| !v.is_nan())?),
            Value::List(list) if list.iter().any(|v| v.is_nan()) => return None,
            Value::List(list) => Value::List(list.iter().map(|v| v.clamp(p.lower, p.upper)).collect()),
            text @ Value::Text(_) => text,
        };
        Some((name, value))
    };
    values.into_iter().filter_map(one).collect()
}

/// An effect on single samples.
pub trait Samples: Sync {
    /// Applies the effect to a simulated rate, deg/h, on the grid of the drivers; `seed` fixes every draw. Rows of which
    /// `keep` becomes false are not written.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], keep: &mut [bool]);

    /// Its detector.
    fn detector(&self) -> Detector;
}

/// The classes of detectors, in the order in which an explanation asks them.
#[derive(Clone, Copy)]
pub enum Detector {
    /// Finds rows that hold no value of their own, before anything is compared. They are set aside.
    Invalid {
        /// Id of the test that such rows fail; its name stands under `explain.test` of the locale tables.
        test: &'static str,
        /// The detector.
        rows: &'static dyn RowDetector,
    },
    /// Finds groups of samples that do not belong to the noise. They are set aside.
    Outliers(&'static dyn OutlierDetector),
    /// Finds the law of the level of the noise. The laws of all detectors of this class compete.
    Level(&'static dyn LevelDetector),
    /// Finds a course of jumps. It competes with the processes that have its spectrum, and is taken out.
    Jumps(&'static dyn JumpDetector),
    /// Finds rows that are not there: a fact and no estimate, reported beside everything else.
    Missing(&'static dyn RowDetector),
}

/// A level of the noise that changes.
#[derive(Clone)]
pub struct Level {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// The law.
    pub law: Law,
    /// Deviation of each sample over that of the whole record; its mean square is 1.
    pub profile: Vec<f64>,
    /// Gain of log-likelihood on the whitened residual over one level.
    pub gain: f64,
    /// Parameters of the law; its instants, its periods and its choice of a column counted.
    pub parameters: usize,
    /// Probability of such a gain under one level, all laws counted.
    pub p_value: f64,
    /// Largest deviation over the smallest; for a law of rate that at the largest rate over that at zero.
    pub ratio: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
    /// Intervals in which the noise is raised, principal one first.
    pub places: Vec<Place>,
}

/// Finds the law of the level of the noise.
pub trait LevelDetector: Sync {
    /// Laws fitted to a residual; `samples` are those that count.
    fn laws(&self, residual: &FlatResidual<'_>, samples: &[usize]) -> Vec<LevelLaw>;

    /// For a detector that looks for a change at an instant: the independent instants that are looked at in so many samples.
    fn instants_of_change(&self, _samples: usize) -> Option<f64> {
        None
    }

    /// Values by which a claim states a law, beside its ratio.
    fn stated(&self, level: &Level, drivers: &Drivers) -> Values;
}

/// Finds a course of jumps.
pub trait JumpDetector: Sync {
    /// Jumps beside a hypothesis; `rival_gain` works out what the best single process gains in their place.
    fn find(&self, background: &Background<'_>, rival_gain: &dyn Fn() -> f64) -> Option<Jumps>;

    /// True where jumps that were found are those that a claim states.
    fn agrees(&self, stated: &Values, found: &Detection) -> bool;

    /// The process that has the spectrum of stated jumps, with its parameters; `None` where too little is stated.
    fn process(&self, stated: &Values) -> Option<(&'static dyn Effect, Vec<f64>)>;
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

    /// Standard deviation of that state for a coefficient of 1; `None` where there is none.
    fn state_deviation(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Option<f64> {
        None
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

    /// For an effect of one nonlinear parameter that is nothing at zero: a value so small that the course is proportional to it
    /// there, which is what its score test takes for a column. `None` for any other effect.
    fn score_step(&self, _drivers: &Drivers) -> Option<f64> {
        None
    }

    /// Positions of nonlinear parameters that are whole numbers: tried by [`MeanModel::starts`] and not refined.
    fn whole(&self) -> &'static [usize] {
        &[]
    }

    /// Position and values of the nonlinear parameter that numbers the forms of a law, where another form gives the other parameters
    /// other values: the interval of these is that of all forms together.
    fn forms(&self) -> Option<(usize, &'static [f64])> {
        None
    }

    /// The columns for given nonlinear parameters.
    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        Regressors {
            offset: None,
            columns: self.column(nonlinear_parameters, drivers).into_iter().collect(),
            nuisance: self.initial_state(nonlinear_parameters, drivers),
            states: self
                .state_deviation(nonlinear_parameters, drivers)
                .map_or_else(Vec::new, |deviation| vec![StatePrior { column: Some(0), deviation }]),
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

    /// The kind with the same course that is the plainer name where nothing in the recording tells the two apart. Its odds are those of
    /// both names.
    fn plainer_name(&self, _nonlinear_parameters: &[f64], _drivers: &Drivers) -> Option<&'static str> {
        None
    }

    /// Samples within which the course is curved, so that the means of the columns do not determine it: they are left out of
    /// the fit. `parameters` in the order of [`Effect::params`](super::Effect::params).
    fn curvature_within_average(&self, _parameters: &[f64], _drivers: &Drivers) -> Vec<usize> {
        vec![]
    }

    /// Distance of each sample from the value of its driver at which the course bends, for a course with a corner: a unit bends there over
    /// a small range. `parameters` as above.
    fn distance_from_corner(&self, _parameters: &[f64], _drivers: &Drivers) -> Option<Vec<f64>> {
        None
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

/// An effect that changes the spectrum of the noise. Its parameters are positive and are fitted by their logarithms.
///
/// The defaults are those of the plainest effect, an unconstrained coefficient of the claim, which has only its `act`. A density
/// or a filter has its own `densities`, `starts`, `bounds`, `trials`, `compose` and `places`.
pub trait Spectrum: Effect {
    /// The way in which it acts.
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Adds
    }

    /// Two-sided density of each bin, (deg/h)²/Hz, or the factor of a filter, for fitted parameters. Unused for
    /// [`SpectrumAct::Unconstrains`].
    fn densities(&self, _fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        vec![0.0; bins.len()]
    }

    /// [`Spectrum::densities`] of one bin.
    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        self.densities(fitted, &[*bin]).first().copied().unwrap_or(0.0)
    }

    /// Adds the effect to a noise model for simulation of samples of `dt_s`: an unconstrained coefficient replaces that of the
    /// model.
    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        if let (SpectrumAct::Unconstrains(term), [coefficient]) = (self.act(), fitted) {
            noise.terms = noise.terms.with(term, *coefficient);
        }
    }

    /// Intervals in which it shows, principal one first, at most three: those of its term, for an unconstrained coefficient.
    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        match self.act() {
            SpectrumAct::Unconstrains(term) => power_law_places(term, fitted, context),
            SpectrumAct::Adds | SpectrumAct::Filters => vec![],
        }
    }

    /// Parameters that a fit begins from, several.
    fn starts(&self, _context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    /// Bounds of the fitted parameters.
    fn bounds(&self, _context: &SpectralContext<'_>) -> Vec<Bounds> {
        vec![]
    }

    /// Independent points that the search looks at: the p-value is multiplied by their number.
    fn trials(&self, _context: &SpectralContext<'_>) -> f64 {
        1.0
    }

    /// The parameters in the order of [`Effect::params`](super::Effect::params); NaN for one not determined.
    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    /// The fitted parameters of claimed ones; `None` where one is missing.
    fn claimed_parameters(&self, values: &Values) -> Option<Vec<f64>> {
        self.params().iter().map(|p| number(values, p.name)).collect()
    }

    /// The power of a parameter that the whole density is proportional to; `None` for one that changes its shape.
    fn scales_with(&self, _parameter: usize) -> Option<f64> {
        None
    }

    /// False for a parameter that a fit leaves where it began.
    fn is_refined(&self, _fitted: &[f64], _parameter: usize) -> bool {
        true
    }

    /// False where a fit ended at parameters that are another effect.
    fn plausible(&self, _fitted: &[f64]) -> bool {
        true
    }

    /// Samples at either end of a record that a filter makes different from noise that is even about the ends. They leak into
    /// the modes that the filter suppresses, the same few samples into all of them.
    fn edge_effect(&self, _fitted: &[f64], _dt_s: f64) -> usize {
        0
    }

    /// Frequencies below the Nyquist frequency at which a filter of samples leaves nothing, Hz.
    fn zeros_hz(&self, _fitted: &[f64], _dt_s: f64) -> Vec<f64> {
        vec![]
    }

    /// The filter that simulated samples go through, where the noise model has none for it.
    fn low_pass(&self, _fitted: &[f64], _dt_s: f64) -> Option<LowPass> {
        None
    }

    /// Size to ask for when it is determined which size would have been noticed; `None` for an effect whose size is no single
    /// number.
    fn sizing(&self, _context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        None
    }

    /// True for an effect of which a record can hold several, each with parameters of its own.
    fn repeats(&self) -> bool {
        false
    }

    /// True for exponentially correlated noise, which has the spectrum of independent jumps between two levels.
    fn is_relaxation(&self) -> bool {
        false
    }

    /// Values by which a claim states a process that was identified in samples of `dt_s`; `None` for one of another kind.
    fn values_of(&self, _process: &Damped, _dt_s: f64) -> Option<Values> {
        None
    }

    /// True when the course of the process can be estimated sample by sample (slow or narrow-band).
    fn has_course(&self) -> bool {
        false
    }
}

/// The numbers that a claim states for all parameters but the first; `None` where one is missing.
fn further_numbers(params: &[Param], values: &Values) -> Option<Vec<f64>> {
    params.iter().skip(1).map(|p| number(values, p.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_claim_cannot_state_is_clamped_or_left_out() {
        let effect = crate::effect::find("bias_step").unwrap();
        let stated = |step: f64, time: f64| {
            let values = [("step_deg_h", step), ("time_s", time)];
            stateable(effect, values.map(|(n, v)| (n.to_owned(), Value::Number(v))).into())
        };
        assert_eq!(stated(3e9, 5.0)["step_deg_h"], Value::Number(1e6));
        assert!(!stated(1.0, f64::NAN).contains_key("time_s"));
        assert!(plausible(effect, &[-1e6, f64::NAN]) && !plausible(effect, &[-1.1e6, 0.0]));
    }

    #[test]
    fn an_effect_that_the_format_has_no_kind_for_is_reported_as_unknown() {
        let of = |kind: &str| crate::effect::find(kind).unwrap().reported_kind();
        assert_eq!((of("line"), of("drifting_line")), ("line", UNKNOWN));
    }

    #[test]
    fn only_effects_on_samples_are_found_in_samples() {
        let of = |kind: &str| crate::effect::find(kind).unwrap().detector();
        assert!(matches!(of("outlier_bursts"), Some(Detector::Outliers(_))));
        assert!(matches!(of("noise_variance_time"), Some(Detector::Level(_))));
        assert!(matches!(of("random_telegraph"), Some(Detector::Jumps(_))));
        assert!(of("line").is_none() && of("excess_arw").is_none());
        assert!(crate::effect::find("noise_variance_rate").unwrap().sets_level());
        assert!(!crate::effect::find("outlier_bursts").unwrap().sets_level());
    }

    #[test]
    fn an_effect_of_numbers_alone_states_no_lists_and_no_texts() {
        let Model::Mean(mean) = crate::effect::find("bias_step").unwrap().model() else { panic!("a mean") };
        let drivers = Drivers::default();
        assert!(mean.texts(&[1.0], &drivers).is_empty());
        assert!(mean.lists(&[1.0], &[1.0], &drivers).is_empty());
        assert!(!mean.same_cause(&[1.0], &[1.0]));
    }
}
