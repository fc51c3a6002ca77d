//! The parts that figures are drawn from, a call each. A legend is the key of its words; an empty one is not shown.

use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::i18n::Note;

/// A figure of a channel. Its id is the stem, with the channel where there are several.
pub fn figure(
    stem: &str,
    title: &'static str,
    channel: &str,
    several: bool,
    panels: Vec<Panel>,
    remarks: Vec<Note>,
) -> Figure {
    Figure {
        id: if several { format!("{stem}_{channel}") } else { stem.to_owned() },
        title: title.into(),
        channel: if several { channel.to_owned() } else { String::new() },
        panels,
        remarks,
    }
}

/// A panel with its axes.
pub fn panel(x: Axis, y: Axis, layers: Vec<Layer>) -> Panel {
    Panel { x, y, layers }
}

/// A linear axis.
pub fn linear(label: &'static str, unit: &str) -> Axis {
    axis(label, unit, Scale::Linear)
}

/// A logarithmic axis.
pub fn log(label: &'static str, unit: &str) -> Axis {
    axis(label, unit, Scale::Log)
}

/// An axis of a polar plot.
pub fn polar(label: &'static str, unit: &str) -> Axis {
    axis(label, unit, Scale::Polar)
}

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

/// A line through points (x, y).
pub fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.to_owned() }
}

/// Marks at points (x, y).
pub fn points(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Points { points, style, legend: legend.to_owned() }
}

/// A band: (x, low, high).
pub fn band(points: Vec<(f64, f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Band { points, style, legend: legend.to_owned() }
}

/// Intervals as upright strokes: (x, low, high).
pub fn strokes(intervals: impl Iterator<Item = (f64, f64, f64)>, style: Style, legend: &str) -> Layer {
    line(intervals.flat_map(|(x, low, high)| [(x, low), (x, high), (x, f64::NAN)]).collect(), style, legend)
}

/// Bars: (from, to, height).
pub fn bars(bars: Vec<(f64, f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Bars { bars, style, legend: legend.to_owned() }
}

/// A line across the panel.
pub fn horizontal(at: f64, style: Style, legend: &str) -> Layer {
    Layer::Horizontal { at, style, legend: legend.to_owned() }
}

/// A shaded range of x.
pub fn span(from: f64, to: f64, style: Style, legend: &str) -> Layer {
    Layer::Span { from, to, style, legend: legend.to_owned() }
}

/// Words at a point (x, y).
pub fn label(at: (f64, f64), text: Note) -> Layer {
    Layer::Label { at, text }
}
