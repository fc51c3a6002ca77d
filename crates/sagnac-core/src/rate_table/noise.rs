//! The noise of parts of a test as matrices: what each kind does to the averages over the parts, to a strength.
//!
//! Drift enters about its own mean over the test: what the bias of the test is, the drift scatters about. So kernels that
//! are only conditionally positive (1/f, random walk) can stand for processes that have no mean.

use nalgebra::{DMatrix, DVector};

/// When and how long each row was measured, and what it shares with others.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Middle, s.
    pub mid_s: Vec<f64>,
    /// Length, s.
    pub length_s: Vec<f64>,
    /// The step each belongs to: rows of one step follow one another without a gap.
    pub step: Vec<usize>,
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.mid_s.len()
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.mid_s.is_empty()
    }

    /// Angle random walk: the strength is N², deg²/h.
    pub fn white(&self) -> DMatrix<f64> {
        DMatrix::from_diagonal(&DVector::from_iterator(self.len(), self.length_s.iter().map(|t| 3600.0 / t)))
    }

    /// White error of angles read at the ends of rows: the strength is its variance, arcsec². Neighbours of one step
    /// share a reading.
    pub fn angle(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.len(), self.len(), |i, j| {
            let product = self.length_s[i] * self.length_s[j];
            if i == j {
                2.0 / product
            } else if i.abs_diff(j) == 1 && self.step[i] == self.step[j] {
                -1.0 / product
            } else {
                0.0
            }
        })
    }

    /// Flicker with the two-sided density B²/(2πf): the strength is B², (deg/h)².
    pub fn flicker(&self) -> DMatrix<f64> {
        let h = 1.0 / std::f64::consts::PI;
        // Second integral of ln|t|.
        let integral = |t: f64| {
            let t = t.abs();
            if t > 0.0 { 0.5 * t * t * t.ln() - 0.75 * t * t } else { 0.0 }
        };
        self.centred(|d, a, b| -h * second_difference(&integral, d, a, b))
    }

    /// Rate random walk: the strength is K², (deg/h)²/h.
    pub fn random_walk(&self) -> DMatrix<f64> {
        let integral = |t: f64| t.abs().powi(3) / 6.0;
        self.centred(|d, a, b| -0.5 / 3600.0 * second_difference(&integral, d, a, b))
    }

    /// Matrix with 1 between rows of one group, whose part is common, and 0 between groups.
    pub fn shared(&self, group: &[usize]) -> DMatrix<f64> {
        DMatrix::from_fn(self.len(), self.len(), |i, j| if group[i] == group[j] { 1.0 } else { 0.0 })
    }

    /// A kernel of distance and the two lengths, s, about the mean of the test.
    fn centred(&self, kernel: impl Fn(f64, f64, f64) -> f64) -> DMatrix<f64> {
        let n = self.len();
        let full = DMatrix::from_fn(n, n, |i, j| {
            kernel(self.mid_s[i] - self.mid_s[j], self.length_s[i], self.length_s[j])
        });
        let total: f64 = self.length_s.iter().sum();
        let weights = DVector::from_iterator(n, self.length_s.iter().map(|t| t / total));
        let means = &full * &weights;
        let mean = weights.dot(&means);
        DMatrix::from_fn(n, n, |i, j| full[(i, j)] - means[i] - means[j] + mean)
    }
}

/// The mean over two intervals of lengths a and b, d apart, of a function of the difference of two times, from its
/// second integral.
fn second_difference(integral: &impl Fn(f64) -> f64, d: f64, a: f64, b: f64) -> f64 {
    let (near, far) = (0.5 * (a - b), 0.5 * (a + b));
    (integral(d + far) - integral(d + near) - integral(d - near) + integral(d - far)) / (a * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(n: usize, length_s: f64) -> Rows {
        Rows {
            mid_s: (0..n).map(|i| (i as f64 + 0.5) * length_s).collect(),
            length_s: vec![length_s; n],
            step: vec![0; n],
        }
    }

    /// The Allan variance that a covariance of consecutive averages implies.
    fn allan(v: &DMatrix<f64>, i: usize) -> f64 {
        0.5 * (v[(i, i)] + v[(i + 1, i + 1)] - 2.0 * v[(i, i + 1)])
    }

    #[test]
    fn each_kernel_has_its_allan_variance() {
        // IEEE Std 952, Annex C: N²/τ, (2 ln 2/π) B², K²τ/3; for angle noise 3Q²/τ² with the variance Q² of a reading.
        let r = rows(8, 30.0);
        let tau_h: f64 = 30.0 / 3600.0;
        assert!((allan(&r.white(), 3) * tau_h - 1.0).abs() < 1e-12);
        assert!((allan(&r.flicker(), 3) - 2.0 * 2f64.ln() / std::f64::consts::PI).abs() < 1e-9);
        assert!((allan(&r.random_walk(), 3) / (tau_h / 3.0) - 1.0).abs() < 1e-9);
        assert!((allan(&r.angle(), 3) * 900.0 / 3.0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn kernels_about_the_mean_are_not_negative() {
        for v in [rows(12, 10.0).flicker(), rows(12, 10.0).random_walk()] {
            let least = v.clone().symmetric_eigen().eigenvalues.min();
            assert!(least > -1e-9 * v.trace(), "{least}");
        }
    }
}
