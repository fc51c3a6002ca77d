//! Units without Shupe effect, lag or hysteresis, and effects over a narrow range: what lag and rate of temperature leave
//! open.

use super::evaluation::{found, over_temperature, unit};
use crate::bench::chamber::{Leg, Unit, programme, record};
use crate::bench::chance::{Chance, Noise};
use crate::coverage::Coverage;
use crate::study::{Asked, Case, Row};
use rayon::prelude::*;
use sagnac::estimate::Estimate;
use std::collections::BTreeMap;
use std::ops::Range;

const IDS: [&str; 4] = [
    "bias_temperature_rate_sensitivity",
    "thermal_lag",
    "thermal_hysteresis",
    "bias_temperature_sensitivity",
];

/// A unit with nothing but a static curve over temperature, or a line.
pub fn plain(chance: &mut Chance, curved: bool) -> Unit {
    let sign = if chance.uniform() < 0.5 { -1.0 } else { 1.0 };
    let bend = f64::from(u8::from(curved));
    Unit {
        a: [
            sign * chance.between(2e-4, 2e-3),
            bend * sign * chance.between(2e-6, 2e-5),
            bend * chance.between(0.0, 1.5e-7),
        ],
        shupe: 0.0,
        lag_s: 0.0,
        hysteresis: (0.0, 0.0),
        noise: Noise {
            n: chance.between(0.001, 0.003),
            b: chance.between(0.0, 0.003),
            k: chance.between(0.0, 0.002),
        },
        level: 12.4,
    }
}

/// Several cycles between two temperatures.
fn cycles(low: f64, high: f64, rates: &[f64], dwell_s: f64) -> Vec<Leg> {
    let one = |r: &f64| [Leg::Ramp(high, *r), Leg::Hold(dwell_s), Leg::Ramp(low, *r), Leg::Hold(dwell_s)];
    std::iter::once(Leg::Hold(dwell_s)).chain(rates.iter().flat_map(one)).collect()
}

/// One measurand over many tests.
#[derive(Debug, Default)]
pub struct Tally {
    /// Its intervals.
    pub coverage: Coverage,
    /// Tests in which it is shown to lie on one side of the truth, at the risk of a limit there (5 % a side).
    pub beyond: usize,
}

/// Intervals of units at random, by measurand, over a programme that starts at a temperature in °C.
pub fn tally(
    units: impl Fn(&mut Chance) -> Unit + Sync,
    (start, legs): (f64, &[Leg]),
    seeds: Range<u64>,
) -> BTreeMap<&'static str, Tally> {
    let evaluated = |seed: u64| {
        let u = units(&mut Chance::new(seed));
        let f = found(&record(&u, start, legs, 20.0, 0.01, 7919 * seed + 1));
        let rows: Vec<Estimate> =
            IDS.iter().filter_map(|id| over_temperature(id, &f).into_iter().next()).collect();
        let span = f.analysis.as_ref().expect("an analysis").posterior.span;
        let (_, _, slope, _) = u.statistics(span.low, span.high);
        (u, slope, rows)
    };
    let all: Vec<_> = seeds.into_par_iter().map(evaluated).collect();
    let mut tallies: BTreeMap<&'static str, Tally> = BTreeMap::new();
    for (u, slope, rows) in all {
        for row in rows {
            let truth = match row.id {
                "bias_temperature_rate_sensitivity" => u.shupe,
                "thermal_lag" => u.lag_s,
                "thermal_hysteresis" => 2.0 * u.hysteresis.0,
                _ => slope,
            };
            let entry = tallies.entry(row.id).or_default();
            entry.coverage.take(Some(&row), truth, None);
            // Shown to lie on one side of the truth, at the risk of a limit there.
            let above = row.value.and_then(|v| row.spread.probability_above(v, truth));
            entry.beyond += usize::from(above.is_some_and(|p| !(0.05..=0.95).contains(&p)));
        }
    }
    tallies
}

fn case(
    name: &str,
    units: impl Fn(&mut Chance) -> Unit + Sync + Copy + 'static,
    start: f64,
    legs: Vec<Leg>,
) -> Case {
    Case::new(name, move |records, seed| {
        let first = 1 + 100_000_000 * (seed - 1);
        let mut rows = vec![];
        for (id, of) in tally(units, (start, &legs), first..first + records) {
            rows.extend(of.coverage.rows(id, Asked::Nothing));
            let claim = "shown to lie on one side of the truth, at 5 % a side";
            rows.push(Row::share(id, claim, Asked::AtMost(0.1), of.beyond as u64, of.coverage.runs as u64));
        }
        rows
    })
}

/// Units without some of the effects, and a narrow range.
pub(super) fn cases() -> Vec<Case> {
    let fast = || programme(&[60.0, 20.0], 3600.0);
    let slow = || programme(&[50.0, 16.0], 3600.0);
    let narrow = || cycles(10.0, 30.0, &[57.0, 4.3], 3600.0);
    vec![
        case("a line over temperature, 60 and 20 °C/h", |c| plain(c, false), -40.0, fast()),
        case("a line over temperature, 50 and 16 °C/h", |c| plain(c, false), -40.0, slow()),
        case("a curve over temperature, 60 and 20 °C/h", |c| plain(c, true), -40.0, fast()),
        case("a curve over temperature, 50 and 16 °C/h", |c| plain(c, true), -40.0, slow()),
        case("10 to 30 °C", unit, 10.0, narrow()),
        case("10 to 30 °C, little play", with_little_play, 10.0, narrow()),
        case("10 to 30 °C, no hysteresis", |c| Unit { hysteresis: (0.0, 0.0), ..unit(c) }, 10.0, narrow()),
        case(
            "rate of temperature alone",
            |c| Unit { shupe: c.between(0.02, 0.08), ..plain(c, false) },
            -40.0,
            slow(),
        ),
        case("lag alone", |c| Unit { lag_s: c.between(300.0, 1500.0), ..plain(c, false) }, -40.0, slow()),
    ]
}

fn with_little_play(chance: &mut Chance) -> Unit {
    let u = unit(chance);
    Unit { hysteresis: (u.hysteresis.0, 0.3 * u.hysteresis.1), ..u }
}
