//! The averaged periodogram with the model, its parts and the lines; below, the record over the model.

use super::{draw, parts};
use crate::estimate::chi_square_quantile;
use crate::figure::{Figure, Layer, Panel, Style};
use crate::i18n::{Arg, note};
use crate::measurand::GyroEvidence;
use crate::noise::composite::Damped;
use crate::noise::residual::BandRatio;
use std::f64::consts::PI;

/// Most points drawn: beyond, neighbouring bins are joined, evenly on the logarithmic axis.
const MAX_POINTS: usize = 700;
/// Points of a model curve.
const CURVE_POINTS: usize = 240;
/// Most lines that get a label.
const MAX_LABELS: usize = 6;

/// Draws the spectrum; `None` when the record was too short for one.
pub fn figure(gyro: &GyroEvidence) -> Option<Figure> {
    let spectrum = gyro.spectrum();
    if spectrum.density.len() < 8 {
        return None;
    }
    let step_hz = 1.0 / (spectrum.segment_len as f64 * gyro.tau0_s);
    let bins: Vec<(f64, f64)> = spectrum
        .density
        .iter()
        .enumerate()
        .skip(2)
        .map(|(k, d)| (k as f64 * step_hz, d * gyro.tau0_s))
        .filter(|(_, d)| *d > 0.0)
        .collect();
    let (first, last) = (bins.first()?.0, bins.last()?.0);
    let (mean, range) = join(&bins);
    let model = &gyro.identification.described.model;
    let ratios: Vec<&BandRatio> = gyro.goodness.bands.iter().filter(|b| b.ratio > 0.0).collect();
    let middle = |b: &BandRatio| (b.low_hz * b.high_hz).sqrt();
    let lowest = ratios.iter().map(|b| middle(b)).fold(first, f64::min);
    let mut grid: Vec<f64> = (0..CURVE_POINTS)
        .map(|i| lowest * (last / lowest).powf(i as f64 / (CURVE_POINTS - 1) as f64))
        .chain(model.quasi_periodic.iter().flat_map(|d| peak(d, lowest, last)))
        .collect();
    grid.sort_by(f64::total_cmp);
    let curve: Vec<(f64, f64)> = grid.iter().map(|f| (*f, model.density(*f, gyro.tau0_s))).collect();
    // Below the periodogram the cosine modes of block means go on.
    let slow: Vec<(f64, f64)> = ratios
        .iter()
        .map(|b| (middle(b), b.ratio * model.density(middle(b), gyro.tau0_s)))
        .filter(|(f, d)| *f < 2.0 * first && *d > 0.0)
        .collect();
    let mut layers = Vec::new();
    if range.len() < bins.len() {
        layers.push(draw::band(range, Style::Data, "figure.legend.range"));
    }
    layers.push(draw::line(mean, Style::Data, "figure.legend.spectrum"));
    layers.push(draw::line(slow, Style::SecondData, "figure.fit.slow_modes"));
    let least = curve.iter().map(|p| p.1).fold(f64::INFINITY, f64::min) / 30.0;
    for part in model.parts() {
        let points: Vec<(f64, f64)> = grid
            .iter()
            .map(|f| (*f, model.part_density(part, *f, gyro.tau0_s)))
            .map(|(f, d)| (f, if d >= least && d > 0.0 { d } else { f64::NAN }))
            .collect();
        if points.iter().any(|p| p.1.is_finite()) {
            let (style, legend) = parts::identified(part, &gyro.identification);
            layers.push(draw::line(points, style, legend));
        }
    }
    layers.push(draw::line(curve, Style::Model, "figure.legend.model"));
    let at = |f: f64| {
        let k = (f / step_hz).round() as usize;
        spectrum.density.get(k).map(|d| (f, d * gyro.tau0_s))
    };
    let points: Vec<(f64, f64)> = gyro.lines.iter().filter_map(|l| at(l.frequency_hz)).collect();
    if !points.is_empty() {
        layers.push(draw::points(points, Style::Reference, "figure.legend.line"));
    }
    layers.extend(line_labels(gyro, &at));
    if let Some(test) = gyro.noise_test.as_ref().filter(|t| !t.mask.is_empty()) {
        // The mask is one-sided.
        let corners = test.mask.iter().map(|p| (p.frequency_hz, 0.5 * p.density.powi(2))).collect();
        layers.push(draw::line(corners, Style::Limit, "figure.legend.limit"));
    }
    let mut panels = vec![draw::panel(
        draw::log("axis.frequency", "Hz"),
        draw::log("axis.density", "(deg/h)^2/Hz"),
        layers,
    )];
    panels.extend((ratios.len() > 3).then(|| ratio(&ratios)));
    Some(draw::figure(
        "spectrum",
        "figure.title.spectrum",
        &gyro.channel,
        gyro.several,
        panels,
        vec![note!("figure.remark.resolution", hz = step_hz)],
    ))
}

/// The frequencies of the strongest lines, harmonics left out. `at` is the point of a frequency.
fn line_labels(gyro: &GyroEvidence, at: &dyn Fn(f64) -> Option<(f64, f64)>) -> Vec<Layer> {
    let mut strongest: Vec<_> = gyro.lines.iter().filter(|l| l.harmonic_of.is_none()).collect();
    strongest.sort_by(|a, b| b.amplitude_deg_h.total_cmp(&a.amplitude_deg_h));
    let label = |frequency_hz: f64| {
        let text = note!("figure_label.line", frequency = Arg::figures(frequency_hz, 4));
        Some(draw::label(at(frequency_hz)?, text))
    };
    strongest.into_iter().take(MAX_LABELS).filter_map(|l| label(l.frequency_hz)).collect()
}

/// Points at which a narrow disturbance is drawn.
fn peak(d: &Damped, from: f64, to: f64) -> impl Iterator<Item = f64> {
    let (centre, width) = (d.frequency_hz, 1.0 / (PI * d.decay_time_s));
    (-30..=30)
        .map(move |i| centre + width * f64::from(i) / 10.0 * (1.0 + f64::from(i).abs() / 10.0))
        .filter(move |f| *f > from && *f < to)
}

/// Record over model, with the band that a correct model keeps in 95 of 100 bands.
fn ratio(ratios: &[&BandRatio]) -> Panel {
    let middle = |b: &BandRatio| (b.low_hz * b.high_hz).sqrt();
    let band = ratios
        .iter()
        .map(|b| {
            let at = |p: f64| chi_square_quantile(p, b.dof) / b.dof;
            (middle(b), at(0.025), at(0.975))
        })
        .collect();
    let points: Vec<(f64, f64)> = ratios.iter().map(|b| (middle(b), b.ratio)).collect();
    draw::panel(
        draw::log("axis.frequency", "Hz"),
        draw::log("figure.fit.ratio", ""),
        vec![
            draw::band(band, Style::Muted, "figure.fit.correct_model"),
            draw::horizontal(1.0, Style::Model, ""),
            draw::line(points.clone(), Style::Data, "figure.fit.ratio_of_bands"),
            draw::points(points, Style::Data, "figure.fit.ratio_of_bands"),
        ],
    )
}

type Curve = Vec<(f64, f64)>;
type Range = Vec<(f64, f64, f64)>;

/// Joins bins that would fall on one point of the paper: mean, and range so that a line stays visible.
fn join(bins: &[(f64, f64)]) -> (Curve, Range) {
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return (vec![], vec![]) };
    let ratio = (last.0 / first.0).powf(1.0 / MAX_POINTS as f64);
    let (mut mean, mut range) = (Vec::new(), Vec::new());
    let mut i = 0;
    while i < bins.len() {
        let end = bins[i].0 * ratio;
        let mut j = i + 1;
        while j < bins.len() && bins[j].0 < end {
            j += 1;
        }
        let group = &bins[i..j];
        let n = group.len() as f64;
        let f = (group[0].0 * group[group.len() - 1].0).sqrt();
        mean.push((f, group.iter().map(|b| b.1).sum::<f64>() / n));
        let low = group.iter().map(|b| b.1).fold(f64::INFINITY, f64::min);
        let high = group.iter().map(|b| b.1).fold(0.0, f64::max);
        range.push((f, low, high));
        i = j;
    }
    (mean, range)
}
