//! The width of a sensitivity at one rate of temperature, against fits that know all but the strengths of the slow noise.

use super::chamber::{Unit, programme, record};
use super::evaluation::{found, over_temperature, unit};
use super::intervals::{told, truth};
use crate::chance::Chance;
use crate::coverage::median;
use crate::study::{Asked, Case, Row};
use rayon::prelude::*;
use sagnac::estimate::normal_probability;
use sagnac::temperature::course::{Shape, Terms};
use sagnac::temperature::findings::Findings;
use sagnac::temperature::gls::Modes;
use sagnac::temperature::read::of_distribution;

/// Width of the sensitivity's interval over that of a fit given everything, and whether it holds the truth, for a fit told
/// lag, play, order and N, and of B and K that they are evenly spread below `most` (`None`: what the program takes).
fn told_a_range(u: &Unit, f: &Findings, most: Option<f64>) -> Option<(f64, bool)> {
    const STEPS: usize = 12;
    let a = f.analysis.as_ref()?;
    let span = a.posterior.span;
    let terms = Terms { order: 3, rate: true, hysteresis: true };
    let shape = Shape { lag_s: u.lag_s, play_deg_c: u.hysteresis.1 };
    let modes = Modes::new(a.course.len(), a.course.block_s);
    let data = modes.of(&a.course.rate_deg_h);
    let columns: Vec<_> = a.course.columns(&terms, &shape, &span).iter().map(|c| modes.of(c)).collect();
    let visible = modes.visible(u.noise.n);
    let at = |i: usize, which: usize| {
        let share = (i as f64 + 0.5) / STEPS as f64;
        match most {
            Some(factor) => factor * [0.003, 0.002][which] * share,
            // Equal steps of ln(x + visible), up to a hundred times what the record shows.
            None => visible[which] * (share * 101f64.ln()).exp_m1(),
        }
    };
    let per_deg_c = 2.0 / (span.high - span.low);
    let mut parts = vec![];
    for i in 0..STEPS {
        for j in 0..STEPS {
            let s = modes.solve(&data, &columns, &[u.noise.n, at(i, 0), at(j, 1)])?;
            parts.push((
                s.log_likelihood,
                s.coefficients[0] * per_deg_c,
                s.covariance[(0, 0)].sqrt() * per_deg_c,
            ));
        }
    }
    let top = parts.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = parts.iter().map(|p| (p.0 - top).exp()).sum();
    let below = |x: f64| {
        parts.iter().map(|(l, m, s)| (l - top).exp() * normal_probability((x - m) / s)).sum::<f64>() / total
    };
    let ends = parts.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (_, m, s)| {
        (l.min(m - 6.0 * s), h.max(m + 6.0 * s))
    });
    let reading = of_distribution(below, ends);
    let i = reading.spread.interval(reading.value, 0.95)?;
    let exact = told(u, f)?["bias_temperature_sensitivity"];
    let truth = truth("bias_temperature_sensitivity", u, f);
    Some(((i.high - i.low) / 3.92 / exact, (i.low..=i.high).contains(&truth)))
}

/// A fit over many tests.
#[derive(Default)]
struct Widths {
    /// Widths over that of a fit that knows everything.
    over_told: Vec<f64>,
    /// Intervals that hold the truth.
    held: u64,
}

/// The fits that are compared; the last one is the program.
const FITS: [&str; 5] = [
    "B and K evenly spread below their ranges",
    "B and K evenly spread below three times their ranges",
    "B and K evenly spread below ten times their ranges",
    "the density that the program takes for B and K",
    "the program",
];

/// The interval of the program over one that knows everything, and whether it holds the truth.
fn own(u: &Unit, f: &Findings) -> Option<(f64, bool)> {
    let interval = over_temperature("bias_temperature_sensitivity", f).first()?.interval95()?;
    let truth = truth("bias_temperature_sensitivity", u, f);
    let exact = told(u, f)?["bias_temperature_sensitivity"];
    Some(((interval.high - interval.low) / 3.92 / exact, (interval.low..=interval.high).contains(&truth)))
}

fn widths(stronger: f64, records: u64, first: u64) -> Vec<Row> {
    let legs = programme(&[20.0], 3600.0);
    let of = |seed: u64| {
        let mut u = unit(&mut Chance::new(seed));
        u.noise.b *= stronger;
        u.noise.k *= stronger;
        let f = found(&record(&u, -40.0, &legs, 10.0, 0.01, 7919 * seed + 1));
        let ranges = [Some(1.0), Some(3.0), Some(10.0), None].map(|most| told_a_range(&u, &f, most));
        let all: Vec<_> = ranges.into_iter().chain([own(&u, &f)]).collect();
        all
    };
    let tests: Vec<_> = (first..first + records).into_par_iter().map(of).collect();
    let mut fits: [Widths; 5] = Default::default();
    for test in tests {
        for (fit, (width, inside)) in fits.iter_mut().zip(test).filter_map(|(fit, got)| Some((fit, got?))) {
            fit.over_told.push(width);
            fit.held += u64::from(inside);
        }
    }
    let rows = FITS.iter().zip(fits).flat_map(|(name, fit)| {
        let of = fit.over_told.len() as u64;
        let width = "median width of the sensitivity over that of a fit that knows everything";
        [
            Row::share(*name, "95 % interval holds the truth", Asked::Between(0.93, 0.97), fit.held, of),
            Row::number(*name, width, Asked::Nothing, median(&fit.over_told), of),
        ]
    });
    rows.collect()
}

/// Walks as the other cases draw them, and twice as strong ones.
pub(super) fn cases() -> Vec<Case> {
    let case = |name: &str, stronger: f64| {
        Case::new(name, move |records, seed| widths(stronger, records, 60_001 + 100_000_000 * (seed - 1)))
    };
    vec![case("20 °C/h with dwells", 1.0), case("20 °C/h with dwells, B and K twice as strong", 2.0)]
}
