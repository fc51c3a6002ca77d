//! N from one process at three sample rates, which it must not depend on.

use super::record::{digest, identify};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::noise::composite::{Composite, Damped};
use sagnac::noise::identification::Identification;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};

/// N at 1, 10 and 100 samples a second.
pub static STUDY: Study = Study {
    id: "sample-rates",
    title: "Angle random walk at three sample rates",
    method: "One process of 3 h at 100 samples a second, and its means over 10 and 100 samples: white noise with flicker and a \
             random walk, without and with a Markov process of 1.5 s.",
    records: 40,
    cases,
};

/// Runs of means.
fn averaged(y: &[f64], factor: usize) -> Vec<f64> {
    y.chunks_exact(factor).map(|c| c.iter().sum::<f64>() / factor as f64).collect()
}

/// Sample rate in Hz and identification, of one process at 1, 10 and 100 samples a second.
pub fn at_three_rates(model: &Composite, hours: f64, seed: u64) -> Vec<(f64, Identification)> {
    let (tau0_s, samples) = (0.01, (hours * 360_000.0) as usize);
    let y = Simulator::of(model, &Setup::for_record(seed, tau0_s, samples as u64)).take(samples);
    [100usize, 10, 1]
        .into_iter()
        .map(|factor| {
            let record = digest(&averaged(&y, factor), tau0_s * factor as f64);
            (100.0 / factor as f64, identify(&record).identification)
        })
        .collect()
}

const RATES: [&str; 3] = ["1 Hz", "10 Hz", "100 Hz"];

fn cases() -> Vec<Case> {
    let noise = |markov: Vec<Damped>| Composite {
        markov,
        ..NoiseModel { n: 0.002, b: 0.006, k: 0.02, ..Default::default() }.into()
    };
    let markov = Damped { rms_deg_h: 0.1, frequency_hz: 0.0, decay_time_s: 1.5 };
    let case = |(name, model): (&str, Composite)| {
        Case::new(name, move |records, seed| rows(&model, records, 9_000 + 1_000_000 * (seed - 1)))
    };
    [("N+B+K", noise(vec![])), ("N+B+K+Markov 1.5 s", noise(vec![markov]))].into_iter().map(case).collect()
}

fn rows(model: &Composite, records: u64, first: u64) -> Vec<Row> {
    let all: Vec<_> =
        (first..first + records).into_par_iter().map(|seed| at_three_rates(model, 3.0, seed)).collect();
    let mut rows = vec![];
    for (i, rate) in RATES.into_iter().enumerate() {
        let quantity = format!("N at {rate}");
        let estimates = || all.iter().map(|r| &r[i].1.angle_random_walk);
        let values: Vec<f64> = estimates().filter_map(|e| e.value).map(|v| v / model.terms.n).collect();
        let holds = |i: sagnac::estimate::Interval| i.low <= model.terms.n && model.terms.n <= i.high;
        let held = estimates().filter(|e| e.interval95().is_some_and(holds)).count() as u64;
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        let number =
            |claim: &str, asked, value| Row::number(&quantity, claim, asked, value, values.len() as u64);
        rows.extend([
            number("mean over the truth", Asked::Nothing, mean),
            number(
                "error of the mean in standard errors",
                Asked::Between(-4.5, 4.5),
                (mean - 1.0) / (deviation / count.sqrt()),
            ),
            number("standard deviation, %", Asked::Nothing, 100.0 * deviation),
            Row::share(&quantity, "95 % interval holds the truth", Asked::Between(0.93, 0.97), held, records),
        ]);
    }
    rows
}
