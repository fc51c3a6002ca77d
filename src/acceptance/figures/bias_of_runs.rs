//! The bias of every switching-on with its interval, and the temperature of the runs.

use super::draw;
use crate::acceptance::interval_means::interval95;
use crate::figure::{Axis, Figure, Style};
use crate::influence::repeatability::Repeatability;

/// Draws the runs of a channel.
pub fn figure(found: &Repeatability, several: bool) -> Figure {
    let runs = || found.runs.iter().enumerate().map(|(i, r)| ((i + 1) as f64, r));
    let range = Some((0.5, found.runs.len() as f64 + 0.5));
    let mut layers = vec![];
    let s = found.deviation.0;
    if s > 0.0 {
        let ends = [0.5, found.runs.len() as f64 + 0.5];
        layers.push(draw::band(
            ends.iter().map(|x| (*x, found.mean - s, found.mean + s)).collect(),
            Style::Model,
            "figure_influence.deviation",
        ));
    }
    layers.push(draw::horizontal(found.mean, Style::Model, "figure_influence.mean"));
    let bars = runs().map(|(x, r)| (x, interval95(&r.bias).low, interval95(&r.bias).high));
    layers.push(draw::strokes(bars, Style::Data, "figure.legend.band95"));
    layers.push(draw::points(
        runs().map(|(x, r)| (x, r.bias.value)).collect(),
        Style::Data,
        "figure_influence.bias",
    ));
    let x = || Axis { range, ..draw::linear("figure_influence.axis_run", "") };
    let mut panels = vec![draw::panel(x(), draw::linear("figure_influence.axis_bias", "deg/h"), layers)];
    if found.runs.iter().all(|r| r.temperature.is_finite()) {
        let points: Vec<(f64, f64)> = runs().map(|(x, r)| (x, r.temperature)).collect();
        panels.push(draw::panel(
            x(),
            draw::linear("axis.temperature", "degC"),
            vec![draw::line(points, Style::SecondData, "figure.legend.temperature")],
        ));
    }
    draw::figure("bias_of_runs", "figure.title.bias_of_runs", &found.channel, several, panels, vec![])
}
