//! Figures of a comparison, as data.

use super::Unit;
use crate::figure::{Axis, Figure, Layer, Panel, Scale, Style};
use crate::i18n::Note;

/// Units that are named in the figure of ratios.
const NAMED: usize = 14;

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
        remarks: vec![
            Note::new("compare.figure.octaves_remark")
                .with("windows", o.windows)
                .with("of", o.of)
                .with("sigma", o.sigma),
        ],
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
        if labels.len() < NAMED {
            let text = Note::new("compare.label").with("name", unit.label());
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

/// All figures of a set of units.
pub fn all(units: &[Unit]) -> Vec<Figure> {
    let bars = units.iter().enumerate().filter_map(|(i, u)| octaves(u, i + 1));
    ratios(units).into_iter().chain(bars).collect()
}
