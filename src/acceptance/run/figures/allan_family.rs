//! The whole Allan family with its intervals: where the estimators part, the kind of noise shows.

use super::{axis, line};
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::i18n::Note;
use crate::measurand::GyroEvidence;
use crate::noise::family::Estimator;
use crate::noise::intervals::bounded;

/// Share of the record up to which points are shown.
const SHOWN: f64 = 1.0 / 3.0;

/// Style and legend of an estimator.
fn look(estimator: Estimator) -> (Style, &'static str) {
    match estimator {
        Estimator::Allan => (Style::Data, "figure.legend.allan"),
        Estimator::Modified => (Style::Term(0), "figure.fit.modified"),
        Estimator::Hadamard => (Style::SecondData, "figure.fit.hadamard"),
        Estimator::Total => (Style::Term(4), "figure.fit.total"),
    }
}

/// Draws the family; `None` where the record holds one estimator only.
pub fn figure(gyro: &GyroEvidence) -> Option<Figure> {
    let curves = &gyro.digest.deviations.curves;
    if curves.len() < 2 {
        return None;
    }
    let scattering = crate::acceptance::run::sigma_tau::scattering(&gyro.identification.described.model);
    let (mut bands, mut lines) = (vec![], vec![]);
    for curve in curves {
        let (style, legend) = look(curve.estimator);
        let shown: Vec<_> = curve
            .points
            .iter()
            .map(|p| (p.m as f64 * gyro.tau0_s, p))
            .filter(|(t, p)| p.deviation > 0.0 && *t <= gyro.longest_stretch_s * SHOWN)
            .map(|(t, p)| {
                let noise = scattering.dominant(t, gyro.tau0_s);
                (t, bounded(curve.estimator, p, &curve.stretches, noise))
            })
            .collect();
        let band =
            |(t, b): &(f64, crate::noise::intervals::BoundedPoint)| b.interval95.map(|i| (*t, i.low, i.high));
        bands.push(Layer::Band {
            points: shown.iter().filter_map(band).collect(),
            style,
            legend: String::new(),
        });
        let points: Vec<(f64, f64)> = shown.iter().map(|(t, b)| (*t, b.point.deviation)).collect();
        lines.push(line(points.clone(), style, legend));
        lines.push(Layer::Points { points, style, legend: legend.into() });
    }
    bands.extend(lines);
    Some(Figure {
        id: gyro.figure_id("allan_family"),
        title: "figure.title.allan_family".into(),
        channel: gyro.figure_channel(),
        panels: vec![Panel {
            x: axis("axis.averaging_time", "s", Scale::Log),
            y: axis("figure.fit.deviation", "deg/h", Scale::Log),
            layers: bands,
        }],
        remarks: vec![Note::new("figure.remark.record").with("hours", gyro.longest_stretch_s / 3600.0)],
    })
}
