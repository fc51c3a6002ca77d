//! Intervals of repeatability and of the sensitivities to an influence, against simulated truth.

pub mod evaluation;

use crate::bench::chance::Noise;
use crate::bench::influence::{FIELD, series, shaken, turns};
use crate::bench::influence::{Series, Turns};
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case, Row, Study};
use evaluation::{compared, repeated};
use rayon::prelude::*;
use sagnac::measurand::{BIAS_REPEATABILITY, BIAS_REPEATABILITY_TREND, BIAS_SHIFT, ComparisonEvidence, find};

/// Repeatability, magnetic and vibration sensitivity.
pub static STUDY: Study = Study {
    id: "influence-intervals",
    title: "Intervals of repeatability and of sensitivities to an influence",
    method: "Eight runs of 6 min with 20 min off between them, and intervals of 2 min without and with a magnetic field or a \
             shaker, with a drift and with noise that the shaker raises. A random walk that goes on while the unit is off \
             differs from switching on by nothing that runs of minutes show: the repeatability is studied without it. Levels \
             that lie on a line may be said to be off it in one test of a hundred.",
    records: 1000,
    cases,
};

/// Kinds of noise: white, with flicker, with flicker and random walk.
pub const KINDS: [(&str, Noise); 3] = [
    ("white", Noise { n: 0.002, b: 0.0, k: 0.0 }),
    ("flicker", Noise { n: 0.002, b: 0.006, k: 0.0 }),
    ("walk", Noise { n: 0.002, b: 0.003, k: 0.02 }),
];

/// A sensitivity that is studied: its measurand, its truth, and the intervals that show it.
pub struct Sensitivity {
    /// Id of the measurand.
    pub id: &'static str,
    /// Its truth, in its unit.
    pub truth: f64,
    /// Intervals at levels.
    pub turns: Turns,
}

/// A field and a shaker that makes the unit noisier.
pub fn sensitivities(noise: Noise) -> [Sensitivity; 2] {
    let louder: fn(f64) -> f64 = |g| 1.0 + 0.3 * g.abs();
    let of = |id, truth, turns| Sensitivity { id, truth, turns: Turns { noise, dt: 2.0, ..turns } };
    [
        of("magnetic_sensitivity", 0.1, turns(&FIELD, 0.1)),
        of("vibration_sensitivity", 0.004, shaken(0.004, louder)),
    ]
}

/// What many tests without and with an influence gave.
#[derive(Debug, Default)]
pub struct Comparisons {
    /// The sensitivity.
    pub unit: Coverage,
    /// The shift of the bias at the first level.
    pub shift: Coverage,
    /// Tests whose levels are said to be off the line that they lie on.
    pub off: usize,
}

/// Many tests of a sensitivity.
pub fn comparisons(of: &Sensitivity, records: u64, first: u64) -> Comparisons {
    let measurand = find(of.id).expect("a measurand");
    let mut all = Comparisons::default();
    let tests: Vec<_> =
        (first..first + records).into_par_iter().map(|seed| compared(&of.turns, seed)).collect();
    for found in tests {
        all.off += usize::from(found.bias.line.is_none_or(|p| p < 0.01));
        let evidence = ComparisonEvidence { bias: &found, noise: &[], by_frequency: None };
        all.unit.take(measurand.evaluate_comparison(&evidence).first(), of.truth, None);
        let truth = (of.turns.bias)(of.turns.per_unit, found.bias.shifts[0].level);
        all.shift.take(BIAS_SHIFT.evaluate_comparison(&evidence).first(), truth, None);
    }
    all
}

/// Scatter between runs and trend over them, of many series whose bias scatters by `between` deg/h.
pub fn repeatability(noise: Noise, between: f64, records: u64, first: u64) -> [Coverage; 2] {
    let s = Series { noise, trend: 0.0, dt: 2.0, ..series(between) };
    over_seeds(first, records, |seed| {
        let found = repeated(&s, seed);
        [(&BIAS_REPEATABILITY, between), (&BIAS_REPEATABILITY_TREND, 0.0)]
            .map(|(m, truth)| Coverage::of(m.evaluate_runs(&found).first(), truth, None))
    })
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for (kind, noise) in KINDS {
        for between in [0.005, 0.02, 0.1].into_iter().filter(|_| noise.k == 0.0) {
            cases.push(Case::new(
                format!("runs that scatter by {between} °/h, {kind}"),
                move |records, seed| {
                    let [scatter, trend] =
                        repeatability(noise, between, records, 900_000 + 100_000_000 * (seed - 1));
                    let mut rows = scatter.rows("bias_repeatability", Asked::Nothing);
                    rows.extend(trend.rows("bias_repeatability_trend", Asked::Nothing));
                    rows
                },
            ));
        }
        for of in sensitivities(noise) {
            cases.push(Case::new(format!("{}, {kind}", of.id), move |records, seed| {
                let all = comparisons(&of, records, 910_000 + 100_000_000 * (seed - 1));
                let mut rows = all.unit.rows(of.id, Asked::Nothing);
                rows.extend(all.shift.rows("bias_shift", Asked::Nothing));
                let claim = "levels on a line are said to be off it";
                rows.push(Row::share("bias_shift", claim, Asked::AtMost(0.01), all.off as u64, records));
                rows
            }));
        }
    }
    cases
}
