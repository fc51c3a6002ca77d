//! The spectrum of the residual with that of the claim, and of the claim with what was added.

use super::{axis, line, shaded};
use crate::effect::{Domain, Place};
use crate::estimate::chi_square_quantile;
use crate::figure::{Figure, Layer, Panel, Scale, Style};

/// Most points of a curve: beyond, neighbouring bins are joined, evenly on the logarithmic axis.
const MAX_CURVE_POINTS: usize = 500;

/// Densities of the residual and of the models, bin by bin.
#[derive(Debug, Clone, Copy)]
pub struct Spectra<'a> {
    /// Middle of each bin, Hz, rising.
    pub frequency_hz: &'a [f64],
    /// Degrees of freedom of each bin.
    pub dof: &'a [f64],
    /// Density of the residual of the claim, (deg/h)²/Hz.
    pub observed: &'a [f64],
    /// Density of the residual of the augmented claim. `None` where nothing determined was added.
    pub observed_after: Option<&'a [f64]>,
    /// Density that the claim expects.
    pub claim: &'a [f64],
    /// Density that the augmented claim expects. `None` where nothing was added.
    pub augmented: Option<&'a [f64]>,
    /// Interval in which the mismatch was located.
    pub places: &'a [Place],
}

/// A group of bins drawn as one point.
struct Joined {
    f: f64,
    dof: f64,
    values: [f64; 4],
}

/// Draws the spectra, and under them the residual over each model. `None` with fewer than four bins.
pub fn spectrum(s: &Spectra<'_>) -> Option<Figure> {
    let bins = joined(s);
    if bins.len() < 4 {
        return None;
    }
    let curve = |of: usize| bins.iter().map(|b| (b.f, b.values[of])).collect::<Vec<_>>();
    let band = bins.iter().map(|b| {
        let at = |p: f64| chi_square_quantile(p, b.dof) / b.dof;
        (b.f, b.values[2] * at(0.025), b.values[2] * at(0.975))
    });
    let ends = bins.first().zip(bins.last()).map(|(a, b)| (a.f, b.f));
    let mut layers: Vec<Layer> = shaded(s.places, &[Domain::Frequency], ends, Scale::Log).collect();
    layers.push(Layer::Band {
        points: band.collect(),
        style: Style::Muted,
        legend: "figure.explain.claim_band".into(),
    });
    layers.push(line(curve(0), Style::Data, "figure.explain.before"));
    if s.observed_after.is_some() {
        layers.push(line(curve(1), Style::SecondData, "figure.explain.after"));
    }
    layers.push(line(curve(2), Style::Model, "figure.explain.claim"));
    if s.augmented.is_some() {
        layers.push(line(curve(3), Style::Term(2), "figure.explain.augmented"));
    }
    let over = |top: usize, model: usize| {
        bins.iter().map(|b| (b.f, b.values[top] / b.values[model])).collect::<Vec<_>>()
    };
    let correct = bins.iter().map(|b| {
        let at = |p: f64| chi_square_quantile(p, b.dof) / b.dof;
        (b.f, at(0.025), at(0.975))
    });
    let mut below: Vec<Layer> = shaded(s.places, &[Domain::Frequency], ends, Scale::Log).collect();
    below.push(Layer::Band {
        points: correct.collect(),
        style: Style::Muted,
        legend: "figure.explain.band".into(),
    });
    below.push(Layer::Horizontal { at: 1.0, style: Style::Model, legend: String::new() });
    below.push(line(over(0, 2), Style::Data, "figure.explain.over_claim"));
    if s.augmented.is_some() || s.observed_after.is_some() {
        below.push(line(over(1, 3), Style::SecondData, "figure.explain.over_augmented"));
    }
    let x = || axis("axis.frequency", "Hz", Scale::Log);
    Some(Figure {
        id: "residual_spectrum".into(),
        title: "figure.explain.title_spectrum".into(),
        channel: String::new(),
        panels: vec![
            Panel { x: x(), y: axis("axis.density", "(deg/h)^2/Hz", Scale::Log), layers },
            Panel { x: x(), y: axis("figure.explain.ratio", "", Scale::Log), layers: below },
        ],
        remarks: vec![],
    })
}

/// Bins that fall on one point of the paper, joined with their degrees of freedom as weights.
fn joined(s: &Spectra<'_>) -> Vec<Joined> {
    let n =
        [s.frequency_hz.len(), s.dof.len(), s.observed.len(), s.claim.len()].into_iter().min().unwrap_or(0);
    let value = |of: Option<&[f64]>, instead: &[f64], i: usize| {
        of.and_then(|v| v.get(i)).or_else(|| instead.get(i)).copied().unwrap_or(f64::NAN)
    };
    let usable: Vec<Joined> = (0..n)
        .map(|i| Joined {
            f: s.frequency_hz[i],
            dof: s.dof[i],
            values: [
                s.observed[i],
                value(s.observed_after, s.observed, i),
                s.claim[i],
                value(s.augmented, s.claim, i),
            ],
        })
        .filter(|b| b.f > 0.0 && b.dof >= 1.0 && b.values.iter().all(|v| *v > 0.0 && v.is_finite()))
        .collect();
    let (Some(first), Some(last)) = (usable.first(), usable.last()) else { return vec![] };
    let step = (last.f / first.f).max(1.0).powf(1.0 / MAX_CURVE_POINTS as f64);
    let mut out: Vec<Joined> = vec![];
    let mut end = 0.0;
    for bin in usable {
        match out.last_mut().filter(|_| bin.f < end) {
            Some(group) => {
                let (a, b) = (group.dof, bin.dof);
                let mix = |x: f64, y: f64| (a * x + b * y) / (a + b);
                group.f = mix(group.f, bin.f);
                group.dof = a + b;
                for (x, y) in group.values.iter_mut().zip(bin.values) {
                    *x = mix(*x, y);
                }
            }
            None => {
                end = bin.f * step;
                out.push(bin);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joining_keeps_power_and_degrees_of_freedom() {
        let n = 20_000;
        let f: Vec<f64> = (1..=n).map(|i| f64::from(i) * 1e-3).collect();
        let dof = vec![1.0; n as usize];
        let observed: Vec<f64> = (0..n).map(|i| if i % 2 == 0 { 1.0 } else { 3.0 }).collect();
        let claim = vec![2.0; n as usize];
        let s = Spectra {
            frequency_hz: &f,
            dof: &dof,
            observed: &observed,
            observed_after: None,
            claim: &claim,
            augmented: None,
            places: &[],
        };
        let bins = joined(&s);
        assert!(bins.len() <= MAX_CURVE_POINTS + 1 && bins.len() > 300, "{}", bins.len());
        let total: f64 = bins.iter().map(|b| b.dof).sum();
        let power: f64 = bins.iter().map(|b| b.dof * b.values[0]).sum();
        assert!((total - 20_000.0).abs() < 1e-6 && (power / total - 2.0).abs() < 1e-9);
        assert_eq!(spectrum(&s).map(|f| f.panels.len()), Some(2));
        assert!(spectrum(&Spectra { observed: &observed[..3], ..s }).is_none());
    }
}
