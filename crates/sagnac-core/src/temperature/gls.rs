//! Generalised least squares in cosine modes with the noise found beside it.
//!
//! Block means of a rate have nearly independent cosine modes, whose variances follow from N, B and K. The mode of order
//! zero holds the mean alone; flicker and random walk leave it without a variance, so it is left out, and with it the
//! constant of every regressor. N, B and K come by restricted maximum likelihood, which counts the degrees of freedom
//! that the regressors take.

use crate::noise::data::NoiseType;
use crate::noise::model::unit_mode_variance;
use crate::numeric::cholesky::log_determinant;
use crate::numeric::cosine::dct2;
use crate::numeric::optimize::Damping;
use nalgebra::{DMatrix, DVector};
use std::ops::ControlFlow;

/// Terms of the noise: N in deg/sqrt(h), B in deg/h, K in deg/h/sqrt(h).
pub const COURSE_NOISE_TERMS: [NoiseType; 3] =
    [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::RateRandomWalk];

/// Unit variances of the modes 1, 2, ... of a series of block means.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Length of a block, s.
    pub block_s: f64,
    units: Vec<[f64; 3]>,
}

/// Generalised least-squares solution for given noise.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Coefficients of the regressors.
    pub coefficients: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Restricted log-likelihood, without constants.
    pub log_likelihood: f64,
    /// Variances of the modes, (deg/h)².
    pub powers: Vec<f64>,
}

/// N, B and K by restricted maximum likelihood, with the least-squares solution at them.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// N, B, K.
    pub noise: [f64; 3],
    /// The mean for that noise.
    pub solved: Solved,
    /// Standard deviations of the logarithms of N, B, K by the information; large where a term is not seen.
    pub log_deviation: [f64; 3],
}

/// Σ aᵢbᵢwᵢ, in lanes: a single sum waits for every addition before.
fn weighted_dot(a: &[f64], b: &[f64], w: &[f64]) -> f64 {
    const SIMD_LANES: usize = 8;
    let mut sums = [0.0; SIMD_LANES];
    let (ca, cb, cw) = (a.chunks_exact(SIMD_LANES), b.chunks_exact(SIMD_LANES), w.chunks_exact(SIMD_LANES));
    let rest: f64 =
        ca.remainder().iter().zip(cb.remainder()).zip(cw.remainder()).map(|((x, y), w)| x * y * w).sum();
    for ((x, y), w) in ca.zip(cb).zip(cw) {
        for i in 0..SIMD_LANES {
            sums[i] += x[i] * y[i] * w[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

impl Solved {
    /// Logarithm of the determinant of the information of the coefficients; `None` where they are collinear.
    pub fn log_information(&self) -> Option<f64> {
        let factor = self.covariance.clone().cholesky()?;
        Some(-log_determinant(&factor))
    }
}

impl Modes {
    /// For `blocks` means over `block_s`.
    pub fn new(blocks: usize, block_s: f64) -> Modes {
        let unit = |k: usize| COURSE_NOISE_TERMS.map(|t| unit_mode_variance(t, k, blocks, block_s));
        Modes { block_s, units: (1..blocks.max(1)).map(unit).collect() }
    }

    /// Modes 1, 2, ... of a series.
    pub fn of(&self, series: &[f64]) -> Vec<f64> {
        dct2(series).into_iter().skip(1).collect()
    }

    /// Variances of the modes, (deg/h)².
    pub fn powers(&self, noise: &[f64; 3]) -> Vec<f64> {
        let n2 = noise.map(|c| c * c);
        let one = |u: &[f64; 3]| (n2[0] * u[0] + n2[1] * u[1] + n2[2] * u[2]).max(1e-280);
        self.units.iter().map(one).collect()
    }

    /// B and K that reach the level of N at the lowest mode: below, a record hardly shows them.
    pub fn visible(&self, n: f64) -> [f64; 2] {
        let Some(lowest) = self.units.first() else { return [1.0, 1.0] };
        let at = |i: usize| (n * n * lowest[0] / lowest[i]).sqrt().max(1e-300);
        [at(1), at(2)]
    }

    /// Coefficients of the regressors for given N, B and K; `None` when the regressors are collinear.
    pub fn solve(&self, data: &[f64], columns: &[Vec<f64>], noise: &[f64; 3]) -> Option<Solved> {
        let powers = self.powers(noise);
        let p = columns.len();
        let inverse: Vec<f64> = powers.iter().map(|v| 1.0 / v).collect();
        let dot = |a: &[f64], b: &[f64]| weighted_dot(a, b, &inverse);
        let mut matrix = DMatrix::zeros(p, p);
        let mut right = DVector::zeros(p);
        for i in 0..p {
            for j in 0..=i {
                let v = dot(&columns[i], &columns[j]);
                matrix[(i, j)] = v;
                matrix[(j, i)] = v;
            }
            right[i] = dot(&columns[i], data);
        }
        let total = dot(data, data);
        let log_powers: f64 = powers.iter().map(|v| v.ln()).sum();
        if p == 0 {
            return Some(Solved {
                coefficients: right,
                covariance: matrix,
                log_likelihood: -0.5 * (log_powers + total),
                powers,
            });
        }
        // Scaled to a unit diagonal, so that units of the regressors do not matter.
        let scale: Vec<f64> = (0..p).map(|i| matrix[(i, i)].sqrt()).collect();
        if scale.iter().any(|s| !s.is_finite() || *s <= 0.0) {
            return None;
        }
        for i in 0..p {
            for j in 0..p {
                matrix[(i, j)] /= scale[i] * scale[j];
            }
            right[i] /= scale[i];
        }
        let factor = matrix.cholesky()?;
        let solution = factor.solve(&right);
        let left = total - right.dot(&solution);
        let log_determinant: f64 = log_determinant(&factor) + scale.iter().map(|s| 2.0 * s.ln()).sum::<f64>();
        let mut covariance = factor.inverse();
        for i in 0..p {
            for j in 0..p {
                covariance[(i, j)] /= scale[i] * scale[j];
            }
        }
        Some(Solved {
            coefficients: DVector::from_fn(p, |i, _| solution[i] / scale[i]),
            covariance,
            log_likelihood: -0.5 * (log_powers + log_determinant + left),
            powers,
        })
    }

    /// Fits N, B and K beside the mean, by Fisher scoring on their logarithms with backtracking.
    pub fn fit(&self, data: &[f64], columns: &[Vec<f64>], start: Option<[f64; 3]>) -> Option<Fitted> {
        let mut noise = match start {
            Some(noise) => noise,
            None => self.guess(data)?,
        };
        let floor = noise.map(|c| 1e-4 * c);
        let mut solved = self.solve(data, columns, &noise)?;
        let mut damping =
            Damping { value: 1e-3, eased_by: 0.3, least: 1e-9, raised_by: 8.0, least_raised: 1e-6 };
        let mut information = DMatrix::zeros(3, 3);
        for _ in 0..60 {
            let (gradient, fisher) = self.derivatives(data, columns, &noise, &solved);
            information = fisher;
            let mut solvable = true;
            let moved = damping.search(10, |damping| {
                let mut damped = information.clone();
                for i in 0..3 {
                    damped[(i, i)] += damping * information[(i, i)] + 1e-9;
                }
                let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else {
                    return ControlFlow::Break(None);
                };
                let mut next = noise;
                for i in 0..3 {
                    next[i] = (noise[i] * step[i].clamp(-1.5, 1.5).exp()).max(floor[i]);
                }
                match self.solve(data, columns, &next) {
                    Some(tried) if tried.log_likelihood > solved.log_likelihood => {
                        ControlFlow::Break(Some((next, tried)))
                    }
                    Some(_) => ControlFlow::Continue(()),
                    None => {
                        solvable = false;
                        ControlFlow::Break(None)
                    }
                }
            });
            if !solvable {
                return None;
            }
            let Some((next, tried)) = moved else { break };
            let gain = tried.log_likelihood - solved.log_likelihood;
            (noise, solved) = (next, tried);
            if gain < 1e-4 {
                break;
            }
        }
        for i in 0..3 {
            information[(i, i)] += 1e-6;
        }
        let inverse = information.try_inverse()?;
        let log_deviation = [0, 1, 2].map(|i| inverse[(i, i)].max(0.0).sqrt());
        Some(Fitted { noise, solved, log_deviation })
    }

    /// White noise from the upper half of the modes; flicker and walk a part of what the lowest hold.
    fn guess(&self, data: &[f64]) -> Option<[f64; 3]> {
        let upper = data.get(data.len() / 2..)?;
        let mut squares: Vec<f64> = upper.iter().map(|c| c * c).collect();
        if squares.is_empty() {
            return None;
        }
        let middle = squares.len() / 2;
        // The median of χ² with one degree of freedom is 0.4549 of its mean.
        let white = *squares.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.4549;
        let whole: f64 = data.iter().map(|c| c * c).sum::<f64>() / data.len().max(1) as f64;
        let white = if white > 0.0 { white } else { (whole * 1e-6).max(1e-24) };
        let at = self.units.get(self.units.len() / 12)?;
        let last = self.units.last()?;
        Some([(white / last[0]).sqrt(), (0.3 * white / at[1]).sqrt(), (0.1 * white / at[2]).sqrt()])
    }

    /// Gradient and expected information of the restricted likelihood, in logarithms of N, B, K. The leverage of the
    /// regressors is taken out of both.
    fn derivatives(
        &self,
        data: &[f64],
        columns: &[Vec<f64>],
        noise: &[f64; 3],
        solved: &Solved,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let p = columns.len();
        let (mut gradient, mut fisher) = (DVector::zeros(3), DMatrix::zeros(3, 3));
        let mut row = DVector::zeros(p);
        for (k, (unit, power)) in self.units.iter().zip(&solved.powers).enumerate() {
            let mut residual = data[k];
            for (i, column) in columns.iter().enumerate() {
                row[i] = column[k];
                residual -= solved.coefficients[i] * column[k];
            }
            let leverage = if p == 0 { 0.0 } else { (row.dot(&(&solved.covariance * &row))) / power };
            let free = (1.0 - leverage).max(0.0);
            let share = [0, 1, 2].map(|i| 2.0 * noise[i] * noise[i] * unit[i] / power);
            for i in 0..3 {
                gradient[i] += 0.5 * share[i] * (residual * residual / power - free);
                for j in 0..3 {
                    fisher[(i, j)] += 0.5 * share[i] * share[j] * free * free;
                }
            }
        }
        (gradient, fisher)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn normal(rng: &mut rand_xoshiro::Xoshiro256PlusPlus) -> f64 {
        let (u, v): (f64, f64) = (rng.random::<f64>().max(1e-300), rng.random());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    #[test]
    fn slopes_in_a_random_walk_keep_their_intervals() {
        // A column that wanders as the noise does: ordinary least squares would claim a third of them.
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(11);
        let (n, trials) = (400, 400);
        let modes = Modes::new(n, 60.0);
        let (mut outside, mut ordinary) = (0, 0);
        for _ in 0..trials {
            let (mut walk, mut column) = (0.0, 0.0);
            let mut y = vec![];
            let mut x = vec![];
            for _ in 0..n {
                walk += 0.01 * normal(&mut rng);
                column += normal(&mut rng);
                y.push(walk + 0.1 * normal(&mut rng));
                x.push(column);
            }
            let fitted = modes.fit(&modes.of(&y), &[modes.of(&x)], None).unwrap();
            let z = fitted.solved.coefficients[0] / fitted.solved.covariance[(0, 0)].sqrt();
            outside += usize::from(z.abs() > 1.959_964);
            let mean = |v: &[f64]| v.iter().sum::<f64>() / n as f64;
            let (xm, ym) = (mean(&x), mean(&y));
            let sxx: f64 = x.iter().map(|v| (v - xm).powi(2)).sum();
            let slope: f64 = x.iter().zip(&y).map(|(a, b)| (a - xm) * (b - ym)).sum::<f64>() / sxx;
            let rest: f64 = x.iter().zip(&y).map(|(a, b)| (b - ym - slope * (a - xm)).powi(2)).sum();
            ordinary += usize::from(slope.abs() > 1.959_964 * (rest / (n as f64 - 2.0) / sxx).sqrt());
        }
        // Noise fitted from 400 blocks costs some; what is not known of it is added where intervals are made.
        let share = |k: usize| k as f64 / trials as f64;
        assert!(share(outside) < 0.11, "false sensitivities in {}", share(outside));
        assert!(share(ordinary) > 0.25, "ordinary least squares: {}", share(ordinary));
    }

    #[test]
    fn the_noise_comes_back() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        let n = 4000;
        let modes = Modes::new(n, 10.0);
        // N = 0.002 deg/sqrt(h): 60 N/√τ; K = 0.01 deg/h/sqrt(h): steps of K √(τ/h).
        let mut walk = 0.0;
        let y: Vec<f64> = (0..n)
            .map(|_| {
                walk += 0.01 * (10.0f64 / 3600.0).sqrt() * normal(&mut rng);
                walk + 0.12 / 10f64.sqrt() * normal(&mut rng)
            })
            .collect();
        let fitted = modes.fit(&modes.of(&y), &[], None).unwrap();
        assert!((fitted.noise[0] / 0.002 - 1.0).abs() < 0.04, "{:?}", fitted.noise);
        assert!((fitted.noise[2] / 0.01 - 1.0).abs() < 0.4, "{:?}", fitted.noise);
    }
}
