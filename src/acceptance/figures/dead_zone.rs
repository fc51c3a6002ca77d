//! Output over rates near zero: the staircase, the fitted zone, the line.

use super::draw;
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Style};
use crate::rate_table::dead_zone::DeadZone;

/// Points of the curve.
const CURVE_POINTS: usize = 201;

/// Draws the response of a channel to small rates: over the input rate, which is zero at the centre of a zone, or over the
/// table rate where no zone tells where that is.
pub fn figure(zone: &DeadZone, several: bool) -> Figure {
    let k = normal_quantile(0.975);
    let low = zone.points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let high = zone.points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let (origin, abscissa) = match zone.half_width {
        Some(_) => (zone.centre, "figure_table.axis_input_rate"),
        None => (0.0, "figure_table.axis_rate"),
    };
    let at = |i: usize| low + (high - low) * i as f64 / (CURVE_POINTS - 1) as f64;
    let curve = (0..CURVE_POINTS).map(|i| (at(i) - origin, zone.at(at(i)))).collect();
    let straight = [low, high].map(|x| (x - origin, zone.offset + zone.slope * (x - zone.centre))).to_vec();
    let band = zone.points.iter().map(|(x, y, u)| (x - origin, y - k * u, y + k * u)).collect();
    let points = zone.points.iter().map(|(x, y, _)| (x - origin, *y)).collect();
    let mut layers = vec![
        draw::band(band, Style::Data, "figure.legend.band95"),
        draw::line(straight, Style::Reference, "figure_table.without_zone"),
        draw::line(curve, Style::Model, "figure.legend.model"),
        draw::points(points, Style::Data, "figure_table.mean_of_rate"),
    ];
    if let Some(width) = zone.half_width {
        layers.insert(0, draw::span(-width, width, Style::Muted, "figure_table.zone"));
    }
    draw::figure(
        "dead_zone",
        "figure.title.dead_zone",
        &zone.channel,
        several,
        vec![draw::panel(
            draw::linear(abscissa, "deg/h"),
            draw::linear("figure_table.axis_output", "deg/h"),
            layers,
        )],
        vec![],
    )
}
