//! Description of an effect: id, parameters, class, properties; and of effects on single samples, their action on a simulated
//! recording and their detection in a recorded one.
//!
//! The search for a mismatch knows no effect by name. It asks an effect on samples for its [`Detector`], whose class determines
//! the data that are searched and the consequence of a detection.

use super::{
    ClaimedMean, Column, Domain, Drivers, MeanModel, Param, Place, ResponseLaw, Spectrum, Value, Values,
};

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
    /// Changes of the spectrum of the noise.
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

/// A value that a detector reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reported {
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
}

impl Reported {
    /// A value with its interval.
    pub fn new(name: &'static str, unit: &'static str, value: f64, ci95: [f64; 2]) -> Reported {
        Reported { name, unit, value, ci95 }
    }
}

/// Result of a detector.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detection {
    /// Parameters as reports give them.
    pub reported: Vec<Reported>,
    /// Parameters as a claim states them.
    pub stated: Values,
    /// Intervals in which it shows, principal one first.
    pub places: Vec<Place>,
    /// Gain of log-likelihood over a record without it.
    pub gain: f64,
    /// Parameters that the gain was bought with.
    pub parameters: usize,
    /// Probability of such a gain without it, everything scanned counted.
    pub p_value: f64,
}

impl Detection {
    /// The reported value of a name.
    pub fn reported(&self, name: &str) -> Option<&Reported> {
        self.reported.iter().find(|r| r.name == name)
    }
}

/// The rows of a recording on its grid.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Rate, deg/h; interpolated where a row is missing.
    pub rate: &'a [f64],
    /// True where a row is.
    pub present: &'a [bool],
    /// Runs of missing rows: first place on the grid, count.
    pub gaps: &'a [(usize, usize)],
    /// `time_s` of the first place of the grid.
    pub start_s: f64,
    /// Sample interval, s.
    pub dt_s: f64,
}

impl Rows<'_> {
    /// `time_s` of a place on the grid.
    pub fn time_s(&self, row: usize) -> f64 {
        self.start_s + row as f64 * self.dt_s
    }
}

/// Finds an effect in the rows as they were recorded.
pub trait RowDetector: Sync {
    /// The rows concerned, and the effect as they show it; `None` where there is none.
    fn find(&self, rows: &Rows<'_>) -> Option<RowsFound>;
}

/// Rows that an effect concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct RowsFound {
    /// Their places on the grid, ascending.
    pub rows: Vec<usize>,
    /// The effect.
    pub detection: Detection,
}

/// Residual of a fitted hypothesis, in single samples.
pub struct FlatResidual<'a> {
    /// Whitened by the hypothesis.
    pub white: Vec<f64>,
    /// Without the slow course, its own spectrum levelled: what a wrong spectrum or a missing course leaves is not in it.
    pub flat: Vec<f64>,
    /// Deviation in `flat` for 1 deg/h in one sample.
    pub per_deg_h: f64,
    /// Samples at either end that say nothing of single samples.
    pub ends: usize,
    /// True for a sample that is that of a row which counts.
    pub usable: &'a [bool],
    /// The columns.
    pub drivers: &'a Drivers,
    /// Step of the grid of values that the output is rounded to, in the unit of `flat`; 0 where there is none.
    pub rounding_step: f64,
}

impl FlatResidual<'_> {
    /// Steps of rounding, in deviations of a sample, from which values are seen to jump between them.
    pub const COARSE_STEPS: f64 = 2.0;

    /// True for a sample that counts.
    pub fn counts(&self, i: usize) -> bool {
        let inside = i >= self.ends && i + self.ends < self.flat.len();
        inside && self.usable.get(i).copied().unwrap_or(false)
    }
}

/// Groups of samples that do not belong to the noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Outliers {
    /// First sample and length of each, by time.
    pub groups: Vec<(usize, usize)>,
    /// Samples to set aside.
    pub samples: Vec<usize>,
    /// Groups at most that are too small to be found: as many as there are between the smallest that is found and twice
    /// its size, if sizes are no more frequent below it.
    pub missed: usize,
    /// Deviation of the whitened samples set aside; 1 where the noise is as the hypothesis says.
    pub deviation: f64,
    /// Gain of log-likelihood by a deviation of their own, against the level of their neighbourhood.
    pub gain: f64,
    /// Parameters that the gain was bought with.
    pub parameters: usize,
    /// Probability of as much without them, everything scanned counted.
    pub p_value: f64,
}

/// Finds groups of outlying samples.
pub trait OutlierDetector: Sync {
    /// Groups in a residual; `None` where there are none.
    fn find(&self, residual: &FlatResidual<'_>) -> Option<Outliers>;

    /// The effect, from what was taken out of each sample, deg/h, when the groups were set aside.
    fn describe(&self, found: &Outliers, removed: &[f64], drivers: &Drivers) -> Option<Detection>;
}

/// A point of a law that runs in straight lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// A time or a value of a column.
    pub at: f64,
    /// Value of the law there.
    pub value: f64,
}

/// Law of the level of the noise.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Time: deviation over that of the whole record at `time_s`, with lines between the knots.
    Time(Vec<Knot>),
    /// Size of the input rate: σ² = σ₀² (1 + (ratio² − 1)(|Ω|/max)^exponent).
    Rate {
        /// Deviation at the largest rate over that at zero.
        ratio: f64,
        /// 1 or 2.
        exponent: u8,
    },
    /// Value of a column: deviation over that of the whole record.
    Column(Column, Vec<Knot>),
}

/// A law of the level, fitted to groups of samples and not yet held against single ones.
#[derive(Debug, Clone)]
pub struct LevelLaw {
    /// The law.
    pub law: Law,
    /// Deviation of each sample, in any unit.
    pub profile: Vec<f64>,
    /// Gain of log-likelihood over one level for all groups.
    pub gain: f64,
    /// Independent laws that were tried for it.
    pub trials: f64,
    /// Coefficients that a gain of nothing comes from.
    pub free: usize,
    /// Parameters of the law, what was searched counted.
    pub parameters: usize,
    /// Spread of the groups about the law over what χ² laws give.
    pub dispersion: f64,
    /// Largest deviation over the smallest; for a law of rate that at the largest rate over that at zero.
    pub ratio: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
    /// Interval in which the noise is raised.
    pub place: Place,
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

    /// For a detector that looks for a change at an instant: parameters of one change, and the independent instants that are
    /// looked at in so many samples.
    fn single_change(&self, _samples: usize) -> Option<(usize, f64)> {
        None
    }

    /// Values by which a claim states a law, beside its ratio.
    fn stated(&self, level: &Level, drivers: &Drivers) -> Values;
}

/// A recording before a hypothesis of its noise and its mean, in cosine modes: what a course of jumps is looked for in.
pub struct Background<'a> {
    /// The columns.
    pub drivers: &'a Drivers,
    /// Modes of what the hypothesis leaves.
    pub modes: Vec<f64>,
    /// Variance of each mode, (deg/h)²; infinite for one that is free.
    pub powers: Vec<f64>,
    /// Modes of the columns of the hypothesis, each with the deviation of its prior.
    pub columns: Vec<(Vec<f64>, f64)>,
    /// Log-likelihood that the noise beside jumps loses against that of the hypothesis in a record without jumps.
    pub lost: f64,
    /// Step of the grid of values that the output is rounded to, as an angle increment, arcsec.
    pub grid_step_arcsec: Option<f64>,
}

/// A course of jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Jumps {
    /// Expected value of each sample given all, less its mean, deg/h.
    pub course: Vec<f64>,
    /// The effect. Its p-value is the larger of that under the hypothesis and that of its gain over the best single process.
    pub detection: Detection,
    /// Bound of the probability of such a gain under the hypothesis.
    pub chance: f64,
    /// Gain of the best single process in its place.
    pub rival_gain: f64,
    /// False for jumps every few samples, which cannot be distinguished from a short correlated process, and for jumps in equal
    /// intervals, which are a periodic course.
    pub resolved: bool,
    /// For a level that is left much sooner than the other, which is no telegraph: its visits.
    pub pulses: Option<Pulses>,
}

/// Pulses of no kind that recur.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulses {
    /// Number of pulses.
    pub count: usize,
    /// Mean length, s.
    pub each_s: f64,
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

/// An effect that rounds the output in steps, which the values of a recording show by themselves.
pub trait Rounding: Sync {
    /// The step that a claim states, as an angle increment, arcsec.
    fn step_arcsec(&self, stated: &Values) -> Option<f64>;

    /// The effect, from the step of the values as an angle increment and what their digits leave open of it, arcsec.
    fn detection(&self, step_arcsec: f64, open_arcsec: f64, dt_s: f64) -> Detection;
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
    fn samples_count_inside_of_both_ends_where_their_rows_do() {
        let drivers = Drivers::default();
        let usable = [true, true, true, false, true, true, true];
        let residual = FlatResidual {
            white: vec![0.0; 7],
            flat: vec![0.0; 7],
            per_deg_h: 1.0,
            ends: 2,
            usable: &usable,
            drivers: &drivers,
            rounding_step: 0.0,
        };
        let counted: Vec<usize> = (0..9).filter(|i| residual.counts(*i)).collect();
        assert_eq!(counted, [2, 4]);
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
