//! Variance that grows with the size of the input rate: σ² = σ₀² (1 + (ratio² − 1)(|Ω|/max)^q).

use super::gamma::{Group, mean_square};
use crate::numeric::optimize::{bisect, golden_section};

/// The law, fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateLaw {
    /// Deviation at the largest rate over that at zero.
    pub ratio: f64,
    /// q, 1 or 2.
    pub exponent: u8,
    /// Interval of the ratio by profile likelihood, 95 %.
    pub ci95: [f64; 2],
    /// Gain of log-likelihood over one level.
    pub gain: f64,
}

/// Bound of ln ratio.
const WIDEST: f64 = 5.0;

/// Fits the law to groups with mean |Ω| in `sizes`.
pub fn rate_law(groups: &[Group], sizes: &[f64], largest: f64) -> Option<RateLaw> {
    if largest <= 0.0 || groups.len() < 4 {
        return None;
    }
    let one = |exponent: u8| {
        let shares: Vec<f64> = sizes.iter().map(|s| (s / largest).powi(i32::from(exponent))).collect();
        let value = |log_ratio: f64| likelihood(groups, &shares, log_ratio);
        let steps = (0..=40).map(|i| WIDEST * (f64::from(i) / 20.0 - 1.0));
        let start = steps.max_by(|a, b| value(*a).total_cmp(&value(*b)))?;
        let at = golden_section(start - 0.25, start + 0.25, 40, |x| -value(x));
        let top = value(at);
        // χ²₁ at 95 % is 3.841.
        let end = |side: f64| crossing(value, at, side * 2.0 * WIDEST, top - 0.5 * 3.841_459);
        let ci95 = [end(-1.0).exp(), end(1.0).exp()];
        Some(RateLaw { ratio: at.exp(), exponent, ci95, gain: top - value(0.0) })
    };
    [one(1), one(2)].into_iter().flatten().max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// Log-likelihood with the level at zero rate at its best.
fn likelihood(groups: &[Group], shares: &[f64], log_ratio: f64) -> f64 {
    let excess = (2.0 * log_ratio).exp_m1();
    let factors: Vec<f64> = shares.iter().map(|s| (1.0 + excess * s).max(1e-12)).collect();
    let scaled: Vec<Group> =
        groups.iter().zip(&factors).map(|(g, f)| Group { square: g.square / f, dof: g.dof }).collect();
    let dof: f64 = groups.iter().map(|g| g.dof).sum();
    let logs: f64 = groups.iter().zip(&factors).map(|(g, f)| g.dof * f.ln()).sum();
    -0.5 * logs - 0.5 * dof * mean_square(&scaled).max(1e-300).ln()
}

/// Where the value falls to `down` between `at` and `at + reach`.
fn crossing(value: impl Fn(f64) -> f64, at: f64, reach: f64, down: f64) -> f64 {
    let outside = at + reach;
    if value(outside) > down {
        return outside;
    }
    bisect(at, outside, 50, |x| value(x) > down).inside
}
