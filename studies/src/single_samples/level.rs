//! A level of the noise that changes over time or with the rate of a table.

use super::inject;
use super::records::{WHITE, bursts, levels};
use crate::coverage::median;
use crate::study::{Asked, Case, Row};
use rayon::prelude::*;
use sagnac::effect::{Column, Law, Level};

/// What is found in a record whose level changes.
pub struct Found {
    /// Laws of the level, the best first.
    pub levels: Vec<Level>,
    /// p-value of outlier bursts, which there are not.
    pub bursts: f64,
}

/// A level that follows the rate of a table, ±50 deg/s and seven periods: σ² = σ₀² (1 + (ratio² − 1)(|Ω|/max)^q).
pub fn rate_level(seed: u64, ratio: f64, exponent: i32) -> Found {
    let share = |u: f64| (u * 44.0).sin();
    let table: Vec<f64> = (0..12_000).map(|i| 50.0 * share((i as f64 + 0.5) / 12_000.0)).collect();
    let columns = [(Column::TableRate, table.clone())].into_iter().collect();
    let (problem, tried) = WHITE.with_columns(12_000, 80 + seed, &columns, |r| {
        let at = |u: f64| (1.0 + (ratio * ratio - 1.0) * share(u).abs().powi(exponent)).sqrt();
        inject::level(r, WHITE.sigma(), at, seed);
        r.iter_mut().zip(&table).for_each(|(y, w)| *y += 3600.0 * w);
    });
    let bursts = bursts(&problem, &tried).map_or(1.0, |b| b.p_value);
    Found { levels: levels(&problem, &tried), bursts }
}

/// A course of the level over the share of the record.
type Profile = fn(f64) -> f64;

const PROFILES: [(&str, Profile, f64); 6] = [
    ("line to 1.3", |u| (1.3f64).powf(u), 1.3),
    ("step to 1.2", |u| if u > 0.37 { 1.2 } else { 1.0 }, 1.2),
    ("stretch 1.4 of 0.1", |u| if (0.6..0.7).contains(&u) { 1.4 } else { 1.0 }, 1.4),
    ("wave to 1.3", |u| 1.15 + 0.15 * (std::f64::consts::TAU * u).cos(), 1.3),
    ("30 waves to 1.3", |u| 1.15 + 0.15 * (30.0 * std::f64::consts::TAU * u).cos(), 1.3),
    ("decay from 1.6", |u| 1.0 + 0.6 * (-u / 0.15).exp(), 1.6),
];

pub(super) fn cases() -> Vec<Case> {
    let base = |seed: u64| 1_000_000 * (seed - 1);
    let mut cases = vec![];
    for (ratio, exponent) in [(1.5, 1), (1.5, 2), (3.0, 1), (1.25, 1)] {
        let name = format!("level up to {ratio} times with the rate to the power of {exponent}");
        cases.push(Case::new(name, move |records, seed| with_rate(ratio, exponent, records, base(seed))));
    }
    for (name, profile, ratio) in PROFILES {
        cases.push(Case::new(format!("level over time: {name}"), move |records, seed| {
            over_time(profile, ratio, records, 700 + base(seed))
        }));
    }
    cases
}

/// Rows on the laws that came first: how often there is one, its ratio, and whether its interval holds the truth.
fn of_levels(quantity: &str, first: &[Option<&Level>], ratio: f64) -> Vec<Row> {
    let found: Vec<&Level> = first.iter().flatten().copied().collect();
    let held = found.iter().filter(|l| l.ci95[0] <= ratio && ratio <= l.ci95[1]).count() as u64;
    let of = found.len() as u64;
    let ratios: Vec<f64> = found.iter().map(|l| l.ratio / ratio).collect();
    let gains: Vec<f64> = found.iter().map(|l| l.gain).collect();
    vec![
        Row::share(quantity, "found", Asked::Nothing, of, first.len() as u64),
        Row::share(
            quantity,
            "95 % interval of the ratio holds the truth",
            Asked::Between(0.93, 0.97),
            held,
            of,
        ),
        Row::number(quantity, "median ratio over the truth", Asked::Nothing, median(&ratios), of),
        Row::number(quantity, "median gain of log-likelihood", Asked::Nothing, median(&gains), of),
    ]
}

fn with_rate(ratio: f64, exponent: i32, records: u64, first: u64) -> Vec<Row> {
    let all: Vec<Found> =
        (first..first + records).into_par_iter().map(|seed| rate_level(seed, ratio, exponent)).collect();
    let of_rate = |f: &Found| {
        f.levels.first().and_then(|l| match l.law {
            Law::Rate { exponent, .. } => Some(i32::from(exponent)),
            _ => None,
        })
    };
    let named: Vec<Option<&Level>> = all.iter().map(|f| of_rate(f).and_then(|_| f.levels.first())).collect();
    let right = all.iter().filter(|f| of_rate(f) == Some(exponent)).count() as u64;
    let mut rows = of_levels("noise_variance_rate", &named, ratio);
    rows.push(Row::share("noise_variance_rate", "the exponent is right", Asked::Nothing, right, records));
    rows
}

fn over_time(profile: Profile, ratio: f64, records: u64, first: u64) -> Vec<Row> {
    let of = |seed: u64| {
        let (problem, tried) =
            WHITE.problem(12_000, seed, |r| inject::level(r, WHITE.sigma(), profile, seed - 700));
        let bursts = bursts(&problem, &tried).map_or(1.0, |b| b.p_value);
        Found { levels: levels(&problem, &tried), bursts }
    };
    let all: Vec<Found> = (first..first + records).into_par_iter().map(of).collect();
    let best: Vec<Option<&Level>> = all.iter().map(|f| f.levels.first()).collect();
    let bursts = all.iter().filter(|f| f.bursts < 1e-4).count() as u64;
    let mut rows = of_levels("noise_variance_time", &best, ratio);
    rows.push(Row::share("outlier bursts", "claimed at p < 1e-4", Asked::Nothing, bursts, records));
    rows
}
