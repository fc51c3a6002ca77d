//! Distribution of what the model leaves, against the normal one; logarithmic, so that the tails show.

use super::draw;
use crate::figure::{Figure, Style};
use crate::i18n::{Arg, note};
use crate::measurand::GyroEvidence;

/// Width of a bar in standard deviations.
const BAR_WIDTH_SIGMAS: f64 = 0.25;
/// Bars on each side of zero; what lies beyond is in the last one.
const BARS_PER_SIDE: usize = 32;

/// Draws the distribution; `None` where the record is too short for a residual.
pub fn figure(gyro: &GyroEvidence) -> Option<Figure> {
    let whitened = gyro.goodness.whitened.as_ref()?;
    let amplitude = gyro.goodness.amplitude.as_ref()?;
    let n = whitened.values.len() as f64;
    let sigma = (whitened.values.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
    if !(sigma > 0.0 && sigma.is_finite()) {
        return None;
    }
    let mut counts = vec![0u64; 2 * BARS_PER_SIDE];
    for v in &whitened.values {
        let at = (v / sigma / BAR_WIDTH_SIGMAS).floor() + BARS_PER_SIDE as f64;
        let at = at.clamp(0.0, (2 * BARS_PER_SIDE - 1) as f64) as usize;
        if let Some(count) = counts.get_mut(at) {
            *count += 1;
        }
    }
    let edge = |i: usize| (i as f64 - BARS_PER_SIDE as f64) * BAR_WIDTH_SIGMAS;
    let bars = counts
        .iter()
        .enumerate()
        .filter(|(_, c)| **c > 0)
        .map(|(i, c)| (edge(i), edge(i + 1), *c as f64))
        .collect();
    let peak = n * BAR_WIDTH_SIGMAS / (2.0 * std::f64::consts::PI).sqrt();
    // The curve ends where less than half a value is expected.
    let normal = (-160..=160)
        .map(|i| f64::from(i) / 20.0)
        .map(|z| (z, peak * (-0.5 * z * z).exp()))
        .filter(|(_, y)| *y >= 0.5)
        .collect();
    let number = |v: f64| Arg::Figures { value: v, digits: 3, zeros: false };
    Some(draw::figure(
        "residual",
        "figure.title.residual",
        &gyro.channel,
        gyro.several,
        vec![draw::panel(
            draw::linear("figure.fit.residual", ""),
            draw::log("figure.fit.values", ""),
            vec![
                draw::bars(bars, Style::Data, "figure.fit.whitened"),
                draw::line(normal, Style::Model, "figure.legend.normal"),
            ],
        )],
        vec![note!(
            "figure.fit.residual_moments",
            n = amplitude.values,
            seconds = whitened.step_s,
            skewness = number(amplitude.skewness),
            kurtosis = number(amplitude.excess_kurtosis),
            beyond = amplitude.beyond,
            expected = number(amplitude.expected_beyond)
        )],
    ))
}
