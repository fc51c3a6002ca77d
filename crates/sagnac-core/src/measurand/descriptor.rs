//! A measured quantity: its id and unit, the test that gives it, its needs, and its evaluation.

use super::evidence::{ComparisonEvidence, GyroEvidence, KnownInputEvidence, TableEvidence};
use crate::criticism;
use crate::estimate::{Estimate, Spread, UpperLimit};
use crate::influence::Influence;
use crate::influence::repeatability::Repeatability;
use crate::noise::data::NoiseType;
use crate::noise::in_band::NoiseTest;
use crate::rate_table::acceleration::Acceleration;
use crate::rate_table::design::Extra;
use crate::rate_table::transfer::Transfer;
use crate::start_up::StartUp;
use crate::temperature::findings::Findings;
use crate::temperature::warm_up::WarmUpFindings;
use std::fmt;

/// Option of a procedure: `keep` or `remove` the Earth rate.
pub const EARTH_RATE_OPTION: &str = "earth_rate";

/// Choices a procedure makes for a measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Whether the Earth rate is taken out of the static bias.
    pub remove_earth_rate: bool,
}

/// The kind of test that gives a measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Test {
    /// Rate at rest at constant temperature.
    Static,
    /// Rate at rest, by frequency, where the procedure states bands.
    NoiseInBands,
    /// Rate at rest over temperature.
    Temperature,
    /// Rate at rest from switching on.
    WarmUp,
    /// Rate about the input axis given by a table, by known turns or by positions against the Earth rate.
    RateTable,
    /// Rate at rest in positions in the field of gravity.
    Acceleration,
    /// Motion of a table over frequency.
    Transfer,
    /// Supply, status and output from switching on.
    StartUp,
    /// Rate at rest over switching off and on.
    Repeatability,
    /// Rate at rest without and with an influence other than temperature.
    Comparison,
}

/// The evaluation of a measurand: a pure function of the evidence that its kind of test leaves.
///
/// A function gives one row, or several where a quantity is given by zone, ramp, axis or level, or none where the channel
/// has nothing to say about it.
#[derive(Clone, Copy)]
pub enum Evaluation {
    /// From a gyro at rest.
    Static(fn(&Measurand, &GyroEvidence, &Options) -> Vec<Estimate>),
    /// From a gyro at rest and what a test of its noise asks for.
    NoiseInBands(fn(&Measurand, &GyroEvidence, &NoiseTest) -> Vec<Estimate>),
    /// From what a test over temperature showed of a channel.
    Temperature(fn(&Measurand, &str, &Findings) -> Vec<Estimate>),
    /// From what the warm-up of a channel showed.
    WarmUp(fn(&Measurand, &str, &WarmUpFindings) -> Vec<Estimate>),
    /// From steps of a rate table, or from known turns and positions, or from both.
    RateTable {
        /// From steps; `None`: steps do not show it.
        steps: Option<OfSteps>,
        /// From inputs that are known without a table; `None`: they do not show it.
        known: Option<OfKnownInput>,
    },
    /// From positions in the field of gravity.
    Acceleration(fn(&Measurand, &Acceleration) -> Vec<Estimate>),
    /// From supply, status and output from switching on.
    StartUp(fn(&Measurand, &StartUp) -> Vec<Estimate>),
    /// From the response to motion over frequency.
    Transfer(fn(&Measurand, &Transfer) -> Vec<Estimate>),
    /// From a series of switchings-on.
    Repeatability(fn(&Measurand, &Repeatability) -> Vec<Estimate>),
    /// From a comparison without and with an influence.
    Comparison {
        /// The influence that shows it; `None`: any.
        influence: Option<Influence>,
        /// The evaluation.
        evaluate: fn(&Measurand, &ComparisonEvidence<'_>) -> Vec<Estimate>,
    },
}

/// How steps of a rate table show a measurand.
#[derive(Clone, Copy)]
pub struct OfSteps {
    /// Motion of the table that is needed.
    pub stimulus: Stimulus,
    /// Terms that the model of the response has to hold beside the rate.
    pub extras: &'static [Extra],
    /// The evaluation.
    pub evaluate: fn(&Measurand, &TableEvidence<'_>) -> Vec<Estimate>,
}

/// Motion of a rate table that is needed to show a measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stimulus {
    /// Rates about the input axis.
    Rates,
    /// Rates about the input axis of an open-loop unit, whose response is a sine.
    OpenLoopRates,
    /// Rates near zero.
    SmallRates,
    /// Rates about the input axis up to those that the output no longer follows.
    Overload,
    /// Rates about the input axis, repeated at several temperatures.
    Soaks,
    /// Turns about the outer axis, which is square to the input axis.
    OuterTurns,
}

/// How turns by known angles and positions against the Earth rate show a measurand.
#[derive(Clone, Copy)]
pub struct OfKnownInput {
    /// True where positions against the Earth rate show it.
    pub positions: bool,
    /// Axis of the turns that show it; `None`: turns do not show it.
    pub turns: Option<TurnAxis>,
    /// The evaluation.
    pub evaluate: fn(&Measurand, &KnownInputEvidence<'_>) -> Vec<Estimate>,
}

/// The axis of a turn by a known angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TurnAxis {
    /// The input axis of the channel itself.
    Own,
    /// The input axis of another channel.
    Other,
}

/// The quantity that decides whether a record is long enough to judge a limit on a measurand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PowerModel {
    /// The information on a coefficient of the noise model.
    NoiseTerm(NoiseType),
    /// The degrees of freedom of a standard deviation of window means.
    WindowMeans {
        /// Length of the windows, s.
        window_s: f64,
    },
    /// The uncertainty of the mean of the record.
    Mean,
}

/// A measured quantity. `measurand.<id>` is its name in the locale tables.
#[derive(Clone, Copy)]
pub struct Measurand {
    /// Id in procedures, limits and results; part of the contract of `result.json`.
    pub id: &'static str,
    /// Unit in results; limits and references are converted to it. Empty: as recorded, one of `recorded_in`.
    pub unit: &'static str,
    /// Units that it may have in results where they follow from the recording or the procedure.
    pub recorded_in: &'static [&'static str],
    /// Definition in one line.
    pub doc: &'static str,
    /// Other names that people write for it, in lower case, so that the id can be offered; no file may use them.
    pub other_names: &'static [&'static str],
    /// True when it can be negative, so that a limit on its magnitude makes sense.
    pub signed: bool,
    /// Options that a procedure may set for it.
    pub options: &'static [&'static str],
    /// True when it follows from the site alone, whatever was recorded.
    pub from_site: bool,
    /// True when only a unit that stands still shows it: motion would be taken for noise.
    pub needs_stillness: bool,
    /// True for a drift or an instability, which no working gyro has as large as a rate.
    pub drift: bool,
    /// What decides whether a record can judge a limit on it; `None`: not a question of statistics.
    pub power: Option<PowerModel>,
    /// Formulas of its own, one a line, for the appendix of a report; `methods.<id>.title` and `.text` are their words. Empty
    /// where an entry that several measurands share explains it.
    pub formulas: &'static [&'static str],
    /// Where the formulas come from.
    pub source: &'static str,
    /// How it is evaluated.
    pub evaluation: Evaluation,
}

impl PartialEq for Measurand {
    fn eq(&self, other: &Measurand) -> bool {
        self.id == other.id
    }
}

impl Eq for Measurand {}

impl fmt::Debug for Measurand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Measurand({})", self.id)
    }
}

impl Test {
    /// True where a gyro at rest at constant conditions shows it.
    pub fn is_at_rest(self) -> bool {
        matches!(self, Test::Static | Test::NoiseInBands)
    }
}

impl Measurand {
    const fn new(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluation: Evaluation,
    ) -> Measurand {
        Measurand {
            id,
            unit,
            recorded_in: &[],
            doc,
            other_names: &[],
            signed: false,
            options: &[],
            from_site: false,
            needs_stillness: false,
            drift: false,
            power: None,
            formulas: &[],
            source: "",
            evaluation,
        }
    }

    /// A measurand of a gyro at rest.
    pub const fn at_rest(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &GyroEvidence, &Options) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Static(evaluate))
    }

    /// A measurand of a test of the noise in bands of frequency.
    pub const fn of_noise_test(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &GyroEvidence, &NoiseTest) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::NoiseInBands(evaluate))
    }

    /// A measurand of a test over temperature.
    pub const fn over_temperature(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &str, &Findings) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Temperature(evaluate))
    }

    /// A measurand of the warm-up.
    pub const fn of_warm_up(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &str, &WarmUpFindings) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::WarmUp(evaluate))
    }

    /// A measurand of steps of a rate table.
    pub const fn of_steps(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        stimulus: Stimulus,
        evaluate: fn(&Measurand, &TableEvidence<'_>) -> Vec<Estimate>,
    ) -> Measurand {
        let steps = Some(OfSteps { stimulus, extras: &[], evaluate });
        Measurand::new(id, unit, doc, Evaluation::RateTable { steps, known: None })
    }

    /// A measurand that turns by known angles or positions alone show.
    pub const fn of_known_input(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        known: OfKnownInput,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::RateTable { steps: None, known: Some(known) })
    }

    /// A measurand of positions in the field of gravity.
    pub const fn of_acceleration(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &Acceleration) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Acceleration(evaluate))
    }

    /// A measurand of the response to motion over frequency.
    pub const fn of_transfer(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &Transfer) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Transfer(evaluate))
    }

    /// A measurand of the start-up.
    pub const fn of_start_up(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &StartUp) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::StartUp(evaluate))
    }

    /// A measurand of a series of switchings-on.
    pub const fn of_runs(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        evaluate: fn(&Measurand, &Repeatability) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Repeatability(evaluate))
    }

    /// A measurand of a comparison without and with an influence; of any influence where `influence` is `None`.
    pub const fn of_influence(
        id: &'static str,
        unit: &'static str,
        doc: &'static str,
        influence: Option<Influence>,
        evaluate: fn(&Measurand, &ComparisonEvidence<'_>) -> Vec<Estimate>,
    ) -> Measurand {
        Measurand::new(id, unit, doc, Evaluation::Comparison { influence, evaluate })
    }

    /// It can be negative.
    #[must_use]
    pub const fn signed(mut self) -> Measurand {
        self.signed = true;
        self
    }

    /// Units that it may have, one of which follows from the recording or the procedure.
    #[must_use]
    pub const fn recorded_in(mut self, units: &'static [&'static str]) -> Measurand {
        self.recorded_in = units;
        self
    }

    /// A procedure may set these options for it.
    #[must_use]
    pub const fn options(mut self, options: &'static [&'static str]) -> Measurand {
        self.options = options;
        self
    }

    /// It follows from the site alone.
    #[must_use]
    pub const fn from_site(mut self) -> Measurand {
        self.from_site = true;
        self
    }

    /// Only a unit that stands still shows it.
    #[must_use]
    pub const fn needs_stillness(mut self) -> Measurand {
        self.needs_stillness = true;
        self
    }

    /// It is a drift or an instability.
    #[must_use]
    pub const fn drift(mut self) -> Measurand {
        self.drift = true;
        self
    }

    /// Symbols and names that people write for it, in lower case.
    #[must_use]
    pub const fn also_called(mut self, names: &'static [&'static str]) -> Measurand {
        self.other_names = names;
        self
    }

    /// The power of a limit on it is that of this model.
    #[must_use]
    pub const fn power(mut self, model: PowerModel) -> Measurand {
        self.power = Some(model);
        self
    }

    /// Formulas of its own, with a point as the decimal mark and no units, and their source.
    #[must_use]
    pub const fn formulas(mut self, formulas: &'static [&'static str], source: &'static str) -> Measurand {
        self.formulas = formulas;
        self.source = source;
        self
    }

    /// The model of the response to a table holds these beside the rate.
    #[must_use]
    pub const fn extras(mut self, extras: &'static [Extra]) -> Measurand {
        if let Evaluation::RateTable { steps: Some(steps), .. } = &mut self.evaluation {
            steps.extras = extras;
        }
        self
    }

    /// Turns by known angles or positions show it too.
    #[must_use]
    pub const fn or_known_input(mut self, input: OfKnownInput) -> Measurand {
        if let Evaluation::RateTable { known, .. } = &mut self.evaluation {
            *known = Some(input);
        }
        self
    }

    /// The kind of test that gives it.
    pub fn test(&self) -> Test {
        match self.evaluation {
            Evaluation::Static(_) => Test::Static,
            Evaluation::NoiseInBands(_) => Test::NoiseInBands,
            Evaluation::Temperature(_) => Test::Temperature,
            Evaluation::WarmUp(_) => Test::WarmUp,
            Evaluation::RateTable { .. } => Test::RateTable,
            Evaluation::Acceleration(_) => Test::Acceleration,
            Evaluation::Transfer(_) => Test::Transfer,
            Evaluation::StartUp(_) => Test::StartUp,
            Evaluation::Repeatability(_) => Test::Repeatability,
            Evaluation::Comparison { .. } => Test::Comparison,
        }
    }

    /// How steps of a rate table show it; `None` where they do not.
    pub fn by_steps(&self) -> Option<OfSteps> {
        match self.evaluation {
            Evaluation::RateTable { steps, .. } => steps,
            _ => None,
        }
    }

    /// How turns by known angles and positions show it; `None` where they do not.
    pub fn by_known_input(&self) -> Option<OfKnownInput> {
        match self.evaluation {
            Evaluation::RateTable { known, .. } => known,
            _ => None,
        }
    }

    /// True when the Earth rate along the input axis is needed.
    pub fn needs_site(&self, options: &Options) -> bool {
        self.from_site || options.remove_earth_rate && self.options.contains(&EARTH_RATE_OPTION)
    }

    /// Its rows on a gyro channel at rest, over temperature or from switching on; none for a measurand of other tests.
    pub fn evaluate_gyro(&self, gyro: &GyroEvidence, options: &Options) -> Vec<Estimate> {
        let estimates = match self.evaluation {
            Evaluation::Static(evaluate) => evaluate(self, gyro, options),
            Evaluation::NoiseInBands(evaluate) => {
                gyro.noise_test.as_ref().map_or_else(Vec::new, |test| evaluate(self, gyro, test))
            }
            Evaluation::Temperature(_) => {
                let found = gyro.over_temperature.as_ref();
                found.map_or_else(Vec::new, |found| self.evaluate_temperature(&gyro.channel, found))
            }
            Evaluation::WarmUp(_) => {
                let found = gyro.warm_up.as_ref();
                found.map_or_else(Vec::new, |found| self.evaluate_warm_up(&gyro.channel, found))
            }
            _ => vec![],
        };
        criticism::raise(criticism::of_gyro(gyro), estimates)
    }

    /// Its rows on a gyro channel over temperature; none for a measurand of other tests.
    pub fn evaluate_temperature(&self, channel: &str, found: &Findings) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::Temperature(evaluate) => evaluate(self, channel, found),
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel from switching on; none for a measurand of other tests.
    pub fn evaluate_warm_up(&self, channel: &str, found: &WarmUpFindings) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::WarmUp(evaluate) => evaluate(self, channel, found),
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel from steps of a rate table; none where they do not show it.
    pub fn evaluate_steps(&self, channel: &TableEvidence<'_>) -> Vec<Estimate> {
        let Some(steps) = self.by_steps() else { return vec![] };
        let objections = criticism::objections(criticism::OF_TABLE, |examine| examine(channel));
        criticism::raise(&objections, (steps.evaluate)(self, channel))
    }

    /// Its rows on all gyro channels from turns by known angles and positions; none where they do not show it.
    pub fn evaluate_known_input(&self, known: &KnownInputEvidence<'_>) -> Vec<Estimate> {
        self.by_known_input().map_or_else(Vec::new, |input| (input.evaluate)(self, known))
    }

    /// Its rows on a gyro channel from positions in the field of gravity; none for a measurand of other tests.
    pub fn evaluate_acceleration(&self, found: &Acceleration) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::Acceleration(evaluate) => evaluate(self, found),
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel from the response over frequency; none for a measurand of other tests.
    pub fn evaluate_transfer(&self, found: &Transfer) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::Transfer(evaluate) => evaluate(self, found),
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel from the start-up; none for a measurand of other tests.
    pub fn evaluate_start_up(&self, found: &StartUp) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::StartUp(evaluate) => evaluate(self, found),
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel from a series of switchings-on; none for a measurand of other tests.
    pub fn evaluate_runs(&self, runs: &Repeatability) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::Repeatability(evaluate) => {
                let objections = criticism::objections(criticism::OF_RUNS, |examine| examine(runs));
                criticism::raise(&objections, evaluate(self, runs))
            }
            _ => vec![],
        }
    }

    /// Its rows on a gyro channel without and with an influence; none for a measurand of another influence or test.
    pub fn evaluate_comparison(&self, compared: &ComparisonEvidence<'_>) -> Vec<Estimate> {
        match self.evaluation {
            Evaluation::Comparison { influence, evaluate }
                if influence.is_none_or(|i| i == compared.bias.test.setting.influence) =>
            {
                let objections = criticism::objections(criticism::OF_COMPARISON, |examine| examine(compared));
                criticism::raise(&objections, evaluate(self, compared))
            }
            _ => vec![],
        }
    }

    /// An estimate of it with its confidence distribution, in its unit.
    pub fn measured(&self, channel: &str, value: f64, spread: Spread, method: &'static str) -> Estimate {
        Estimate::measured(self.id, channel, value, self.unit, spread, method)
    }

    /// A row that says that the record does not show it, with what it is at most (`None`: nothing can be said).
    pub fn not_identifiable(
        &self,
        channel: &str,
        upper_limit: Option<UpperLimit>,
        method: &'static str,
    ) -> Estimate {
        Estimate::not_identifiable(self.id, channel, upper_limit, self.unit, method)
    }

    /// An estimate that was made under another name, as one of this measurand.
    pub fn named(&self, estimate: &Estimate) -> Estimate {
        Estimate { id: self.id, unit: self.unit, ..estimate.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{asked, gyro};
    use super::*;

    fn none(m: &Measurand, channel: &str) -> Vec<Estimate> {
        vec![m.not_identifiable(channel, None, "test")]
    }

    fn plain() -> Measurand {
        Measurand::at_rest("a", "deg/h", "doc", |m, gyro, _| none(m, &gyro.channel))
    }

    fn of_turns(m: &Measurand, _: &KnownInputEvidence<'_>) -> Vec<Estimate> {
        none(m, "turned")
    }

    const INPUT: OfKnownInput =
        OfKnownInput { positions: true, turns: Some(TurnAxis::Own), evaluate: of_turns };

    #[test]
    fn a_measurand_is_its_id() {
        let other = Measurand::at_rest("b", "deg/h", "doc", |m, gyro, _| none(m, &gyro.channel));
        assert!(plain() == plain().signed() && plain() != other);
        assert_eq!(format!("{:?}", plain()), "Measurand(a)");
    }

    #[test]
    fn the_site_is_needed_where_it_is_the_source_or_its_rate_is_removed() {
        let (remove, keep) = (Options { remove_earth_rate: true }, Options { remove_earth_rate: false });
        let with_option = plain().options(&[EARTH_RATE_OPTION]);
        for (m, options, needed) in [
            (plain(), remove, false),
            (plain(), keep, false),
            (plain().options(&["other"]), remove, false),
            (with_option, remove, true),
            (with_option, keep, false),
            (plain().from_site(), keep, true),
            (plain().from_site(), remove, true),
        ] {
            assert_eq!(m.needs_site(&options), needed, "{:?} {options:?}", m.options);
        }
    }

    #[test]
    fn builders_set_what_they_name() {
        let m = plain().needs_stillness().drift().signed().also_called(&["x"]).power(PowerModel::Mean);
        assert!(m.needs_stillness && m.drift && m.signed && !m.from_site);
        assert_eq!(
            (m.other_names, m.power, m.id, m.unit, m.doc),
            (&["x"][..], Some(PowerModel::Mean), "a", "deg/h", "doc")
        );
        let m = plain().formulas(&["y = x"], "a book");
        assert_eq!((m.formulas, m.source), (&["y = x"][..], "a book"));
        assert!(
            !plain().needs_stillness && !plain().drift && !plain().signed && plain().from_site().from_site
        );
    }

    #[test]
    fn each_test_evaluates_its_own_measurands_and_no_others() {
        let options = Options { remove_earth_rate: false };
        let temperature = Measurand::over_temperature("t", "deg/h", "doc", |m, channel, _| none(m, channel));
        let warm_up = Measurand::of_warm_up("w", "s", "doc", |m, channel, _| none(m, channel));
        let runs = Measurand::of_runs("r", "deg/h", "doc", |m, runs| none(m, &runs.channel));
        let steps = Measurand::of_steps("s", "ppm", "doc", Stimulus::SmallRates, |m, e| none(m, &e.channel));
        let known = Measurand::of_known_input("k", "1", "doc", INPUT);
        let influence = Measurand::of_influence("i", "deg/h", "doc", None, |m, c| none(m, &c.bias.channel));
        let tests = [
            (plain(), Test::Static),
            (temperature, Test::Temperature),
            (warm_up, Test::WarmUp),
            (steps, Test::RateTable),
            (known, Test::RateTable),
            (runs, Test::Repeatability),
            (influence, Test::Comparison),
        ];
        let mut gyro = gyro();
        for (m, test) in tests {
            assert_eq!(m.test(), test);
            assert_eq!(m.evaluate_gyro(&gyro, &options).len(), usize::from(test == Test::Static));
        }
        let found = Findings::nothing(&asked());
        gyro.over_temperature = Some(found.clone());
        for (m, test) in tests {
            let is_own = test == Test::Temperature;
            assert_eq!(m.evaluate_temperature("c", &found).len(), usize::from(is_own));
            let both = usize::from(is_own || test == Test::Static);
            assert_eq!(m.evaluate_gyro(&gyro, &options).len(), both);
        }
        assert_eq!(temperature.evaluate_gyro(&gyro, &options)[0].channel, "g");
        assert_eq!(temperature.evaluate_temperature("c", &found)[0].channel, "c");
        let nothing = KnownInputEvidence { positions: &[], turns: None };
        let (setup, list) = (crate::rate_table::Setup::default(), crate::rate_table::steps::Steps::default());
        let table = TableEvidence::new(0, "g", &setup, &list);
        for (m, _) in tests {
            assert_eq!(m.by_known_input().is_some(), m.id == "k");
            assert_eq!(m.evaluate_known_input(&nothing).len(), usize::from(m.id == "k"));
            assert_eq!(m.by_steps().map(|s| s.stimulus), (m.id == "s").then_some(Stimulus::SmallRates));
            assert_eq!(m.evaluate_steps(&table).len(), usize::from(m.id == "s"));
        }
    }

    #[test]
    fn a_measurand_of_steps_may_have_extras_and_a_known_input() {
        let m = Measurand::of_steps("s", "ppm", "doc", Stimulus::Rates, |m, e| none(m, &e.channel))
            .extras(&[Extra::Approach])
            .or_known_input(INPUT);
        assert_eq!(m.by_steps().map(|s| s.extras), Some(&[Extra::Approach][..]));
        assert_eq!(m.by_known_input().map(|k| (k.positions, k.turns)), Some((true, Some(TurnAxis::Own))));
        // Neither means anything for another test.
        let rest = plain().extras(&[Extra::Approach]).or_known_input(INPUT);
        assert!(rest.by_steps().is_none() && rest.by_known_input().is_none());
    }

    #[test]
    fn rows_carry_id_and_unit_of_their_measurand() {
        let spread = Spread::Normal { standard_uncertainty: 0.1 };
        let row = plain().measured("c", 1.5, spread.clone(), "how");
        assert_eq!((row.id, row.channel.as_str(), row.value, row.unit), ("a", "c", Some(1.5), "deg/h"));
        assert_eq!((row.spread.clone(), row.method), (spread, "how"));
        let other = Measurand::at_rest("b", "s", "doc", |m, gyro, _| none(m, &gyro.channel));
        let named = other.named(&row);
        assert_eq!((named.id, named.unit, named.value, named.channel.as_str()), ("b", "s", Some(1.5), "c"));
        let limit = UpperLimit { value: 2.0, coverage: 0.95 };
        let none = plain().not_identifiable("c", Some(limit), "how");
        assert_eq!((none.id, none.value, none.upper_limit, none.unit), ("a", None, Some(limit), "deg/h"));
    }
}
