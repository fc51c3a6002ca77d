//! Effects of no catalogue, the other half: development never sees them.

use super::draw::Draw;
use super::effect::{Effect, White, means, unit};
use super::noise::random_walk;
use super::setting::Setting;
use super::unknowns::{band_noise, carrier};
use std::f64::consts::TAU;

/// A sawtooth whose period grows.
pub fn drifting_sawtooth(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f0 = draw.uniform(15.0, 50.0) / s.duration_s();
    let (change, start, size) = (draw.uniform(0.2, 0.5), draw.uniform(0.0, 1.0), 3.0 * a * unit(s));
    let phase = |t: f64| f0 * t * (1.0 - 0.5 * change * t / s.duration_s()) + start;
    let course = means(s, |t| size * (phase(t).rem_euclid(1.0) - 0.5));
    Effect::of("drifting_sawtooth")
        .adding(course)
        .found("frequency", (1.0 - change) * f0, 3.0 * f0)
        .found_in_time(s)
}

/// Spikes of one sign that decay, at irregular times.
pub fn one_sided_spikes(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let count = 15 + draw.below(25);
    let decay = s.interval_s() * draw.uniform(5.0, 25.0);
    let size = draw.sign() * 5.0 * a * unit(s);
    let mut course = vec![0.0; s.rows];
    for _ in 0..count {
        let (at, height) = (draw.below(s.rows), size * draw.uniform(0.5, 1.5));
        let reach = (12.0 * decay * s.claim.rate_hz) as usize;
        for (i, row) in course.iter_mut().skip(at).take(reach).enumerate() {
            *row += height * (-(i as f64) * s.interval_s() / decay).exp();
        }
    }
    let sigma = s.claim.white_sigma();
    Effect::of("one_sided_spikes").adding(course).found_in_time(s).found("amplitude", 0.0, 100.0 * sigma)
}

/// Noise of one band for one while.
pub fn burst_in_band(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = draw.uniform(0.08, 0.4) * s.claim.rate_hz;
    let half = f * draw.uniform(0.05, 0.2);
    let length = s.duration_s() * draw.uniform(0.08, 0.25);
    let from = draw.uniform(0.05, 0.7) * s.duration_s();
    let shape = |t: f64| if (from..from + length).contains(&t) { 1.0 } else { 0.0 };
    let (course, gain) = band_noise(draw, s, (f, half), 3.0 * a, shape);
    let mut effect = Effect::of("burst_in_band").adding(course);
    effect.own_gain = Some(gain);
    effect.found("time", from, from + length).found("frequency", f - half, f + half)
}

/// The white noise comes a second time, later and weaker.
pub fn echo(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let lag = 12 + draw.below(60);
    let gain = draw.sign() * 0.05 * a;
    let mut effect = Effect::of("echo");
    let at = lag as f64 * s.interval_s();
    effect = effect.found("lag", at - s.interval_s(), at + s.interval_s());
    effect = effect.found("frequency", 0.0, 0.5 * s.claim.rate_hz);
    effect.white = Some(White::Echo { gain, lag });
    effect
}

/// The size of a random walk: it never goes below its start.
pub fn rectified_walk(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let size = 2.0 * a * unit(s);
    let k = 60.0 / s.duration_s().sqrt();
    let walk = random_walk(draw, s.rows, s.claim.rate_hz, k);
    let course = walk.iter().map(|x| size * x.abs()).collect();
    Effect::of("rectified_walk").adding(course).found_in_time(s).found(
        "frequency",
        0.0,
        30.0 / s.duration_s(),
    )
}

/// A line that is there now and then.
pub fn intermittent_line(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = carrier(draw, s);
    let (p, size) = (draw.uniform(0.0, TAU), 3.0 * a * unit(s));
    let mut edges: Vec<f64> =
        (0..2 * (2 + draw.below(4))).map(|_| draw.uniform(0.0, s.duration_s())).collect();
    edges.sort_by(f64::total_cmp);
    let on = |t: f64| edges.partition_point(|&e| e < t) % 2 == 1;
    let course = means(s, |t| if on(t) { size * (TAU * f * t + p).cos() } else { 0.0 });
    let half = 6.0 / s.duration_s();
    let effect = Effect::of("intermittent_line").adding(course).found("frequency", f - half, f + half);
    effect.found("time", edges[0], edges[edges.len() - 1])
}

/// White noise that is not symmetric.
pub fn skewed_noise(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let degrees = 60.0 / a;
    let sigma = s.claim.white_sigma();
    let mut effect = Effect::of("skewed_noise").found("amplitude", sigma, 100.0 * sigma).found_in_time(s);
    // Leading term of the divergence from the normal: a twelfth of the squared skewness 8/ν.
    effect.own_gain = Some(s.rows as f64 * 8.0 / degrees / 12.0);
    effect.white = Some(White::Skew(degrees));
    effect
}

/// A line whose phase turns by half a period at irregular times.
pub fn reversing_line(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = carrier(draw, s);
    let (p, size) = (draw.uniform(0.0, TAU), 1.4 * a * unit(s));
    let mut at: Vec<f64> = (0..3 + draw.below(5)).map(|_| draw.uniform(0.0, s.duration_s())).collect();
    at.sort_by(f64::total_cmp);
    let side = |t: f64| if at.partition_point(|&e| e < t) % 2 == 0 { 1.0 } else { -1.0 };
    let course = means(s, |t| size * side(t) * (TAU * f * t + p).cos());
    let half = 8.0 / s.duration_s();
    Effect::of("reversing_line").adding(course).found("frequency", f - half, f + half)
}
