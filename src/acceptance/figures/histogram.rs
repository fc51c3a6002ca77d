//! Distribution of the samples about their local mean, against the normal one.

use super::draw;
use crate::figure::{Figure, Style};
use crate::i18n::note;
use crate::measurand::GyroEvidence;

/// Draws the histogram; `None` when the channel never changes.
pub fn figure(gyro: &GyroEvidence) -> Option<Figure> {
    let h = &gyro.digest.histogram;
    let sigma = h.standard_deviation;
    if h.samples == 0 || !(sigma > 0.0 && h.bin_width > 0.0) {
        return None;
    }
    let first = h.counts.iter().position(|c| *c > 0)?;
    let last = h.counts.iter().rposition(|c| *c > 0)?;
    let share = 100.0 / h.samples as f64;
    let bars: Vec<(f64, f64, f64)> = h
        .counts
        .iter()
        .enumerate()
        .skip(first)
        .take(last + 1 - first)
        .map(|(i, c)| {
            let from = h.from + i as f64 * h.bin_width;
            (from, from + h.bin_width, *c as f64 * share)
        })
        .collect();
    let peak = 100.0 * h.bin_width / (sigma * (2.0 * std::f64::consts::PI).sqrt());
    let normal =
        (-90..=90).map(|i| f64::from(i) / 20.0).map(|z| (z * sigma, peak * (-0.5 * z * z).exp())).collect();
    Some(draw::figure(
        "histogram",
        "figure.title.histogram",
        &gyro.channel,
        gyro.several,
        vec![draw::panel(
            draw::linear("axis.deviation", "deg/h"),
            draw::linear("axis.share", "%"),
            vec![
                draw::bars(bars, Style::Data, "figure.legend.data"),
                draw::line(normal, Style::Model, "figure.legend.normal"),
            ],
        )],
        vec![note!(
            "figure.remark.moments",
            sigma,
            skewness = h.skewness,
            kurtosis = h.excess_kurtosis,
            n = h.samples
        )],
    ))
}
