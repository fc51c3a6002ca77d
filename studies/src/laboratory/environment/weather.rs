//! Weather: fronts as random processes of some days that move pressure, temperature and humidity together; gusts and a day.

use super::span::Span;
use crate::laboratory::dice::Dice;
use crate::laboratory::process::relaxation;
use std::f64::consts::TAU;

/// Courses of the weather.
pub struct Weather {
    /// Pressure at the site, hPa.
    pub pressure_hpa: Vec<f64>,
    /// Air outside, °C.
    pub outside_deg_c: Vec<f64>,
    /// Relative humidity, %.
    pub humidity_pct: Vec<f64>,
}

/// A front: a slow variable whose rate of change is itself correlated over hours, drawn back to its mean within days.
fn front(dice: &mut Dice, span: &Span, memory_h: f64, days: f64) -> Vec<f64> {
    let memory_s = memory_h * 3600.0;
    let push = relaxation(dice, span.length, span.step_s, memory_s, 1.0);
    let pull_s = days * 86_400.0;
    // The spread of the slow variable of such a pair is √(pull·memory·pull/(pull + memory)) times that of its rate.
    let spread = (pull_s * memory_s * pull_s / (pull_s + memory_s)).sqrt();
    let mut at = spread * dice.normal();
    push.iter()
        .map(|p| {
            at += span.step_s * (p - at / pull_s);
            at / spread
        })
        .collect()
}

/// Weather over a span.
pub fn weather(dice: &mut Dice, span: &Span) -> Weather {
    let memory = dice.uniform(2.0, 8.0);
    let days = dice.uniform(1.2, 4.0);
    let shared = front(dice, span, memory, days);
    let own = front(dice, span, 4.0, 2.0);
    let damp = front(dice, span, 3.0, 1.0);
    let gust_s = dice.decades(20.0, 300.0);
    let gust_hpa = dice.decades(0.01, 0.08);
    let gusts = relaxation(dice, span.length, span.step_s, gust_s, gust_hpa);
    let (mean, deep) = (dice.uniform(985.0, 1022.0), dice.uniform(5.0, 11.0));
    let (warm, swing) = (dice.uniform(-5.0, 22.0), dice.uniform(1.0, 6.0));
    let peak_hour = dice.uniform(13.5, 16.0);
    let tide = dice.uniform(0.3, 1.0);
    let outside = |i: usize| {
        let day = (TAU * (span.hour(i) - peak_hour) / 24.0).cos();
        // The night is flatter than the day.
        warm + swing * (day + 0.2 * (2.0 * TAU * (span.hour(i) - peak_hour) / 24.0).cos()) - 2.2 * shared[i]
            + 1.5 * own[i]
    };
    Weather {
        pressure_hpa: (0..span.length)
            .map(|i| {
                mean + deep * shared[i] + gusts[i] + tide * (2.0 * TAU * (span.hour(i) - 10.0) / 24.0).cos()
            })
            .collect(),
        outside_deg_c: (0..span.length).map(outside).collect(),
        humidity_pct: (0..span.length)
            .map(|i| (55.0 - 1.2 * (outside(i) - warm) - 6.0 * shared[i] + 7.0 * damp[i]).clamp(12.0, 99.0))
            .collect(),
    }
}
