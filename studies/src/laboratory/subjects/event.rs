//! Jumps, bursts and lines.

use crate::laboratory::bench::Bench;
use crate::laboratory::claim::EARTH_DEG_H;
use crate::laboratory::effect::{Effect, Facts, Law, OfSize, Shape};
use crate::laboratory::process::{instants, resonance, two_levels};
use std::f64::consts::{PI, TAU};

/// A unit at rest with some decoys.
pub fn at_rest(bench: &mut Bench) {
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

/// Mean over each sampling interval of a function of time in s, at eight instants.
pub fn averaged(bench: &Bench, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let step = 1.0 / bench.rate_hz;
    (0..bench.rows)
        .map(|i| (0..8).map(|j| f((i as f64 + (j as f64 + 0.5) / 8.0) * step)).sum::<f64>() / 8.0)
        .collect()
}

/// A coherent sinusoid.
pub fn line(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let frequency = dice.decades(10.0 / bench.duration_s(), 0.45 * bench.rate_hz);
    let phase = dice.uniform(0.0, TAU);
    let course = averaged(bench, |t| (TAU * frequency * t + phase).cos());
    Effect::new("line", Shape::Course(course), move |bench, size| {
        let wide = 1.0 / bench.duration_s();
        Facts::default()
            .at("frequency", frequency - wide, frequency + wide)
            .with("frequency_hz", frequency)
            .with("amplitude_deg_h", size)
    })
}

/// A resonance struck by noise.
pub fn resonant(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let frequency = dice.decades(0.003 * bench.rate_hz, 0.3 * bench.rate_hz);
    // Five to forty periods, at most a fiftieth of the record.
    let decay = (dice.decades(5.0, 40.0) / frequency).min(bench.duration_s() / 50.0);
    let course = resonance(&mut dice, bench.rows, 1.0 / bench.rate_hz, frequency, decay, 1.0);
    let rate_hz = bench.rate_hz;
    let added: OfSize<Vec<f64>> = Box::new(move |_, size| course.iter().map(|c| size * c).collect());
    let law: OfSize<Law> = Box::new(move |bench, size| Law {
        levels: bench.right.levels,
        factor: Box::new(|_| 1.0),
        added: Box::new(move |f| {
            let half = |f0: f64| 1.0 / decay / ((1.0 / decay).powi(2) + (TAU * (f - f0)).powi(2));
            let x = PI * f / rate_hz;
            let box_car = if x > 0.0 { (x.sin() / x).powi(2) } else { 1.0 };
            size * size * box_car * (half(frequency) + half(-frequency))
        }),
    });
    Effect::new("quasi_periodic", Shape::Process(added, law), move |_, size| {
        let half = 2.0 / (TAU * decay);
        Facts::default()
            .at("frequency", (frequency - half).max(0.0), frequency + half)
            .with("frequency_hz", frequency)
            .with("amplitude_rms_deg_h", size)
            .with("coherence_time_s", decay)
    })
}

/// A pump whose strokes ring off: one period, many harmonics.
pub fn strokes(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let period = dice.decades(12.0, 80.0) / bench.rate_hz;
    let (start, fall) = (dice.uniform(0.0, 1.0), dice.uniform(0.04, 0.12) * period);
    let sign = dice.sign();
    let course = averaged(bench, |t| sign * (-((t / period + start).fract() * period) / fall).exp());
    Effect::new("comb", Shape::Course(course), move |bench, _| {
        Facts::default()
            .at("frequency", 0.99 / period, (6.01 / period).min(bench.rate_hz / 2.0))
            .with("fundamental_hz", 1.0 / period)
    })
}

/// Groups of outlying samples: something switched nearby.
pub fn bursts(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let count = dice.count(2, 9);
    let mut course = vec![0.0; bench.rows];
    let mut groups: Vec<[usize; 2]> = vec![];
    for _ in 0..count {
        let length = dice.count(2, 18);
        let at = dice.count(0, bench.rows - length - 1);
        for (j, c) in course[at..at + length].iter_mut().enumerate() {
            *c += dice.normal() * (1.5 - j as f64 / length as f64);
        }
        groups.push([at, at + length]);
    }
    groups.sort_unstable();
    Effect::new("outlier_bursts", Shape::Course(course), move |bench, _| {
        let mut facts = Facts::default();
        for [from, to] in &groups {
            facts = facts.at("time", *from as f64 / bench.rate_hz, *to as f64 / bench.rate_hz);
        }
        let [first, last] = [groups[0][0], groups[groups.len() - 1][1]];
        facts
            .at("time", first as f64 / bench.rate_hz, last as f64 / bench.rate_hz)
            .with("count", groups.len() as f64)
    })
}

/// Jumps between two levels.
pub fn telegraph(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let dwell = bench.duration_s() / dice.decades(6.0, 60.0);
    let course = two_levels(&mut dice, bench.rows, 1.0 / bench.rate_hz, dwell);
    Effect::new("random_telegraph", Shape::Course(course), move |bench, size| {
        Facts::default()
            .at("time", 0.0, bench.duration_s())
            .with("amplitude_deg_h", size)
            .with("mean_dwell_s", dwell)
    })
    .latent()
}

/// One jump.
pub fn step(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let at = dice.uniform(0.12, 0.88) * bench.duration_s();
    let sign = dice.sign();
    let course = averaged(bench, |t| if t < at { 0.0 } else { sign });
    Effect::new("bias_step", Shape::Course(course), move |bench, size| {
        // What the noise leaves open of the instant is a hundredth of the record.
        let near = 0.01 * bench.duration_s();
        Facts::default().at("time", at - near, at + near).with("step_deg_h", sign * size).with("time_s", at)
    })
    .same(&["heading_change"])
}

/// A level unit on an indexing table whose mount slips.
pub fn on_positions(bench: &mut Bench) {
    bench.index(true);
}

/// The mount slips while the table turns: another projection of the Earth's rate from then on.
pub fn slip(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let at = dice.uniform(0.15, 0.8) * bench.duration_s();
    let sign = dice.sign();
    let (angle, time) = (bench.columns["table_angle_deg"].clone(), bench.time_s());
    let earth = bench.right.earth_deg.unwrap_or([0.0, 0.0]);
    let level = EARTH_DEG_H * earth[0].to_radians().cos();
    let of = move |_: &Bench, size: f64| -> Vec<f64> {
        // Degrees; a mount that slips by more than a right angle has fallen off.
        let slip = sign * (0.01 * size).min(90.0);
        let projection = |a: f64| level * (a + earth[1]).to_radians().cos();
        angle
            .iter()
            .zip(&time)
            .map(|(a, t)| if *t < at { 0.0 } else { projection(a + slip) - projection(*a) })
            .collect()
    };
    Effect::new("heading_change", Shape::Bend(Box::new(of)), move |bench, _| {
        // The step differs from position to position, so no single one is true.
        let near = 0.03 * bench.duration_s();
        Facts::default().at("time", at - near, at + near).at("angle", 0.0, 360.0).with("time_s", at)
    })
}

/// Instants at which something happens a number of times in a record, s.
pub fn some_instants(bench: &mut Bench, least: f64, most: f64) -> Vec<f64> {
    let mean = bench.duration_s() / bench.dice.decades(least, most);
    let duration = bench.duration_s();
    let mut all = instants(&mut bench.dice, duration, mean);
    while all.len() < 3 {
        all.push(bench.dice.uniform(0.0, duration));
    }
    all.sort_by(f64::total_cmp);
    all
}
