//! The tables of a procedure that ask for a series of switching off and on, and for comparisons without and with an
//! influence.

use crate::config::procedure::model::Procedure;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::spec::{
    KeySpec, Kind, Range, TableSpec, Word, difference, optional, quantity, required, with_default,
};
use crate::i18n::Note;
use crate::influence::{ComparisonTest, Influence, RepeatabilityTest, Stated, StatedLevel};
use crate::measurand::{Evaluation, Measurand, Test};
use crate::recording::Role;

const PHASE: KeySpec =
    optional("phase", Kind::Id, "\"on\"", "Its phase in the manifest; all files of the phase belong to it.");
const FROM: KeySpec = optional(
    "from",
    quantity("s", Range::NOT_NEGATIVE),
    "\"10 min\"",
    "Start, from the start of the recording.",
);
const TO: KeySpec =
    optional("to", quantity("s", Range::POSITIVE), "\"20 min\"", "End, from the start of the recording.");
const TEMPERATURE: KeySpec =
    optional("temperature", Kind::Id, "\"temp\"", "Channel of the unit's temperature. Default: the first.");
const AXIS: KeySpec = optional("axis", Kind::Id, "\"x\"", "Axis along which it acts, if several are tested.");

pub(crate) static REPEATABILITY_TEST: TableSpec = TableSpec {
    name: "repeatability_test",
    doc: "A series of turn-ons. Without [[repeatability_test.run]], every file of a manifest is one run, and \
          within one file every stretch between pauses in the output.",
    keys: &[
        with_default(
            "settling",
            quantity("s", Range::NOT_NEGATIVE),
            "\"0 s\"",
            "\"5 min\"",
            "Time after turn-on excluded from every run.",
        ),
        with_default(
            "minimum_run",
            quantity("s", Range::POSITIVE),
            "\"60 s\"",
            "\"10 min\"",
            "Minimum length of a run without its settling; shorter runs are not evaluated.",
        ),
        with_default(
            "off",
            quantity("s", Range::POSITIVE),
            "\"60 s\"",
            "\"5 min\"",
            "Minimum pause in the output that separates two runs of one file.",
        ),
        with_default(
            "runs",
            Kind::Number(Range::between(2.0, 1000.0)),
            "6",
            "6",
            "Minimum number of runs. With 6 runs the standard deviation is known to within 0.62 to 2.45 \
             times its value.",
        ),
        TEMPERATURE,
        optional(
            "run",
            Kind::Tables(&RUN),
            "",
            "The runs, if they are neither files nor separated by pauses.",
        ),
    ],
};

static RUN: TableSpec = TableSpec {
    name: "repeatability_test.run",
    doc: "One run, in the order of time.",
    keys: &[PHASE, FROM, TO],
};

const SETTLING: KeySpec = with_default(
    "settling",
    quantity("s", Range::NOT_NEGATIVE),
    "\"5 s\"",
    "\"10 s\"",
    "Time excluded after a change of level.",
);
const MINIMUM: KeySpec = with_default(
    "minimum_interval",
    quantity("s", Range::POSITIVE),
    "\"30 s\"",
    "\"60 s\"",
    "Minimum length of an interval without its settling; shorter intervals are not evaluated.",
);
const ALTERNATIONS: KeySpec = with_default(
    "alternations",
    Kind::Number(Range::between(1.0, 1000.0)),
    "2",
    "3",
    "Minimum number of intervals with the influence, each between two without. One removes a steady drift; a \
     second shows whether the change is reproducible.",
);
const LEVEL_UNCERTAINTY: KeySpec = with_default(
    "level_uncertainty",
    quantity("1", Range::between(0.0, 1.0)),
    "\"0 %\"",
    "\"2 %\"",
    "Standard uncertainty (k = 1) of the level.",
);
const TEMPERATURE_DIFFERENCE: KeySpec = with_default(
    "temperature_difference",
    difference("degC", Range::POSITIVE),
    "\"0.3 degC\"",
    "\"0.3 degC\"",
    "Maximum temperature difference between any two levels, including the one without influence: the effect \
     of a larger one on the bias could not be separated from the influence.",
);
const TEMPERATURE_COEFFICIENT: KeySpec = optional(
    "temperature_coefficient",
    quantity("deg/h/degC", Range::NOT_NEGATIVE),
    "\"0.003 deg/h/degC\"",
    "Maximum temperature sensitivity of the bias, from a temperature test: the possible effect of a \
     temperature correlated with the levels, within `temperature_difference`, is then part of the \
     uncertainty.",
);
const EVIDENCE: KeySpec = optional(
    "evidence",
    Kind::Choice(EVIDENCES),
    "\"declared\"",
    "If nothing in the recording shows that the influence was applied, the test is invalid unless this key \
     declares it; report and verdict then say so.",
);

/// Evidence that a procedure may do with.
const EVIDENCES: &[Word] =
    &[("declared", "that the influence acted, and at which levels, is taken from the procedure")];

macro_rules! comparison_table {
    ($table:ident, $interval:ident, $name:literal, $interval_name:literal, $unit:literal, $reference:literal,
     $level:literal, $range:expr, $doc:literal) => {
        pub(crate) static $table: TableSpec = TableSpec {
            name: $name,
            doc: $doc,
            keys: &[
                with_default(
                    "reference",
                    quantity($unit, $range),
                    $reference,
                    $reference,
                    "Level that counts as zero influence.",
                ),
                SETTLING,
                MINIMUM,
                ALTERNATIONS,
                LEVEL_UNCERTAINTY,
                TEMPERATURE_DIFFERENCE,
                TEMPERATURE_COEFFICIENT,
                TEMPERATURE,
                EVIDENCE,
                optional(
                    "interval",
                    Kind::Tables(&$interval),
                    "",
                    "The intervals with and without the influence, instead of a channel with the level.",
                ),
            ],
        };
        static $interval: TableSpec = TableSpec {
            name: $interval_name,
            doc: "One interval at a level.",
            keys: &[
                PHASE,
                FROM,
                TO,
                required("level", quantity($unit, $range), $level, "Level during the interval."),
                AXIS,
            ],
        };
    };
}

comparison_table!(
    MAGNETIC_TEST,
    MAGNETIC_INTERVAL,
    "magnetic_test",
    "magnetic_test.interval",
    "mT",
    "\"0 mT\"",
    "\"0.5 mT\"",
    Range::ANY,
    "A comparison without and with a magnetic field. The level is read from the channels with the role \
     `magnetic_field`, one per axis, or stated in [[magnetic_test.interval]]."
);
comparison_table!(
    SUPPLY_TEST,
    SUPPLY_INTERVAL,
    "supply_test",
    "supply_test.interval",
    "V",
    "\"5 V\"",
    "\"5.25 V\"",
    Range::ANY,
    "A comparison at several supply voltages. The level is read from the channel with the role `supply`, or stated in \
     [[supply_test.interval]]."
);
comparison_table!(
    VIBRATION_TEST,
    VIBRATION_INTERVAL,
    "vibration_test",
    "vibration_test.interval",
    "g",
    "\"0 g\"",
    "\"2 g\"",
    Range::NOT_NEGATIVE,
    "A comparison without and with vibration: the rectified bias, proportional to the square of the rms \
     level, and the change of N. The level is read from the channels with the role `vibration`, one per \
     axis, or stated in [[vibration_test.interval]]."
);

fn stretch(s: &Section) -> Stated {
    Stated { phase: s.text("phase"), from_s: s.number("from"), to_s: s.number("to") }
}

/// The series of switching off and on that a table declares.
pub(crate) fn repeatability(section: &Section) -> RepeatabilityTest {
    let number = |key| section.number(key);
    RepeatabilityTest {
        settling_s: number("settling").unwrap_or(0.0),
        minimum_run_s: number("minimum_run").unwrap_or(60.0),
        off_s: number("off").unwrap_or(60.0),
        fewest: number("runs").unwrap_or(6.0) as usize,
        temperature: section.text("temperature"),
        runs: section.tables("run").iter().map(stretch).collect(),
    }
}

/// The comparison that a procedure declares.
pub(crate) fn comparison(root: &Section) -> Option<ComparisonTest> {
    let (influence, section) = Influence::ALL.into_iter().find_map(|i| Some((i, root.table(i.table())?)))?;
    let number = |key| section.number(key);
    let usual = if influence == Influence::Supply { 5.0 } else { 0.0 };
    Some(ComparisonTest {
        influence,
        reference: number("reference").unwrap_or(usual),
        settling_s: number("settling").unwrap_or(5.0),
        minimum_interval_s: number("minimum_interval").unwrap_or(30.0),
        alternations: number("alternations").unwrap_or(2.0) as usize,
        level_uncertainty: number("level_uncertainty").unwrap_or(0.0),
        temperature_difference_deg_c: number("temperature_difference").unwrap_or(0.3),
        temperature_coefficient: number("temperature_coefficient"),
        declared: section.word("evidence") == Some("declared"),
        temperature: section.text("temperature"),
        intervals: section
            .tables("interval")
            .iter()
            .map(|s| StatedLevel {
                stretch: stretch(s),
                level: s.number("level").unwrap_or(0.0),
                axis: s.text("axis"),
            })
            .collect(),
    })
}

/// The tables of which a measurand needs one, the likeliest first; `None` for one of other tests.
fn tables_of(measurand: &Measurand) -> Option<Vec<&'static str>> {
    match measurand.evaluation {
        Evaluation::Repeatability(_) => Some(vec![REPEATABILITY_TEST.name]),
        Evaluation::Comparison { influence: Some(influence), .. } => Some(vec![influence.table()]),
        Evaluation::Comparison { influence: None, .. } => {
            Some(vec![VIBRATION_TEST.name, MAGNETIC_TEST.name, SUPPLY_TEST.name])
        }
        _ => None,
    }
}

/// What such tests and their measurands need of each other.
pub(crate) fn validate(procedure: &Procedure, root: &Section, reader: &mut Reader<'_>) {
    let tests = [REPEATABILITY_TEST.name, MAGNETIC_TEST.name, SUPPLY_TEST.name, VIBRATION_TEST.name];
    let others = ["rate_table", "temperature_test", "warm_up_test"];
    let asked: Vec<&str> = tests.into_iter().chain(others).filter(|t| root.table(t).is_some()).collect();
    let own = tests.iter().find(|t| root.table(t).is_some());
    if let (Some(own), [first, second, ..]) = (own, asked.as_slice()) {
        let other = if first == own { second } else { first };
        let message = Note::new("influence_check.two_tests").with("first", *own).with("second", *other);
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
                let message =
                    Note::new("influence_check.no_table").with("id", measurand.id).with("table", *likeliest);
                reader.error(&at, message, None);
            }
        } else if own.is_some() && measurand.test() == Test::Static && !measurand.from_site {
            let message = Note::new("influence_check.static").with("id", measurand.id);
            reader.error(&at, message, None);
        }
    }
    for name in tests {
        let Some(section) = root.table(name) else { continue };
        if let Some(id) = section.text("temperature")
            && procedure.channel(&id).is_none_or(|c| c.channel.role != Role::Temperature)
        {
            let message = Note::new("rate_table_check.no_temperature").with("id", id);
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
            let message = Note::new("influence_check.no_level").with("role", test.influence.id());
            let help = Note::new("influence_check.help.no_level").with("table", test.influence.table());
            reader.error(&at, message, Some(help));
        }
    }
}
