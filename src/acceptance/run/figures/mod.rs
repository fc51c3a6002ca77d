//! Figures of a static test, as data.

pub mod allan_family;
pub mod autocorrelation;
pub mod bias_of_runs;
pub mod dead_zone;
pub mod histogram;
pub mod influence;
mod parts;
pub mod polar;
pub mod positions;
pub mod residual;
pub mod scale_factor;
pub mod sigma_tau;
pub mod spectrum;
pub mod thermal;
pub mod time_series;

use crate::figure::{Axis, Layer, Scale, Style};

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.to_owned() }
}

/// Intervals as upright strokes: (x, low, high).
fn strokes(intervals: impl Iterator<Item = (f64, f64, f64)>, style: Style, legend: &str) -> Layer {
    let points = intervals.flat_map(|(x, low, high)| [(x, low), (x, high), (x, f64::NAN)]).collect();
    line(points, style, legend)
}
