//! Rate and temperatures over the whole recording, with what was left out.

use super::{axis, line};
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::i18n::Note;
use crate::noise::envelope::Envelope;
use crate::record::Window;

/// A channel to be drawn under the rate.
pub struct Below<'a> {
    /// Envelope of the channel.
    pub envelope: &'a Envelope,
    /// Key of the label of its axis.
    pub label: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Key of its legend.
    pub legend: &'static str,
    /// Band that it must keep: lowest and highest value.
    pub limits: Option<(f64, f64)>,
}

/// Draws a rate channel over time, in h from the start of the recording.
pub fn figure(
    id: String,
    channel: String,
    rate: &Envelope,
    below: &[Below<'_>],
    window: &Window,
    tau0_s: f64,
) -> Figure {
    let mut panels = vec![Panel {
        x: axis("axis.time", "s", Scale::Linear),
        y: axis("axis.rate", "deg/h", Scale::Linear),
        layers: layers(rate, window, tau0_s, Style::Data, "figure.legend.rate"),
    }];
    for other in below {
        let mut layers = layers(other.envelope, window, tau0_s, Style::SecondData, other.legend);
        if let Some((low, high)) = other.limits {
            for at in [low, high] {
                layers.push(Layer::Horizontal {
                    at,
                    style: Style::Limit,
                    legend: "figure.legend.limit".into(),
                });
            }
        }
        panels.push(Panel {
            x: axis("axis.time", "s", Scale::Linear),
            y: axis(other.label, other.unit, Scale::Linear),
            layers,
        });
    }
    let mut remarks = vec![];
    if rate.bin_len > 1 {
        let seconds = rate.bin_len as f64 * tau0_s;
        remarks.push(Note::new("figure.remark.averaged").with("seconds", seconds));
    }
    Figure { id, title: "figure.title.time_series".into(), channel, panels, remarks }
}

fn layers(
    envelope: &Envelope,
    window: &Window,
    tau0_s: f64,
    style: Style,
    legend: &'static str,
) -> Vec<Layer> {
    let mut layers: Vec<Layer> = window
        .excluded
        .iter()
        .filter(|span| span.reason != "gap" && span.reason != "pause")
        .map(|span| Layer::Span {
            from: span.from_s,
            to: span.to_s,
            style: Style::Muted,
            legend: "figure.legend.left_out".into(),
        })
        .collect();
    let middle =
        |i: usize| (envelope.first_index as f64 + (i as f64 + 0.5) * envelope.bin_len as f64 - 0.5) * tau0_s;
    let mut bins = envelope.bins.clone();
    // The mean of the few samples of a last span that is not full would stand out of the others.
    if let [.., last, rest] = bins.as_mut_slice()
        && 2 * rest.count < envelope.bin_len
        && last.count > 0
    {
        if rest.count > 0 {
            let (n, m) = (last.count as f64, rest.count as f64);
            last.mean = (n * last.mean + m * rest.mean) / (n + m);
            last.min = last.min.min(rest.min);
            last.max = last.max.max(rest.max);
        }
        bins.pop();
    }
    let range = bins.iter().enumerate().map(|(i, b)| (middle(i), b.min, b.max)).collect();
    let mean: Vec<(f64, f64)> = bins.iter().enumerate().map(|(i, b)| (middle(i), b.mean)).collect();
    // A range far wider than the means would hide them: white noise at a high rate says nothing here.
    if envelope.bin_len > 1 && median_range(envelope) < spread(&mean) {
        layers.push(Layer::Band { points: range, style, legend: "figure.legend.range".into() });
    }
    layers.push(line(mean, style, legend));
    layers
}

/// Median height of the range of a span.
fn median_range(envelope: &Envelope) -> f64 {
    let mut heights: Vec<f64> = envelope.bins.iter().filter(|b| b.count > 0).map(|b| b.max - b.min).collect();
    let middle = heights.len() / 2;
    if heights.is_empty() { 0.0 } else { *heights.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Range of the means.
fn spread(means: &[(f64, f64)]) -> f64 {
    let finite = means.iter().map(|m| m.1).filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    (high - low).max(0.0)
}
