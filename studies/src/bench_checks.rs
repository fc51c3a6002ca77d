//! Checks of a bench against what is wrong with it: how often intervals hold the truth, and how often a bench at a limit is released.

use crate::bench::bench_check::{BenchCheck, reference};
use crate::bench::noise_source::NoiseSource;
use crate::bench::rate_table::RateTable;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::estimate::Verdict;
use sagnac::record::RunRecord;
use sagnac::{Procedure, Recording, UnitUnderTest};
use std::path::PathBuf;

/// Checks of a bench.
pub static STUDY: Study = Study {
    id: "bench-check",
    title: "Checks of a bench",
    method: "Recordings of 14 min of a reference gyro on a table beside two thermometers, tested by `bench-check`. The thermometers are off by \
             a normal deviate of their stated uncertainty, the rate of the table by one of its own, and each has noise, an error that lasts \
             a minute, a drift, or few digits. At a limit, one of them is exactly as large as the limit allows: no more than 5 % may pass. \
             The generator shares no formula with the analysis.",
    records: 200,
    cases,
};

/// Standard uncertainties that the procedure states: of the difference of the thermometers, K, and of the rate of the table, ppm.
const THERMOMETERS_K: f64 = 0.05;
const TABLE_PPM: f64 = 0.5;
/// Rows of a check.
const SCALE_FACTOR: &str = "scale_factor_error";
const BIAS: &str = "scale_factor_bias";
const THERMOMETERS: &str = "thermometer_difference";

/// A bench with what is wrong with it.
#[derive(Clone)]
struct State {
    name: &'static str,
    bench: BenchCheck,
    /// The row that is at its limit.
    at_limit: Option<&'static str>,
}

fn states() -> Vec<State> {
    let sound = BenchCheck::default;
    let table = |table: RateTable| BenchCheck { table, ..sound() };
    let state = |name, bench, at_limit| State { name, bench, at_limit };
    vec![
        state("a sound bench", sound(), None),
        state(
            "thermometers with an error that lasts a minute",
            BenchCheck { noise: (0.01, 0.05), ..sound() },
            None,
        ),
        state("a difference that drifts by 0.2 K", BenchCheck { drift: 0.2, ..sound() }, None),
        state("readings of 0.1 K", BenchCheck { digit: 0.1, noise: (0.002, 0.0), ..sound() }, None),
        state("a reference gyro with flicker", table(RateTable { b: 0.01, ..reference(0) }), None),
        state("thermometers 0.3 K apart", BenchCheck { difference: 0.3, ..sound() }, Some(THERMOMETERS)),
        state("a table 10 ppm off", table(RateTable { error_ppm: 10.0, ..reference(0) }), Some(SCALE_FACTOR)),
        state("an Earth rate 0.1 deg/h off", table(RateTable { bias: 0.12, ..reference(0) }), Some(BIAS)),
    ]
}

impl State {
    /// A recording of it with noise and instruments drawn anew: the record and the true values of its rows.
    fn tested(&self, procedure: &Procedure, seed: u64) -> Option<(RunRecord, [(&'static str, f64); 3])> {
        let mut source = NoiseSource::new(seed ^ 0xbe7c);
        let off = (THERMOMETERS_K * source.normal(), TABLE_PPM * source.normal());
        let mut bench = self.bench.clone();
        let truths = [
            (SCALE_FACTOR, bench.table.error_ppm),
            (BIAS, bench.table.bias),
            (THERMOMETERS, bench.difference),
        ];
        bench.difference += off.0;
        bench.table = RateTable { error_ppm: bench.table.error_ppm + off.1, seed, ..bench.table };
        bench.seed = seed + 1;
        let folder = tempfile::tempdir().ok()?;
        let path = folder.path().join("r.csv");
        std::fs::write(&path, bench.csv()).ok()?;
        let result =
            procedure.run(&Recording::open(&path).ok()?, &UnitUnderTest::with_serial("REF-1")).ok()?;
        Some((result.record().clone(), truths))
    }

    fn rows(&self, records: u64, seed: u64) -> Vec<Row> {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../procedures/bench-check.toml");
        let Ok(procedure) = Procedure::load(path) else { return vec![] };
        let first = 1_000_000 * seed;
        let all: Vec<_> =
            (first..first + records).into_par_iter().filter_map(|s| self.tested(&procedure, s)).collect();
        let of = all.len() as u64;
        let mut rows = vec![];
        for (place, id) in [SCALE_FACTOR, BIAS, THERMOMETERS].into_iter().enumerate() {
            let held = all.iter().filter(|(record, truths)| {
                let row = record.measurands.iter().find(|m| m.id == id);
                let interval = row.and_then(|m| m.interval);
                interval.is_some_and(|i| (i.low..=i.high).contains(&truths[place].1))
            });
            let asked = Asked::Between(0.93, 0.99);
            rows.push(Row::share(id, "the interval holds the truth", asked, held.count() as u64, of));
        }
        let passed = |id: Option<&str>| {
            let verdict = |record: &RunRecord| match id {
                Some(id) => record.measurands.iter().find(|m| m.id == id).map(|m| m.verdict),
                None => Some(record.verdict),
            };
            all.iter().filter(|(record, _)| verdict(record) == Some(Verdict::Pass)).count() as u64
        };
        match self.at_limit {
            Some(id) => {
                rows.push(Row::share(id, "passes at its limit", Asked::AtMost(0.05), passed(Some(id)), of));
                rows.push(Row::share(
                    "bench",
                    "is released at a limit",
                    Asked::AtMost(0.05),
                    passed(None),
                    of,
                ));
            }
            None => rows.push(Row::share("bench", "is released", Asked::AtLeast(0.95), passed(None), of)),
        }
        rows
    }
}

fn cases() -> Vec<Case> {
    let case = |state: State| Case::new(state.name, move |records, seed| state.rows(records, seed));
    states().into_iter().map(case).collect()
}
