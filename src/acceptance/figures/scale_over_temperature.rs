//! Scale factor over temperature.

use super::draw;
use crate::estimate::student_quantile;
use crate::figure::{Figure, Style};
use crate::rate_table::scale_over_temperature::ScaleOverTemperature;

/// Draws the scale factor of every temperature about the mean of all, ppm, with its interval, single soaks by their direction and the
/// line of least squares.
pub fn figure(found: &ScaleOverTemperature, channel: &str, several: bool) -> Figure {
    let (points, soaks) = (found.points.len(), found.soaks.len());
    let mut mean = vec![0.0; soaks];
    for point in 0..points {
        mean.iter_mut().zip(found.mean_of(point)).for_each(|(m, w)| *m += w / points as f64);
    }
    let about_mean =
        |weights: Vec<f64>| -> Vec<f64> { weights.iter().zip(&mean).map(|(w, m)| w - m).collect() };
    let curve: Vec<(f64, f64, f64)> = (0..points)
        .map(|point| {
            let change = found.contrast(&about_mean(found.mean_of(point)));
            let half = student_quantile(0.975, change.dof) * change.standard;
            (found.temperature_of(point), change.value - half, change.value + half)
        })
        .collect();
    let of_direction = |direction: i8| -> Vec<(f64, f64)> {
        let own = found.soaks.iter().enumerate().filter(|(_, s)| s.direction == direction);
        own.map(|(at, soak)| {
            let weights = about_mean((0..soaks).map(|i| if i == at { 1.0 } else { 0.0 }).collect());
            (soak.temperature, found.contrast(&weights).value)
        })
        .collect()
    };
    let temperatures = found.temperatures();
    let slope = found.contrast(&found.slope_weights()).value;
    let middle = temperatures.iter().sum::<f64>() / points as f64;
    let line = temperatures.first().into_iter().chain(temperatures.last());
    let mut layers = vec![
        draw::strokes(curve.iter().copied(), Style::Data, "figure.legend.band95"),
        draw::line(line.map(|t| (*t, slope * (t - middle))).collect(), Style::Model, "figure_soaks.line"),
    ];
    let directions = [
        (0, Style::Muted, "figure_soaks.first"),
        (1, Style::Heating, "figure_soaks.heating"),
        (-1, Style::Cooling, "figure_soaks.cooling"),
    ];
    for (direction, style, legend) in directions {
        let own = of_direction(direction);
        if !own.is_empty() {
            layers.push(draw::points(own, style, legend));
        }
    }
    draw::figure(
        "scale_over_temperature",
        "figure.title.scale_over_temperature",
        channel,
        several,
        vec![draw::panel(
            draw::linear("axis.temperature", "degC"),
            draw::linear("figure_soaks.axis_change", "ppm"),
            layers,
        )],
        vec![],
    )
}
