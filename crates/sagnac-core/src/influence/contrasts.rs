//! The spread between means that are noisy themselves: what is left of it when their noise is taken out.
//!
//! Means mᵢ = xᵢ'β + bᵢ + eᵢ with independent bᵢ of the variance σ² and noise of known covariance C. In contrasts that
//! are free of β and turned to the axes of their noise, Q(σ²) = Σ eₖ²/(σ² + λₖ) is χ² with as many degrees of freedom
//! as there are contrasts, whatever C is (Viechtbauer 2007, "Q profile"; Paule and Mandel 1982 for the value).

use crate::estimate::{Spread, chi_square_quantile, chi_square_tail, normal_probability};
use crate::numeric::optimize::bisect;
use crate::numeric::reml::Combination;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Means with the covariance of their noise.
#[derive(Debug, Clone)]
pub struct Means {
    /// The means.
    pub values: DVector<f64>,
    /// Covariance of their noise.
    pub noise: DMatrix<f64>,
}

/// What columns leave of means, in independent terms.
#[derive(Debug, Clone)]
pub struct Contrasts {
    /// Square and variance of the noise of each.
    terms: Vec<(f64, f64)>,
    /// Factor that the noise was scaled by.
    pub noise_factor: f64,
}

impl Contrasts {
    /// Takes columns out of means; `None` when nothing is left.
    pub fn new(means: &Means, columns: &DMatrix<f64>) -> Option<Contrasts> {
        let n = means.values.len();
        let normal = Cholesky::new(columns.transpose() * columns)?;
        let rest = DMatrix::identity(n, n) - columns * normal.solve(&columns.transpose());
        let own = rest.symmetric_eigen();
        let free: Vec<DVector<f64>> = (0..n)
            .filter(|k| own.eigenvalues[*k] > 0.5)
            .map(|k| own.eigenvectors.column(k).into_owned())
            .collect();
        if free.is_empty() {
            return None;
        }
        let z = DMatrix::from_columns(&free).transpose();
        let turned = (&z * &means.noise * z.transpose()).symmetric_eigen();
        let e = turned.eigenvectors.transpose() * (&z * &means.values);
        let mut terms: Vec<(f64, f64)> =
            e.iter().zip(turned.eigenvalues.iter()).map(|(e, l)| (e * e, l.max(0.0))).collect();
        // Noise that would make the means differ much more than they do is overrated.
        let dof = terms.len() as f64;
        let q = terms.iter().map(|(e, l)| e / l.max(f64::MIN_POSITIVE)).sum::<f64>();
        let mut noise_factor = 1.0;
        if q < chi_square_quantile(0.05, dof) {
            noise_factor = (q / chi_square_quantile(0.5, dof)).min(1.0);
            terms.iter_mut().for_each(|t| t.1 *= noise_factor);
        }
        Some(Contrasts { terms, noise_factor })
    }

    /// Degrees of freedom.
    pub fn dof(&self) -> f64 {
        self.terms.len() as f64
    }

    fn q(&self, variance: f64) -> f64 {
        self.terms.iter().map(|(e, l)| e / (variance + l).max(f64::MIN_POSITIVE)).sum()
    }

    /// The variance at which Q has a value; 0 when it is less at every one.
    fn variance_at(&self, target: f64) -> f64 {
        let total: f64 = self.terms.iter().map(|t| t.0).sum();
        if total <= 0.0 || self.q(0.0) <= target {
            return 0.0;
        }
        let most = total / target.max(f64::MIN_POSITIVE);
        bisect(0.0, most, 200, |v| self.q(v) > target).middle()
    }

    /// The variance between the means, their noise taken out.
    pub fn variance(&self) -> f64 {
        self.variance_at(self.dof())
    }

    /// Confidence that the standard deviation between the means is less.
    pub fn below(&self, deviation: f64) -> f64 {
        chi_square_tail(self.q(deviation * deviation), self.dof())
    }

    /// A standard deviation that is more with a confidence of one in ten thousand only.
    pub fn largest(&self) -> f64 {
        self.variance_at(chi_square_quantile(1e-4, self.dof())).sqrt()
    }

    /// The standard deviation between the means with its confidence distribution.
    pub fn deviation(&self) -> (f64, Spread) {
        let points = (-35..=35)
            .map(|i| {
                let z = f64::from(i) / 10.0;
                let target = chi_square_quantile(1.0 - normal_probability(z), self.dof());
                (z, self.variance_at(target).sqrt())
            })
            .collect();
        (self.variance().sqrt(), Spread::Curve(points))
    }
}

/// A coefficient of columns fitted to means that scatter by `variance` beside their noise.
pub fn coefficient(means: &Means, columns: &DMatrix<f64>, at: usize, variance: f64) -> Option<Combination> {
    let n = means.values.len();
    let dof = n.checked_sub(columns.ncols()).filter(|d| *d > 0)? as f64;
    let smallest = f64::MIN_POSITIVE.max(1e-12 * (variance + means.noise.trace() / n as f64));
    let v = &means.noise + DMatrix::identity(n, n) * variance.max(smallest);
    let factor = Cholesky::new(v)?;
    let weighted = factor.solve(columns);
    let normal = Cholesky::new(columns.transpose() * &weighted)?;
    let beta = normal.solve(&(weighted.transpose() * &means.values));
    let covariance = normal.inverse();
    Some(Combination { value: *beta.get(at)?, standard: covariance[(at, at)].max(0.0).sqrt(), dof })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn means(values: &[f64], variances: &[f64]) -> Means {
        Means {
            values: DVector::from_row_slice(values),
            noise: DMatrix::from_diagonal(&DVector::from_row_slice(variances)),
        }
    }

    fn ones(n: usize) -> DMatrix<f64> {
        DMatrix::from_element(n, 1, 1.0)
    }

    #[test]
    fn without_noise_it_is_the_standard_deviation_with_its_chi_square_interval() {
        // domain: six cycles leave 0.62 … 2.45 times the estimate.
        let m = means(&[1.0, 2.0, 4.0, 3.0, 6.0, 5.0], &[0.0; 6]);
        let (value, spread) = Contrasts::new(&m, &ones(6)).unwrap().deviation();
        assert!((value - 3.5f64.sqrt()).abs() < 1e-9);
        let i = spread.interval(value, 0.95).unwrap();
        assert!((i.low / value - 0.6242).abs() < 2e-3 && (i.high / value - 2.4526).abs() < 6e-3, "{i:?}");
    }

    #[test]
    fn equal_noise_is_taken_out_of_the_variance() {
        let m = means(&[1.0, 2.0, 4.0, 3.0, 6.0, 5.0], &[0.7; 6]);
        let c = Contrasts::new(&m, &ones(6)).unwrap();
        assert!((c.variance() - 2.8).abs() < 1e-9);
    }

    #[test]
    fn unequal_noise_follows_paule_and_mandel() {
        // Two means: (m₁ − m₂)² = 2σ² + u₁² + u₂².
        let m = means(&[0.0, 3.0], &[1.0, 2.0]);
        let c = Contrasts::new(&m, &ones(2)).unwrap();
        assert!((c.variance() - 3.0).abs() < 1e-9);
    }

    #[test]
    fn a_line_through_means_is_least_squares_with_as_many_degrees_of_freedom_as_are_left() {
        let m = means(&[0.0, 1.0, 2.0, 3.5], &[0.0; 4]);
        let x = DMatrix::from_fn(4, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let c = Contrasts::new(&m, &x).unwrap();
        let slope = coefficient(&m, &x, 1, c.variance()).unwrap();
        // By hand: slope 1.15, residual sum of squares 0.075, s² = 0.0375, u = sqrt(s²/5).
        assert!((slope.value - 1.15).abs() < 1e-9 && slope.dof == 2.0);
        assert!((slope.standard - (0.0375f64 / 5.0).sqrt()).abs() < 1e-9, "{}", slope.standard);
    }
}
