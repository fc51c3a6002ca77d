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
pub use join::over_time;
pub use spectrum::{Spectra, spectrum};

use crate::effect::{Domain, Place};
use crate::figure::{Axis, Layer, Scale, Style};

fn axis(label: &'static str, unit: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), unit: unit.to_owned(), scale, range: None }
}

fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Layer {
    Layer::Line { points, style, legend: legend.to_owned() }
}

/// Share of an axis from which on a place no longer narrows anything.
const WIDE_SHARE: f64 = 0.8;

/// The places of a domain, shaded where they are narrower than the axis. `axis` holds its first and last value.
fn shaded(
    places: &[Place],
    domains: &[Domain],
    axis: Option<(f64, f64)>,
    scale: Scale,
) -> impl Iterator<Item = Layer> {
    let along = move |v: f64| if scale == Scale::Log { v.max(f64::MIN_POSITIVE).ln() } else { v };
    let narrows = move |p: &&Place| {
        axis.is_none_or(|(first, last)| {
            let (first, last) = (along(first), along(last));
            let seen = along(p.to).min(last) - along(p.from).max(first);
            seen < WIDE_SHARE * (last - first)
        })
    };
    let here = places.iter().filter(move |p| domains.contains(&p.domain)).filter(narrows);
    here.map(|p| Layer::Span {
        from: p.from,
        to: p.to,
        style: Style::Limit,
        legend: "figure.explain.place".into(),
    })
}
