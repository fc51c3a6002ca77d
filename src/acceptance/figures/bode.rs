//! Gain and phase of the response over frequency with the model.

use super::draw;
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::figure::{Figure, Style};
use crate::rate_table::transfer::{Band, Transfer, decibel};

/// Points of a model curve.
const CURVE_POINTS: u32 = 200;

/// Level that the bandwidth is read at, 20·log10(1/√2), dB.
const BANDWIDTH_LEVEL_DB: f64 = -3.0103;

/// Draws the response of a channel.
pub fn figure(found: &Transfer, several: bool) -> Figure {
    let points = |of: &dyn Fn(&Band) -> f64| {
        found.bands.iter().map(|b| (b.frequency_hz, of(b))).collect::<Vec<(f64, f64)>>()
    };
    let intervals = |of: &dyn Fn(&Band) -> f64, scale: f64| {
        let half = |b: &Band| SCORE_TWO_SIDED_95 * scale * b.standard;
        let ends = |b: &Band| (b.frequency_hz, of(b) - half(b), of(b) + half(b));
        found.bands.iter().map(ends).collect::<Vec<(f64, f64, f64)>>()
    };
    let (first, last) = match (found.bands.first(), found.bands.last()) {
        (Some(first), Some(last)) => (first.frequency_hz, last.frequency_hz),
        _ => (1.0, 1.0),
    };
    let frequencies: Vec<f64> = (0..=CURVE_POINTS)
        .map(|i| first * (last / first).powf(f64::from(i) / f64::from(CURVE_POINTS)))
        .collect();
    let curve = |of: &dyn Fn(f64) -> f64| frequencies.iter().map(|f| (*f, of(*f))).collect::<Vec<_>>();
    let model = found.best().map(|f| &f.model);
    let gain_of_model = curve(&|f| model.map_or(f64::NAN, |m| decibel(m.shape(f).norm().ln())));
    let phase_of_model = curve(&|f| model.map_or(f64::NAN, |m| m.phase(f).to_degrees()));
    let gain = |b: &Band| decibel(b.log_gain);
    let phase = |b: &Band| b.phase.to_degrees();
    let layers = |points, intervals, model, level: (f64, &'static str)| {
        vec![
            draw::band(intervals, Style::Data, "figure.legend.band95"),
            draw::line(model, Style::Model, "figure.legend.model"),
            draw::points(points, Style::Data, "figure.legend.response"),
            draw::horizontal(level.0, Style::Reference, level.1),
        ]
    };
    let of_gain = layers(
        points(&gain),
        intervals(&gain, decibel(1.0)),
        gain_of_model,
        (BANDWIDTH_LEVEL_DB, "figure.legend.minus_3_db"),
    );
    let of_phase = layers(
        points(&phase),
        intervals(&phase, 1f64.to_degrees()),
        phase_of_model,
        (-90.0, "figure.legend.minus_90"),
    );
    let frequency = || draw::log("axis.frequency", "Hz");
    draw::figure(
        "bode",
        "figure.title.bode",
        &found.channel,
        several,
        vec![
            draw::panel(frequency(), draw::linear("axis.gain", "dB"), of_gain),
            draw::panel(frequency(), draw::linear("axis.phase", "deg"), of_phase),
        ],
        vec![],
    )
}
