//! Contributions that follow the table's angle, the sensed angle or the gyro's heading.

use super::claim::EARTH_DEG_H;
use super::draw::Draw;
use super::effect::{Effect, means, unit};
use super::scenario::Scenario;
use super::setting::Setting;
use std::f64::consts::TAU;

/// The gyro is moved: at a turn to another heading, or at one heading.
pub fn heading_change(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let width = s.interval_s();
    if s.scenario == Scenario::Fixed {
        let at = s.duration_s() * draw.uniform(0.12, 0.88);
        let step = draw.sign() * a * unit(s);
        let course = means(s, |t| if t > at { step } else { 0.0 });
        let around = 3.0 * width;
        let effect = Effect::of("heading_change").with("step_deg_h", step).with("time_s", at).adding(course);
        return effect.found_at("time", at - around, at + around);
    }
    let (turning, _) = s.drivers.heading.as_ref().expect("a scenario with headings");
    // Four corners a turn, behind the one that begins the profile.
    let turns: Vec<(f64, f64)> = turning.corners()[1..].chunks_exact(4).map(|c| (c[0], c[3])).collect();
    let (from, to) = turns[1 + draw.below(turns.len() - 2)];
    let at = 0.5 * (from + to);
    let (latitude, azimuth) = s.claim.earth.expect("headings come with the Earth's rate");
    let horizontal = EARTH_DEG_H * latitude.to_radians().cos();
    let moved_deg = (draw.sign() * a * unit(s) / horizontal).to_degrees().clamp(-90.0, 90.0);
    let felt =
        |t: f64, more: f64| horizontal * (s.drivers.heading_deg(t) + azimuth + more).to_radians().cos();
    let course: Vec<f64> =
        s.time_s.iter().map(|&t| if t > at { felt(t, moved_deg) - felt(t, 0.0) } else { 0.0 }).collect();
    let step = felt(to, moved_deg) - felt(to, 0.0);
    Effect::of("heading_change").with("step_deg_h", step).with("time_s", at).adding(course).found_at(
        "time",
        from - 3.0 * width,
        to + 3.0 * width,
    )
}

/// The Earth's rate is another function of the heading.
pub fn earth_rate_projection(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (size, phase) = (a * unit(s), draw.uniform(0.0, 360.0));
    let course = means(s, |t| size * (s.drivers.heading_deg(t) + phase).to_radians().cos());
    Effect::of("earth_rate_projection")
        .with("amplitude_deg_h", size)
        .adding(course)
        .found("angle", 0.0, 360.0)
        .found_in_time(s)
}

/// So many periods a revolution.
pub fn table_harmonic(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let order = (1 + draw.below(6)) as f64;
    let (size, phase) = (a * unit(s), draw.uniform(0.0, 360.0));
    let course = means(s, |t| size * (order * s.drivers.heading_deg(t) + phase).to_radians().cos());
    Effect::of("table_harmonic")
        .with("order", order)
        .with("amplitude_deg_h", size)
        .adding(course)
        .found("angle", 0.0, 360.0)
        .found_in_time(s)
}

/// Periodic in the angle the gyro has sensed.
pub fn reset_ripple(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let table = s.drivers.table.as_ref().expect("a scenario with table rate");
    let most = 3600.0 * super::rates::top(s);
    let rate_hz = s.claim.rate_hz;
    let period = (most / (rate_hz * draw.log_uniform(0.05, 0.3))).clamp(1.5, 60.0);
    let (size, phase) = (a * unit(s) * 1.5, draw.uniform(0.0, TAU));
    let bias = s.claim.bias_deg_h + s.departure.bias_deg_h;
    // The finest pieces in which no piece holds more than an eighth of a period.
    let pieces = (8.0 * (most + bias.abs()) / (rate_hz * period)).ceil().max(4.0) as usize;
    let h = s.interval_s() / pieces as f64;
    let start = table.integral(0.0);
    let ripple = |t: f64| (TAU * (3600.0 * (table.integral(t) - start) + bias * t) / period + phase).cos();
    let course: Vec<f64> = s
        .time_s
        .iter()
        .map(|t| (0..pieces).map(|p| ripple(t + h * (p as f64 + 0.5) - 0.5 * s.interval_s())).sum::<f64>())
        .map(|sum| size * sum / pieces as f64)
        .collect();
    let deg = period / 3600.0;
    Effect::of("reset_ripple")
        .with("period_arcsec", period)
        .adding(course)
        .found("angle", 0.97 * deg, 1.03 * deg)
        .found("frequency", 0.0, 0.5 * rate_hz)
        .found_in_time(s)
}
