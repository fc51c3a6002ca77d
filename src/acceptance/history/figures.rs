//! Figures of a history, as data.

use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::record::{HistoryChart, HistoryControl, HistoryMonth, HistoryRecord};

/// Id of the figure of verdicts by month.
pub const MONTHS_FIGURE: &str = "months";

/// Every figure: verdicts by month, then the charts.
pub fn all(history: &HistoryRecord) -> Vec<Figure> {
    let months = (history.months.len() > 1).then(|| months(&history.months));
    months.into_iter().chain(history.charts.iter().enumerate().map(|(i, c)| chart(c, i))).collect()
}

/// Id of the figure of a chart.
pub fn figure_id(place: usize) -> String {
    format!("chart_{}", place + 1)
}

fn axis(label: &'static str, unit: &str) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
}

fn months(months: &[HistoryMonth]) -> Figure {
    let bars = |of: &dyn Fn(&HistoryMonth) -> usize| {
        months.iter().enumerate().map(|(i, m)| (i as f64 + 0.6, i as f64 + 1.4, of(m) as f64)).collect()
    };
    Figure {
        id: MONTHS_FIGURE.to_owned(),
        title: "history.figure.months".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis("history.axis.month", ""),
            y: axis("history.axis.tests", ""),
            layers: vec![
                Layer::Bars {
                    bars: bars(&|m| m.tests),
                    style: Style::Muted,
                    legend: "history.legend.tests".into(),
                },
                Layer::Bars {
                    bars: bars(&|m| m.passed),
                    style: Style::Data,
                    legend: "history.legend.passed".into(),
                },
            ],
        }],
        remarks: vec![],
    }
}

/// Values with their intervals and limits, below them the weighted means and the moving ranges.
fn chart(chart: &HistoryChart, place: usize) -> Figure {
    let unit = &chart.quantity.unit;
    let mut panels = vec![Panel {
        x: axis("history.axis.number", ""),
        y: axis("history.axis.value", unit),
        layers: values(chart),
    }];
    if let Some(control) = &chart.control {
        panels.push(Panel {
            x: axis("history.axis.number", ""),
            y: axis("history.axis.ewma", unit),
            layers: weighted(control),
        });
        panels.push(Panel {
            x: axis("history.axis.number", ""),
            y: axis("history.axis.range", unit),
            layers: ranges(control),
        });
    }
    Figure {
        id: figure_id(place),
        title: "history.figure.chart".into(),
        channel: String::new(),
        panels,
        remarks: vec![],
    }
}

/// Numbers of points from 1, with what each has.
fn numbered<T>(of: impl Iterator<Item = T>) -> Vec<(f64, T)> {
    of.enumerate().map(|(i, v)| ((i + 1) as f64, v)).collect()
}

fn values(chart: &HistoryChart) -> Vec<Layer> {
    let mut bars = vec![];
    for (x, p) in numbered(chart.points.iter()) {
        if let Some(interval) = p.interval {
            // A point that is no number breaks the line.
            bars.extend([(x, interval.low), (x, interval.high), (f64::NAN, f64::NAN)]);
        }
    }
    let mut layers = vec![];
    if let Some(control) = &chart.control {
        let limits = |sign: f64| {
            numbered(control.points.iter())
                .into_iter()
                .map(|(x, p)| (x, control.center + sign * p.reach))
                .collect()
        };
        for sign in [-1.0, 1.0] {
            let legend = "history.legend.limits".into();
            layers.push(Layer::Line { points: limits(sign), style: Style::Term(1), legend });
        }
        let legend = "history.legend.center".into();
        layers.push(Layer::Horizontal { at: control.center, style: Style::Reference, legend });
    }
    layers.push(Layer::Line { points: bars, style: Style::Muted, legend: "history.legend.interval".into() });
    let (mut inside, mut broken) = (vec![], vec![]);
    for (x, p) in numbered(chart.points.iter()) {
        let at = (x as usize).checked_sub(1);
        let flag = chart.control.as_ref().and_then(|c| c.points.get(at?));
        let is_broken = flag.is_some_and(|f| !f.broken.is_empty());
        if is_broken { &mut broken } else { &mut inside }.push((x, p.value));
    }
    layers.push(Layer::Points { points: inside, style: Style::Data, legend: "history.legend.value".into() });
    if !broken.is_empty() {
        let legend = "history.legend.broken".into();
        layers.push(Layer::Points { points: broken, style: Style::Heating, legend });
    }
    for at in chart.limit.iter().flat_map(|l| [l.min, l.max]).flatten() {
        layers.push(Layer::Horizontal { at, style: Style::Limit, legend: "history.legend.limit".into() });
    }
    layers
}

fn weighted(control: &HistoryControl) -> Vec<Layer> {
    let line = |of: &dyn Fn(usize) -> Option<f64>| -> Vec<(f64, f64)> {
        (0..control.points.len()).filter_map(|i| Some(((i + 1) as f64, of(i)?))).collect()
    };
    let limit = |sign: f64| line(&|i| Some(control.center + sign * control.points.get(i)?.ewma_reach));
    let legend = || "history.legend.limits".to_owned();
    vec![
        Layer::Line { points: limit(-1.0), style: Style::Term(1), legend: legend() },
        Layer::Line { points: limit(1.0), style: Style::Term(1), legend: legend() },
        Layer::Line {
            points: line(&|i| Some(control.points.get(i)?.ewma)),
            style: Style::Data,
            legend: "history.legend.ewma".into(),
        },
    ]
}

fn ranges(control: &HistoryControl) -> Vec<Layer> {
    let points =
        numbered(control.points.iter()).into_iter().filter_map(|(x, p)| Some((x, p.range?))).collect();
    vec![
        Layer::Line { points, style: Style::Data, legend: "history.legend.range".into() },
        Layer::Horizontal {
            at: control.range_limit,
            style: Style::Term(1),
            legend: "history.legend.limits".into(),
        },
    ]
}
