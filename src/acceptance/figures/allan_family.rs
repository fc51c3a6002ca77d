//! The whole Allan family with its intervals: where the estimators part, the kind of noise shows.

use super::draw;
use crate::figure::{Figure, Style};
use crate::i18n::note;
use crate::measurand::GyroEvidence;
use crate::noise::family::Estimator;
use crate::noise::intervals::{BoundedPoint, bounded};

/// Share of the record up to which points are shown.
const MAX_RECORD_SHARE: f64 = 1.0 / 3.0;

/// Style and legend of an estimator.
fn style(estimator: Estimator) -> (Style, &'static str) {
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
    let scattering = gyro.identification.described.model.without_lines();
    let shown = curves.iter().map(|curve| {
        let points = curve.points.iter().map(|p| (p.m as f64 * gyro.tau0_s, p));
        let points = points
            .filter(|(t, p)| p.deviation > 0.0 && *t <= gyro.longest_stretch_s * MAX_RECORD_SHARE)
            .map(|(t, p)| {
                let noise = scattering.dominant(t, gyro.tau0_s);
                (t, bounded(curve.estimator, p, &curve.stretches, noise))
            });
        (curve.estimator, points.collect())
    });
    let drawn = of_curves(&shown.collect::<Vec<_>>(), &gyro.channel, gyro.several, "deg/h");
    let hours = gyro.longest_stretch_s / 3600.0;
    Some(Figure { remarks: vec![note!("figure.remark.record", hours)], ..drawn })
}

/// A deviation at averaging times in s.
pub type Curve = (Estimator, Vec<(f64, BoundedPoint)>);

/// Draws deviations with their bands, in a unit.
pub fn of_curves(curves: &[Curve], channel: &str, several: bool, unit: &str) -> Figure {
    let (mut bands, mut lines) = (vec![], vec![]);
    for (estimator, shown) in curves {
        let (style, legend) = style(*estimator);
        let band = |(t, b): &(f64, BoundedPoint)| b.interval95.map(|i| (*t, i.low, i.high));
        bands.push(draw::band(shown.iter().filter_map(band).collect(), style, ""));
        let points: Vec<(f64, f64)> = shown.iter().map(|(t, b)| (*t, b.point.deviation)).collect();
        lines.push(draw::line(points.clone(), style, legend));
        lines.push(draw::points(points, style, legend));
    }
    bands.extend(lines);
    draw::figure(
        "allan_family",
        "figure.title.allan_family",
        channel,
        several,
        vec![draw::panel(
            draw::log("axis.averaging_time", "s"),
            draw::log("figure.fit.deviation", unit),
            bands,
        )],
        vec![],
    )
}
