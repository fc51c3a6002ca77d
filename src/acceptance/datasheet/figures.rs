//! Figures of a data sheet, as data.

use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::i18n::note;
use crate::record::{
    DataSheet, SheetCurve, SheetOf, SheetQuantity, SheetScale, SheetTemperatureCurve, SheetUnitCurve,
};

/// Every figure: σ(τ) of each channel, bias over temperature, then the units of each quantity that has bounds.
pub fn all(sheet: &DataSheet) -> Vec<Figure> {
    let several =
        sheet.quantities.iter().any(|q| Some(&q.channel) != sheet.quantities.first().map(|f| &f.channel));
    let curves = sheet.curves.iter().map(|c| sigma_tau(c, several));
    let drawn = sheet.quantities.iter().enumerate().filter(|(_, q)| !q.bounds.is_empty());
    let temperature = sheet.temperature_curves.iter().map(|c| over_temperature(c, several));
    curves.chain(temperature).chain(drawn.map(|(i, q)| units(q, i))).collect()
}

/// Id of the figure of a quantity.
pub fn figure_id(place: usize) -> String {
    format!("units_{}", place + 1)
}

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

fn sigma_tau(curve: &SheetCurve, several: bool) -> Figure {
    let mut layers = vec![];
    let band = curve.points.iter().map(|p| (p.tau_s, p.low, p.high)).collect();
    layers.push(Layer::Band { points: band, style: Style::Data, legend: "datasheet.legend.band".into() });
    layers.push(hairs(&curve.units));
    let median = curve.points.iter().map(|p| (p.tau_s, p.median)).collect();
    layers.push(Layer::Line { points: median, style: Style::Data, legend: "datasheet.legend.median".into() });
    let bound: Vec<(f64, f64)> = curve.points.iter().filter_map(|p| Some((p.tau_s, p.bound?))).collect();
    if !bound.is_empty() {
        let legend = "datasheet.legend.bound_measured".into();
        layers.push(Layer::Line { points: bound, style: Style::Reference, legend });
    }
    Figure {
        id: format!("sigma_tau_{}", curve.channel),
        title: "datasheet.figure.sigma_tau".into(),
        channel: if several { curve.channel.clone() } else { String::new() },
        panels: vec![Panel {
            x: axis("axis.averaging_time", "s", Scale::Log),
            y: axis("axis.allan_deviation", "deg/h", Scale::Log),
            layers,
        }],
        remarks: vec![note!("datasheet.figure.sigma_tau_remark", n = curve.units.len())],
    }
}

/// Each unit as a hairline: one line for all, which a point that is no number breaks.
fn hairs(units: &[SheetUnitCurve]) -> Layer {
    let mut points: Vec<(f64, f64)> = vec![];
    for unit in units {
        points.extend(unit.points.iter().map(|[x, y]| (*x, *y)));
        points.push((f64::NAN, f64::NAN));
    }
    Layer::Line { points, style: Style::Muted, legend: "datasheet.legend.unit".into() }
}

/// Bias over temperature: the band of the middle two thirds, each unit, the median, the tolerance band.
fn over_temperature(curve: &SheetTemperatureCurve, several: bool) -> Figure {
    let line = |points, style, legend: &str| Layer::Line { points, style, legend: legend.to_owned() };
    let points = || curve.points.iter();
    let mut layers = vec![
        Layer::Band {
            points: points().map(|p| (p.temperature_deg_c, p.low, p.high)).collect(),
            style: Style::Data,
            legend: "datasheet.legend.band".into(),
        },
        hairs(&curve.units),
        line(
            points().map(|p| (p.temperature_deg_c, p.median)).collect(),
            Style::Data,
            "datasheet.legend.median",
        ),
    ];
    let side =
        |i: usize| points().filter_map(|p| Some((p.temperature_deg_c, p.band?[i]))).collect::<Vec<_>>();
    let mut bounds = side(0);
    if !bounds.is_empty() {
        bounds.push((f64::NAN, f64::NAN));
        bounds.extend(side(1));
        layers.push(line(bounds, Style::Reference, "datasheet.legend.tolerance"));
    }
    Figure {
        id: format!("over_temperature_{}", curve.channel),
        title: "datasheet.figure.over_temperature".into(),
        channel: if several { curve.channel.clone() } else { String::new() },
        panels: vec![Panel {
            x: axis("axis.temperature", "degC", Scale::Linear),
            y: axis("datasheet.axis.bias", "deg/h", Scale::Linear),
            layers,
        }],
        remarks: vec![note!("datasheet.figure.over_temperature_remark", n = curve.units.len())],
    }
}

/// Every unit with its interval, the smallest first, with limit and bounds.
fn units(q: &SheetQuantity, place: usize) -> Figure {
    let mut order: Vec<_> = q.values.iter().collect();
    let at = |v: &crate::record::SheetValue| v.value.or(v.upper_limit.map(|u| u.value)).unwrap_or(f64::NAN);
    order.sort_by(|a, b| at(a).total_cmp(&at(b)));
    let positive = |v: f64| q.scale == SheetScale::Linear || v > 0.0;
    let (mut bars, mut values, mut bounded) = (vec![], vec![], vec![]);
    for (i, v) in order.iter().enumerate() {
        let x = (i + 1) as f64;
        match (v.value, v.interval) {
            (Some(value), interval) => {
                values.push((x, value));
                if let Some(interval) = interval {
                    let low = if positive(interval.low) { interval.low } else { value };
                    bars.extend([(x, low), (x, interval.high), (f64::NAN, f64::NAN)]);
                }
            }
            (None, _) => bounded.push((x, at(v))),
        }
    }
    let mut layers = vec![
        Layer::Line { points: bars, style: Style::Muted, legend: "datasheet.legend.interval".into() },
        Layer::Points { points: values, style: Style::Data, legend: "datasheet.legend.value".into() },
    ];
    if !bounded.is_empty() {
        let legend = "datasheet.legend.bounded".into();
        layers.push(Layer::Points { points: bounded, style: Style::SecondData, legend });
    }
    for b in q.bounds.iter().filter(|b| b.of == SheetOf::True) {
        let legend = "datasheet.legend.bound".into();
        layers.push(Layer::Horizontal { at: b.value, style: Style::Reference, legend });
    }
    let limits = q.limit.iter().flat_map(|l| [l.min, l.max]).flatten().filter(|l| positive(*l));
    for at in limits {
        layers.push(Layer::Horizontal { at, style: Style::Limit, legend: "datasheet.legend.limit".into() });
    }
    let scale = if q.scale == SheetScale::Log { Scale::Log } else { Scale::Linear };
    Figure {
        id: figure_id(place),
        title: "datasheet.figure.units".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis("datasheet.axis.unit", "", Scale::Linear),
            y: axis("datasheet.axis.value", &q.unit, scale),
            layers,
        }],
        remarks: vec![],
    }
}
