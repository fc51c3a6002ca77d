//! The restricted likelihood of values with known uncertainty in lots: y = μ + lot + unit + error, in terms of the variances
//! between lots and between units, and the reference prior of these.
//!
//! The covariance of a lot is diagonal but for a constant, so that everything follows from sums over its units.

/// The power of the share of a variance between lots that cannot be seen, as its prior has it: 1 is the prior of Jeffreys, whose
/// intervals are far too wide for a few lots that differ little. Tails are the same with any.
const TOWARD_NONE: f64 = 0.25;

/// Values of one lot, with the variance of each.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Lot {
    pub(super) values: Vec<f64>,
    pub(super) variances: Vec<f64>,
}

/// Variances between units and between lots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Variances {
    pub(super) units: f64,
    /// `None` where lots are not told apart.
    pub(super) lots: Option<f64>,
}

impl Variances {
    /// The variance of a unit taken at random.
    pub(super) fn total(self) -> f64 {
        self.units + self.lots.unwrap_or(0.0)
    }
}

/// What the values tell with given variances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Level {
    /// Mean by generalised least squares.
    pub(super) mean: f64,
    /// Its variance.
    pub(super) variance: f64,
    /// Logarithm of the restricted likelihood and the prior of the variances.
    pub(super) log_density: f64,
}

/// Weights of one lot: Σ1/d and Σy/d with d the variance of a value about its lot.
pub(super) fn weights(lot: &Lot, units: f64) -> (f64, f64) {
    let pairs = lot.values.iter().zip(&lot.variances);
    pairs.fold((0.0, 0.0), |(sum, first), (y, u)| {
        let weight = 1.0 / (units + u);
        (sum + weight, first + weight * y)
    })
}

/// The mean and the density of some variances.
///
/// The prior is that of Jeffreys for the variances in the restricted likelihood, flat in the mean. For equal uncertainties it
/// is the one of Box and Tiao, and without any it gives Student's intervals and the exact tolerance factors.
pub(super) fn level(lots: &[Lot], variances: Variances) -> Level {
    let (w, b) = (variances.units, variances.lots.unwrap_or(0.0));
    let mut plain = 0.0;
    let (mut weight, mut first, mut square, mut log_det) = (0.0, 0.0, 0.0, 0.0);
    let (mut of_units, mut of_both, mut of_lots) = (0.0, 0.0, 0.0);
    for lot in lots {
        let (mut a, mut s, mut q) = (0.0, 0.0, 0.0);
        let (mut a2, mut a3, mut product) = (0.0, 0.0, 1.0);
        for (y, u) in lot.values.iter().zip(&lot.variances) {
            let d = w + u;
            let g = 1.0 / d;
            a += g;
            s += g * y;
            q += g * y * y;
            a2 += g * g;
            a3 += g * g * g;
            // One logarithm for many factors.
            product *= d;
            if !(1e-100..1e100).contains(&product) {
                log_det += product.ln();
                product = 1.0;
            }
        }
        let shrink = 1.0 / (1.0 + b * a);
        log_det += product.ln() - shrink.ln();
        plain += a;
        weight += a * shrink;
        first += s * shrink;
        square += q - b * s * s * shrink;
        let c = b * shrink;
        of_units += a2 - 2.0 * c * a3 + (c * a2).powi(2);
        of_both += a2 * shrink * shrink;
        of_lots += (a * shrink).powi(2);
    }
    let information = match variances.lots {
        None => of_units,
        Some(_) => of_units * of_lots - of_both * of_both,
    };
    // How much the variance between lots exceeds what the scatter within them gives their means.
    let excess = b * plain / lots.len() as f64;
    let toward_none = variances.lots.map_or(0.0, |_| (TOWARD_NONE - 1.0) * (excess / (1.0 + excess)).ln());
    let mean = first / weight;
    let log_likelihood = -0.5 * (log_det + weight.ln() + (square - first * mean).max(0.0));
    Level { mean, variance: 1.0 / weight, log_density: log_likelihood + 0.5 * information.ln() + toward_none }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn sums_agree_with_matrices() {
        let lots = [
            Lot { values: vec![0.3, -0.2, 0.9], variances: vec![0.1, 0.2, 0.05] },
            Lot { values: vec![1.1, 0.4], variances: vec![0.3, 0.01] },
        ];
        let given = Variances { units: 0.37, lots: Some(0.21) };
        let y = DVector::from_iterator(5, lots.iter().flat_map(|l| l.values.iter().copied()));
        let u = DVector::from_iterator(5, lots.iter().flat_map(|l| l.variances.iter().copied()));
        let of_lots = DMatrix::from_fn(5, 5, |i, j| f64::from(u8::from((i < 3) == (j < 3))));
        let v = DMatrix::from_diagonal(&u.add_scalar(0.37)) + &of_lots * 0.21;
        let inverse = v.clone().try_inverse().unwrap();
        let one = DVector::from_element(5, 1.0);
        let weight = one.dot(&(&inverse * &one));
        let mean = one.dot(&(&inverse * &y)) / weight;
        let rest = y.add_scalar(-mean);
        let likelihood = -0.5 * (v.determinant().ln() + weight.ln() + rest.dot(&(&inverse * &rest)));
        let trace = |a: &DMatrix<f64>, b: &DMatrix<f64>| (&inverse * a * &inverse * b).trace();
        let unit = DMatrix::identity(5, 5);
        let information = trace(&unit, &unit) * trace(&of_lots, &of_lots) - trace(&unit, &of_lots).powi(2);
        let plain: f64 = u.iter().map(|u| 1.0 / (0.37 + u)).sum();
        let excess = 0.21 * plain / 2.0;
        let toward_none = (TOWARD_NONE - 1.0) * (excess / (1.0 + excess)).ln();
        let found = level(&lots, given);
        assert!((found.mean - mean).abs() < 1e-12);
        assert!((found.variance - 1.0 / weight).abs() < 1e-12);
        assert!((found.log_density - likelihood - 0.5 * information.ln() - toward_none).abs() < 1e-10);
    }
}
