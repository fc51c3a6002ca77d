//! The tables of a procedure that ask for a series of switching off and on, and for comparisons without and with an
//! influence.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::{Range, Word};
use crate::config::table::Table;
use crate::i18n::note;
use crate::influence::{ComparisonTest, Influence, RepeatabilityTest, Stated, StatedLevel};
use crate::measurand::{Evaluation, Measurand};
use crate::recording::Role;

/// A stretch of the recording.
#[derive(Table)]
pub(crate) struct StretchKeys {
    /// Its phase in the manifest; all files of the phase belong to it.
    #[key(id, example = "on")]
    phase: Option<String>,
    /// Start, from the start of the recording.
    #[key(quantity = "s", min = 0, example = "10 min")]
    from_s: Option<f64>,
    /// End, from the start of the recording.
    #[key(quantity = "s", above = 0, example = "20 min")]
    to_s: Option<f64>,
}

impl From<StretchKeys> for Stated {
    fn from(keys: StretchKeys) -> Stated {
        let StretchKeys { phase, from_s, to_s } = keys;
        Stated { phase, from_s, to_s }
    }
}

/// A series of turn-ons. Without [[repeatability_test.run]], every file of a manifest is one run, and within
/// one file every stretch between pauses in the output.
#[derive(Table)]
#[table("repeatability_test")]
pub(crate) struct RepeatabilityKeys {
    /// Time after turn-on excluded from every run.
    #[key(quantity = "s", min = 0, default = "0 s", example = "5 min")]
    settling_s: f64,
    /// Minimum length of a run without its settling; shorter runs are not evaluated.
    #[key(quantity = "s", above = 0, default = "60 s", example = "10 min")]
    minimum_run_s: f64,
    /// Minimum pause in the output that separates two runs of one file.
    #[key(quantity = "s", above = 0, default = "60 s", example = "5 min")]
    off_s: f64,
    /// Minimum number of runs. With 6 runs the standard deviation is known to within 0.62 to 2.45 times its value.
    #[key(name = "runs", min = 2, max = 1000, default = 6, example = 6)]
    fewest_runs: usize,
    /// Channel of the unit's temperature. Default: the first.
    #[key(id, example = "temp")]
    temperature: Option<String>,
    /// The runs, if they are neither files nor separated by pauses.
    #[key(name = "run")]
    runs: Vec<RunKeys>,
}

/// One run, in the order of time.
#[derive(Table)]
#[table("repeatability_test.run")]
pub(crate) struct RunKeys {
    #[key(flatten)]
    stretch: StretchKeys,
}

impl From<RepeatabilityKeys> for RepeatabilityTest {
    fn from(keys: RepeatabilityKeys) -> RepeatabilityTest {
        RepeatabilityTest {
            settling_s: keys.settling_s,
            minimum_run_s: keys.minimum_run_s,
            off_s: keys.off_s,
            fewest: keys.fewest_runs,
            temperature: keys.temperature,
            runs: keys.runs.into_iter().map(|run| run.stretch.into()).collect(),
        }
    }
}

/// Keys of every comparison.
#[derive(Table)]
pub(crate) struct ComparisonKeys {
    /// Time excluded after a change of level.
    #[key(quantity = "s", min = 0, default = "5 s", example = "10 s")]
    settling_s: f64,
    /// Minimum length of an interval without its settling; shorter intervals are not evaluated.
    #[key(quantity = "s", above = 0, default = "30 s", example = "60 s")]
    minimum_interval_s: f64,
    /// Minimum number of intervals with the influence, each between two without. One removes a steady drift; a
    /// second shows whether the change is reproducible.
    #[key(min = 1, max = 1000, default = 2, example = 3)]
    alternations: usize,
    /// Standard uncertainty (k = 1) of the level.
    #[key(quantity = "1", min = 0, max = 1, default = "0 %", example = "2 %")]
    level_uncertainty: f64,
    /// Maximum temperature difference between any two levels, including the one without influence: the effect of a
    /// larger one on the bias could not be separated from the influence.
    #[key(difference = "degC", above = 0, default = "0.3 degC", example = "0.3 degC")]
    temperature_difference_deg_c: f64,
    /// Maximum temperature sensitivity of the bias, from a temperature test: the possible effect of a temperature
    /// correlated with the levels, within `temperature_difference`, is then part of the uncertainty.
    #[key(quantity = "deg/h/degC", min = 0, example = "0.003 deg/h/degC")]
    temperature_coefficient_deg_h_deg_c: Option<f64>,
    /// Channel of the unit's temperature. Default: the first.
    #[key(id, example = "temp")]
    temperature: Option<String>,
    /// If nothing in the recording shows that the influence was applied, the test is invalid unless this key
    /// declares it; report and verdict then say so.
    #[key(choice = ACCEPTED_EVIDENCE, example = "declared")]
    evidence: Option<&'static str>,
}

/// Evidence that a procedure may do with.
const ACCEPTED_EVIDENCE: &[Word] =
    &[("declared", "that the influence acted, and at which levels, is taken from the procedure")];

impl ComparisonKeys {
    fn test(self, influence: Influence, reference: f64, intervals: Vec<StatedLevel>) -> ComparisonTest {
        ComparisonTest {
            influence,
            reference,
            settling_s: self.settling_s,
            minimum_interval_s: self.minimum_interval_s,
            alternations: self.alternations,
            level_uncertainty: self.level_uncertainty,
            temperature_difference_deg_c: self.temperature_difference_deg_c,
            temperature_coefficient: self.temperature_coefficient_deg_h_deg_c,
            declared: self.evidence == Some("declared"),
            temperature: self.temperature,
            intervals,
        }
    }
}

/// The table of a comparison and that of its intervals, which differ by the unit of the level.
macro_rules! comparison_table {
    ($keys:ident, $interval:ident, $influence:expr, $name:literal, $interval_name:literal, $unit:literal,
     $reference:literal, $level:literal, $range:expr, $doc:literal) => {
        #[doc = $doc]
        #[derive(Table)]
        #[table($name)]
        pub(crate) struct $keys {
            /// Level that counts as zero influence.
            #[key(quantity = $unit, range = $range, default = $reference, example = $reference)]
            reference: f64,
            #[key(flatten)]
            common: ComparisonKeys,
            /// The intervals with and without the influence, instead of a channel with the level.
            #[key(name = "interval")]
            intervals: Vec<$interval>,
        }

        /// One interval at a level.
        #[derive(Table)]
        #[table($interval_name)]
        pub(crate) struct $interval {
            #[key(flatten)]
            stretch: StretchKeys,
            /// Level during the interval.
            #[key(quantity = $unit, range = $range, example = $level)]
            level: f64,
            /// Axis along which it acts, if several are tested.
            #[key(id, example = "x")]
            axis: Option<String>,
        }

        impl From<$interval> for StatedLevel {
            fn from(keys: $interval) -> StatedLevel {
                StatedLevel { stretch: keys.stretch.into(), level: keys.level, axis: keys.axis }
            }
        }

        impl From<$keys> for ComparisonTest {
            fn from(keys: $keys) -> ComparisonTest {
                let intervals = keys.intervals.into_iter().map(StatedLevel::from).collect();
                keys.common.test($influence, keys.reference, intervals)
            }
        }
    };
}

comparison_table!(
    MagneticKeys,
    MagneticIntervalKeys,
    Influence::MagneticField,
    "magnetic_test",
    "magnetic_test.interval",
    "mT",
    "0 mT",
    "0.5 mT",
    Range::ANY,
    "A comparison without and with a magnetic field. The level is read from the channels with the role \
     `magnetic_field`, one per axis, or stated in [[magnetic_test.interval]]."
);
comparison_table!(
    SupplyKeys,
    SupplyIntervalKeys,
    Influence::Supply,
    "supply_test",
    "supply_test.interval",
    "V",
    "5 V",
    "5.25 V",
    Range::ANY,
    "A comparison at several supply voltages. The level is read from the channel with the role `supply`, or \
     stated in [[supply_test.interval]]."
);
comparison_table!(
    VibrationKeys,
    VibrationIntervalKeys,
    Influence::Vibration,
    "vibration_test",
    "vibration_test.interval",
    "g",
    "0 g",
    "2 g",
    Range::NOT_NEGATIVE,
    "A comparison without and with vibration: the rectified bias, proportional to the square of the rms \
     level, and the change of N. The level is read from the channels with the role `vibration`, one per axis, \
     or stated in [[vibration_test.interval]]."
);

/// The tables of which a measurand needs one, the likeliest first; `None` for one of other tests.
fn tables_of(measurand: &Measurand) -> Option<Vec<&'static str>> {
    match measurand.evaluation {
        Evaluation::Repeatability(_) => Some(vec![RepeatabilityKeys::SPEC.name]),
        Evaluation::Comparison { influence: Some(influence), .. } => Some(vec![influence.table()]),
        Evaluation::Comparison { influence: None, .. } => {
            Some(vec![VibrationKeys::SPEC.name, MagneticKeys::SPEC.name, SupplyKeys::SPEC.name])
        }
        _ => None,
    }
}

/// What such tests and their measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let tests = [
        RepeatabilityKeys::SPEC.name,
        MagneticKeys::SPEC.name,
        SupplyKeys::SPEC.name,
        VibrationKeys::SPEC.name,
    ];
    let others = ["rate_table", "temperature_test", "warm_up_test"];
    let asked: Vec<&str> = tests.into_iter().chain(others).filter(|t| root.table(t).is_some()).collect();
    let own = tests.iter().find(|t| root.table(t).is_some());
    if let (Some(own), [first, second, ..]) = (own, asked.as_slice()) {
        let other = if first == own { second } else { first };
        let message = note!("influence_check.two_tests", first = *own, second = *other);
        let at = root.table(own).map_or(0..0, |s| s.span.clone());
        reader.error(&at, message, Some("influence_check.help.two_tests".into()));
    }
    for section in root.tables("measurand") {
        let Some(measurand) = section.measurand("id") else { continue };
        let at = section.span_of("id");
        if let Some(tables) = tables_of(measurand) {
            if let Some(likeliest) = tables.first()
                && tables.iter().all(|t| root.table(t).is_none())
            {
                let message = note!("influence_check.no_table", id = measurand.id, table = *likeliest);
                reader.error(&at, message, None);
            }
        } else if own.is_some() && measurand.test().is_at_rest() && !measurand.from_site {
            let message = note!("influence_check.static", id = measurand.id);
            reader.error(&at, message, None);
        }
    }
    for name in tests {
        let Some(section) = root.table(name) else { continue };
        if let Some(id) = section.text("temperature")
            && procedure.channel(&id).is_none_or(|c| c.channel.role != Role::Temperature)
        {
            let message = note!("rate_table_check.no_temperature", id);
            reader.error(&section.span_of("temperature"), message, None);
        }
        for part in ["run", "interval"].iter().flat_map(|list| section.tables(list)) {
            let (from, to) = (part.number("from"), part.number("to"));
            if let (Some(from), Some(to)) = (from, to)
                && to <= from
            {
                reader.error(&part.span_of("to"), "check.to_before_from", None);
            }
            if part.text("phase").is_none() && from.is_none() && to.is_none() {
                reader.error(&part.span.clone(), "influence_check.no_place", None);
            }
        }
    }
    if let Some(test) = &procedure.comparison_test {
        let told = procedure.channels.iter().any(|c| c.channel.role == test.influence.role());
        if !told && test.intervals.is_empty() {
            let at = root.table(test.influence.table()).map_or(0..0, |s| s.span.clone());
            let message = note!("influence_check.no_level", role = test.influence.id());
            let help = note!("influence_check.help.no_level", table = test.influence.table());
            reader.error(&at, message, Some(help));
        }
    }
}
