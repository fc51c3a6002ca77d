//! Figures of an explanation, as data, from plain series.
//!
//! Each function bounds what is drawn: long series are averaged first, and each point of the paper is the mean of those
//! that would fall on it.

mod against;
mod course;
mod join;
mod spectrum;

pub use against::{Against, against};
pub use course::{TimeSeries, local_level, time_course};
pub use spectrum::{Spectra, spectrum};

use crate::effect::{Domain, Place};
use crate::figure::{Axis, Layer, Scale, Style};

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.to_owned() }
}

/// The places of a domain, shaded.
fn shaded(places: &[Place], domains: &[Domain]) -> impl Iterator<Item = Layer> {
    let here = places.iter().filter(|p| domains.contains(&p.domain));
    here.map(|p| Layer::Span {
        from: p.from,
        to: p.to,
        style: Style::Limit,
        legend: "figure.explain.place".into(),
    })
}
