//! Two results of one unit: how often E_n calls them different where nothing differs, and where the unit changed.

use crate::bench::noise_source::{NoiseSource, add};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::acceptance::compare::laboratories::{Evaluated, Given, Laboratories, PairedRow};
use sagnac::estimate::{Component, InputQuantity, Interval};
use sagnac::record::{InstrumentRecord, MeasurandRecord, RunRecord};
use sagnac::{Procedure, Recording, UnitUnderTest};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// E_n of two results.
pub static STUDY: Study = Study {
    id: "two-laboratories",
    title: "Two laboratories, one unit",
    method: "Whole tests: a unit at rest is recorded twice for 10.6 h, with angle random walk of 0.002 deg/√h, flicker and a random walk \
             drawn anew, and both recordings are evaluated by `static-bias` and compared. Where nothing differs, E_n beyond ±1 is asked \
             in at most 5 % of the pairs, for every row that has an interval; a changed bias or angle random walk shows how \
             large a change is found. Drawn results: values are the sum of an error of a table and of readings, each normal; the two results \
             share the table, or do not. The generators share no formula with the comparison.",
    records: 200,
    cases,
};

/// What a unit is.
#[derive(Debug, Clone, Copy)]
struct Unit {
    bias_deg_h: f64,
    n: f64,
    b: f64,
    k: f64,
}

/// A unit that shows nothing but white noise over ten hours, and one with slow noise.
const WHITE: Unit = Unit { bias_deg_h: 0.05, n: 0.002, b: 0.0, k: 0.0 };
const SLOW: Unit = Unit { bias_deg_h: 0.05, n: 0.002, b: 0.004, k: 0.002 };
/// Earth rate on the axis at the site of the shipped procedure, deg/h.
const EARTH_DEG_H: f64 = 12.467;
/// Samples of a recording, one a second.
const SAMPLES: usize = 38_160;
/// Serial number of the unit.
const SERIAL: &str = "SN-1";

fn procedure() -> Option<Procedure> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../procedures/static-bias.toml");
    Procedure::load(path).ok()
}

impl Unit {
    /// The result of a recording of the unit.
    fn tested(self, procedure: &Procedure, seed: u64) -> Option<RunRecord> {
        let mut source = NoiseSource::new(seed);
        let mut rate = source.white(self.n, 1.0, SAMPLES);
        if self.b > 0.0 {
            add(&mut rate, &source.flicker(self.b, 1.0, SAMPLES));
        }
        if self.k > 0.0 {
            add(&mut rate, &source.walk(self.k, 1.0, SAMPLES));
        }
        rate.iter_mut().for_each(|r| *r += EARTH_DEG_H + self.bias_deg_h);
        let time = (0..SAMPLES).map(|i| i as f64).collect();
        let temperature = (0..SAMPLES).map(|_| 20.0 + 0.01 * source.normal()).collect();
        let columns = [("time_s", time), ("rate_deg_h", rate), ("temp_degC", temperature)];
        let recording = Recording::from_columns(columns).ok()?;
        let result = procedure.run(&recording, &UnitUnderTest::with_serial(SERIAL)).ok()?;
        Some(result.record().clone())
    }
}

/// The rows of two results, compared.
fn compared(first: &RunRecord, second: &RunRecord) -> Vec<PairedRow> {
    let given = |name, record| Given { name, path: name, record, site: None };
    let pair = [given("maker", first), given("customer", second)];
    Laboratories::of(pair, Evaluated::default()).map_or_else(Vec::new, |l| l.rows)
}

/// For each quantity: pairs with |E_n| above 1, and pairs in all.
type Counts = BTreeMap<String, (u64, u64)>;

/// Pairs of tests of two states of a unit.
pub fn tests(unit: &str, second_bias_deg_h: f64, second_n_factor: f64, pairs: u64, first: u64) -> Counts {
    let unit = if unit == "white" { WHITE } else { SLOW };
    let changed =
        Unit { bias_deg_h: unit.bias_deg_h + second_bias_deg_h, n: unit.n * second_n_factor, ..unit };
    let Some(procedure) = procedure() else { return Counts::new() };
    let rows = (first..first + pairs).into_par_iter().flat_map_iter(|pair| {
        let a = unit.tested(&procedure, 2 * pair);
        let b = changed.tested(&procedure, 2 * pair + 1);
        a.zip(b).map_or_else(Vec::new, |(a, b)| compared(&a, &b))
    });
    count(rows.collect())
}

fn count(rows: Vec<PairedRow>) -> Counts {
    let mut counts = Counts::new();
    for row in rows {
        if let Some(score) = row.score {
            let (hits, of) = counts.entry(row.first.id).or_default();
            *hits += u64::from(!score.agrees());
            *of += 1;
        }
    }
    counts
}

/// Standard uncertainties of drawn results: of the table, and of the readings.
const TABLE: f64 = 1.0;
const READINGS: f64 = 0.5;

/// Pairs of drawn results whose table is the same one, or another; `change` in expanded uncertainties of the difference that is
/// there without a common table.
pub fn drawn(one_table: bool, change: f64, pairs: u64, first: u64) -> (u64, u64) {
    let rows: Vec<PairedRow> = (first..first + pairs)
        .flat_map(|seed| {
            let mut source = NoiseSource::new(seed);
            let table = TABLE * source.normal();
            let other = if one_table { table } else { TABLE * source.normal() };
            let shift = change * 1.96 * 2f64.sqrt() * READINGS;
            let a = result("T-1", table + READINGS * source.normal());
            let b = result(if one_table { "T-1" } else { "T-2" }, other + shift + READINGS * source.normal());
            compared(&a, &b)
        })
        .collect();
    count(rows).into_values().next().unwrap_or_default()
}

fn result(table: &str, value: f64) -> RunRecord {
    let half = 1.96 * TABLE.hypot(READINGS);
    let row = MeasurandRecord {
        id: "scale_factor_error".into(),
        channel: "rate".into(),
        value: Some(value),
        unit: "ppm".into(),
        interval: Some(Interval { low: value - half, high: value + half, coverage: 0.95 }),
        budget: vec![
            Component::of(InputQuantity::TableRate, TABLE, "ppm", 1.0),
            Component::of(InputQuantity::Readings, READINGS, "ppm", 1.0),
        ],
        ..MeasurandRecord::default()
    };
    let instrument = |name: &str, serial: &str, component| InstrumentRecord {
        name: name.into(),
        serial: Some(serial.to_owned()),
        certificate: None,
        calibrated: None,
        component,
        calibration_due: None,
        status: sagnac::record::ConditionStatus::Ok,
    };
    // The second instrument differs, so that only the table can be what is common.
    let beside = format!("{value}");
    RunRecord {
        unit_under_test: UnitUnderTest::with_serial(SERIAL),
        measurands: vec![row],
        instruments: vec![
            instrument("table", table, Some(InputQuantity::TableRate)),
            instrument("chamber", &beside, None),
        ],
        ..RunRecord::default()
    }
}

/// The most of what may be called different by chance.
const CHANCE: f64 = 0.05;
/// Changes of the bias, deg/h, and of angle random walk as a factor.
const BIAS_CHANGES: [f64; 3] = [0.01, 0.02, 0.04];
const N_CHANGES: [f64; 2] = [1.02, 1.05];

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for unit in ["white", "slow"] {
        cases.push(Case::new(format!("whole tests, {unit} noise, nothing differs"), move |records, seed| {
            let found = tests(unit, 0.0, 1.0, records, 900_000 * seed);
            let row = |(id, (hits, of)): (String, (u64, u64))| {
                Row::share(id, "E_n beyond ±1 where nothing differs", Asked::AtMost(CHANCE), hits, of)
            };
            found.into_iter().map(row).collect()
        }));
    }
    cases.push(Case::new("whole tests, white noise, a changed unit", |records, seed| {
        let one = |id: &str, claim: String, counts: &Counts| {
            let (hits, of) = counts.get(id).copied().unwrap_or_default();
            Row::share(id, claim, Asked::Nothing, hits, of)
        };
        let bias = BIAS_CHANGES.map(|change| {
            let found = tests("white", change, 1.0, records, 950_000 * seed);
            one("static_bias", format!("a change of {change} deg/h is found"), &found)
        });
        let n = N_CHANGES.map(|factor| {
            let found = tests("white", 0.0, factor, records, 950_000 * seed);
            one("angle_random_walk", format!("a change by a factor of {factor} is found"), &found)
        });
        bias.into_iter().chain(n).collect()
    }));
    for (one_table, name) in [(true, "one table"), (false, "two tables")] {
        cases.push(Case::new(format!("drawn results, {name}"), move |records, seed| {
            let pairs = 20 * records;
            let share = |claim: &str, asked, change| {
                let (hits, of) = drawn(one_table, change, pairs, 970_000 * seed);
                Row::share("scale_factor_error", claim, asked, hits, of)
            };
            // Of normal errors, a change by r expanded uncertainties is found with probability 1 − Φ(1.96 (1 − r)).
            let found = |low, high| if one_table { Asked::Between(low, high) } else { Asked::Nothing };
            vec![
                share("E_n beyond ±1 where nothing differs", Asked::Between(0.04, 0.06), 0.0),
                share(
                    "a change by the expanded uncertainty without the table is found",
                    found(0.48, 0.53),
                    1.0,
                ),
                share("a change by twice that is found", found(0.96, 0.985), 2.0),
            ]
        }));
    }
    cases
}
