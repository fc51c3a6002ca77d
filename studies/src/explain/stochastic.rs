//! Noise that the claim leaves out or states wrongly, lines, and noise whose level changes.

use super::draw::Draw;
use super::effect::{Effect, Filter, Process, White, unit};
use super::modes::sinc;
use super::setting::Setting;
use std::f64::consts::{PI, TAU};

fn nyquist(s: &Setting) -> f64 {
    0.5 * s.claim.rate_hz
}

/// More white noise, or less.
pub fn excess_arw(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let up = 1.0 + 0.05 * a;
    let factor = if draw.chance(0.75) { up } else { 1.0 / up };
    let total = s.claim.n * (1.0 + s.departure.n_rel) * factor;
    let mut effect = Effect::of("excess_arw").with("N_deg_rt_h", total).found("frequency", 0.0, nyquist(s));
    effect.white = Some(White::Factor(factor));
    effect
}

/// Lowest frequency that a record shows, Hz.
fn lowest(s: &Setting) -> f64 {
    0.5 / s.duration_s()
}

/// The band in which an added density stands highest against the claim: where it adds a tenth of its best at least.
fn band(s: &Setting, added: impl Fn(f64) -> f64) -> (f64, f64) {
    let grid: Vec<f64> =
        (0..=200).map(|i| lowest(s) * (nyquist(s) / lowest(s)).powf(f64::from(i) / 200.0)).collect();
    // Information lies in the square of the share, and in the number of modes, which grows with frequency.
    let worth = |f: f64| f * (added(f) / (added(f) + s.claim.mode_variance(f, [0.0; 3]))).powi(2);
    let best = grid.iter().map(|&f| worth(f)).fold(0.0, f64::max);
    let inside = |f: &&f64| worth(**f) > 0.1 * best;
    let from = grid.iter().find(inside).copied().unwrap_or(lowest(s));
    let to = grid.iter().rev().find(inside).copied().unwrap_or(nyquist(s));
    (from, to)
}

/// More flicker.
pub fn excess_flicker(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let stands = s.claim.b * (1.0 + s.departure.b_rel);
    let more = s.claim.b * a;
    let (from, to) = band(s, |f| more * more / (TAU * f) * s.claim.rate_hz);
    let mut effect =
        Effect::of("excess_flicker").with("B_deg_h", stands.hypot(more)).found("frequency", from, to);
    effect.process = Some(Process::Terms { n: 0.0, b: more, k: 0.0 });
    effect
}

/// More random walk.
pub fn excess_rrw(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let stands = s.claim.k * (1.0 + s.departure.k_rel);
    let more = s.claim.k * a;
    let (from, to) = band(s, |f| (more / (60.0 * TAU * f)).powi(2) * s.claim.rate_hz);
    let mut effect = Effect::of("excess_rrw")
        .with("K_deg_h_rt_h", stands.hypot(more))
        .found("frequency", from, to)
        .found_in_time(s);
    effect.process = Some(Process::Terms { n: 0.0, b: 0.0, k: more });
    effect
}

fn markov(name: &str, s: &Setting, sigma: f64, time_s: f64) -> Effect {
    let corner = 1.0 / (TAU * time_s);
    let mut effect = Effect::of(name)
        .with("correlation_time_s", time_s)
        .with("sigma_deg_h", sigma)
        .found("lag", 0.0, 4.0 * time_s)
        .found("frequency", 0.3 * corner, (3.0 * corner).min(nyquist(s)));
    effect.process = Some(Process::Markov { sigma, time_s });
    effect
}

/// Correlated over a few samples.
pub fn markov_short(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let time_s = s.interval_s() * draw.log_uniform(1.0, 8.0);
    markov("markov_short", s, 0.2 * a * s.claim.white_sigma(), time_s)
}

/// Correlated over many samples.
pub fn markov_long(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let time_s = draw.log_uniform(25.0 * s.interval_s(), s.duration_s() / 15.0);
    markov("markov_long", s, a * unit(s), time_s)
}

/// A hum of finite coherence.
pub fn quasi_periodic(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = draw.log_uniform(20.0 / s.duration_s(), 0.6 * nyquist(s));
    let time_s = draw.log_uniform((3.0 / f).min(s.duration_s() / 16.0), s.duration_s() / 15.0);
    let sigma = a * unit(s);
    let half = 1.0 / (TAU * time_s) + 1.0 / s.duration_s();
    let mut effect = Effect::of("quasi_periodic")
        .with("frequency_hz", f)
        .with("amplitude_rms_deg_h", sigma)
        .with("coherence_time_s", time_s)
        .found_at("frequency", f - half, f + half);
    effect.process = Some(Process::Resonance { sigma, frequency_hz: f, time_s });
    effect
}

/// A sinusoid, averaged over the sampling interval like all that is measured.
pub fn line(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let f = draw.log_uniform(8.0 / s.duration_s(), 0.9 * nyquist(s));
    let (size, phase) = (1.4 * a * unit(s), draw.uniform(0.0, TAU));
    let seen = size * sinc(f * s.interval_s());
    let course = s.time_s.iter().map(|t| seen * (TAU * f * t + phase).cos()).collect();
    let half = 0.5 / s.duration_s();
    Effect::of("line").with("frequency_hz", f).with("amplitude_deg_h", size).adding(course).found_at(
        "frequency",
        f - half,
        f + half,
    )
}

/// −3 dB frequency of the mean of `length` samples, as a share of the sample rate.
fn boxcar_cutoff(length: usize) -> f64 {
    let response = |x: f64| (PI * x * length as f64).sin() / (length as f64 * (PI * x).sin());
    let (mut low, mut high) = (1e-9, 1.0 / length as f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if response(middle) > 0.5f64.sqrt() { low = middle } else { high = middle }
    }
    low
}

/// Everything goes through a low-pass.
pub fn bandwidth_filter(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let cutoff = 0.9 * nyquist(s) / (a * draw.log_uniform(1.0, 8.0));
    let (filter, cutoff) = match draw.below(7) {
        0 => (Filter::TwoPole(cutoff), cutoff),
        1 => (Filter::Smoothing(cutoff), cutoff),
        2 => (Filter::Bilinear(cutoff), cutoff),
        3 => {
            let length = ((0.443 * s.claim.rate_hz / cutoff) as usize).max(2);
            (Filter::Boxcar(length), boxcar_cutoff(length) * s.claim.rate_hz)
        }
        _ => (Filter::OnePole(cutoff), cutoff),
    };
    let mut effect =
        Effect::of("bandwidth_filter").with("cutoff_hz", cutoff).found("frequency", 0.3 * cutoff, nyquist(s));
    effect.filter = Some(filter);
    effect
}

/// Square of a filter's response at `f`.
pub fn response(filter: Filter, f: f64, rate_hz: f64) -> f64 {
    match filter {
        Filter::OnePole(cutoff) => 1.0 / (1.0 + (f / cutoff).powi(2)),
        Filter::TwoPole(cutoff) => 1.0 / (1.0 + (f / cutoff).powi(4)),
        Filter::Smoothing(cutoff) => {
            // y += g (x - y), with the gain that has half the power at the cutoff.
            let s = 2.0 * (PI * cutoff / rate_hz).sin().powi(2);
            let g = (s * s + 2.0 * s).sqrt() - s;
            let turn = (PI * f / rate_hz).sin().powi(2);
            g * g / (g * g + 4.0 * (1.0 - g) * turn)
        }
        Filter::Bilinear(cutoff) => {
            let tan = |f: f64| (PI * f / rate_hz).tan();
            1.0 / (1.0 + (tan(f) / tan(cutoff)).powi(2))
        }
        Filter::Boxcar(length) => {
            let x = f / rate_hz;
            if x < 1e-9 {
                1.0
            } else {
                ((PI * x * length as f64).sin() / (length as f64 * (PI * x).sin())).powi(2)
            }
        }
    }
}

/// Gain of telling a changing level from the constant one that fits best within its prior.
pub fn level_gain(level: &[f64], rel: f64, prior: f64) -> f64 {
    let cost = |r: f64| {
        let scale = (1.0 + r).powi(2);
        let of = |g: &f64| {
            let ratio = (g * (1.0 + rel)).powi(2) / scale;
            0.5 * (ratio - 1.0 - ratio.ln())
        };
        level.iter().map(of).sum::<f64>() + 0.5 * (r / prior).powi(2)
    };
    let (mut low, mut high) = (-0.5, 20.0);
    for _ in 0..60 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if cost(a) < cost(b) { high = b } else { low = a }
    }
    cost(0.5 * (low + high)) - 0.5 * (rel / prior).powi(2)
}

fn levelled(effect: Effect, s: &Setting, level: Vec<f64>) -> Effect {
    let (low, high) = super::slow::range(&level);
    let mut effect = effect.with("ratio", high / low);
    effect.own_gain = Some(level_gain(&level, s.departure.n_rel, s.claim.uncertainty.n_rel));
    effect.white = Some(White::Level(level));
    effect
}

/// The level of the white noise changes with time: for a while, steadily, or up and down.
pub fn noise_variance_time(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let end = s.duration_s();
    let more = 0.1 * a;
    let form = draw.below(3);
    let (from, to) = {
        let length = end * draw.uniform(0.1, 0.4);
        let from = draw.uniform(0.0, end - length);
        (from, from + length)
    };
    let (cycles, phase) = (draw.uniform(1.0, 4.0), draw.uniform(0.0, TAU));
    let level = |t: f64| match form {
        0 if (from..to).contains(&t) => 1.0 + more,
        0 => 1.0,
        1 => 1.0 + more * t / end,
        _ => 1.0 + more * 0.5 * (1.0 + (TAU * cycles * t / end + phase).cos()),
    };
    let effect = Effect::of("noise_variance_time");
    let effect = if form == 0 { effect.found("time", from, to) } else { effect.found_in_time(s) };
    levelled(effect, s, s.time_s.iter().map(|&t| level(t)).collect())
}

/// The level of the white noise grows with the rate.
pub fn noise_variance_rate(_: &mut Draw, s: &Setting, a: f64) -> Effect {
    let table = s.drivers.table.as_ref().expect("a scenario with table rate");
    let most = super::rates::top(s);
    let level: Vec<f64> = s.time_s.iter().map(|&t| 1.0 + 0.1 * a * table.at(t).abs() / most).collect();
    let effect = Effect::of("noise_variance_rate").found("input_rate", -most, most).found_in_time(s);
    levelled(effect, s, level)
}
