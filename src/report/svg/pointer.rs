//! What a pointer reads off a figure: the values behind the drawing, for the script of a page.

use super::axis::Ruled;
use super::layer::Plot;
use super::layout::{Canvas, Layout};
use super::style::look;
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::i18n::{Lang, lookup};
use serde::Serialize;

/// A figure as the script reads it. Lengths are in px of the view box.
#[derive(Debug, Serialize)]
struct Readings<'a> {
    /// How numbers are printed.
    number: Print,
    panels: Vec<PanelReadings<'a>>,
}

/// Decimal mark, mark between groups, words before a power of ten.
#[derive(Debug, Serialize)]
struct Print {
    decimal: &'static str,
    group: &'static str,
    times: &'static str,
}

/// A panel: its frame (left, top, width, height), its axes, what is read off.
#[derive(Debug, Serialize)]
struct PanelReadings<'a> {
    frame: [f64; 4],
    x: Scaled<'a>,
    y: Scaled<'a>,
    series: Vec<Series>,
}

/// An axis: range in the unit of the data, and the unit of what is read off.
#[derive(Debug, Serialize)]
struct Scaled<'a> {
    log: bool,
    range: (f64, f64),
    name: &'a str,
    unit: &'a str,
    per: f64,
}

/// One entry of the legend.
#[derive(Debug, Serialize)]
struct Series {
    name: String,
    colour: &'static str,
    kind: Kind,
    /// Numbers one after the other: x, y of points; x, low, high of bands; from, to, height of bars; one level.
    at: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Line,
    Points,
    Band,
    Bars,
    Level,
}

/// The readings of a figure as JSON; empty where nothing can be read off.
pub(crate) fn readings(figure: &Figure, lang: Lang) -> String {
    let layout = Layout::new(figure, Canvas::Page, lang);
    let legends = layout.legends(figure, lang);
    let (plots, _) = layout.plots(figure, &legends);
    let drawn = figure.panels.iter().zip(&plots).filter(|(panel, _)| panel.x.scale != Scale::Polar);
    let panels: Vec<PanelReadings<'_>> = drawn
        .map(|(panel, plot)| PanelReadings {
            frame: [plot.left, plot.top, plot.width, plot.height].map(rounded),
            x: scaled(plot.x),
            y: scaled(plot.y),
            series: series(panel, plot, lang),
        })
        .collect();
    if panels.iter().all(|p| p.series.is_empty()) {
        return String::new();
    }
    let word = |key, otherwise| lookup(lang, key).unwrap_or(otherwise);
    let number = Print {
        decimal: word("number.decimal", "."),
        group: word("number.group", "\u{202f}"),
        times: word("number.times", "×10"),
    };
    serde_json::to_string(&Readings { number, panels }).unwrap_or_default()
}

fn scaled(axis: &Ruled) -> Scaled<'_> {
    let reading = &axis.reading;
    Scaled {
        log: axis.is_log(),
        range: axis.range(),
        name: &reading.name,
        unit: &reading.unit,
        per: reading.per,
    }
}

/// Series with a name in the legend, each once.
fn series(panel: &Panel, plot: &Plot<'_>, lang: Lang) -> Vec<Series> {
    let mut out: Vec<Series> = vec![];
    for layer in &panel.layers {
        let Some((legend, style, kind, at)) = values(layer, plot) else { continue };
        if legend.is_empty() || at.is_empty() {
            continue;
        }
        let name = lookup(lang, legend).unwrap_or(legend).to_owned();
        let colour = look(style).colour;
        // The points of a line have been read with the line; limits of one name may lie at several levels.
        let same = |s: &&mut Series| s.name == name && s.colour == colour;
        match out.iter_mut().find(same) {
            Some(known) if known.kind == Kind::Line && kind == Kind::Points => {}
            Some(known) if known.kind == kind && kind != Kind::Level => known.at.extend(at),
            _ => out.push(Series { name, colour, kind, at }),
        }
    }
    out
}

/// Legend, style, kind and numbers of a layer; `None` for spans and words, which are read off the drawing.
fn values<'a>(layer: &'a Layer, plot: &Plot<'_>) -> Option<(&'a str, Style, Kind, Vec<f64>)> {
    let inside = |x: f64| plot.x.holds(x);
    let pairs = |points: &[(f64, f64)]| -> Vec<f64> {
        let shown = points.iter().filter(|p| p.1.is_finite() && inside(p.0) && plot.y.holds(p.1));
        shown.flat_map(|p| [rounded(p.0), rounded(p.1)]).collect()
    };
    let triples = |points: &[(f64, f64, f64)]| -> Vec<f64> {
        let finite = points.iter().filter(|p| p.0.is_finite() && p.1.is_finite() && p.2.is_finite());
        finite.flat_map(|p| [p.0, p.1, p.2].map(rounded)).collect()
    };
    Some(match layer {
        Layer::Line { points, style, legend } => (legend, *style, Kind::Line, pairs(points)),
        Layer::Points { points, style, legend } => (legend, *style, Kind::Points, pairs(points)),
        Layer::Band { points, style, legend } => (legend, *style, Kind::Band, triples(points)),
        Layer::Bars { bars, style, legend } => (legend, *style, Kind::Bars, triples(bars)),
        Layer::Horizontal { at, style, legend } => {
            (legend, *style, Kind::Level, if plot.y.holds(*at) { vec![rounded(*at)] } else { vec![] })
        }
        Layer::Span { .. } | Layer::Label { .. } => return None,
    })
}

/// Six significant digits: more than is shown, and less than half of the bytes. A zero is positive.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Axis;

    fn figure(scale: Scale, layers: Vec<Layer>) -> Figure {
        let axis = |unit: &str| Axis { label: "axis.time".into(), unit: unit.into(), scale, range: None };
        Figure {
            id: "f".into(),
            title: "t".into(),
            channel: String::new(),
            panels: vec![Panel { x: axis("s"), y: axis("deg/h"), layers }],
            remarks: vec![],
        }
    }

    fn line(points: Vec<(f64, f64)>) -> Layer {
        Layer::Line { points, style: Style::Data, legend: "measured".into() }
    }

    #[test]
    fn values_are_read_in_the_unit_of_the_axis_and_each_once() {
        let points = vec![(0.0, 1.0), (36_000.0, 2.123_456), (72_000.0, f64::NAN)];
        let marks = Layer::Points { points: points.clone(), style: Style::Data, legend: "measured".into() };
        let json = readings(&figure(Scale::Linear, vec![line(points), marks]), Lang::Ru);
        let read: serde_json::Value = serde_json::from_str(&json).unwrap();
        let panel = &read["panels"][0];
        assert_eq!(panel["x"]["per"], 3600.0);
        assert_eq!(panel["x"]["unit"], "ч");
        assert_eq!(panel["y"]["per"], 1.0);
        assert_eq!(read["number"]["decimal"], ",");
        assert_eq!(panel["series"].as_array().unwrap().len(), 1);
        assert_eq!(panel["series"][0]["at"], serde_json::json!([0.0, 1.0, 36_000.0, 2.12346]));
    }

    #[test]
    fn what_cannot_be_read_off_has_no_readings() {
        assert_eq!(readings(&figure(Scale::Polar, vec![line(vec![(0.0, 1.0)])]), Lang::En), "");
        assert_eq!(readings(&figure(Scale::Linear, vec![]), Lang::En), "");
        let infinite = line(vec![(0.0, f64::INFINITY)]);
        assert_eq!(readings(&figure(Scale::Log, vec![infinite]), Lang::En), "");
    }
}
