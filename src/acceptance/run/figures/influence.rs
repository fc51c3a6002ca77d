//! The bias of every interval without and with an influence over time, and its change over the level.

use super::{axis, line, strokes};
use crate::acceptance::run::interval_means::interval;
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::influence::comparison::{Comparison, IntervalMean};
use crate::influence::setup::Influence;

/// Points of a curve over the level.
const CURVE: usize = 61;

/// Draws the intervals of a channel, and a panel over the level for every axis.
pub fn figure(found: &Comparison, several: bool) -> Figure {
    let middle = |i: &IntervalMean| 0.5 * (i.span_s.0 + i.span_s.1) / 60.0;
    let mut layers = vec![];
    let kinds = [
        (true, Style::Data, "figure_influence.without"),
        (false, Style::SecondData, "figure_influence.with"),
    ];
    for (off, style, legend) in kinds {
        let of = || found.intervals.iter().filter(move |i| i.off == off);
        layers.push(strokes(of().map(|i| (middle(i), interval(&i.mean).0, interval(&i.mean).1)), style, ""));
        let points = of().map(|i| (middle(i), i.mean.value)).collect();
        layers.push(Layer::Points { points, style, legend: legend.into() });
    }
    let mut panels = vec![Panel {
        x: axis("axis.time", "min", Scale::Linear),
        y: axis("figure_influence.axis_change", "deg/h", Scale::Linear),
        layers,
    }];
    if found.intervals.iter().all(|i| i.temperature.is_finite()) {
        let points = found.intervals.iter().map(|i| (middle(i), i.temperature)).collect();
        panels.push(Panel {
            x: axis("axis.time", "min", Scale::Linear),
            y: axis("axis.temperature", "degC", Scale::Linear),
            layers: vec![line(points, Style::SecondData, "figure.legend.temperature")],
        });
    }
    panels.extend(found.axes.iter().enumerate().map(|(k, name)| over_level(found, k, name)));
    Figure {
        id: if several { format!("influence_{}", found.channel) } else { "influence".to_owned() },
        title: "figure.title.influence".into(),
        channel: if several { found.channel.clone() } else { String::new() },
        panels,
        remarks: vec![],
    }
}

fn over_level(found: &Comparison, k: usize, name: &str) -> Panel {
    let influence = found.test.influence;
    let own = || found.shifts.iter().filter(|s| s.axis == name);
    let reference = found.test.reference;
    let low = own().fold(reference, |m, s| m.min(s.level));
    let high = own().fold(reference, |m, s| m.max(s.level));
    let at = |i: usize| low + (high - low) * i as f64 / (CURVE - 1) as f64;
    let drive = |l: f64| influence.drive(l) - influence.drive(reference);
    let curve = (0..CURVE).map(|i| (at(i), found.per_unit[k].value * drive(at(i)))).collect();
    let label = match influence {
        Influence::MagneticField => "figure_influence.axis_field",
        Influence::Supply => "axis.supply",
        Influence::Vibration => "figure_influence.axis_vibration",
    };
    let bars = own().map(|s| (s.level, interval(&s.change).0, interval(&s.change).1));
    let mut layers = vec![
        line(curve, Style::Model, "figure.legend.model"),
        strokes(bars, Style::SecondData, "figure.legend.band95"),
        Layer::Points {
            points: own().map(|s| (s.level, s.change.value)).collect(),
            style: Style::SecondData,
            legend: "figure_influence.shift".into(),
        },
    ];
    if !name.is_empty() {
        let text = crate::i18n::Note::new("figure_influence.axis_name").with("axis", name);
        layers.push(Layer::Label { at: (high, 0.0), text });
    }
    Panel {
        x: axis(label, influence.unit(), Scale::Linear),
        y: axis("figure_influence.axis_change", "deg/h", Scale::Linear),
        layers,
    }
}
