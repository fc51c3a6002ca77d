//! Levels and processes of noise.

use crate::laboratory::bench::Bench;
use crate::laboratory::effect::{Effect, Facts, Law, OfSize, Shape, range_of, spread_of};
use crate::laboratory::environment::people;
use crate::laboratory::motion::Programme;
use crate::laboratory::noise::Levels;
use crate::laboratory::process::relaxation;
use std::f64::consts::{PI, TAU};

/// A unit at rest with some decoys.
pub fn at_rest(bench: &mut Bench) {
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

fn level(kind: &'static str, sign: f64, part: usize, name: &'static str) -> Effect {
    let factor = move |size: f64| (sign * 0.05 * size).exp();
    let added: OfSize<Vec<f64>> = Box::new(move |bench, size| {
        let of = [&bench.parts.white, &bench.parts.flicker, &bench.parts.walk][part];
        of.iter().map(|x| (factor(size) - 1.0) * x).collect()
    });
    let changed = move |bench: &Bench, size: f64| {
        let Levels { mut n, mut b, mut k } = bench.right.levels;
        *[&mut n, &mut b, &mut k][part] *= factor(size);
        Levels { n, b, k }
    };
    let law: OfSize<Law> = Box::new(move |bench, size| Law {
        levels: changed(bench, size),
        factor: Box::new(|_| 1.0),
        added: Box::new(|_| 0.0),
    });
    Effect::new(kind, Shape::Process(added, law), move |bench, size| {
        let Levels { n, b, k } = changed(bench, size);
        // Where the term is as strong as white noise; a few periods of the record at least.
        let to_white = [f64::INFINITY, b * b / (TAU * 3600.0 * n * n), k / (TAU * 3600.0 * n)][part];
        let top = (4.0 * to_white).max(10.0 / bench.duration_s()).min(bench.rate_hz / 2.0);
        let band = [if part == 0 { 0.01 * top } else { 0.0 }, top];
        let facts = Facts::default().at("frequency", band[0], band[1]).with(name, [n, b, k][part]);
        // The raised noise is the claimed one and noise of its own beside it: variances add. Less noise adds none.
        let raised = factor(size).powi(2) - 1.0;
        let of = [&bench.parts.white, &bench.parts.flicker, &bench.parts.walk][part];
        if raised > 0.0 { facts.with("rms_deg_h", raised.sqrt() * spread_of(of)) } else { facts }
    })
}

/// More or less white noise.
pub fn white(bench: &mut Bench) -> Effect {
    let sign = if bench.dice.chance(0.75) { 1.0 } else { -1.0 };
    level("excess_arw", sign, 0, "N_deg_rt_h")
}

/// More flicker.
pub fn flicker(_: &mut Bench) -> Effect {
    level("excess_flicker", 1.0, 1, "B_deg_h")
}

/// More random walk.
pub fn walk(_: &mut Bench) -> Effect {
    level("excess_rrw", 1.0, 2, "K_deg_h_rt_h")
}

fn correlated(bench: &mut Bench, kind: &'static str, time_s: f64) -> Effect {
    let mut dice = bench.dice.fork();
    let course = relaxation(&mut dice, bench.rows, 1.0 / bench.rate_hz, time_s, 1.0);
    let step_s = 1.0 / bench.rate_hz;
    let added: OfSize<Vec<f64>> = Box::new(move |_, size| course.iter().map(|c| size * c).collect());
    let law: OfSize<Law> = Box::new(move |bench, size| Law {
        levels: bench.right.levels,
        factor: Box::new(|_| 1.0),
        // Density of samples of an exponential correlation.
        added: Box::new(move |f| {
            let kept = (-step_s / time_s).exp();
            size * size * step_s * (1.0 - kept * kept)
                / (1.0 + kept * kept - 2.0 * kept * (TAU * f * step_s).cos())
        }),
    });
    Effect::new(kind, Shape::Process(added, law), move |bench, size| {
        let corner = 1.0 / (TAU * time_s);
        Facts::default()
            .at("lag", 0.0, 3.0 * time_s)
            .at("frequency", 0.0, (4.0 * corner).min(bench.rate_hz / 2.0))
            .with("correlation_time_s", time_s)
            .with("sigma_deg_h", size)
    })
}

/// Noise correlated over a few samples.
pub fn short(bench: &mut Bench) -> Effect {
    let time_s = bench.dice.uniform(1.2, 8.0) / bench.rate_hz;
    correlated(bench, "markov_short", time_s)
}

/// Noise correlated over many samples.
pub fn long(bench: &mut Bench) -> Effect {
    let most = bench.duration_s() / 40.0;
    let time_s = bench.dice.decades((25.0 / bench.rate_hz).max(20.0).min(0.5 * most), most);
    correlated(bench, "markov_long", time_s)
}

/// A counter of angle.
pub fn quantisation(bench: &mut Bench) -> Effect {
    let typical = bench.right.levels.n * 60.0 / bench.rate_hz.sqrt();
    let phase = bench.dice.uniform(0.0, 1.0);
    let step = move |size: f64| typical * size;
    let added: OfSize<Vec<f64>> = Box::new(move |bench, size| {
        let lsb = step(size);
        let (mut angle, mut counted) = (phase * lsb, 0.0);
        bench
            .rate()
            .iter()
            .map(|y| {
                angle += y / bench.rate_hz;
                let now = (angle / lsb).floor() * lsb;
                let shown = (now - counted) * bench.rate_hz;
                counted = now;
                shown - y
            })
            .collect()
    });
    let law: OfSize<Law> = Box::new(move |bench, size| {
        let (lsb, rate_hz) = (step(size), bench.rate_hz);
        Law {
            levels: bench.right.levels,
            factor: Box::new(|_| 1.0),
            added: Box::new(move |f| lsb * lsb / 3.0 * rate_hz * (PI * f / rate_hz).sin().powi(2)),
        }
    });
    Effect::new("quantization", Shape::Process(added, law), move |bench, size| {
        let lsb = step(size);
        Facts::default()
            .at("amplitude", 0.0, lsb * bench.rate_hz)
            .at("frequency", 0.1 * bench.rate_hz, bench.rate_hz / 2.0)
            .with("lsb_arcsec", lsb)
    })
}

/// Two poles of an amplifier after the noise.
pub fn filter(bench: &mut Bench) -> Effect {
    let second = bench.dice.uniform(0.05, 0.5);
    // Poles as parts kept from row to row.
    let kept = move |size: f64| [1.0, second].map(|s| 1.0 - 1.0 / (1.0 + 0.2 * s * size));
    let added: OfSize<Vec<f64>> = Box::new(move |bench, size| {
        let [a, b] = kept(size);
        let noise = bench.parts.sum();
        let (mut x, mut y) = (noise[0], noise[0]);
        noise
            .iter()
            .map(|n| {
                x = a * x + (1.0 - a) * n;
                y = b * y + (1.0 - b) * x;
                y - n
            })
            .collect()
    });
    let response = move |size: f64, f_over_rate: f64| -> f64 {
        let pole = |k: f64| (1.0 - k) * (1.0 - k) / (1.0 + k * k - 2.0 * k * (TAU * f_over_rate).cos());
        kept(size).into_iter().map(pole).product()
    };
    let law: OfSize<Law> = Box::new(move |bench, size| {
        let rate_hz = bench.rate_hz;
        Law {
            levels: bench.right.levels,
            factor: Box::new(move |f| response(size, f / rate_hz)),
            added: Box::new(|_| 0.0),
        }
    });
    Effect::new("bandwidth_filter", Shape::Process(added, law), move |bench, size| {
        let facts = Facts::default().at("frequency", 0.02 * bench.rate_hz, bench.rate_hz / 2.0);
        let corner = (1..5000).map(|i| i as f64 * 1e-4).find(|f| response(size, *f) < 0.5);
        match corner {
            Some(f) => facts.with("cutoff_hz", f * bench.rate_hz),
            None => facts,
        }
    })
}

/// A level of noise that changes during the record: a step, a drift, or busy hours.
pub fn level_in_time(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let (rows, span) = (bench.rows, bench.span);
    let form = dice.count(0, 2);
    let (from, to) = (dice.uniform(0.1, 0.5), dice.uniform(0.6, 0.9));
    let level: Vec<f64> = match form {
        0 => (0..rows).map(|i| f64::from((from..to).contains(&(i as f64 / rows as f64)))).collect(),
        1 => (0..rows).map(|i| i as f64 / rows as f64).collect(),
        _ => {
            let busy: Vec<f64> = (0..span.length).map(|i| people::busyness(span.hour(i))).collect();
            let rows = bench.at_rows(&busy);
            // A night without change tells nothing.
            if rows.iter().all(|b| (b - rows[0]).abs() < 0.1) {
                (0..bench.rows).map(|i| (i as f64 / bench.rows as f64).powi(3)).collect()
            } else {
                rows
            }
        }
    };
    let levels = level.clone();
    let spread: OfSize<Vec<f64>> =
        Box::new(move |_, size| levels.iter().map(|l| 1.0 + 0.05 * size * l).collect());
    Effect::new("noise_variance_time", Shape::Spread(spread), move |bench, size| {
        let loud = |i: &usize| level[*i] > 0.5;
        let first = (0..level.len()).find(loud).unwrap_or(0);
        let last = (0..level.len()).rfind(loud).unwrap_or(level.len() - 1);
        let [low, high] = range_of(&level);
        Facts::default()
            .at("time", first as f64 / bench.rate_hz, (last + 1) as f64 / bench.rate_hz)
            .with("ratio", (1.0 + 0.05 * size * high) / (1.0 + 0.05 * size * low))
    })
}

/// A unit on a rate table.
pub fn on_table(bench: &mut Bench) {
    bench.turn(Programme::Steps);
}

/// A level of noise that grows with the rate.
pub fn level_by_rate(bench: &mut Bench) -> Effect {
    let rate = &bench.columns["table_rate_deg_s"];
    let most = rate.iter().fold(0.0f64, |m, r| m.max(r.abs()));
    let part: Vec<f64> = rate.iter().map(|r| (r / most).abs()).collect();
    let spread: OfSize<Vec<f64>> =
        // Noise of the scale factor adds to that of the bias in power.
        Box::new(move |_, size| part.iter().map(|p| (1.0 + 0.1 * size * p * p).sqrt()).collect());
    Effect::new("noise_variance_rate", Shape::Spread(spread), move |bench, size| {
        let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
        Facts::default().at("input_rate", low, high).with("ratio", (1.0 + 0.1 * size).sqrt())
    })
}
