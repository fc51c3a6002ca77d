//! Scale factor and its errors on benches of several kinds.

use super::evaluation::on_bench;
use super::truths::{told, truths};
use crate::bench::rate_table::RateTable;
use crate::coverage::Coverage;
use crate::study::{Asked, Case, Study};
use rayon::prelude::*;
use sagnac::estimate::Estimate;
use sagnac::measurand::{TableEvidence, find, table_extras};
use sagnac::rate_table::scale_factor;

/// Intervals of the scale factor and its errors.
pub static STUDY: Study = Study {
    id: "scale-factor",
    title: "Scale factor on a rate table",
    method: "Three cycles of eleven rates up to 100 °/s on a table made of geometry, read by its angle: a unit with cubic and \
             quadratic errors and a change with temperature, then one that drifts, whose cycles differ, with hysteresis, and \
             on a tilted table. Widths are over those of least squares that knows the noise.",
    records: 1000,
    cases,
};

/// Coverage over many simulated tests of every measurand that has a truth.
pub fn study(bench: &RateTable, runs: u64, first: u64) -> Vec<(&'static str, Coverage)> {
    let mut counts: Vec<(&'static str, Coverage)> = vec![];
    let evaluated = |seed: u64| -> Vec<(&'static str, Estimate, f64, Option<f64>)> {
        let bench = RateTable { seed, ..bench.clone() };
        let recorded = bench.record();
        let (run, setup) = on_bench(&bench, &recorded);
        let found = scale_factor::evaluate(&run, 0, &setup, &table_extras(&|_| true)).expect("a line");
        let told = told(&bench, &run, &found);
        let truths = truths(&bench, &recorded, &found).into_iter().filter(|t| t.1.is_finite());
        let line = Some(found);
        let evidence = TableEvidence { line, ..TableEvidence::new(0, "rate", &setup, &run.steps) };
        truths
            .map(|(id, truth)| {
                let [estimate] =
                    find(id).expect("a measurand").evaluate_steps(&evidence).try_into().expect("an estimate");
                (id, estimate, truth, told.get(id).copied())
            })
            .collect()
    };
    let tests: Vec<_> = (first..first + runs).into_par_iter().map(evaluated).collect();
    for test in tests {
        for (id, estimate, truth, told) in test {
            match counts.iter_mut().find(|c| c.0 == id) {
                Some((_, count)) => count.take(Some(&estimate), truth, told),
                None => {
                    let mut count = Coverage::default();
                    count.take(Some(&estimate), truth, told);
                    counts.push((id, count));
                }
            }
        }
    }
    counts
}

/// Benches of the study.
fn benches() -> Vec<(&'static str, RateTable)> {
    let usual = RateTable::default();
    vec![
        ("usual", usual.clone()),
        ("drifting", RateTable { k: 0.3, b: 0.05, ..usual.clone() }),
        ("cycles differ", RateTable { cycle_ppm: 5.0, ..usual.clone() }),
        ("hysteresis", RateTable { hysteresis_ppm: 3.0, ..usual.clone() }),
        ("wobble", RateTable { tilt: 0.02, dwell_s: 80.0, ..usual }),
    ]
}

fn cases() -> Vec<Case> {
    let case = |(name, bench): (&'static str, RateTable)| {
        Case::new(name, move |records, seed| {
            let counts = study(&bench, records, 1_000_000 + 100_000_000 * (seed - 1));
            counts.iter().flat_map(|(id, count)| count.rows(id, Asked::Nothing)).collect()
        })
    };
    benches().into_iter().map(case).collect()
}
