//! A description on a logarithmic grid of frequency: where the weight of a statistic lies, and what its parameters
//! can move.

use super::super::composite::{Composite, Described};
use super::spectrum::{ModelSpectrum, log_gradients};
use crate::noise::model::{Bin, Spectral};
use crate::numeric::order::SortNumbers;
use nalgebra::DMatrix;
use std::f64::consts::PI;

/// Bands of one octave.
const PER_OCTAVE: f64 = 12.0;
/// Lowest modes that are bands of their own.
const SINGLE_MODE_BANDS: usize = 24;

/// Bands with their densities.
pub(super) struct Grid {
    /// Length of the record, s.
    pub length_s: f64,
    /// Edges: band i lies between edges i and i + 1, Hz.
    pub edges: Vec<f64>,
    /// Degrees of freedom of each band.
    pub dof: Vec<f64>,
    /// Density of the model, (deg/h)²/Hz.
    pub density: Vec<f64>,
    /// ∂ ln S/∂ ln p, by parameter and band.
    pub gradient: Vec<Vec<f64>>,
}

impl Grid {
    /// The grid of a record over `length_s` sampled at `tau0_s`.
    pub fn new(described: &Described, length_s: f64, tau0_s: f64) -> Grid {
        let nyquist = 0.5 / tau0_s;
        let step = 0.5 / length_s;
        let mut edges: Vec<f64> = (0..SINGLE_MODE_BANDS).map(|k| (k as f64 + 0.5) * step).collect();
        let ratio = 2f64.powf(1.0 / PER_OCTAVE);
        while edges.last().is_some_and(|e| e * ratio < nyquist) {
            let last = edges.last().copied().unwrap_or(step);
            edges.push((last * ratio).max(last + step));
        }
        // Narrow disturbances are resolved.
        for d in &described.model.quasi_periodic {
            let width = (1.0 / (PI * d.decay_time_s)).max(2.0 * step);
            for k in [-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 2.0, 4.0, 8.0] {
                edges.push(d.frequency_hz + k * width);
            }
        }
        edges.retain(|e| *e >= 0.5 * step && *e < nyquist);
        edges.push(nyquist);
        edges.sort_ascending();
        edges.dedup_by(|a, b| *a - *b < 0.2 * step);
        let blocks = (length_s / tau0_s).round().max(1.0) as usize;
        let density = |model: &Composite| -> Vec<f64> {
            let spectrum = ModelSpectrum { model, tau0_s };
            edges
                .windows(2)
                .map(|e| {
                    let at = |share: f64| {
                        let frequency_hz = e[0] + share * (e[1] - e[0]);
                        let mode = ((frequency_hz / step).round() as usize).max(1);
                        spectrum.density(&Bin {
                            frequency_hz,
                            tau_s: tau0_s,
                            filling: 1.0,
                            mode,
                            blocks,
                            segment: 0,
                        })
                    };
                    if e[1] - e[0] < 1.5 * step {
                        at(0.5)
                    } else {
                        (at(0.125) + at(0.375) + at(0.625) + at(0.875)) / 4.0
                    }
                })
                .collect()
        };
        Grid {
            length_s,
            dof: edges.windows(2).map(|e| (e[1] - e[0]) / step).collect(),
            density: density(&described.model),
            gradient: log_gradients(described, density),
            edges,
        }
    }

    /// Fisher information of the logarithms of the parameters.
    pub fn information(&self) -> DMatrix<f64> {
        let p = self.gradient.len();
        DMatrix::from_fn(p, p, |i, j| {
            let pairs = self.gradient[i].iter().zip(&self.gradient[j]).zip(&self.dof);
            pairs.map(|((a, b), dof)| 0.5 * dof * a * b).sum()
        })
    }

    /// Share of each band in the Allan variance of means over `m` samples at `tau0_s`.
    pub fn allan_shares(&self, m: f64, tau0_s: f64) -> Vec<f64> {
        let tau_s = m * tau0_s;
        let mut shares: Vec<f64> = self
            .edges
            .windows(2)
            .zip(&self.density)
            .map(|(e, s)| {
                // sin⁴x = 3/8 − cos 2x/2 + cos 4x/8, averaged over the band.
                let (a, b) = (PI * e[0] * tau_s, PI * e[1] * tau_s);
                let sin4 = if b - a < 0.05 {
                    (0.5 * (a + b)).sin().powi(4)
                } else {
                    0.375
                        + (-0.25 * ((2.0 * b).sin() - (2.0 * a).sin())
                            + ((4.0 * b).sin() - (4.0 * a).sin()) / 32.0)
                            / (b - a)
                };
                let sine = (PI * 0.5 * (e[0] + e[1]) * tau0_s).sin();
                s * (e[1] - e[0]) * sin4.max(0.0) / (m * sine).powi(2)
            })
            .collect();
        let total: f64 = shares.iter().sum();
        if total > 0.0 {
            shares.iter_mut().for_each(|s| *s /= total);
        }
        shares
    }

    /// Mean of each gradient times cos(2πf·lag) over frequencies up to half of 1/`step_s`, for lags 1 … `lags` in steps.
    pub fn lag_gradients(&self, lags: usize, step_s: f64) -> Vec<Vec<f64>> {
        let top = 0.5 / step_s;
        self.gradient
            .iter()
            .map(|g| {
                (1..=lags)
                    .map(|lag| {
                        let w = 2.0 * PI * lag as f64 * step_s;
                        let sum: f64 = self
                            .edges
                            .windows(2)
                            .zip(g)
                            .map(|(e, g)| {
                                let to = e[1].min(top);
                                if to <= e[0] { 0.0 } else { g * ((w * to).sin() - (w * e[0]).sin()) / w }
                            })
                            .sum();
                        sum / top
                    })
                    .collect()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::composite::Parameter;
    use crate::noise::data::NoiseType;
    use crate::noise::model::NoiseModel;

    fn white() -> Described {
        Described {
            model: NoiseModel { n: 0.002, ..NoiseModel::default() }.into(),
            parameters: vec![Parameter::Coefficient(NoiseType::AngleRandomWalk)],
            covariance: vec![vec![1e-10]],
        }
    }

    #[test]
    fn white_noise_has_two_degrees_of_freedom_a_sample_pair() {
        let grid = Grid::new(&white(), 10_000.0, 1.0);
        // One degree of freedom a mode: 2·T·(Nyquist frequency) but for half a mode.
        assert!((grid.dof.iter().sum::<f64>() - 9_999.5).abs() < 1e-6);
        // d ln S / d ln N = 2, so that the information of ln N is 2 n.
        assert!(grid.gradient[0].iter().all(|g| (g - 2.0).abs() < 1e-5));
        assert!((grid.information()[(0, 0)] / (2.0 * 9_999.5) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn shares_of_an_allan_variance_lie_about_its_frequency() {
        let grid = Grid::new(&white(), 10_000.0, 1.0);
        let shares = grid.allan_shares(64.0, 1.0);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let mean: f64 = shares.iter().zip(grid.edges.windows(2)).map(|(s, e)| s * (e[0] + e[1]) / 2.0).sum();
        // The weight sin⁴(πfτ)/(πfτ)² is largest near 0.37/τ and has a heavy tail.
        assert!(mean > 0.3 / 64.0 && mean < 2.0 / 64.0, "{mean}");
    }

    #[test]
    fn shares_are_those_of_an_integral_over_each_band() {
        let grid = Grid::new(&white(), 10_000.0, 1.0);
        for m in [4.0, 300.0] {
            let weight = |e: &[f64], s: f64| {
                let of = |i: u32| e[0] + (e[1] - e[0]) * (f64::from(i) + 0.5) / 2000.0;
                let mean = (0..2000).map(|i| (PI * of(i) * m).sin().powi(4)).sum::<f64>() / 2000.0;
                s * (e[1] - e[0]) * mean / (PI * 0.5 * (e[0] + e[1])).sin().powi(2)
            };
            let weights: Vec<f64> =
                grid.edges.windows(2).zip(&grid.density).map(|(e, s)| weight(e, *s)).collect();
            let total: f64 = weights.iter().sum();
            for (got, expected) in grid.allan_shares(m, 1.0).iter().zip(&weights) {
                assert!((got - expected / total).abs() < 1e-4, "{m}: {got} {}", expected / total);
            }
        }
    }
}
