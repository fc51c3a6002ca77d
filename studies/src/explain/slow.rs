//! Contributions that follow time, temperature or supply slowly.

use super::draw::Draw;
use super::effect::{Effect, means, unit};
use super::profile::Profile;
use super::setting::Setting;
use super::thermal::Thermal;
use std::f64::consts::TAU;

fn thermal(s: &Setting) -> &Thermal {
    s.drivers.any_thermal().expect("a scenario with temperature")
}

/// Lowest and highest value.
pub fn range(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &v| (a.min(v), b.max(v)))
}

fn temperatures(s: &Setting) -> Vec<f64> {
    s.time_s.iter().map(|&t| thermal(s).at(t)).collect()
}

fn reference(s: &Setting) -> f64 {
    s.claim.temperature.map_or(20.0, |(_, reference)| reference)
}

/// The coefficient is another one.
pub fn temp_linear(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let t = temperatures(s);
    let (low, high) = range(&t);
    let beyond = draw.sign() * a * unit(s) * 3.0 / (high - low);
    let total = s.claim.temperature.map_or(0.0, |(c, _)| c + s.departure.coefficient) + beyond;
    let course = t.iter().map(|t| beyond * (t - reference(s))).collect();
    Effect::of("temp_linear")
        .with("coefficient_deg_h_per_degC", total)
        .adding(course)
        .found("temperature", low, high)
        .found_in_time(s)
}

/// A curved static dependence.
pub fn temp_polynomial(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let t = temperatures(s);
    let (low, high) = range(&t);
    let (centre, half) = (draw.uniform(low, high), 0.5 * (high - low));
    let (sign, cubic) = (draw.sign(), draw.uniform(-0.7, 0.7));
    let curve = |t: f64| {
        let x = (t - centre) / half;
        x * x + cubic * x * x * x
    };
    let course = t.iter().map(|&t| sign * a * unit(s) * curve(t)).collect();
    Effect::of("temp_polynomial").adding(course).found("temperature", low, high).found_in_time(s)
}

/// Proportional to the rate of change of temperature.
pub fn temp_rate(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let rates: Vec<f64> = s.time_s.iter().map(|&t| thermal(s).rate(t)).collect();
    let (low, high) = range(&rates);
    let coefficient = draw.sign() * a * unit(s) / high.abs().max(low.abs());
    let course = rates.iter().map(|r| coefficient * r).collect();
    Effect::of("temp_rate")
        .with("coefficient_deg_h_per_degC_per_min", coefficient)
        .adding(course)
        .found("temperature_rate", low, high)
        .found_in_time(s)
}

/// The claimed dependence acts through a later temperature.
pub fn thermal_lag(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let lag_s = s.duration_s() * draw.log_uniform(0.01, 0.06);
    let lagged = thermal(s).lagged(&s.time_s, lag_s);
    let t = temperatures(s);
    let (low, high) = range(&t);
    let coefficient = draw.sign() * a * unit(s) / (high - low);
    let course = lagged.iter().zip(&t).map(|(l, t)| coefficient * (l - t)).collect();
    let mut effect = Effect::of("thermal_lag")
        .with("time_constant_s", lag_s)
        .adding(course)
        .found("lag", 0.0, 3.0 * lag_s)
        .found("temperature", low, high)
        .found_in_time(s);
    effect.coefficient = Some(coefficient);
    effect
}

/// A loop that opens by a play and does not depend on how fast it is gone through.
pub fn temp_hysteresis(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let t = temperatures(s);
    let (low, high) = range(&t);
    let half_c = (high - low) * draw.uniform(0.03, 0.12);
    let width = a * unit(s);
    let sign = draw.sign();
    let course: Vec<f64> =
        thermal(s).play(&s.time_s, half_c).iter().map(|side| sign * 0.5 * width * side).collect();
    let (least, most) = range(&course);
    Effect::of("temp_hysteresis")
        .with("loop_width_deg_h", most - least)
        .adding(course)
        .found("temperature", low, high)
        .found_in_time(s)
}

/// Decays from the beginning.
pub fn warmup(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let time_s = s.duration_s() * draw.log_uniform(0.02, 0.3);
    let size = draw.sign() * a * unit(s);
    let course = means(s, |t| size * (-t / time_s).exp());
    let amplitude = course[0] - course[s.rows - 1];
    Effect::of("warmup_exponential")
        .with("amplitude_deg_h", amplitude)
        .with("time_constant_s", time_s)
        .adding(course)
        .found("time", 0.0, 3.0 * time_s)
}

/// A straight drift.
pub fn rate_ramp(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let slope = draw.sign() * a * unit(s) * 3600.0 / s.duration_s();
    let course = s.time_s.iter().map(|t| slope * t / 3600.0).collect();
    Effect::of("rate_ramp").with("slope_deg_h_per_h", slope).adding(course).found_in_time(s)
}

/// A period of a day.
pub fn diurnal(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (size, phase) = (a * unit(s), draw.uniform(0.0, TAU));
    let f = 1.0 / 86_400.0;
    let half = 1.0 / s.duration_s();
    let course = means(s, |t| size * (TAU * f * t + phase).cos());
    Effect::of("diurnal")
        .with("amplitude_deg_h", size)
        .with("period_s", 86_400.0)
        .adding(course)
        .found("frequency", f - 0.5 * half, f + 0.5 * half)
        .found_in_time(s)
}

/// A quantity that nobody recorded.
pub fn unobserved_driver(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let size = draw.sign() * a * unit(s);
    let end = s.duration_s();
    let mut stretch = (0.0, end);
    let course: Vec<f64> = match draw.below(4) {
        // A heater switched on and off, seen through a thermal mass.
        0 => {
            let mass_s = end * draw.uniform(0.02, 0.08);
            let count = 2 + draw.below(4);
            let mut times: Vec<f64> = (0..count).map(|_| draw.uniform(0.05, 0.95) * end).collect();
            times.sort_by(f64::total_cmp);
            let steps: Vec<f64> =
                (0..count).map(|i| if i % 2 == 0 { 1.0 } else { -draw.uniform(0.5, 1.0) }).collect();
            means(s, |t| {
                let risen = |(at, step): (&f64, &f64)| {
                    if t > *at { step * (1.0 - (-(t - at) / mass_s).exp()) } else { 0.0 }
                };
                size * times.iter().zip(&steps).map(risen).sum::<f64>()
            })
        }
        // A room whose temperature wanders smoothly.
        1 => {
            let waves: Vec<(f64, f64, f64)> = (0..5)
                .map(|i| {
                    (
                        draw.uniform(0.3, 1.0),
                        (f64::from(i) + draw.uniform(0.7, 1.6)) / end,
                        draw.uniform(0.0, TAU),
                    )
                })
                .collect();
            means(s, |t| size * waves.iter().map(|(w, f, p)| w * (TAU * f * t + p).cos()).sum::<f64>())
        }
        // It came and went once.
        2 => {
            let (at, width) = (end * draw.uniform(0.25, 0.75), end * draw.uniform(0.03, 0.1));
            stretch = (at - 2.0 * width, at + 2.0 * width);
            means(s, |t| size * (-0.5 * ((t - at) / width).powi(2)).exp())
        }
        // A thermostat: up and down between two levels, never quite evenly.
        _ => {
            let mut points = vec![(-0.1 * end, 0.0)];
            let period = end * draw.uniform(0.06, 0.16);
            let mut at = -0.1 * end;
            while at < end {
                at += period * draw.uniform(0.25, 0.45);
                points.push((at, 1.0 + 0.15 * draw.normal()));
                at += period * draw.uniform(0.45, 0.75);
                points.push((at, 0.15 * draw.normal()));
            }
            let wave = Profile::new(&points);
            s.time_s.iter().map(|&t| size * wave.mean(t, s.interval_s())).collect()
        }
    };
    Effect::of("unobserved_driver").adding(course).found("time", stretch.0, stretch.1)
}

/// One jump.
pub fn bias_step(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let at = s.duration_s() * draw.uniform(0.12, 0.88);
    let step = draw.sign() * a * unit(s);
    let course = means(s, |t| if t > at { step } else { 0.0 });
    let around = 3.0 * s.interval_s();
    Effect::of("bias_step").with("step_deg_h", step).with("time_s", at).adding(course).found_at(
        "time",
        at - around,
        at + around,
    )
}

/// Back and forth between two levels.
pub fn random_telegraph(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let end = s.duration_s();
    let dwell = (end / draw.log_uniform(8.0, 50.0)).max(20.0 * s.interval_s());
    let height = a * unit(s);
    let mut jumps = Vec::new();
    let mut at = dwell * draw.exponential();
    while at < end {
        jumps.push(at);
        at += dwell * draw.exponential();
    }
    while jumps.len() < 3 {
        jumps.push(end * draw.uniform(0.1, 0.9));
        jumps.sort_by(f64::total_cmp);
    }
    let first = usize::from(draw.chance(0.5));
    let width = s.interval_s();
    let high = |t: f64| (jumps.partition_point(|&j| j < t) + first) % 2 == 1;
    let level = |t: f64| if high(t) { height } else { 0.0 };
    let course = s
        .time_s
        .iter()
        .map(|&t| (0..8).map(|p| level(t + width * (f64::from(p) - 3.5) / 8.0)).sum::<f64>() / 8.0);
    let mut effect = Effect::of("random_telegraph")
        .with("amplitude_deg_h", height)
        .with("mean_dwell_s", dwell)
        .adding(course.collect())
        .found_in_time(s);
    // The course of such a process has a probability of its own: dwells instead of samples that all might jump.
    effect.cost = jumps.len() as f64 * 3.0;
    effect
}

/// Follows the recorded supply.
pub fn supply_sensitivity(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let supply = s.drivers.supply.as_ref().expect("a scenario with supply");
    let volts: Vec<f64> = s.time_s.iter().map(|&t| supply.at(t)).collect();
    let (low, high) = range(&volts);
    let coefficient = draw.sign() * a * unit(s) * 3.0 / (high - low);
    let middle = 0.5 * (low + high);
    let course = volts.iter().map(|v| coefficient * (v - middle)).collect();
    Effect::of("supply_sensitivity")
        .with("coefficient_deg_h_per_V", coefficient)
        .adding(course)
        .found("supply", low, high)
        .found_in_time(s)
}
