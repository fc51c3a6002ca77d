//! σ(τ) with its band, the fitted terms, reading points, the limits and the Russian value.

use super::{draw, parts, sigma_tau_limits};
use crate::estimate::normal_quantile;
use crate::figure::{Figure, Layer, Style};
use crate::i18n::{Arg, Note, note};
use crate::measurand::GyroEvidence;
use crate::noise::composite::{Part, Propagated};
use crate::noise::data::NoiseType;

/// Points of a model curve.
const CURVE_POINTS: usize = 96;

/// Share of the record up to which a point is reliable, and up to which it is shown.
const RELIABLE_SHARE: f64 = 0.2;
const MAX_RECORD_SHARE: f64 = 1.0 / 3.0;

/// Draws σ(τ) of a channel. `highest` gives the upper limit of a measurand by its id, in its own unit.
pub fn figure(gyro: &GyroEvidence, highest: &dyn Fn(&str) -> Option<f64>) -> Figure {
    let longest_s = gyro.longest_stretch_s;
    let shown: Vec<_> = gyro
        .sigma_tau
        .iter()
        .filter(|p| p.point.deviation > 0.0 && p.point.m as f64 * gyro.tau0_s <= longest_s * MAX_RECORD_SHARE)
        .map(|p| (p.point.m as f64 * gyro.tau0_s, p.point.deviation, p.interval95))
        .collect();
    let band = |from: f64, to: f64| -> Vec<(f64, f64, f64)> {
        let inside = shown.iter().filter(|p| p.0 >= from && p.0 <= to);
        inside.filter_map(|(t, _, i)| i.map(|i| (*t, i.low, i.high))).collect()
    };
    let last_reliable_s =
        shown.iter().map(|p| p.0).filter(|t| *t <= longest_s * RELIABLE_SHARE).fold(0.0, f64::max);
    let reliable: Vec<(f64, f64)> =
        shown.iter().filter(|p| p.0 <= longest_s * RELIABLE_SHARE).map(|p| (p.0, p.1)).collect();
    let mut tail: Vec<(f64, f64)> =
        shown.iter().filter(|p| p.0 > longest_s * RELIABLE_SHARE).map(|p| (p.0, p.1)).collect();
    let (tail_points, readable) = (tail.clone(), reliable.clone());
    if let (Some(last), false) = (reliable.last(), tail.is_empty()) {
        tail.insert(0, *last);
    }
    let mut layers = vec![draw::band(band(0.0, last_reliable_s), Style::Data, "figure.legend.band95")];
    if !tail_points.is_empty() {
        layers.push(draw::band(band(last_reliable_s, f64::INFINITY), Style::Muted, ""));
    }
    if let (Some(first), Some(last)) = (shown.first(), shown.last()) {
        layers.extend(model_curves(gyro, first.0, last.0.max(first.0 * 2.0)));
    }
    layers.push(draw::line(reliable.clone(), Style::Data, "figure.legend.allan"));
    layers.push(draw::points(reliable, Style::Data, "figure.legend.allan"));
    layers.push(draw::line(tail, Style::Muted, "figure.legend.unreliable"));
    layers.push(draw::points(tail_points, Style::Muted, "figure.legend.unreliable"));
    let lowest = readable.iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a });
    if let (Some(first), Some(last), Some(lowest)) = (shown.first(), shown.last(), lowest) {
        let span = sigma_tau_limits::Span { first_s: first.0, lowest_s: lowest.0, last_s: last.0 };
        layers.extend(sigma_tau_limits::layers(span, highest));
    }
    if let Some(drift) = gyro.drift_100s() {
        layers.push(draw::points(vec![(100.0, drift)], Style::Reference, "figure.legend.russian"));
        layers.push(draw::label((100.0, drift), label("figure_label.drift", drift)));
    }
    if let Some(at) = lowest {
        layers.push(draw::label(at, label("figure_label.minimum", at.1)));
    }
    if let Some(n) = gyro.identification.read_angle_random_walk().value {
        let within =
            shown.first().is_some_and(|p| p.0 <= 3600.0) && shown.last().is_some_and(|p| p.0 >= 3600.0);
        if within {
            let points = vec![(3600.0, n)];
            let style = parts::style(Part::Term(NoiseType::AngleRandomWalk));
            layers.push(draw::points(points, style, ""));
            layers.push(draw::label((3600.0, n), label("figure_label.arw", n)));
        }
    }
    draw::figure(
        "sigma_tau",
        "figure.title.sigma_tau",
        &gyro.channel,
        gyro.several,
        vec![draw::panel(
            draw::log("axis.averaging_time", "s"),
            draw::log("axis.allan_deviation", "deg/h"),
            layers,
        )],
        vec![note!("figure.remark.record", hours = longest_s / 3600.0)],
    )
}

/// A number at its point.
fn label(key: &'static str, value: f64) -> Note {
    Note::new(key).with("value", Arg::figures(value, 3))
}

/// Largest relative uncertainty of a model curve that a band shows: beyond, the first order of it means nothing.
const MAX_RELATIVE_UNCERTAINTY: f64 = 2.0;

fn model_curves(gyro: &GyroEvidence, from: f64, to: f64) -> Vec<Layer> {
    let described = &gyro.identification.described;
    let (model, tau0_s) = (&described.model, gyro.tau0_s);
    // The Allan variance of samples exists at whole multiples of their interval; the points of the record are among
    // the drawn ones, for between two of them lines and filters make the curve swing.
    let mut multiples: Vec<u64> = (0..CURVE_POINTS)
        .map(|i| from * (to / from).powf(i as f64 / (CURVE_POINTS - 1) as f64) / tau0_s)
        .map(|m| (m.round() as u64).max(1))
        .chain(gyro.octaves.iter().map(|p| p.point.m).filter(|m| (from..=to).contains(&(*m as f64 * tau0_s))))
        .collect();
    multiples.sort_unstable();
    multiples.dedup();
    let grid: Vec<f64> = multiples.into_iter().map(|m| m as f64 * tau0_s).collect();
    // Variance and its standard uncertainty; the band is symmetric in the logarithm, as a variance is positive.
    let curve: Vec<(f64, f64, f64)> = grid
        .iter()
        .map(|t| {
            let Propagated { value: variance, standard_uncertainty: u } =
                described.propagate(|m| m.allan_variance(*t, tau0_s));
            let half = if variance > 0.0 {
                0.5 * normal_quantile(0.975) * (u / variance).min(MAX_RELATIVE_UNCERTAINTY)
            } else {
                0.0
            };
            (*t, variance.max(0.0).sqrt(), half.exp())
        })
        .collect();
    // A part is drawn only where it would be seen, or the axis would stretch down to nothing.
    let least = curve.iter().map(|p| p.1).fold(f64::INFINITY, f64::min) / 8.0;
    let mut layers = vec![draw::band(
        curve.iter().map(|(t, s, f)| (*t, s / f, s * f)).collect(),
        Style::Model,
        "figure.fit.model_band",
    )];
    let drawn = |of: &[Part]| -> Vec<(f64, f64)> {
        grid.iter()
            .map(|t| (*t, of.iter().map(|p| model.part_allan_variance(*p, *t, tau0_s)).sum::<f64>().sqrt()))
            .map(|(t, s)| (t, if s >= least { s } else { f64::NAN }))
            .collect()
    };
    // Lines swing from nought to nought, a curve each: many would hide the rest, so they are drawn as one.
    let (tones, noises): (Vec<Part>, Vec<Part>) =
        model.parts().into_iter().partition(|p| matches!(p, Part::Line(_)));
    for part in noises {
        let (style, legend) = parts::identified(part, &gyro.identification);
        layers.push(draw::line(drawn(&[part]), style, legend));
    }
    if let Some(first) = tones.first() {
        layers.push(draw::line(drawn(&tones), parts::style(*first), parts::legend(*first)));
    }
    let total = curve.iter().map(|(t, s, _)| (*t, *s)).collect();
    layers.push(draw::line(total, Style::Model, "figure.legend.model"));
    layers
}
