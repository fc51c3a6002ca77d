//! Expected band powers of each part for a coefficient of 1.

use super::model::BASE_TERMS;
use crate::noise::composite::{
    Bandwidth, Composite, Damped, Densities, Sampling, averaged_white_mode, filtered_white, sampled_density,
};
use crate::noise::data::NoiseType;
use crate::noise::evidence::{Evidence, Places, Transform};
use crate::noise::model::{Bin, Spectral, bin_ratio};
use std::cell::Cell;
use std::f64::consts::PI;
use std::sync::Arc;

/// A term behind a filter.
struct Filtered {
    term: NoiseType,
    filter: Option<Bandwidth>,
    tau0_s: f64,
    sampling: Sampling,
    /// White noise behind a filter of first order over the interval that was asked for last.
    white: Cell<Option<(f64, Densities)>>,
}

impl Spectral for Filtered {
    fn density(&self, bin: &Bin) -> f64 {
        let (f, tau) = (bin.frequency_hz, bin.tau_s);
        let plain = match self.filter {
            None => sampled_density(self.term, f, tau, self.sampling_of(bin)),
            Some(Bandwidth::FirstOrder { time_constant_s }) if self.term == NoiseType::AngleRandomWalk => {
                let white = match self.white.get() {
                    Some((tau_s, white)) if tau_s == tau => white,
                    _ => filtered_white(time_constant_s).densities(tau, self.sampling_of(bin)),
                };
                self.white.set(Some((tau, white)));
                white.at(f)
            }
            Some(filter @ Bandwidth::FirstOrder { .. }) => {
                filter.unit_density(self.term, f, tau, self.sampling_of(bin))
            }
            Some(Bandwidth::MovingAverage { samples })
                if bin.mode > 0 && tau <= 1.5 * self.tau0_s && self.term == NoiseType::AngleRandomWalk =>
            {
                sampled_density(self.term, f, tau, self.sampling)
                    * averaged_white_mode(samples, bin.mode as f64, bin.blocks)
            }
            Some(Bandwidth::MovingAverage { samples }) => {
                let n = f64::from(samples.max(1));
                let x = PI * f * self.tau0_s;
                let rounding = self.term == NoiseType::Quantization || x.sin().abs() < 1e-12;
                let gain = if rounding { 1.0 } else { (n * x).sin() / (n * x.sin()) };
                gain * gain * sampled_density(self.term, f, tau, self.sampling_of(bin))
            }
        };
        plain * bin_ratio(self.term, bin)
    }
}

impl Filtered {
    fn sampling_of(&self, bin: &Bin) -> Sampling {
        sampling_of_means(bin.tau_s, self.tau0_s, self.sampling)
    }
}

/// Means over blocks of instantaneous samples are averages to a good approximation.
fn sampling_of_means(tau_s: f64, tau0_s: f64, sampling: Sampling) -> Sampling {
    if tau_s > 1.5 * tau0_s { Sampling::Averaging } else { sampling }
}

/// The columns of N, B, K and Q behind a filter.
pub(super) fn base(evidence: &Evidence, filter: Option<Bandwidth>, sampling: Sampling) -> Vec<Vec<f64>> {
    BASE_TERMS
        .iter()
        .map(|term| {
            if filter.is_none() && sampling == Sampling::Averaging {
                return evidence.expectation(term);
            }
            let (tau0_s, white) = (evidence.tau0_s, Cell::new(None));
            evidence.expectation(&Filtered { term: *term, filter, tau0_s, sampling, white })
        })
        .collect()
}

/// The column of one process of standard deviation 1 at places of an evidence with samples over `tau0_s`.
pub(super) fn process(places: &Places, tau0_s: f64, process: &Damped, sampling: Sampling) -> Vec<f64> {
    let unit = Damped { rms_deg_h: 1.0, ..*process };
    places.expectation(|transform, tau_s, turns, out| {
        let sampling = sampling_of_means(tau_s, tau0_s, sampling);
        match transform {
            Transform::Modes(blocks) => unit.modes(blocks, tau_s, sampling).powers(turns, out),
            Transform::Segments(length) => unit.windowed(length, tau_s, sampling).densities(turns, out),
        }
    })
}

/// The columns of N, B, K and Q, shared by all shapes behind the same filter.
pub(super) type Base = Arc<Vec<Vec<f64>>>;

/// All columns of a shape.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    pub(super) base: Base,
    pub(super) damped: Vec<Arc<Vec<f64>>>,
}

impl Columns {
    pub(super) fn all(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.base.iter().chain(self.damped.iter().map(Arc::as_ref))
    }
}

/// Expected power of each band under a model, (deg/h)²/Hz, without its ramp and lines.
pub fn expected_power(evidence: &Evidence, model: &Composite) -> Vec<f64> {
    let coefficients = BASE_TERMS.iter().map(|t| model.terms.coefficient(*t).powi(2));
    let base = base(evidence, model.bandwidth, model.sampling).into_iter().zip(coefficients);
    let damped = model.markov.iter().chain(&model.quasi_periodic);
    let places = evidence.places();
    let damped = damped.map(|d| (process(&places, evidence.tau0_s, d, model.sampling), d.rms_deg_h.powi(2)));
    let mut out = vec![0.0; evidence.bands.len()];
    for (column, square) in base.chain(damped).filter(|(_, square)| *square > 0.0) {
        for (o, c) in out.iter_mut().zip(column) {
            *o += square * c;
        }
    }
    out
}
