//! Output over rates near zero: the staircase, the fitted zone, the line.

use super::{axis, line};
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::rate_table::dead_zone::DeadZone;

/// Points of the curve.
const CURVE: usize = 201;

/// Draws the response of a channel to small rates.
pub fn figure(zone: &DeadZone, several: bool) -> Figure {
    let k = normal_quantile(0.975);
    let low = zone.points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let high = zone.points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let at = |i: usize| low + (high - low) * i as f64 / (CURVE - 1) as f64;
    let curve = (0..CURVE).map(|i| (at(i), zone.at(at(i)))).collect();
    let straight = [low, high].map(|x| (x, zone.offset + zone.slope * (x - zone.centre))).to_vec();
    let band = zone.points.iter().map(|(x, y, u)| (*x, y - k * u, y + k * u)).collect();
    let points = zone.points.iter().map(|(x, y, _)| (*x, *y)).collect();
    let mut layers = vec![
        Layer::Band { points: band, style: Style::Data, legend: "figure.legend.band95".into() },
        line(straight, Style::Reference, "figure_table.without_zone"),
        line(curve, Style::Model, "figure.legend.model"),
        Layer::Points { points, style: Style::Data, legend: "figure_table.mean_of_rate".into() },
    ];
    if let Some(width) = zone.half_width {
        layers.insert(
            0,
            Layer::Span {
                from: zone.centre - width,
                to: zone.centre + width,
                style: Style::Muted,
                legend: "figure_table.zone".into(),
            },
        );
    }
    Figure {
        id: if several { format!("dead_zone_{}", zone.channel) } else { "dead_zone".to_owned() },
        title: "figure.title.dead_zone".into(),
        channel: if several { zone.channel.clone() } else { String::new() },
        panels: vec![Panel {
            x: axis("figure_table.axis_rate", "deg/h", Scale::Linear),
            y: axis("figure_table.axis_output", "deg/h", Scale::Linear),
            layers,
        }],
        remarks: vec![],
    }
}
