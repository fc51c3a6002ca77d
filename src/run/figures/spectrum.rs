//! The averaged periodogram with the model and the lines.

use super::{axis, line};
use crate::figure::{Figure, Layer, Panel, Scale, Style};
use crate::measurand::GyroEvidence;
use crate::text::{Arg, Note};

/// Most points drawn: beyond, neighbouring bins are joined, evenly on the logarithmic axis.
const POINTS: usize = 700;
/// Most lines that get a label.
const LABELS: usize = 6;

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
    let model = &gyro.identification.supported;
    let curve = (0..160)
        .map(|i| first * (last / first).powf(f64::from(i) / 159.0))
        .map(|f| (f, model.density(f, gyro.tau0_s)))
        .collect();
    let mut layers = Vec::new();
    if range.len() < bins.len() {
        layers.push(Layer::Band { points: range, style: Style::Data, legend: "figure.legend.range".into() });
    }
    layers.push(line(mean, Style::Data, "figure.legend.spectrum"));
    layers.push(line(curve, Style::Model, "figure.legend.model"));
    let at = |f: f64| {
        let k = (f / step_hz).round() as usize;
        spectrum.density.get(k).map(|d| (f, d * gyro.tau0_s))
    };
    let points: Vec<(f64, f64)> = gyro.lines.iter().filter_map(|l| at(l.frequency_hz)).collect();
    if !points.is_empty() {
        layers.push(Layer::Points { points, style: Style::Reference, legend: "figure.legend.line".into() });
    }
    let mut strongest: Vec<_> = gyro.lines.iter().filter(|l| l.harmonic_of.is_none()).collect();
    strongest.sort_by(|a, b| b.amplitude_deg_h.total_cmp(&a.amplitude_deg_h));
    for found in strongest.into_iter().take(LABELS) {
        if let Some(place) = at(found.frequency_hz) {
            let frequency = Arg::figures(found.frequency_hz, 4);
            let text = Note::new("figure_label.line").with("frequency", frequency);
            layers.push(Layer::Label { at: place, text });
        }
    }
    Some(Figure {
        id: gyro.figure_id("spectrum"),
        title: "figure.title.spectrum",
        channel: gyro.figure_channel(),
        panels: vec![Panel {
            x: axis("axis.frequency", "Hz", Scale::Log),
            y: axis("axis.density", "(deg/h)^2/Hz", Scale::Log),
            layers,
        }],
        remarks: vec![Note::new("figure.remark.resolution").with("hz", step_hz)],
    })
}

type Curve = Vec<(f64, f64)>;
type Range = Vec<(f64, f64, f64)>;

/// Joins bins that would fall on one point of the paper: mean, and range so that a line stays visible.
fn join(bins: &[(f64, f64)]) -> (Curve, Range) {
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return (vec![], vec![]) };
    let ratio = (last.0 / first.0).powf(1.0 / POINTS as f64);
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
