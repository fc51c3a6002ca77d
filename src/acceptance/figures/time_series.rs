//! Rate, temperatures and supplies over the whole recording, with what was left out.

use super::draw;
use crate::acceptance::condition::stability_track::Band;
use crate::acceptance::test_kind::Reading;
use crate::figure::{Figure, Layer, Panel, Style};
use crate::i18n::{Note, note};
use crate::noise::envelope::Envelope;
use crate::record::Window;
use crate::recording::Role;

/// Every gyro channel, for tests that are not evaluated sample by sample.
pub(in crate::acceptance) fn of_every_gyro(reading: &Reading<'_>) -> Vec<Figure> {
    let several = reading.gyros().count() > 1;
    reading.gyros().filter_map(|(_, channel)| of_channel(reading, &channel.id, several)).collect()
}

/// One gyro channel, where the report asks for it. `several`: the figure names its channel.
pub(in crate::acceptance) fn of_channel(
    reading: &Reading<'_>,
    channel: &str,
    several: bool,
) -> Option<Figure> {
    let wanted = |id: &str| reading.procedure().report.shows(id);
    if !wanted("rate") && !wanted("temperature") {
        return None;
    }
    let slot = reading.channels.iter().position(|c| c.id == channel)?;
    let below = if wanted("temperature") { lower_panels(reading) } else { vec![] };
    let rate = reading.envelopes.get(&slot)?;
    let (panels, remarks) = panels(rate, &below, &reading.window, reading.tau0_s);
    Some(draw::figure("time_series", "figure.title.time_series", channel, several, panels, remarks))
}

/// The other channels drawn under the rate, with the bands that they must keep.
fn lower_panels<'a>(reading: &'a Reading<'_>) -> Vec<LowerPanel<'a>> {
    let conditions = &reading.procedure().conditions;
    let mut list = Vec::new();
    for (slot, channel) in reading.channels.iter().enumerate() {
        let Some(envelope) = reading.envelopes.get(&slot) else { continue };
        let (label, unit, legend, limits) = match channel.role {
            Role::Temperature => {
                let condition = conditions.temperatures.iter().find(|c| c.channel == channel.id);
                let limits = condition.map(|c| Band::about(c.nominal_deg_c, c.tolerance_deg_c));
                ("axis.temperature", "degC", "figure.legend.temperature", limits)
            }
            Role::Supply => {
                let condition = conditions.supplies.iter().find(|c| c.channel == channel.id);
                let limits = condition.map(|c| Band::about(c.nominal_v, c.tolerance_v));
                ("axis.supply", "V", "figure.legend.supply", limits)
            }
            _ => continue,
        };
        list.push(LowerPanel { envelope, label, unit, legend, limits });
    }
    list
}

/// A channel to be drawn under the rate.
struct LowerPanel<'a> {
    /// Envelope of the channel.
    envelope: &'a Envelope,
    /// Key of the label of its axis.
    label: &'static str,
    /// Unit.
    unit: &'static str,
    /// Key of its legend.
    legend: &'static str,
    /// Band that it must keep.
    limits: Option<Band>,
}

/// The rate over time, in s from the start of the recording, and what is drawn below.
fn panels(
    rate: &Envelope,
    below: &[LowerPanel<'_>],
    window: &Window,
    tau0_s: f64,
) -> (Vec<Panel>, Vec<Note>) {
    let mut panels = vec![draw::panel(
        draw::linear("axis.time", "s"),
        draw::linear("axis.rate", "deg/h"),
        layers(rate, window, tau0_s, Style::Data, "figure.legend.rate"),
    )];
    for other in below {
        let mut layers = layers(other.envelope, window, tau0_s, Style::SecondData, other.legend);
        if let Some(Band { low, high }) = other.limits {
            for at in [low, high] {
                layers.push(draw::horizontal(at, Style::Limit, "figure.legend.limit"));
            }
        }
        panels.push(draw::panel(
            draw::linear("axis.time", "s"),
            draw::linear(other.label, other.unit),
            layers,
        ));
    }
    let mut remarks = vec![];
    if rate.bin_len > 1 {
        let seconds = rate.bin_len as f64 * tau0_s;
        remarks.push(note!("figure.remark.averaged", seconds));
    }
    (panels, remarks)
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
        .map(|span| draw::span(span.from_s, span.to_s, Style::Muted, "figure.legend.left_out"))
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
        layers.push(draw::band(range, style, "figure.legend.range"));
    }
    layers.push(draw::line(mean, style, legend));
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
