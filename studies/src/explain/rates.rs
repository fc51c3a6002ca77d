//! Contributions that follow the table's rates, and faults of the time between gyro and table.

use super::draw::Draw;
use super::effect::{Effect, means, unit};
use super::profile::Profile;
use super::setting::Setting;
use super::slow::range;

fn table(s: &Setting) -> &Profile {
    s.drivers.table.as_ref().expect("a scenario with table rate")
}

/// Largest rate of the table, deg/s.
pub fn top(s: &Setting) -> f64 {
    s.time_s.iter().map(|&t| table(s).at(t).abs()).fold(0.0, f64::max)
}

fn over_rate(effect: Effect, s: &Setting) -> Effect {
    let (low, high) = range(&s.time_s.iter().map(|&t| table(s).at(t)).collect::<Vec<_>>());
    effect.found("input_rate", low, high).found_in_time(s)
}

/// Rows of a function of the momentary rate, deg/s, in deg/h.
fn of_rate(s: &Setting, f: impl Fn(f64) -> f64) -> Vec<f64> {
    means(s, |t| 3600.0 * f(table(s).at(t)))
}

/// ppm at the largest rate that white noise alone would show clearly.
fn ppm(s: &Setting, a: f64) -> f64 {
    1e6 * a * unit(s) / (3600.0 * top(s))
}

/// Another factor.
pub fn sf_error(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let error = draw.sign() * ppm(s, a);
    let course = of_rate(s, |w| 1e-6 * error * w);
    // What the engineer's uncertainty moved is beyond the claim as well.
    over_rate(Effect::of("sf_error").with("error_ppm", error + s.departure.scale_ppm).adding(course), s)
}

/// Another factor for one sense.
pub fn sf_asymmetry(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let asymmetry = draw.sign() * 2.0 * ppm(s, a);
    let course = of_rate(s, |w| 0.5e-6 * asymmetry * w.abs());
    over_rate(Effect::of("sf_asymmetry").with("asymmetry_ppm", asymmetry).adding(course), s)
}

/// A cubic.
pub fn sf_nonlinearity(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let (cubic, most) = (draw.sign() * ppm(s, a), top(s));
    let course = of_rate(s, |w| 1e-6 * cubic * w * (w / most).powi(2));
    over_rate(Effect::of("sf_nonlinearity").with("cubic_ppm_at_max", cubic).adding(course), s)
}

/// A factor that follows temperature.
pub fn sf_temperature(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let thermal = s.drivers.any_thermal().expect("a scenario with temperature");
    let reference = s.claim.temperature.map_or(20.0, |(_, reference)| reference);
    let (low, high) = range(&s.time_s.iter().map(|&t| thermal.at(t)).collect::<Vec<_>>());
    let coefficient = draw.sign() * ppm(s, a) / (high - low);
    let course = means(s, |t| 3.6e-3 * coefficient * (thermal.at(t) - reference) * table(s).at(t));
    let effect = Effect::of("sf_temperature").with("coefficient_ppm_per_degC", coefficient).adding(course);
    over_rate(effect.found("temperature", low, high), s)
}

/// No response around zero: with a gap, or with a threshold taken off.
pub fn dead_zone(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let half = 3600.0 * top(s) * (0.05 * a).min(0.5);
    let gap = draw.chance(0.5);
    let response = |w: f64| {
        let h = half / 3600.0;
        match (w.abs() < h, gap) {
            (true, _) => -w,
            (false, true) => 0.0,
            (false, false) => -h * w.signum(),
        }
    };
    let course = of_rate(s, response);
    let effect = Effect::of("dead_zone").with("half_width_deg_h", half).adding(course);
    let h = half / 3600.0;
    effect.found("input_rate", -h, h).found_in_time(s)
}

/// No response beyond a limit.
pub fn saturation(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let most = top(s);
    let limit = most * (1.0 - (0.03 * a * draw.uniform(0.5, 1.0)).min(0.3));
    let course = of_rate(s, |w| w.clamp(-limit, limit) - w);
    let mut effect = Effect::of("saturation").with("limit_deg_s", limit).adding(course);
    let (low, high) = range(&s.time_s.iter().map(|&t| table(s).at(t)).collect::<Vec<_>>());
    if high > limit {
        effect = effect.found("input_rate", limit, high);
    }
    if low < -limit {
        effect = effect.found("input_rate", low, -limit);
    }
    effect.found_in_time(s)
}

/// The other axis is felt.
pub fn cross_axis(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let outer = s.drivers.outer.as_ref().expect("a scenario with the other axis");
    let rate: Vec<f64> = s.time_s.iter().map(|&t| outer.mean(t, s.interval_s())).collect();
    let (low, high) = range(&rate);
    let mrad = draw.sign() * a * unit(s) / (3.6 * high.abs().max(low.abs()));
    let course = rate.iter().map(|r| 3.6 * mrad * r).collect();
    Effect::of("cross_axis")
        .with("misalignment_mrad", mrad)
        .adding(course)
        .found("outer_rate", low, high)
        .found_in_time(s)
}

fn late(s: &Setting, lag: impl Fn(f64) -> f64) -> Vec<f64> {
    s.known(lag).iter().zip(s.known(|_| 0.0)).map(|(late, now)| late - now).collect()
}

/// The gyro comes late by the same time always.
pub fn time_offset(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let lag_s = draw.sign() * a * s.interval_s();
    let course = late(s, |_| lag_s);
    let around = (0.5 * lag_s.abs()).max(0.5 * s.interval_s());
    Effect::of("time_offset")
        .with("lag_s", lag_s)
        .adding(course)
        .found("lag", lag_s - around, lag_s + around)
        .found("lag", -lag_s - around, -lag_s + around)
        .found_in_time(s)
        .found("timestamps", 0.0, s.duration_s())
}

/// The gyro comes later and later.
pub fn clock_drift(draw: &mut Draw, s: &Setting, a: f64) -> Effect {
    let total_s = draw.sign() * a * s.interval_s();
    let drift = total_s / s.duration_s();
    let course = late(s, |t| drift * t);
    Effect::of("clock_drift")
        .with("drift_ppm", 1e6 * drift)
        .adding(course)
        .found("lag", total_s.min(0.0), total_s.max(0.0))
        .found("lag", (-total_s).min(0.0), (-total_s).max(0.0))
        .found_in_time(s)
        .found("timestamps", 0.0, s.duration_s())
}
