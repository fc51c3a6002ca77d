//! What is claimed of noise that is as claimed, and of records with something else in them.

use super::inject;
use super::records::{FLICKER, Model, WALK, WHITE, bursts, levels, telegraph};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;

/// False finds.
pub static STUDY: Study = Study {
    id: "local-false-finds",
    title: "False finds of bursts, noise levels and telegraph signals",
    method: "Records at 10 Hz of white noise, with flicker and with a random walk, against a claim of just that noise: p-values \
             should be below a bound in that share of the records at most. Records with another effect in them, where bursts, \
             levels and telegraph signals are claimed at p < 1e-4: what the other effect is taken for is reported, and a \
             telegraph signal must not be claimed in processes that have none.",
    records: 300,
    cases,
};

const QUANTITIES: [&str; 3] = ["outlier bursts", "noise level", "telegraph signal"];

type Change = Box<dyn Fn(&mut [f64], u64) + Sync>;

/// p-values of bursts, level and telegraph signal in records of a model.
pub fn p_values(model: Model, samples: usize, records: u64, first: u64) -> Vec<[f64; 3]> {
    let one = |seed: u64| {
        let (problem, tried) = model.problem(samples, seed, |_| {});
        let levels = levels(&problem, &tried);
        [
            bursts(&problem, &tried).map_or(1.0, |b| b.p_value),
            levels.iter().map(|l| l.p_value).fold(1.0, f64::min),
            telegraph(&problem, &tried).map_or(1.0, |t| t.detection.p_value),
        ]
    };
    (first..first + records).into_par_iter().map(one).collect()
}

/// How many lie below a bound, of each.
pub fn below(values: &[[f64; 3]], bound: f64) -> [usize; 3] {
    [0, 1, 2].map(|i| values.iter().filter(|p| p[i] < bound).count())
}

/// What each of the three claims at p < 1e-4 in records with something else in them.
fn claims(change: &Change, seeds: std::ops::Range<u64>) -> [u64; 3] {
    seeds
        .into_par_iter()
        .map(|seed| {
            let (problem, tried) = WHITE.problem(6000, 5000 + seed, |rate| change(rate, seed));
            let b = bursts(&problem, &tried).is_some_and(|b| b.p_value < 1e-4);
            let l = levels(&problem, &tried).iter().any(|l| l.p_value < 1e-4);
            let t = telegraph(&problem, &tried).is_some_and(|t| t.detection.p_value < 1e-4);
            [b, l, t].map(u64::from)
        })
        .reduce(|| [0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]])
}

/// Other effects by their names.
fn others() -> Vec<(&'static str, Change)> {
    let sigma = WHITE.sigma();
    let ramp = move |rate: &mut [f64], size: f64| {
        let n = rate.len() as f64;
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * i as f64 / n);
    };
    let warm = move |rate: &mut [f64], size: f64, tau: f64| {
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * (-(i as f64) / tau).exp());
    };
    let step = move |rate: &mut [f64], size: f64| {
        let at = rate.len() / 3;
        rate[at..].iter_mut().for_each(|y| *y += size);
    };
    let line = move |rate: &mut [f64], size: f64, f: f64| {
        rate.iter_mut().enumerate().for_each(|(i, y)| *y += size * (f * i as f64).sin());
    };
    let round = move |rate: &mut [f64], lsb: f64| rate.iter_mut().for_each(|y| *y = (*y / lsb).round() * lsb);
    let carried = move |rate: &mut [f64], lsb: f64| {
        let mut angle = 0.0;
        rate.iter_mut().for_each(|y| {
            angle += *y;
            let whole = (angle / lsb).floor() * lsb;
            angle -= whole;
            *y = whole;
        });
    };
    vec![
        ("N x 1.3", Box::new(move |r, s| inject::level(r, sigma, |_| 1.3, s))),
        ("N x 4", Box::new(move |r, s| inject::level(r, sigma, |_| 4.0, s))),
        ("N x 0.5", Box::new(move |r, _| r.iter_mut().for_each(|y| *y *= 0.5))),
        ("ramp 20 sigma", Box::new(move |r, _| ramp(r, 20.0 * sigma))),
        ("warm-up 10 sigma, 60 samples", Box::new(move |r, _| warm(r, 10.0 * sigma, 60.0))),
        ("warm-up 30 sigma, 600 samples", Box::new(move |r, _| warm(r, 30.0 * sigma, 600.0))),
        ("step 5 sigma", Box::new(move |r, _| step(r, 5.0 * sigma))),
        ("line 3 sigma", Box::new(move |r, _| line(r, 3.0 * sigma, 0.7))),
        ("slow line 3 sigma", Box::new(move |r, _| line(r, 3.0 * sigma, 0.01))),
        (
            "narrow band 3 sigma, 20 s",
            Box::new(move |r, s| inject::narrow_band(r, 3.0 * sigma, 1.3, 20.0, s)),
        ),
        ("narrow band 2 sigma, 3 s", Box::new(move |r, s| inject::narrow_band(r, 2.0 * sigma, 1.3, 3.0, s))),
        ("Markov 1 sigma, 5", Box::new(move |r, s| inject::markov(r, sigma, 5.0, s))),
        ("Markov 1 sigma, 50", Box::new(move |r, s| inject::markov(r, sigma, 50.0, s))),
        ("Markov 0.5 sigma, 500", Box::new(move |r, s| inject::markov(r, 0.5 * sigma, 500.0, s))),
        ("Markov 3 sigma, 200", Box::new(move |r, s| inject::markov(r, 3.0 * sigma, 200.0, s))),
        (
            "random walk",
            Box::new(move |r, s| {
                let walk = Model { n: 0.0, b: 0.0, k: 3.0 }.draw(r.len(), 90_000 + s);
                r.iter_mut().zip(walk).for_each(|(y, w)| *y += w);
            }),
        ),
        (
            "flicker",
            Box::new(move |r, s| {
                let flicker = Model { n: 0.0, b: 0.3, k: 0.0 }.draw(r.len(), 90_000 + s);
                r.iter_mut().zip(flicker).for_each(|(y, w)| *y += w);
            }),
        ),
        ("rounded to 3 sigma", Box::new(move |r, _| round(r, 3.0 * sigma))),
        ("rounded to 6 sigma", Box::new(move |r, _| round(r, 6.0 * sigma))),
        ("angle of 4 sigma", Box::new(move |r, _| carried(r, 4.0 * sigma))),
        ("angle of 20 sigma", Box::new(move |r, _| carried(r, 20.0 * sigma))),
    ]
}

/// Processes without a telegraph signal.
fn processes() -> Vec<(&'static str, Change)> {
    let sigma = WHITE.sigma();
    let add = |model: Model| -> Change {
        Box::new(move |r: &mut [f64], s: u64| {
            let other = model.draw(r.len(), 90_000 + s);
            r.iter_mut().zip(other).for_each(|(y, w)| *y += w);
        })
    };
    vec![
        ("flicker", add(Model { n: 0.0, b: 0.3, k: 0.0 })),
        ("random walk", add(Model { n: 0.0, b: 0.0, k: 3.0 })),
        (
            "Markov",
            Box::new(move |r, s| {
                inject::markov(
                    r,
                    sigma * (0.3 + 0.01 * (s % 100) as f64),
                    10.0 * 1.05f64.powf((s % 97) as f64),
                    s,
                );
            }),
        ),
    ]
}

fn cases() -> Vec<Case> {
    let base = |seed: u64| 1_000_000 * (seed - 1);
    let mut cases = vec![];
    for (samples, part) in [(6000, 1), (40_000, 4)] {
        for (name, model) in [("white noise", WHITE), ("flicker", FLICKER), ("random walk", WALK)] {
            cases.push(Case::new(format!("{name} as claimed, {samples} samples"), move |records, seed| {
                noise_as_claimed(model, samples, records.div_ceil(part), 1000 + base(seed))
            }));
        }
    }
    for (name, change) in others() {
        cases.push(Case::new(format!("{name} in white noise"), move |records, seed| {
            let records = records.div_ceil(5);
            let claimed = claims(&change, base(seed)..base(seed) + records);
            let row = |(q, n): (&str, u64)| Row::share(q, "claimed at p < 1e-4", Asked::Nothing, n, records);
            QUANTITIES.into_iter().zip(claimed).map(row).collect()
        }));
    }
    for (name, change) in processes() {
        cases.push(Case::new(format!("{name}, no telegraph signal"), move |records, seed| {
            no_telegraph(&change, records, base(seed))
        }));
    }
    cases
}

fn noise_as_claimed(model: Model, samples: usize, records: u64, first: u64) -> Vec<Row> {
    let values = p_values(model, samples, records, first);
    let mut rows = vec![];
    for bound in [0.05, 1e-2, 1e-3, 1e-4] {
        for (quantity, found) in QUANTITIES.into_iter().zip(below(&values, bound)) {
            let claim = format!("p < {bound} where there is none");
            rows.push(Row::share(quantity, claim, Asked::AtMost(bound), found as u64, records));
        }
    }
    rows
}

fn no_telegraph(change: &Change, records: u64, first: u64) -> Vec<Row> {
    let found: Vec<f64> = (first..first + records)
        .into_par_iter()
        .map(|seed| {
            let (problem, tried) = WHITE.problem(6000, 5000 + seed, |rate| change(rate, seed));
            telegraph(&problem, &tried).map_or(1.0, |t| t.detection.p_value)
        })
        .collect();
    let row = |bound: f64| {
        let below = found.iter().filter(|p| **p < bound).count() as u64;
        Row::share(
            QUANTITIES[2],
            format!("p < {bound} where there is none"),
            Asked::AtMost(bound),
            below,
            records,
        )
    };
    [0.05, 1e-2, 1e-4].map(row).to_vec()
}
