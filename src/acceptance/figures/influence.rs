//! The bias of every interval without and with an influence over time, and its change over the level.

use super::draw;
use crate::acceptance::interval_means::interval95;
use crate::figure::{Figure, Panel, Style};
use crate::influence::comparison::{Comparison, IntervalMean};
use crate::influence::setup::Influence;

/// Points of a curve over the level.
const CURVE_POINTS: usize = 61;

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
        layers.push(draw::strokes(
            of().map(|i| (middle(i), interval95(&i.mean).low, interval95(&i.mean).high)),
            style,
            "",
        ));
        let points = of().map(|i| (middle(i), i.mean.value)).collect();
        layers.push(draw::points(points, style, legend));
    }
    let mut panels = vec![draw::panel(
        draw::linear("axis.time", "min"),
        draw::linear("figure_influence.axis_change", "deg/h"),
        layers,
    )];
    if found.intervals.iter().all(|i| i.temperature.is_finite()) {
        let points = found.intervals.iter().map(|i| (middle(i), i.temperature)).collect();
        panels.push(draw::panel(
            draw::linear("axis.time", "min"),
            draw::linear("axis.temperature", "degC"),
            vec![draw::line(points, Style::SecondData, "figure.legend.temperature")],
        ));
    }
    panels.extend(found.axes.iter().enumerate().map(|(k, name)| over_level(found, k, name)));
    draw::figure("influence", "figure.title.influence", &found.channel, several, panels, vec![])
}

fn over_level(found: &Comparison, k: usize, name: &str) -> Panel {
    let influence = found.test.influence;
    let own = || found.shifts.iter().filter(|s| s.axis == name);
    let reference = found.test.reference;
    let low = own().fold(reference, |m, s| m.min(s.level));
    let high = own().fold(reference, |m, s| m.max(s.level));
    let at = |i: usize| low + (high - low) * i as f64 / (CURVE_POINTS - 1) as f64;
    let drive = |l: f64| influence.drive(l) - influence.drive(reference);
    let curve = (0..CURVE_POINTS).map(|i| (at(i), found.per_unit[k].value * drive(at(i)))).collect();
    let label = match influence {
        Influence::MagneticField => "figure_influence.axis_field",
        Influence::Supply => "axis.supply",
        Influence::Vibration => "figure_influence.axis_vibration",
    };
    let bars = own().map(|s| (s.level, interval95(&s.change).low, interval95(&s.change).high));
    let mut layers = vec![
        draw::line(curve, Style::Model, "figure.legend.model"),
        draw::strokes(bars, Style::SecondData, "figure.legend.band95"),
        draw::points(
            own().map(|s| (s.level, s.change.value)).collect(),
            Style::SecondData,
            "figure_influence.shift",
        ),
    ];
    if !name.is_empty() {
        let text = crate::i18n::note!("figure_influence.axis_name", axis = name);
        layers.push(draw::label((high, 0.0), text));
    }
    draw::panel(
        draw::linear(label, influence.unit()),
        draw::linear("figure_influence.axis_change", "deg/h"),
        layers,
    )
}
