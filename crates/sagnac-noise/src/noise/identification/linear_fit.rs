//! Maximum likelihood of N, B, K, Q and R.
//!
//! The expected power of a band is linear in the variances N², B², K² and Q². Fisher scoring: each step is a nonnegative
//! weighted least-squares problem of at most four unknowns, solved exactly by enumerating its active sets; a step that
//! does not raise the likelihood is halved. Public for tests that check the maximum by other arithmetic.

use super::likelihood::{BandPower, best_ramp, deviance, ramp_information, starting_variance, usable_bands};
use super::misfit::WhitenedBand;
use crate::noise::data::NoiseType;
use crate::noise::evidence::Evidence;
use crate::noise::model::{NoiseModel, TERMS};
use crate::numeric::optimize::{nonnegative_quadratic, shortened_steps};

/// Number of terms with a spectrum: the first four of [`TERMS`].
pub const SPECTRAL_TERM_COUNT: usize = 4;
/// Position of the ramp in [`TERMS`].
pub const RAMP_INDEX: usize = 4;

/// Which terms a fit may use, in the order of [`TERMS`].
pub type Structure = [bool; 5];

/// A point of the likelihood: coefficients squared for the four spectral terms, the ramp with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// N², B², K², Q².
    pub variance: [f64; SPECTRAL_TERM_COUNT],
    /// Ramp, deg/h/h.
    pub ramp: f64,
    /// −2 ln L up to a constant of the evidence.
    pub deviance: f64,
}

impl Point {
    /// The model at this point.
    pub fn model(&self) -> NoiseModel {
        let root = |i: usize| self.variance.get(i).copied().unwrap_or(0.0).max(0.0).sqrt();
        NoiseModel { n: root(0), b: root(1), k: root(2), q: root(3), r: self.ramp }
    }

    /// The coefficient at a position of [`TERMS`].
    pub fn coefficient(&self, term: usize) -> f64 {
        self.variance.get(term).map_or(self.ramp, |v| v.max(0.0).sqrt())
    }
}

/// The likelihood of N, B, K, Q and R given an evidence.
pub struct Likelihood {
    bands: Vec<BandPower>,
    /// Expected power of each band for a coefficient of 1 of the four spectral terms.
    basis: Vec<[f64; SPECTRAL_TERM_COUNT]>,
    scale: [f64; SPECTRAL_TERM_COUNT],
}

impl Likelihood {
    /// Prepares the likelihood; `None` when there is no power in any band or too few bands to say anything.
    pub fn new(evidence: &Evidence) -> Option<Likelihood> {
        let (used, bands) = usable_bands(evidence)?;
        let columns: Vec<Vec<f64>> =
            TERMS.iter().take(SPECTRAL_TERM_COUNT).map(|t| evidence.expectation(t)).collect();
        let expected = |i: usize| {
            let mut basis = [0.0; SPECTRAL_TERM_COUNT];
            for (b, column) in basis.iter_mut().zip(&columns) {
                *b = column.get(i).copied().unwrap_or(0.0);
            }
            basis
        };
        let basis: Vec<[f64; SPECTRAL_TERM_COUNT]> = used.into_iter().map(expected).collect();
        let scale =
            std::array::from_fn(|term| starting_variance(bands.iter(), basis.iter().map(|b| b[term])));
        Some(Likelihood { bands, basis, scale })
    }

    /// Every band with its expected power.
    fn expected<'a>(
        &'a self,
        v: &'a [f64; SPECTRAL_TERM_COUNT],
    ) -> impl Iterator<Item = (&'a BandPower, f64)> + Clone + 'a {
        let density = move |basis: &[f64; SPECTRAL_TERM_COUNT]| basis.iter().zip(v).map(|(g, v)| g * v).sum();
        self.bands.iter().zip(self.basis.iter().map(density))
    }

    fn deviance(&self, v: &[f64; SPECTRAL_TERM_COUNT], r: f64, restricted: bool) -> f64 {
        deviance(self.expected(v), r, restricted)
    }

    /// The maximum with the given structure; `fixed` holds one coefficient of [`TERMS`] at a value; `start` is a
    /// point to begin from. `None` when no density is possible (no spectral term allowed).
    pub fn maximise(
        &self,
        structure: &Structure,
        fixed: Option<(usize, f64)>,
        start: Option<&Point>,
    ) -> Option<Point> {
        let mut free = [false; SPECTRAL_TERM_COUNT];
        free.copy_from_slice(&structure[..SPECTRAL_TERM_COUNT]);
        let mut ramp_free = structure[RAMP_INDEX];
        let restricted = structure[RAMP_INDEX] && !matches!(fixed, Some((RAMP_INDEX, _)));
        let mut v = [0.0; SPECTRAL_TERM_COUNT];
        let active = free.iter().filter(|f| **f).count().max(1) as f64;
        for i in 0..SPECTRAL_TERM_COUNT {
            if free[i] {
                // A start at exactly zero stays possible, but from a small value the first step sees every term.
                let own = self.scale[i] / active;
                v[i] = start.map_or(own, |s| s.variance[i].max(1e-3 * own));
            }
        }
        let mut r = match start {
            Some(s) if ramp_free => s.ramp,
            _ => 0.0,
        };
        match fixed {
            Some((RAMP_INDEX, value)) => {
                ramp_free = false;
                r = value;
            }
            Some((term, value)) if term < SPECTRAL_TERM_COUNT => {
                free[term] = false;
                v[term] = value * value;
            }
            _ => {}
        }
        let mut deviance = self.deviance(&v, r, restricted);
        if !deviance.is_finite() {
            return None;
        }
        for _ in 0..200 {
            if ramp_free {
                r = best_ramp(self.expected(&v));
            }
            let before = deviance;
            deviance = self.deviance(&v, r, restricted);
            let target = self.scoring_step(&v, r, &free, restricted);
            let (better, _) = shortened_steps(
                40,
                |step| 0.5 * step,
                |step| {
                    let trial = std::array::from_fn(|i| (v[i] + step * (target[i] - v[i])).max(0.0));
                    let value = self.deviance(&trial, r, restricted);
                    (value < deviance).then_some((trial, value))
                },
            );
            if let Some(better) = better {
                (v, deviance) = better;
            }
            if before - deviance < 1e-7 {
                break;
            }
        }
        Some(Point { variance: v, ramp: r, deviance })
    }

    /// The weighted least-squares problem of one step, scaled to unit columns.
    fn scoring_step(
        &self,
        v: &[f64; SPECTRAL_TERM_COUNT],
        r: f64,
        free: &[bool; SPECTRAL_TERM_COUNT],
        restricted: bool,
    ) -> [f64; SPECTRAL_TERM_COUNT] {
        let (mut h, mut b) = ([[0.0; SPECTRAL_TERM_COUNT]; SPECTRAL_TERM_COUNT], [0.0; SPECTRAL_TERM_COUNT]);
        let ramp_variance =
            if restricted { 1.0 / ramp_information(self.expected(v)).max(f64::MIN_POSITIVE) } else { 0.0 };
        for ((band, s), basis) in self.expected(v).zip(&self.basis) {
            let weight = band.dof / (s * s);
            let held: f64 = (0..SPECTRAL_TERM_COUNT).filter(|i| !free[*i]).map(|i| basis[i] * v[i]).sum();
            let rest = band.without_ramp(r) + ramp_variance * band.ramp - held;
            for ((h, b), gi) in h.iter_mut().zip(&mut b).zip(basis) {
                *b += weight * gi * rest;
                for (h, gj) in h.iter_mut().zip(basis) {
                    *h += weight * gi * gj;
                }
            }
        }
        let best = nonnegative_quadratic(&h, &b, free);
        let mut out = *v;
        for i in 0..SPECTRAL_TERM_COUNT {
            if free[i] {
                out[i] = best[i];
            }
        }
        out
    }

    /// Fisher information of the variances N², B², K², Q² and of the ramp.
    fn information(&self, variance: &[f64; SPECTRAL_TERM_COUNT]) -> [[f64; 5]; 5] {
        let mut out = [[0.0; 5]; 5];
        for ((band, s), basis) in self.expected(variance).zip(&self.basis) {
            if s <= 0.0 {
                continue;
            }
            for (out, gi) in out.iter_mut().zip(basis) {
                for (out, gj) in out.iter_mut().zip(basis) {
                    *out += 0.5 * band.dof * gi * gj / (s * s);
                }
            }
            out[RAMP_INDEX][RAMP_INDEX] += band.dof * band.ramp / s;
        }
        out
    }

    /// Cramér-Rao bound of the covariance of N², B², K², Q² and R within a structure; zero elsewhere. Unlike that of
    /// the coefficients it exists where a term is zero.
    pub fn variance_bound(&self, model: &NoiseModel, structure: &Structure) -> [[f64; 5]; 5] {
        let mut variance = [0.0; SPECTRAL_TERM_COUNT];
        for (v, term) in variance.iter_mut().zip(TERMS) {
            *v = model.coefficient(term).powi(2);
        }
        let information = self.information(&variance);
        let active: Vec<usize> = (0..5).filter(|&i| structure[i] && information[i][i] > 0.0).collect();
        let scale: Vec<f64> = active.iter().map(|&i| information[i][i].sqrt()).collect();
        let matrix = nalgebra::DMatrix::from_fn(active.len(), active.len(), |i, j| {
            information[active[i]][active[j]] / (scale[i] * scale[j])
        });
        let mut out = [[0.0; 5]; 5];
        if let Some(inverse) = matrix.try_inverse() {
            for (a, &i) in active.iter().enumerate() {
                for (b, &j) in active.iter().enumerate() {
                    out[i][j] = inverse[(a, b)] / (scale[a] * scale[b]);
                }
            }
        }
        out
    }

    /// Cramér-Rao bound of the covariance of the coefficients of [`TERMS`] within a structure; zero for terms that
    /// are not in it or have the value zero.
    pub fn covariance_bound(&self, model: &NoiseModel, structure: &Structure) -> [[f64; 5]; 5] {
        let coefficients = TERMS.map(|t| model.coefficient(t));
        let mut present = *structure;
        for (flag, c) in present.iter_mut().zip(coefficients).take(SPECTRAL_TERM_COUNT) {
            *flag &= c != 0.0;
        }
        let mut out = self.variance_bound(model, &present);
        for (i, row) in out.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                for k in [i, j] {
                    if k < SPECTRAL_TERM_COUNT && coefficients[k] != 0.0 {
                        *value /= 2.0 * coefficients[k].abs();
                    }
                }
            }
        }
        out
    }

    /// Standard deviation of the square of a spectral coefficient, the others held: its scale near zero.
    pub fn variance_sigma(&self, point: &Point, term: usize) -> f64 {
        let information: f64 = self
            .expected(&point.variance)
            .zip(&self.basis)
            .map(|((band, s), basis)| {
                let share = basis.get(term).copied().unwrap_or(0.0) / s;
                0.5 * band.dof * share * share
            })
            .sum();
        if information > 0.0 { information.sqrt().recip() } else { 0.0 }
    }

    /// The bands set against the model at a point.
    pub fn whitened(&self, point: &Point) -> Vec<WhitenedBand> {
        self.expected(&point.variance)
            .map(|(band, s)| WhitenedBand { ratio: band.without_ramp(point.ramp) / s, dof: band.dof })
            .collect()
    }
}

/// The structure with one term more or less.
pub fn toggled(structure: &Structure, term: usize, present: bool) -> Structure {
    let mut out = *structure;
    if let Some(flag) = out.get_mut(term) {
        *flag = present;
    }
    out
}

/// Position of a term in [`TERMS`].
pub fn position(term: NoiseType) -> usize {
    TERMS.iter().position(|t| *t == term).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(model: &NoiseModel) -> Evidence {
        Evidence::expected(model, 36_000, 1.0)
    }

    #[test]
    fn the_maximum_on_expected_powers_is_the_model() {
        let model = NoiseModel { n: 0.002, b: 0.004, k: 0.01, r: 0.02, q: 0.3 };
        let likelihood = Likelihood::new(&evidence(&model)).unwrap();
        let fitted = likelihood.maximise(&[true; 5], Some((RAMP_INDEX, model.r)), None).unwrap().model();
        for term in TERMS {
            let ratio = fitted.coefficient(term) / model.coefficient(term);
            assert!((ratio - 1.0).abs() < 1e-3, "{term:?} {ratio}");
        }
    }

    #[test]
    fn white_noise_is_known_to_one_over_the_root_of_twice_its_samples() {
        let model = NoiseModel { n: 0.002, ..NoiseModel::default() };
        let likelihood = Likelihood::new(&evidence(&model)).unwrap();
        let bound = likelihood.covariance_bound(&model, &[true, false, false, false, false]);
        let relative = bound[0][0].sqrt() / model.n;
        assert!((relative * (2.0 * 36_000f64).sqrt() - 1.0).abs() < 1e-3, "{relative}");
        // A ramp against it: σ² = 12·3600² N²·3600/T³ for a straight line in white noise.
        let ramp =
            likelihood.covariance_bound(&model, &[true, false, false, false, true])[RAMP_INDEX][RAMP_INDEX];
        let expected = 12.0 * 3600f64.powi(3) * model.n * model.n / 36_000f64.powi(3);
        assert!((ramp / expected - 1.0).abs() < 1e-2, "{ramp} {expected}");
    }

    #[test]
    fn too_few_bands_or_no_power_have_no_likelihood() {
        assert!(Likelihood::new(&Evidence::default()).is_none());
        assert!(Likelihood::new(&evidence(&NoiseModel::default())).is_none());
    }

    #[test]
    fn the_square_of_a_coefficient_is_known_to_the_root_of_two_over_the_samples() {
        let model = NoiseModel { n: 0.002, ..NoiseModel::default() };
        let likelihood = Likelihood::new(&evidence(&model)).unwrap();
        let point = likelihood.maximise(&[true, false, false, false, false], None, None).unwrap();
        let sigma = likelihood.variance_sigma(&point, 0);
        assert!((sigma / (0.002f64.powi(2) * (2.0f64 / 36_000.0).sqrt()) - 1.0).abs() < 0.01, "{sigma:e}");
    }
}
