//! Maximum Whittle likelihood over spectral evidence.
//!
//! −2 ln L = Σ dof·[ln s + P/s], where s is linear in the variances N², B², K², Q² and P is the band power with the
//! ramp taken out. Fisher scoring: each step is a nonnegative weighted least-squares problem of at most four
//! unknowns, solved exactly by enumerating its active sets; a step that does not raise the likelihood is halved.

use super::data::NoiseType;
use super::evidence::Evidence;
use super::model::{NoiseModel, TERMS};

/// Number of terms with a spectrum: the first four of [`TERMS`].
pub const SPECTRAL: usize = 4;
/// Position of the ramp in [`TERMS`].
pub const RAMP: usize = 4;

/// Which terms a fit may use, in the order of [`TERMS`].
pub type Structure = [bool; 5];

/// A point of the likelihood: coefficients squared for the four spectral terms, the ramp with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// N², B², K², Q².
    pub variance: [f64; SPECTRAL],
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

struct Row {
    dof: f64,
    power: f64,
    cross: f64,
    ramp: f64,
    basis: [f64; SPECTRAL],
}

impl Row {
    fn power_without(&self, r: f64) -> f64 {
        (self.power - 2.0 * r * self.cross + r * r * self.ramp).max(0.0)
    }

    fn density(&self, v: &[f64; SPECTRAL]) -> f64 {
        self.basis.iter().zip(v).map(|(g, v)| g * v).sum()
    }
}

/// The likelihood of an evidence.
pub struct Likelihood {
    rows: Vec<Row>,
    scale: [f64; SPECTRAL],
}

impl Likelihood {
    /// Prepares the likelihood; `None` when there is no power in any band or too few bands to say anything.
    pub fn new(evidence: &Evidence) -> Option<Likelihood> {
        let columns: Vec<Vec<f64>> =
            TERMS.iter().take(SPECTRAL).map(|term| evidence.expectation(term)).collect();
        let usable = |p: f64| p.is_finite() && p >= 0.0;
        let rows: Vec<Row> = evidence
            .bands
            .iter()
            .enumerate()
            .filter(|(_, band)| usable(band.power) && band.dof > 0.0)
            .map(|(i, band)| {
                let mut basis = [0.0; SPECTRAL];
                for (b, column) in basis.iter_mut().zip(&columns) {
                    *b = column.get(i).copied().unwrap_or(0.0);
                }
                Row { dof: band.dof, power: band.power, cross: band.cross, ramp: band.ramp, basis }
            })
            .collect();
        let total: f64 = rows.iter().map(|r| r.dof * r.power).sum();
        if rows.len() < 8 || total <= 0.0 || !total.is_finite() {
            return None;
        }
        // A starting size for each term: what it would be if it alone made all the power, on a harmonic average
        // that the smallest bands rule.
        let mut scale = [0.0; SPECTRAL];
        let mean_power = total / rows.iter().map(|r| r.dof).sum::<f64>();
        for (i, s) in scale.iter_mut().enumerate() {
            let (mut sum, mut dof) = (0.0, 0.0);
            for row in &rows {
                sum += row.dof * row.basis[i] / (row.power + 1e-9 * mean_power);
                dof += row.dof;
            }
            *s = if sum > 0.0 { dof / sum } else { 0.0 };
        }
        Some(Likelihood { rows, scale })
    }

    fn deviance(&self, v: &[f64; SPECTRAL], r: f64, restricted: bool) -> f64 {
        let mut sum = if restricted { self.ramp_information(v).max(f64::MIN_POSITIVE).ln() } else { 0.0 };
        for row in &self.rows {
            let s = row.density(v);
            if s <= 0.0 || !s.is_finite() {
                return f64::INFINITY;
            }
            sum += row.dof * (s.ln() + row.power_without(r) / s);
        }
        sum
    }

    /// The maximum with the given structure; `fixed` holds one coefficient of [`TERMS`] at a value; `start` is a
    /// point to begin from. `None` when no density is possible (no spectral term allowed).
    pub fn maximise(
        &self,
        structure: &Structure,
        fixed: Option<(usize, f64)>,
        start: Option<&Point>,
    ) -> Option<Point> {
        let mut free = [false; SPECTRAL];
        free.copy_from_slice(&structure[..SPECTRAL]);
        let mut ramp_free = structure[RAMP];
        // A ramp that is fitted takes a degree of freedom from the noise: restricted likelihood gives it back.
        let restricted = structure[RAMP] && !matches!(fixed, Some((RAMP, _)));
        let mut v = [0.0; SPECTRAL];
        let active = free.iter().filter(|f| **f).count().max(1) as f64;
        for i in 0..SPECTRAL {
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
            Some((RAMP, value)) => {
                ramp_free = false;
                r = value;
            }
            Some((term, value)) if term < SPECTRAL => {
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
                r = self.best_ramp(&v);
            }
            let before = deviance;
            deviance = self.deviance(&v, r, restricted);
            let target = self.scoring_step(&v, r, &free, restricted);
            let mut step = 1.0;
            for _ in 0..40 {
                let mut trial = v;
                for i in 0..SPECTRAL {
                    trial[i] = (v[i] + step * (target[i] - v[i])).max(0.0);
                }
                let value = self.deviance(&trial, r, restricted);
                if value < deviance {
                    (v, deviance) = (trial, value);
                    break;
                }
                step *= 0.5;
            }
            if before - deviance < 1e-7 {
                break;
            }
        }
        Some(Point { variance: v, ramp: r, deviance })
    }

    /// Fisher information of the ramp.
    fn ramp_information(&self, v: &[f64; SPECTRAL]) -> f64 {
        self.rows.iter().map(|row| row.dof * row.ramp / row.density(v)).sum()
    }

    fn best_ramp(&self, v: &[f64; SPECTRAL]) -> f64 {
        let (mut cross, mut square) = (0.0, 0.0);
        for row in &self.rows {
            let weight = row.dof / row.density(v);
            cross += weight * row.cross;
            square += weight * row.ramp;
        }
        if square > 0.0 { cross / square } else { 0.0 }
    }

    /// The weighted least-squares problem of one step, scaled to unit columns.
    fn scoring_step(
        &self,
        v: &[f64; SPECTRAL],
        r: f64,
        free: &[bool; SPECTRAL],
        restricted: bool,
    ) -> [f64; SPECTRAL] {
        let (mut h, mut b) = ([[0.0; SPECTRAL]; SPECTRAL], [0.0; SPECTRAL]);
        let ramp_variance =
            if restricted { 1.0 / self.ramp_information(v).max(f64::MIN_POSITIVE) } else { 0.0 };
        for row in &self.rows {
            let s = row.density(v);
            let weight = row.dof / (s * s);
            let held: f64 = (0..SPECTRAL).filter(|i| !free[*i]).map(|i| row.basis[i] * v[i]).sum();
            let rest = row.power_without(r) + ramp_variance * row.ramp - held;
            for ((h, b), gi) in h.iter_mut().zip(&mut b).zip(row.basis) {
                *b += weight * gi * rest;
                for (h, gj) in h.iter_mut().zip(row.basis) {
                    *h += weight * gi * gj;
                }
            }
        }
        let best = nonnegative(&h, &b, free);
        let mut out = *v;
        for i in 0..SPECTRAL {
            if free[i] {
                out[i] = best[i];
            }
        }
        out
    }

    /// Fisher information of the variances N², B², K², Q² and of the ramp.
    fn information(&self, variance: &[f64; SPECTRAL]) -> [[f64; 5]; 5] {
        let mut out = [[0.0; 5]; 5];
        for row in &self.rows {
            let s = row.density(variance);
            if s <= 0.0 {
                continue;
            }
            for (out, gi) in out.iter_mut().zip(row.basis) {
                for (out, gj) in out.iter_mut().zip(row.basis) {
                    *out += 0.5 * row.dof * gi * gj / (s * s);
                }
            }
            out[RAMP][RAMP] += row.dof * row.ramp / s;
        }
        out
    }

    /// Cramér-Rao bound of the covariance of N², B², K², Q² and R within a structure; zero elsewhere. Unlike that of
    /// the coefficients it exists where a term is zero.
    pub fn variance_bound(&self, model: &NoiseModel, structure: &Structure) -> [[f64; 5]; 5] {
        let mut variance = [0.0; SPECTRAL];
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
        for (flag, c) in present.iter_mut().zip(coefficients).take(SPECTRAL) {
            *flag &= c != 0.0;
        }
        let mut out = self.variance_bound(model, &present);
        for (i, row) in out.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                for k in [i, j] {
                    if k < SPECTRAL && coefficients[k] != 0.0 {
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
            .rows
            .iter()
            .map(|row| {
                let share = row.basis.get(term).copied().unwrap_or(0.0) / row.density(&point.variance);
                0.5 * row.dof * share * share
            })
            .sum();
        if information > 0.0 { information.sqrt().recip() } else { 0.0 }
    }

    /// Power over density and degrees of freedom of each band at a point.
    pub fn whitened(&self, point: &Point) -> Vec<(f64, f64)> {
        self.rows
            .iter()
            .map(|row| (row.power_without(point.ramp) / row.density(&point.variance), row.dof))
            .collect()
    }
}

/// min ½xᵀHx − bᵀx over x ≥ 0 with x = 0 where not free: every active set tried, the best feasible one kept.
fn nonnegative(
    h: &[[f64; SPECTRAL]; SPECTRAL],
    b: &[f64; SPECTRAL],
    free: &[bool; SPECTRAL],
) -> [f64; SPECTRAL] {
    let mut best = ([0.0; SPECTRAL], 0.0);
    for set in 1u32..(1 << SPECTRAL) {
        let indices: Vec<usize> = (0..SPECTRAL).filter(|i| set >> i & 1 == 1).collect();
        if indices.iter().any(|&i| !free[i] || h[i][i] <= 0.0) {
            continue;
        }
        let scale: Vec<f64> = indices.iter().map(|&i| h[i][i].sqrt()).collect();
        let n = indices.len();
        let matrix =
            nalgebra::DMatrix::from_fn(n, n, |i, j| h[indices[i]][indices[j]] / (scale[i] * scale[j]));
        let right = nalgebra::DVector::from_fn(n, |i, _| b[indices[i]] / scale[i]);
        let Some(solution) = matrix.cholesky().map(|c| c.solve(&right)) else { continue };
        if solution.iter().any(|x| *x < 0.0 || !x.is_finite()) {
            continue;
        }
        let value = -0.5 * solution.dot(&right);
        if value < best.1 {
            let mut x = [0.0; SPECTRAL];
            for (i, &index) in indices.iter().enumerate() {
                x[index] = solution[i] / scale[i];
            }
            best = (x, value);
        }
    }
    best.0
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
