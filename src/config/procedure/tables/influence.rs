//! The tables of a procedure that ask for a series of switching off and on, and for comparisons without and with an
//! influence.

use crate::config::diagnostics::Span;
use crate::config::procedure::model::{ChannelSpec, Procedure};
use crate::config::quantity;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::{Range, Word};
use crate::config::table::Table;
use crate::i18n::{Arg, note};
use crate::influence::setup::LEVEL_UNITS;
use crate::influence::{
    ComparisonTest, Influence, Law, LevelUnit, RepeatabilityTest, Setting, Stated, StatedLevel, ToldBy,
};
use crate::measurand::{Evaluation, Measurand, PerLevel, SCALE_FACTOR_SHIFT};
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
    fn test(self, setting: Setting, reference: f64, intervals: Vec<StatedLevel>) -> ComparisonTest {
        ComparisonTest {
            setting,
            reference,
            settling_s: self.settling_s,
            rate_settling_s: 0.0,
            minimum_interval_s: self.minimum_interval_s,
            alternations: self.alternations,
            level_uncertainty: self.level_uncertainty,
            temperature_difference_deg_c: self.temperature_difference_deg_c,
            temperature_coefficient: self.temperature_coefficient_deg_h_deg_c,
            declared: self.evidence == Some("declared"),
            temperature: self.temperature,
            intervals,
            by_frequency: None,
        }
    }
}

/// The table of a comparison and that of its intervals, which differ by the unit of the level.
macro_rules! comparison_table {
    ($keys:ident, $interval:ident, $setting:expr, $name:literal, $interval_name:literal, $unit:literal,
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
                keys.common.test($setting, keys.reference, intervals)
            }
        }
    };
}

comparison_table!(
    MagneticKeys,
    MagneticIntervalKeys,
    Setting::magnetic_field(),
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
    Setting::supply(),
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
    Setting::vibration(),
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

/// A comparison without and with any influence: pressure, humidity, acceleration, radiation, a field that is switched on. The
/// level is read from one channel, in the unit of its role or, with the role `auxiliary`, in its own; or it is stated in
/// [[influence_test.interval]].
#[derive(Table)]
#[table("influence_test")]
pub(crate) struct InfluenceKeys {
    /// Channel that tells the level. Without it the intervals are stated.
    #[key(id, example = "baro")]
    channel: Option<String>,
    /// Name of the influence in rows: `rate@NAME`. Default: the channel.
    #[key(id, example = "emi")]
    name: Option<String>,
    /// Unit of the level where no channel tells it: `kPa`, `%`, `g`, `V`, `A`, `mT`, `V/m`, `W/m^2`, `Gy` or `deg/s^2`. Without
    /// one, levels are numbers: 0 without and 1 with the influence.
    #[key(example = "kPa")]
    unit: Option<String>,
    /// How the output follows the level.
    #[key(choice = LAWS, example = "linear")]
    law: &'static str,
    /// What follows the level. For the scale factor, every interval holds two or more rates of a table (role `table_rate`).
    #[key(choice = ACTS_ON, default = "bias", example = "bias")]
    acts_on: &'static str,
    /// Level that counts as zero influence, in the unit of the level.
    #[key(default = "0", example = "101.3 kPa")]
    reference: String,
    /// Time excluded after a change of the rate of the table.
    #[key(quantity = "s", min = 0, default = "1 s", example = "2 s")]
    rate_settling_s: f64,
    #[key(flatten)]
    common: ComparisonKeys,
    /// The intervals with and without the influence, instead of a channel with the level.
    #[key(name = "interval")]
    intervals: Vec<InfluenceIntervalKeys>,
    #[key(section)]
    section: Section,
}

/// One interval at a level.
#[derive(Table)]
#[table("influence_test.interval")]
pub(crate) struct InfluenceIntervalKeys {
    #[key(flatten)]
    stretch: StretchKeys,
    /// Level during the interval, in the unit of the level.
    #[key(example = "150 kPa")]
    level: String,
    /// Axis along which it acts, if several are tested.
    #[key(id, example = "x")]
    axis: Option<String>,
    #[key(section)]
    section: Section,
}

/// Laws that an output may follow a level by.
const LAWS: &[Word] = &[
    ("linear", "in proportion to the level"),
    ("quadratic", "in proportion to the square of the level"),
    ("linear_quadratic", "a parabola about the reference, from two or more levels beside it"),
    ("on_off", "a change of its own at every level"),
];

/// What may follow a level.
const ACTS_ON: &[Word] =
    &[("bias", "the bias"), ("bias_and_scale_factor", "the bias and the scale factor, apart")];

/// Reads a level in its unit; a wrong one is reported and counts as zero.
fn level(text: &str, unit: Option<&'static LevelUnit>, at: &Span, reader: &mut Reader<'_>) -> f64 {
    let unit = unit.map_or("1", |u| u.id);
    // Zero is zero in every unit.
    if text.trim() == "0" {
        return 0.0;
    }
    match quantity::parse(text, unit, true, unit == "1") {
        Ok(number) => number,
        Err(wrong) => {
            let help = note!("influence_check.help.level", unit = Arg::key("unit", unit));
            reader.error(at, wrong.message, Some(wrong.help.unwrap_or(help)));
            0.0
        }
    }
}

impl InfluenceKeys {
    /// Unit of the level: that of its channel, or the one stated. `None` where levels are numbers.
    fn unit(&self, channels: &[ChannelSpec], reader: &mut Reader<'_>) -> Option<&'static LevelUnit> {
        let told = self.channel.as_ref().and_then(|id| channels.iter().find(|c| c.channel.id == *id));
        let known = || LEVEL_UNITS.iter().map(|u| u.id).collect::<Vec<_>>().join(", ");
        if let (Some(_), Some(_)) = (&self.channel, &self.unit) {
            reader.error(&self.section.span_of("unit"), "influence_check.unit_of_channel", None);
        }
        let (given, key) = match (told, &self.unit) {
            (Some(c), _) => (c.channel.role.internal_unit().unwrap_or(c.channel.unit.text()), "channel"),
            (None, Some(unit)) => (unit.as_str(), "unit"),
            (None, None) => return None,
        };
        let found = LevelUnit::of(given);
        if found.is_none() && given != "1" {
            let message = note!("influence_check.unit", given);
            let help = note!("influence_check.help.unit", known = known());
            reader.error(&self.section.span_of(key), message, Some(help));
        }
        found
    }

    /// The test, with the unit of the channel that tells the level.
    pub(crate) fn test(self, channels: &[ChannelSpec], reader: &mut Reader<'_>) -> ComparisonTest {
        let unit = self.unit(channels, reader);
        let law = Law::ALL.into_iter().find(|law| law.id() == self.law);
        let setting = Setting {
            influence: Influence::Declared,
            told_by: self.channel.clone().map_or(ToldBy::Nothing, ToldBy::Channel),
            unit,
            law: law.unwrap_or(Law::Linear),
            name: self.name.or(self.channel).unwrap_or_default(),
            on_scale_factor: self.acts_on != "bias",
        };
        let reference = level(&self.reference, unit, &self.section.span_of("reference"), reader);
        let mut read = |keys: InfluenceIntervalKeys| StatedLevel {
            level: level(&keys.level, unit, &keys.section.span_of("level"), reader),
            stretch: keys.stretch.into(),
            axis: keys.axis,
        };
        let intervals = self.intervals.into_iter().map(&mut read).collect();
        let rate_settling_s = self.rate_settling_s;
        ComparisonTest { rate_settling_s, ..self.common.test(setting, reference, intervals) }
    }
}

/// What a declared influence and its measurands need.
fn validate_declared(test: &ComparisonTest, procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let Some(section) = root.table(InfluenceKeys::SPEC.name) else { return };
    let (setting, at) = (&test.setting, section.span.clone());
    if let ToldBy::Channel(id) = &setting.told_by {
        let role = procedure.channel(id).map(|c| c.channel.role);
        let is_level = |role: Role| {
            let level = [Role::Supply, Role::MagneticField, Role::Vibration, Role::Pressure, Role::Humidity];
            let axes = [Role::AccelerationX, Role::AccelerationY, Role::AccelerationZ];
            let plain = [Role::Current, Role::Status, Role::Auxiliary];
            level.contains(&role) || axes.contains(&role) || plain.contains(&role)
        };
        if !role.is_some_and(is_level) {
            let message = note!("influence_check.no_channel", id = id.as_str());
            reader.error(&section.span_of("channel"), message, None);
        }
    } else if setting.name.is_empty() {
        reader.error(&at, "influence_check.no_name", None);
    } else if test.intervals.is_empty() {
        reader.error(&at, "influence_check.no_level", Some("influence_check.help.no_channel".into()));
    }
    if setting.unit.is_none() && setting.law != Law::OnOff {
        reader.error(&section.span_of("law"), "influence_check.no_unit", None);
    }
    let turned = procedure.channels.iter().any(|c| c.channel.role == Role::TableRate);
    if setting.on_scale_factor && !turned {
        reader.error(&section.span_of("acts_on"), "influence_check.no_table_rate", None);
    }
    for asked in root.tables("measurand") {
        let Some(measurand) = asked.measurand("id") else { continue };
        let at = asked.span_of("id");
        let per = PerLevel::of(measurand);
        let on_scale_factor = per.is_some_and(|p| p.on_scale_factor) || *measurand == SCALE_FACTOR_SHIFT;
        if on_scale_factor && !setting.on_scale_factor {
            let message = note!("influence_check.bias_only", id = measurand.id);
            reader.error(&at, message, Some("influence_check.help.bias_only".into()));
        } else if per.is_some_and(|p| !setting.law.degrees().contains(&p.degree)) {
            let message = note!("influence_check.other_law", id = measurand.id);
            reader.error(&at, message, Some("influence_check.help.other_law".into()));
        }
    }
}

/// The tables of which a measurand needs one, the likeliest first; `None` for one of other tests.
fn tables_of(measurand: &Measurand) -> Option<Vec<&'static str>> {
    match measurand.evaluation {
        Evaluation::Repeatability(_) => Some(vec![RepeatabilityKeys::SPEC.name]),
        Evaluation::Comparison { influence: Some(influence), .. } => Some(vec![influence.table()]),
        Evaluation::Comparison { influence: None, .. } => {
            let own = [VibrationKeys::SPEC.name, MagneticKeys::SPEC.name, SupplyKeys::SPEC.name];
            Some([&own[..], &[InfluenceKeys::SPEC.name]].concat())
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
        InfluenceKeys::SPEC.name,
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
    let Some(test) = &procedure.comparison_test else { return };
    let ToldBy::Role(role) = test.setting.told_by else {
        return validate_declared(test, procedure, root, reader);
    };
    let told = procedure.channels.iter().any(|c| c.channel.role == role);
    if !told && test.intervals.is_empty() {
        let table = test.setting.influence.table();
        let at = root.table(table).map_or(0..0, |s| s.span.clone());
        let message = note!("influence_check.no_level", role = role.id());
        let help = note!("influence_check.help.no_level", table);
        reader.error(&at, message, Some(help));
    }
}
