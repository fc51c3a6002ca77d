//! Power of the record over that of the model, by frequency: runs of neighbouring bands, each length tried.

use super::super::composite::{Composite, Described};
use super::super::evidence::Evidence;
use super::null::{Fitted, at_most_bonferroni};
use super::spectrum::{ModelSpectrum, log_gradients};
use super::view::{Departure, Judged, View};
use crate::noise::identification::misfit::normal_score;
use nalgebra::DMatrix;

/// Degrees of freedom that a band of the test holds at least.
const BAND_DOF: f64 = 12.0;
/// Bands per octave at most.
const PER_OCTAVE: f64 = 6.0;
/// Least share of its variance that the fit leaves to a run that is looked at.
const LEAST_LEFT: f64 = 0.5;

/// Power over model in one band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandRatio {
    /// Lowest frequency, Hz.
    pub low_hz: f64,
    /// Highest frequency, Hz.
    pub high_hz: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Power of the record over that of the model.
    pub ratio: f64,
}

struct Run {
    from: usize,
    to: usize,
    deviation: f64,
}

/// The bands of the test.
pub(super) struct Bands {
    pub bands: Vec<BandRatio>,
    gradient: Vec<Vec<f64>>,
    information: DMatrix<f64>,
}

impl Bands {
    pub fn new(evidence: &Evidence, described: &Described, tau0_s: f64) -> Bands {
        let expectation = |model: &Composite| evidence.expectation(&ModelSpectrum { model, tau0_s });
        let expected = expectation(&described.model);
        let fine = log_gradients(described, expectation);
        let parameters = fine.len();
        let mut bands: Vec<BandRatio> = vec![];
        let mut gradient: Vec<Vec<f64>> = vec![vec![]; parameters];
        let mut information = DMatrix::zeros(parameters, parameters);
        let width = 2f64.powf(1.0 / PER_OCTAVE);
        for (i, (band, expected)) in evidence.bands.iter().zip(&expected).enumerate() {
            let ratio = band.power_without_ramp(described.model.terms.r) / expected;
            if !(ratio.is_finite() && *expected > 0.0 && band.dof > 0.0) {
                continue;
            }
            for p in 0..parameters {
                for q in 0..parameters {
                    information[(p, q)] += 0.5 * band.dof * fine[p][i] * fine[q][i];
                }
            }
            match bands.last_mut() {
                Some(t) if t.dof < BAND_DOF || band.high_hz < t.low_hz * width => {
                    let share = band.dof / (t.dof + band.dof);
                    t.high_hz = t.high_hz.max(band.high_hz);
                    t.ratio += (ratio - t.ratio) * share;
                    t.dof += band.dof;
                    for (g, fine) in gradient.iter_mut().zip(&fine) {
                        if let Some(g) = g.last_mut() {
                            *g += (fine[i] - *g) * share;
                        }
                    }
                }
                _ => {
                    bands.push(BandRatio {
                        low_hz: band.low_hz,
                        high_hz: band.high_hz,
                        dof: band.dof,
                        ratio,
                    });
                    gradient.iter_mut().zip(&fine).for_each(|(g, fine)| g.push(fine[i]));
                }
            }
        }
        Bands { bands, gradient, information }
    }

    /// The run of bands that departs most.
    pub fn judge(&self) -> Option<Judged> {
        let count = self.bands.len();
        if count < 4 {
            return None;
        }
        let root: Vec<f64> = self.bands.iter().map(|b| b.dof.sqrt()).collect();
        let gradient: Vec<Vec<f64>> = self
            .gradient
            .iter()
            .map(|g| g.iter().zip(&self.bands).map(|(g, b)| g * (0.5 * b.dof).sqrt()).collect())
            .collect();
        let fitted = Fitted::new(count, &gradient, &self.information);
        let mut runs = vec![];
        let mut length = 1;
        while length <= count / 2 {
            for from in (0..=count - length).step_by((length / 2).max(1)) {
                let mut weights = vec![0.0; count];
                weights[from..from + length].copy_from_slice(&root[from..from + length]);
                let whole: f64 = weights.iter().map(|w| w * w).sum();
                let left = fitted.variance(&weights);
                if left > LEAST_LEFT * whole {
                    runs.push(Run { from, to: from + length, deviation: left.sqrt() });
                }
            }
            length *= 2;
        }
        let score = |scores: &[f64], run: &Run| {
            let sum: f64 = (run.from..run.to).map(|i| root[i] * scores[i]).sum();
            sum / run.deviation
        };
        let largest = |scores: &[f64]| runs.iter().map(|r| score(scores, r).abs()).fold(0.0, f64::max);
        let scores: Vec<f64> = self.bands.iter().map(|b| normal_score(b.ratio * b.dof, b.dof)).collect();
        let statistic = largest(&scores);
        let p_value = at_most_bonferroni(fitted.probability(statistic, largest), statistic, runs.len());
        let worst = runs.iter().max_by(|a, b| score(&scores, a).abs().total_cmp(&score(&scores, b).abs()))?;
        let inside = self.bands.get(worst.from..worst.to)?;
        let dof: f64 = inside.iter().map(|b| b.dof).sum();
        let ratio = inside.iter().map(|b| b.ratio * b.dof).sum::<f64>() / dof;
        Some(Judged {
            view: View::Frequency,
            statistic,
            p_value,
            departure: Departure {
                from: inside.first()?.low_hz,
                to: inside.iter().map(|b| b.high_hz).fold(0.0, f64::max),
                excess: ratio - 1.0,
            },
        })
    }
}
