//! Bursts of outliers and telegraph signals of several sizes: whether they are found, and how large.

use super::inject::{self, Group};
use super::records::{FLICKER, Model, RATE_HZ, WALK, WHITE, bursts, telegraph};
use crate::coverage::median;
use crate::study::{Asked, Case, Row};
use rayon::prelude::*;
use sagnac::effect::{Jumps, Outliers};
use std::sync::Mutex;

pub(super) fn cases() -> Vec<Case> {
    let base = |seed: u64| 700 + 1_000_000 * (seed - 1);
    let mut cases = vec![];
    for (count, length, times) in GROUPS {
        let name = format!("{count} bursts of {length} samples, {times} times the noise");
        cases.push(Case::new(name, move |records, seed| {
            of_bursts(&vec![length; count], times, records, base(seed))
        }));
    }
    let noises = [("white noise", WHITE), ("flicker", FLICKER), ("random walk", WALK)];
    for (noise, amplitude, dwell, samples) in SIGNALS {
        let (name, model) = noises[noise];
        let name = format!(
            "telegraph signal of {amplitude} σ, dwells of {dwell} samples, {name}, {samples} samples"
        );
        cases.push(Case::new(name, move |records, seed| {
            of_telegraph(model, Signal { amplitude, dwell, samples }, records, base(seed))
        }));
    }
    cases
}

/// Number of groups, samples of each, deviation over that of the noise.
const GROUPS: [(usize, usize, f64); 6] =
    [(6, 1, 12.0), (5, 10, 4.0), (4, 30, 3.0), (3, 50, 2.5), (2, 200, 2.0), (12, 20, 3.0)];

/// Place of the noise in the list, amplitude over the deviation of the white noise, mean dwell and length in samples.
const SIGNALS: [(usize, f64, f64, usize); 7] = [
    (0, 0.5, 300.0, 12_000),
    (0, 1.0, 60.0, 12_000),
    (0, 2.5, 10.0, 12_000),
    (0, 0.3, 2000.0, 40_000),
    (1, 0.5, 300.0, 12_000),
    (2, 0.5, 300.0, 12_000),
    (2, 1.0, 60.0, 12_000),
];

/// A telegraph signal.
#[derive(Clone, Copy)]
struct Signal {
    /// Over the deviation of the white noise of a sample.
    amplitude: f64,
    /// Mean dwell, samples.
    dwell: f64,
    /// Length of the record.
    samples: usize,
}

fn of_bursts(lengths: &[usize], times: f64, records: u64, first: u64) -> Vec<Row> {
    let of = |seed: u64| {
        let truth = Mutex::new(vec![]);
        let (problem, tried) = WHITE.problem(12_000, seed, |r| {
            let groups = inject::bursts(r, WHITE.sigma(), lengths, times, seed - 700);
            *truth.lock().expect("one thread") = groups;
        });
        let truth = truth.into_inner().expect("one thread");
        bursts(&problem, &tried).map(|b| {
            let right = b.samples.iter().filter(|i| truth.iter().any(|g: &Group| g.holds(**i))).count();
            (right as f64 / b.samples.len() as f64, b)
        })
    };
    let all: Vec<Option<(f64, Outliers)>> = (first..first + records).into_par_iter().map(of).collect();
    let found: Vec<&(f64, Outliers)> = all.iter().flatten().collect();
    let of = found.len() as u64;
    let middle =
        |f: &dyn Fn(&(f64, Outliers)) -> f64| median(&found.iter().map(|b| f(b)).collect::<Vec<f64>>());
    let number = |claim: &str, value| Row::number("outlier bursts", claim, Asked::Nothing, value, of);
    vec![
        Row::share("outlier bursts", "found", Asked::Nothing, of, records),
        number("median gain of log-likelihood", middle(&|b| b.1.gain)),
        number(
            "median number of groups over the truth",
            middle(&|b| b.1.groups.len() as f64) / lengths.len() as f64,
        ),
        number("median share of the samples set aside that are outliers", middle(&|b| b.0)),
    ]
}

fn of_telegraph(model: Model, signal: Signal, records: u64, first: u64) -> Vec<Row> {
    let size = signal.amplitude * WHITE.sigma();
    let of = |seed: u64| {
        let (problem, tried) = model.problem(signal.samples, seed, |r| {
            inject::telegraph(r, size, signal.dwell, seed - 700);
        });
        let outliers = bursts(&problem, &tried).is_some_and(|b| b.p_value < 1e-4);
        telegraph(&problem, &tried).map(|t| (t, outliers))
    };
    let all: Vec<Option<(Jumps, bool)>> = (first..first + records).into_par_iter().map(of).collect();
    let found: Vec<&(Jumps, bool)> = all.iter().flatten().collect();
    let of = found.len() as u64;
    let count = |f: &dyn Fn(&(Jumps, bool)) -> bool| found.iter().filter(|t| f(t)).count() as u64;
    let middle = |f: &dyn Fn(&Jumps) -> f64| median(&found.iter().map(|t| f(&t.0)).collect::<Vec<f64>>());
    let signal_row = |claim: &str, asked, hits| Row::share("telegraph signal", claim, asked, hits, of);
    let mut rows = vec![
        Row::share("telegraph signal", "found", Asked::Nothing, of, records),
        signal_row("p < 1e-4", Asked::Nothing, count(&|t| t.0.detection.p_value < 1e-4)),
        signal_row("bursts claimed as well at p < 1e-4", Asked::Nothing, count(&|t| t.1)),
        Row::number(
            "telegraph signal",
            "median gain of log-likelihood over a process of the same spectrum",
            Asked::Nothing,
            middle(&|t| t.detection.gain - t.rival_gain),
            of,
        ),
    ];
    for (name, truth) in [("amplitude_deg_h", size), ("mean_dwell_s", signal.dwell / RATE_HZ)] {
        let held = count(&|t| {
            let reported = t.0.detection.reported(name);
            reported.is_some_and(|r| r.ci95[0] <= truth && truth <= r.ci95[1])
        });
        let ratio = middle(&|t| t.detection.reported(name).map_or(f64::NAN, |r| r.value / truth));
        rows.push(Row::share(name, "95 % interval holds the truth", Asked::Between(0.93, 0.97), held, of));
        rows.push(Row::number(name, "median value over the truth", Asked::Nothing, ratio, of));
    }
    rows
}
