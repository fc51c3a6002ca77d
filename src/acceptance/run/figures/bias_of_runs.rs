//! The bias of every switching-on with its interval, and the temperature of the runs.

use super::{axis, line, strokes};
use crate::acceptance::run::interval_means::interval;
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::influence::repeatability::Repeatability;

/// Draws the runs of a channel.
pub fn figure(found: &Repeatability, several: bool) -> Figure {
    let runs = || found.runs.iter().enumerate().map(|(i, r)| ((i + 1) as f64, r));
    let range = Some((0.5, found.runs.len() as f64 + 0.5));
    let mut layers = vec![];
    let s = found.deviation.0;
    if s > 0.0 {
        let ends = [0.5, found.runs.len() as f64 + 0.5];
        layers.push(Layer::Band {
            points: ends.iter().map(|x| (*x, found.mean - s, found.mean + s)).collect(),
            style: Style::Model,
            legend: "figure_influence.deviation".into(),
        });
    }
    layers.push(Layer::Horizontal {
        at: found.mean,
        style: Style::Model,
        legend: "figure_influence.mean".into(),
    });
    let bars = runs().map(|(x, r)| (x, interval(&r.bias).0, interval(&r.bias).1));
    layers.push(strokes(bars, Style::Data, "figure.legend.band95"));
    layers.push(Layer::Points {
        points: runs().map(|(x, r)| (x, r.bias.value)).collect(),
        style: Style::Data,
        legend: "figure_influence.bias".into(),
    });
    let x = || crate::figure::Axis { range, ..axis("figure_influence.axis_run", "", Scale::Linear) };
    let mut panels =
        vec![Panel { x: x(), y: axis("figure_influence.axis_bias", "deg/h", Scale::Linear), layers }];
    if found.runs.iter().all(|r| r.temperature.is_finite()) {
        let points: Vec<(f64, f64)> = runs().map(|(x, r)| (x, r.temperature)).collect();
        panels.push(Panel {
            x: x(),
            y: axis("axis.temperature", "degC", Scale::Linear),
            layers: vec![line(points, Style::SecondData, "figure.legend.temperature")],
        });
    }
    Figure {
        id: if several { format!("bias_of_runs_{}", found.channel) } else { "bias_of_runs".to_owned() },
        title: "figure.title.bias_of_runs".into(),
        channel: if several { found.channel.clone() } else { String::new() },
        panels,
        remarks: vec![],
    }
}
