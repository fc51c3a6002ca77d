//! The bias of every interval without and with an influence over time, and its change over the level.

use super::draw;
use crate::acceptance::interval_means::interval95;
use crate::figure::{Figure, Panel, Style};
use crate::influence::comparison::{Comparison, Effect, IntervalMean};
use crate::influence::{Influence, Law};

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
    let effects = [Some((&found.bias, false)), found.scale_factor.as_ref().map(|e| (e, true))];
    for (effect, of_scale_factor) in effects.into_iter().flatten() {
        let mut axes: Vec<&str> = effect.shifts.iter().map(|s| s.axis.as_str()).collect();
        axes.sort_by_key(|axis| effect.terms.iter().position(|t| t.axis == *axis));
        axes.dedup();
        panels.extend(axes.into_iter().map(|axis| over_level(found, effect, axis, of_scale_factor)));
    }
    draw::figure("influence", "figure.title.influence", &found.channel, several, panels, vec![])
}

/// Changes of bias or scale factor along one axis over the level, with the law through them.
fn over_level(found: &Comparison, effect: &Effect, axis: &str, of_scale_factor: bool) -> Panel {
    let setting = &found.test.setting;
    let own = || effect.shifts.iter().filter(|s| s.axis == axis);
    let reference = found.test.reference;
    let low = own().fold(reference, |m, s| m.min(s.level));
    let high = own().fold(reference, |m, s| m.max(s.level));
    let at = |i: usize| low + (high - low) * i as f64 / (CURVE_POINTS - 1) as f64;
    let value = |level: f64| {
        let terms = effect.terms.iter().filter(|t| t.axis == axis);
        terms.map(|t| t.per_unit.value * setting.law.drive(t.degree, level, reference)).sum::<f64>()
    };
    let label = match setting.influence {
        Influence::MagneticField => "figure_influence.axis_field",
        Influence::Supply => "axis.supply",
        Influence::Vibration => "figure_influence.axis_vibration",
        Influence::Declared => "figure_influence.axis_level",
    };
    let bars = own().map(|s| (s.level, interval95(&s.change).low, interval95(&s.change).high));
    let mut layers = vec![];
    if setting.law != Law::OnOff {
        let curve = (0..CURVE_POINTS).map(|i| (at(i), value(at(i)))).collect();
        layers.push(draw::line(curve, Style::Model, "figure.legend.model"));
    }
    layers.extend([
        draw::strokes(bars, Style::SecondData, "figure.legend.band95"),
        draw::points(
            own().map(|s| (s.level, s.change.value)).collect(),
            Style::SecondData,
            "figure_influence.shift",
        ),
    ]);
    if !axis.is_empty() {
        let text = crate::i18n::note!("figure_influence.axis_name", axis);
        layers.push(draw::label((high, 0.0), text));
    }
    let change = if of_scale_factor {
        draw::linear("figure_influence.axis_scale_factor", "ppm")
    } else {
        draw::linear("figure_influence.axis_change", "deg/h")
    };
    draw::panel(draw::linear(label, setting.level_unit()), change, layers)
}
