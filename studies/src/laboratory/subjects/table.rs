//! Scale factor, table and clock.

use crate::laboratory::bench::Bench;
use crate::laboratory::claim::EARTH_DEG_H;
use crate::laboratory::effect::{Effect, Facts, Shape, range_of};
use crate::laboratory::motion::{Motion, Programme};
use crate::laboratory::unit::body::Pace;
use std::f64::consts::TAU;

/// A unit on a rate table in steps.
pub fn steps(bench: &mut Bench) {
    bench.turn(Programme::Steps);
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

/// A unit on a rate table in the chamber.
pub fn steps_in_chamber(bench: &mut Bench) {
    bench.warm(true, Pace::Quick);
    bench.turn(Programme::Steps);
}

/// A unit on a swinging table.
pub fn swings(bench: &mut Bench) {
    bench.turn(Programme::Swings);
}

/// A unit on a table that crawls through zero.
pub fn crawl(bench: &mut Bench) {
    bench.turn(Programme::Crawl);
}

/// A unit on a table that turns and whose position is recorded.
pub fn turning(bench: &mut Bench) {
    bench.turn(Programme::Steps);
    let angle = bench.motion.as_ref().map_or_else(Vec::new, Motion::angle_deg);
    bench.columns.insert("table_angle_deg".to_owned(), angle);
}

/// A unit on an indexing table of which the claim knows the heading.
pub fn positions(bench: &mut Bench) {
    bench.index(true);
}

/// A unit at rest about its own axis on a table whose other axis turns.
pub fn other_axis(bench: &mut Bench) {
    let mut dice = bench.dice.fork();
    let motion = Motion::draw(&mut dice, Programme::Swings, bench.rows, bench.rate_hz);
    bench.columns.insert("outer_rate_deg_s".to_owned(), motion.rate_deg_s());
    bench.claim.description = "turned about the other axis".to_owned();
    let count = bench.dice.count(0, 2);
    bench.record_others(count);
}

fn rates(bench: &Bench) -> Vec<f64> {
    bench.columns["table_rate_deg_s"].clone()
}

fn over_rates(bench: &Bench) -> Facts {
    let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
    Facts::default().at("input_rate", low, high)
}

/// Ppm by which the scale factor differs from the claimed one without any effect.
fn off_ppm(bench: &Bench) -> f64 {
    bench.right.scale_ppm.map_or(0.0, |[p, _]| p) - bench.claim.scale_ppm.map_or(0.0, |[p, _]| p)
}

/// Another scale factor.
pub fn error(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let course = rates(bench).iter().map(|r| sign * 3.6e-3 * r).collect();
    Effect::new("sf_error", Shape::Course(course), move |bench, size| {
        over_rates(bench).with("error_ppm", off_ppm(bench) + sign * size)
    })
}

/// One scale factor for each direction.
pub fn asymmetry(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let course = bench.motion.as_ref().map_or_else(Vec::new, |m| m.mean_of(|_, r| sign * 1.8e-3 * r.abs()));
    Effect::new("sf_asymmetry", Shape::Course(course), move |bench, size| {
        over_rates(bench).with("asymmetry_ppm", sign * size)
    })
}

/// The sine of an open loop that its output stage takes for a straight line.
pub fn sine(bench: &mut Bench) -> Effect {
    let most = rates(bench).iter().fold(0.0f64, |m, r| m.max(r.abs()));
    // Phase at the largest rate in mrad.
    let of = move |bench: &Bench, size: f64| -> Vec<f64> {
        let per = (1e-3 * size).min(1.5) / most;
        bench
            .motion
            .as_ref()
            .map_or_else(Vec::new, |m| m.mean_of(|_, r| 3600.0 * ((per * r).sin() / per - r)))
    };
    Effect::new("sf_nonlinearity", Shape::Bend(Box::new(of)), move |bench, size| {
        let phase = (1e-3 * size).min(1.5);
        over_rates(bench).with("cubic_ppm_at_max", -1e6 * phase * phase / 6.0)
    })
    .beside(&["sf_error"])
}

/// Scale factor that follows the temperature of the coil.
pub fn by_temperature(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let coil = bench.warmth.as_ref().map_or_else(Vec::new, |w| w.coil());
    let course =
        bench.at_rows(&coil).iter().zip(rates(bench)).map(|(t, r)| sign * 3.6e-3 * (t - 20.0) * r).collect();
    let mut effect = Effect::new("sf_temperature", Shape::Course(course), move |bench, size| {
        let [low, high] = range_of(&bench.columns["temp_degC"]);
        let [from, to] = range_of(&bench.columns["table_rate_deg_s"]);
        Facts::default()
            .at("temperature", low, high)
            .at("input_rate", from, to)
            .with("coefficient_ppm_per_degC", sign * size)
    });
    effect.column = Some("temp_degC".to_owned());
    effect.beside(&["sf_error"])
}

/// Two beams that lock to each other at small rates, as those of a ring laser do: the rate that is left is that of a beat.
pub fn lock(_: &mut Bench) -> Effect {
    let of = |bench: &Bench, size: f64| -> Vec<f64> {
        let half = 0.01 * size;
        let beat = |deg_h: f64| {
            let left = deg_h * deg_h - half * half;
            if left > 0.0 { deg_h.signum() * left.sqrt() } else { 0.0 }
        };
        bench.motion.as_ref().map_or_else(Vec::new, |m| m.mean_of(|_, r| beat(3600.0 * r) - 3600.0 * r))
    };
    Effect::new("dead_zone", Shape::Bend(Box::new(of)), |bench, size| {
        let half = 0.01 * size;
        let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
        let near = 3.0 * half / 3600.0;
        Facts::default().at("input_rate", (-near).max(low), near.min(high)).with("half_width_deg_h", half)
    })
}

/// A detector that has no more to give beyond a rate. The noise of the electronics behind it stays.
pub fn limit(bench: &mut Bench) -> Effect {
    let most = rates(bench).iter().fold(0.0f64, |m, r| m.max(r.abs()));
    // Less than the noise at first, so that middling ones exist.
    let cut = move |size: f64| (most - 1e-4 * size / 3600.0).max(0.0);
    let of = move |bench: &Bench, size: f64| -> Vec<f64> {
        let limit = 3600.0 * cut(size);
        let clipped = |r: f64| (3600.0 * r).clamp(-limit, limit) - 3600.0 * r;
        bench.motion.as_ref().map_or_else(Vec::new, |m| m.mean_of(|_, r| clipped(r)))
    };
    Effect::new("saturation", Shape::Bend(Box::new(of)), move |bench, size| {
        let limit = cut(size);
        let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
        let side = if high > -low { [limit.min(high) * 0.98, high] } else { [low, limit.max(low) * -0.98] };
        Facts::default()
            .at("input_rate", side[0], side[1])
            .at("input_rate", low, high)
            .with("limit_deg_s", limit)
    })
}

/// The other axis leaks in.
pub fn cross(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let course = bench.columns["outer_rate_deg_s"].iter().map(|r| sign * 3.6 * r).collect();
    let mut effect = Effect::new("cross_axis", Shape::Course(course), move |bench, size| {
        let [low, high] = range_of(&bench.columns["outer_rate_deg_s"]);
        Facts::default().at("outer_rate", low, high).with("misalignment_mrad", sign * size)
    });
    effect.column = Some("outer_rate_deg_s".to_owned());
    effect
}

/// Poles of the table's motor, once, twice or more often in each turn.
pub fn harmonic(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let order = *dice.one_of(&[1.0, 2.0, 3.0, 4.0, 6.0, 8.0]);
    let phase = dice.uniform(0.0, TAU);
    let course = bench
        .motion
        .as_ref()
        .map_or_else(Vec::new, |m| m.mean_of(|angle, _| (order * angle.to_radians() + phase).cos()));
    Effect::new("table_harmonic", Shape::Course(course), move |_, size| {
        Facts::default().at("angle", 0.0, 360.0).with("order", order).with("amplitude_deg_h", size)
    })
}

/// The claim has the heading wrong by some degrees.
pub fn heading(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let angle = bench.columns["table_angle_deg"].clone();
    let earth = bench.right.earth_deg.unwrap_or([0.0, 0.0]);
    let level = EARTH_DEG_H * earth[0].to_radians().cos();
    let off = move |size: f64| sign * (0.01 * size).min(120.0);
    let of = move |_: &Bench, size: f64| -> Vec<f64> {
        let projection = |a: f64| level * (a + earth[1]).to_radians().cos();
        angle.iter().map(|a| projection(a + off(size)) - projection(*a)).collect()
    };
    Effect::new("earth_rate_projection", Shape::Bend(Box::new(of)), move |_, size| {
        let amplitude = 2.0 * level * (off(size).abs().to_radians() / 2.0).sin();
        Facts::default().at("angle", 0.0, 360.0).with("amplitude_deg_h", amplitude)
    })
}

/// The phase ramp of a closed loop, set back by a little more or less than 2π whenever it has run through a period of the
/// sensed angle. What the reset misses is an error of angle that comes back with each period.
pub fn reset(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let most =
        rates(bench).iter().fold(0.0f64, |m, r| m.max(3600.0 * r.abs())) + bench.right.bias_deg_h.abs();
    // The ripple runs through the band of the recording, and folds over only where the table is fast.
    let period_arcsec = (most / bench.rate_hz / dice.decades(0.15, 1.0)).clamp(1.8, 200.0);
    let sign = dice.sign();
    let bias = bench.right.bias_deg_h;
    let rate_hz = bench.rate_hz;
    let turned = |bench: &Bench, edge: usize| {
        let time_s = edge as f64 / rate_hz;
        let table = bench.motion.as_ref().map_or(0.0, |m| 3600.0 * m.turned_at(time_s));
        table + bias * time_s
    };
    // Arcsec; the phase counts from -1/2 to 1/2, and what the reset misses is in proportion.
    let missed: Vec<f64> = (0..=bench.rows)
        .map(|edge| {
            let phase = turned(bench, edge) / period_arcsec;
            sign * (phase - phase.floor() - 0.5) * period_arcsec
        })
        .collect();
    let course = missed.windows(2).map(|w| (w[1] - w[0]) * rate_hz).collect();
    Effect::new("reset_ripple", Shape::Course(course), move |bench, _| {
        let [low, high] = range_of(&bench.columns["table_rate_deg_s"]);
        Facts::default()
            .at("angle", 0.97 * period_arcsec / 3600.0, 1.03 * period_arcsec / 3600.0)
            .at("input_rate", low, high)
            .with("period_arcsec", period_arcsec)
    })
}

fn late(kind: &'static str, late_s: impl Fn(f64, f64) -> f64 + 'static) -> Effect {
    let of = move |bench: &Bench, size: f64| -> Vec<f64> {
        let Some(motion) = &bench.motion else { return vec![0.0; bench.rows] };
        let shown = motion.rate_deg_s();
        let late = motion.late_rate_deg_s(|t| late_s(t, size));
        late.iter().zip(&shown).map(|(l, s)| 3600.0 * (l - s)).collect()
    };
    let sign = if kind == "time_offset" { 1e-5 } else { 0.01 };
    Effect::new(kind, Shape::Bend(Box::new(of)), move |bench, size| {
        let most = if kind == "time_offset" { 1e-5 * size } else { 1e-8 * size * bench.duration_s() };
        let name = if kind == "time_offset" { "lag_s" } else { "drift_ppm" };
        Facts::default()
            .at("lag", 0.5 * most.min(1.0), 1.5 * most)
            .at("time", 0.0, bench.duration_s())
            .with(name, sign * size)
    })
}

/// The gyro's clock is behind.
pub fn offset(_: &mut Bench) -> Effect {
    late("time_offset", |_, size| 1e-5 * size)
}

/// The gyro's clock loses.
pub fn drift(_: &mut Bench) -> Effect {
    late("clock_drift", |time_s, size| 1e-8 * size * time_s)
}
