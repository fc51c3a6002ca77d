//! Figures of a comparison, as data.

use super::Unit;
use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::i18n::note;
use crate::measurand;

/// Units that are named in the figure of ratios.
const MAX_NAMED_UNITS: usize = 14;

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

/// The octave identity of a unit: bars of what the data hold, points of what the model expects.
pub fn octaves(unit: &Unit, number: usize) -> Option<Figure> {
    let o = unit.detail.as_ref()?.octaves.as_ref()?;
    let half = 2f64.sqrt();
    let bars = o.octaves.iter().map(|o| (o.tau_s / half, o.tau_s * half, 100.0 * o.share)).collect();
    let mut layers =
        vec![Layer::Bars { bars, style: Style::Data, legend: "compare.legend.octaves_data".into() }];
    let expected: Vec<(f64, f64)> =
        o.octaves.iter().filter_map(|o| Some((o.tau_s, 100.0 * o.expected_share?))).collect();
    if !expected.is_empty() {
        layers.push(Layer::Points {
            points: expected,
            style: Style::SecondData,
            legend: "compare.legend.octaves_model".into(),
        });
    }
    Some(Figure {
        id: format!("octaves_{number}"),
        title: "compare.figure.octaves".into(),
        channel: unit.label(),
        panels: vec![Panel {
            x: axis("axis.averaging_time", "s", Scale::Log),
            y: axis("compare.axis.share", "%", Scale::Linear),
            layers,
        }],
        remarks: vec![note!(
            "compare.figure.octaves_remark",
            windows = o.windows,
            of = o.of,
            sigma = o.sigma
        )],
    })
}

/// The ratio of each unit over the length of its record, with what angle random walk alone would give.
pub fn ratios(units: &[Unit]) -> Option<Figure> {
    let mut layers = vec![];
    let mut points = vec![];
    let mut labels = vec![];
    for unit in units {
        let Some(detail) = &unit.detail else { continue };
        let Some((m, ratio)) = detail.minimum.as_ref().and_then(|m| Some((m, m.ratio?))) else { continue };
        let hours = detail.length_s / 3600.0;
        if let Some([low, _, high]) = m.null_ratio {
            layers.push(Layer::Line {
                points: vec![(hours, low), (hours, high)],
                style: Style::Muted,
                legend: "compare.legend.null".into(),
            });
        }
        points.push((hours, ratio));
        if labels.len() < MAX_NAMED_UNITS {
            let text = note!("compare.label", name = unit.label());
            labels.push(Layer::Label { at: (hours, ratio), text });
        }
    }
    if points.is_empty() {
        return None;
    }
    let medians: Vec<(f64, f64)> = units
        .iter()
        .filter_map(|u| {
            let d = u.detail.as_ref()?;
            Some((d.length_s / 3600.0, d.minimum.as_ref()?.null_ratio?[1]))
        })
        .collect();
    layers.push(Layer::Points {
        points: medians,
        style: Style::Muted,
        legend: "compare.legend.null_median".into(),
    });
    layers.push(Layer::Points { points, style: Style::SecondData, legend: "compare.legend.ratio".into() });
    layers.extend(labels);
    Some(Figure {
        id: "ratios".into(),
        title: "compare.figure.ratios".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis("compare.axis.record_length", "h", Scale::Log),
            y: axis("compare.axis.ratio", "", Scale::Log),
            layers,
        }],
        remarks: vec!["compare.figure.ratios_remark".into()],
    })
}

/// Units whose σ(τ) one figure holds: as many as can be told apart.
const MAX_OVERLAID_UNITS: usize = 8;

/// Share of the record up to which σ(τ) is drawn.
const MAX_RECORD_SHARE: f64 = 1.0 / 3.0;

/// σ(τ) of the units on common axes, with the standard deviation of 100-s means of each; `None` for fewer than two.
pub fn sigma_tau(units: &[Unit]) -> Option<Figure> {
    let with_curve: Vec<&Unit> = units.iter().filter(|u| u.deviations.len() > 1).collect();
    if with_curve.len() < 2 {
        return None;
    }
    let mut layers = vec![];
    for (i, unit) in with_curve.iter().take(MAX_OVERLAID_UNITS).enumerate() {
        let style = Style::Unit(i as u8);
        let longest_s = unit.length_s.map_or(f64::INFINITY, |t| t * MAX_RECORD_SHARE);
        let points: Vec<(f64, f64)> = unit
            .deviations
            .iter()
            .filter(|d| d.deviation_deg_h > 0.0 && d.tau_s <= longest_s)
            .map(|d| (d.tau_s, d.deviation_deg_h))
            .collect();
        let bands = unit.deviations.iter().filter(|d| d.tau_s <= longest_s);
        let band = bands.filter_map(|d| Some((d.tau_s, d.low_deg_h?, d.high_deg_h?))).collect();
        layers.push(Layer::Band { points: band, style, legend: String::new() });
        layers.push(Layer::Line { points: points.clone(), style, legend: unit.label() });
        layers.push(Layer::Points { points, style, legend: unit.label() });
    }
    let russian =
        with_curve.iter().take(MAX_OVERLAID_UNITS).filter_map(|u| u.value(measurand::RUSSIAN_DRIFT_100S.id));
    let russian: Vec<(f64, f64)> = russian.map(|v| (100.0, v)).collect();
    layers.push(Layer::Points {
        points: russian,
        style: Style::Reference,
        legend: "figure.legend.russian".into(),
    });
    let mut remarks = vec![];
    if with_curve.len() > MAX_OVERLAID_UNITS {
        let shown = note!("compare.figure.sigma_tau_remark");
        remarks.push(shown.with("shown", MAX_OVERLAID_UNITS).with("all", with_curve.len()));
    }
    Some(Figure {
        id: "sigma_tau".into(),
        title: "compare.figure.sigma_tau".into(),
        channel: String::new(),
        panels: vec![Panel {
            x: axis("axis.averaging_time", "s", Scale::Log),
            y: axis("axis.allan_deviation", "deg/h", Scale::Log),
            layers,
        }],
        remarks,
    })
}

/// All figures of a set of units.
pub fn all(units: &[Unit]) -> Vec<Figure> {
    let bars = units.iter().enumerate().filter_map(|(i, u)| octaves(u, i + 1));
    sigma_tau(units).into_iter().chain(ratios(units)).chain(bars).collect()
}
