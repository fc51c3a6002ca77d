//! Scale factor over temperature.

use super::draw;
use crate::estimate::student_quantile;
use crate::figure::{Figure, Panel, Style};
use crate::rate_table::scale_over_temperature::ScaleOverTemperature;

/// Draws the scale factor of every temperature about the mean of all, ppm, with its interval, single soaks by their direction and the
/// line of least squares; and all of them about that line, where loops and intervals show.
pub fn figure(found: &ScaleOverTemperature, channel: &str, several: bool) -> Figure {
    let slope = found.contrast(&found.slope_weights()).value;
    let curve = Curve::of(found);
    draw::figure(
        "scale_over_temperature",
        "figure.title.scale_over_temperature",
        channel,
        several,
        vec![
            curve.panel(slope, 0.0, "figure_soaks.axis_change"),
            curve.panel(slope, slope, "figure_soaks.axis_left"),
        ],
        vec![],
    )
}

/// Scale factors about the mean of all temperatures, ppm.
struct Curve<'a> {
    found: &'a ScaleOverTemperature,
    /// Weights of the soaks that give the mean of all temperatures.
    mean: Vec<f64>,
    temperatures: Vec<f64>,
    /// Mean temperature, degC.
    middle: f64,
}

impl Curve<'_> {
    fn of(found: &ScaleOverTemperature) -> Curve<'_> {
        let temperatures = found.temperatures();
        let points = temperatures.len() as f64;
        let mut mean = vec![0.0; found.soaks.len()];
        for point in 0..temperatures.len() {
            mean.iter_mut().zip(found.mean_of(point)).for_each(|(m, w)| *m += w / points);
        }
        let middle = temperatures.iter().sum::<f64>() / points;
        Curve { found, mean, temperatures, middle }
    }

    /// Value and half width of the interval of a sum over soaks about the mean.
    fn about_mean(&self, weights: &[f64]) -> (f64, f64) {
        let weights: Vec<f64> = weights.iter().zip(&self.mean).map(|(w, m)| w - m).collect();
        let change = self.found.contrast(&weights);
        (change.value, student_quantile(0.975, change.dof) * change.standard)
    }

    /// A panel of the curve and of the line of this slope, without a line of the slope `without`, ppm/degC.
    fn panel(&self, slope: f64, without: f64, axis: &'static str) -> Panel {
        let left = |t: f64, value: f64| value - without * (t - self.middle);
        let means: Vec<(f64, f64, f64)> = self
            .temperatures
            .iter()
            .enumerate()
            .map(|(point, t)| {
                let (value, half) = self.about_mean(&self.found.mean_of(point));
                (*t, left(*t, value), half)
            })
            .collect();
        let band = means.iter().map(|(t, value, half)| (*t, value - half, value + half)).collect();
        let curve = means.iter().map(|(t, value, _)| (*t, *value)).collect();
        let ends = self.temperatures.first().into_iter().chain(self.temperatures.last());
        let line = ends.map(|t| (*t, left(*t, slope * (t - self.middle)))).collect();
        let mut layers = vec![
            draw::band(band, Style::Data, "figure.legend.band95"),
            draw::line(curve, Style::Data, "figure_soaks.mean"),
            draw::line(line, Style::Model, "figure_soaks.line"),
        ];
        for (direction, style, legend) in [
            (0, Style::Reference, "figure_soaks.first"),
            (1, Style::Heating, "figure_soaks.heating"),
            (-1, Style::Cooling, "figure_soaks.cooling"),
        ] {
            let soaks = self.found.soaks.iter().enumerate().filter(|(_, s)| s.direction == direction);
            let points: Vec<(f64, f64)> = soaks
                .map(|(at, soak)| {
                    let mut weights = vec![0.0; self.mean.len()];
                    weights[at] = 1.0;
                    (soak.temperature, left(soak.temperature, self.about_mean(&weights).0))
                })
                .collect();
            if !points.is_empty() {
                layers.push(draw::points(points, style, legend));
            }
        }
        draw::panel(draw::linear("axis.temperature", "degC"), draw::linear(axis, "ppm"), layers)
    }
}
