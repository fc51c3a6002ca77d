//! Figures of a static test, as data.

pub mod allan_family;
pub mod autocorrelation;
pub mod dead_zone;
pub mod histogram;
mod parts;
pub mod residual;
pub mod scale_factor;
pub mod sigma_tau;
pub mod spectrum;
pub mod thermal;
pub mod time_series;

use crate::figure::{Axis, Layer, Scale, Style};

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label, unit: unit.to_owned(), scale, range: None }
}

fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.to_owned() }
}
