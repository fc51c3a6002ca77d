//! Linear least squares of differences of neighbours whose noise is white and a random walk together.

use nalgebra::{DMatrix, DVector};

/// Turns differences of neighbours into independent numbers of equal variance: the Cholesky factor of a covariance with
/// three diagonals.
pub(super) struct Whitener {
    diagonal: Vec<f64>,
    below: Vec<f64>,
    /// Logarithm of the determinant of the factor.
    pub log_scale: f64,
}

impl Whitener {
    /// Steps between neighbours, s; `None` where a stretch ends: differences on its two sides share no sample.
    pub fn new(steps_s: &[Option<f64>], ratio: f64) -> Whitener {
        // Scaled so that neither a vanishing nor a huge ratio loses digits.
        let scale = 1.0 / (1.0 + ratio);
        let (mut diagonal, mut below): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut before: Option<f64> = None;
        for step in steps_s {
            let Some(step) = step else {
                before = None;
                continue;
            };
            let side = before.map_or(0.0, |before| -scale / before);
            let size = (scale * (2.0 + ratio * step) - side * side).max(f64::MIN_POSITIVE).sqrt();
            below.push(side);
            diagonal.push(size);
            before = Some(size);
        }
        let log_scale = diagonal.iter().map(|d| d.ln()).sum();
        Whitener { diagonal, below, log_scale }
    }

    /// Makes differences independent.
    pub fn whiten(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut before = 0.0;
        for ((value, diagonal), below) in values.iter_mut().zip(&self.diagonal).zip(&self.below) {
            *value = (*value - below * before) / diagonal;
            before = *value;
        }
        values
    }
}

/// Least squares of a few columns.
pub(super) struct Solved {
    pub coefficients: Vec<f64>,
    pub inverse: DMatrix<f64>,
    /// Sum of the squares of what remains.
    pub squares: f64,
}

/// The coefficients of columns in data; `None` where they cannot be told apart.
pub(super) fn solve(columns: &[&[f64]], data: &[f64]) -> Option<Solved> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let sizes: Vec<f64> = columns.iter().map(|c| product(c, c).sqrt().max(f64::MIN_POSITIVE)).collect();
    let k = columns.len();
    let size = |i: usize| sizes.get(i).copied().unwrap_or(1.0);
    let of = |i: usize| columns.get(i).copied().unwrap_or_default();
    let normal = DMatrix::from_fn(k, k, |i, j| product(of(i), of(j)) / (size(i) * size(j)));
    let right = DVector::from_fn(k, |i, _| product(of(i), data) / size(i));
    let inverse = normal.cholesky()?.inverse();
    let scaled = &inverse * right;
    let coefficients: Vec<f64> =
        (0..k).map(|i| scaled.get(i).copied().unwrap_or(f64::NAN) / size(i)).collect();
    let squares = (0..data.len())
        .map(|row| {
            let fitted: f64 =
                columns.iter().zip(&coefficients).map(|(c, x)| c.get(row).copied().unwrap_or(0.0) * x).sum();
            (data.get(row).copied().unwrap_or(0.0) - fitted).powi(2)
        })
        .sum();
    let inverse =
        DMatrix::from_fn(k, k, |i, j| inverse.get((i, j)).copied().unwrap_or(f64::NAN) / (size(i) * size(j)));
    Some(Solved { coefficients, inverse, squares })
}

/// Least squares by instruments.
pub(super) struct Instrumental {
    pub coefficients: Vec<f64>,
    pub standard_deviations: Vec<f64>,
    /// Share of the first effect that its instrument shows, times the number of data.
    pub shown: f64,
}

/// The coefficients of effects by instruments, one for each.
pub(super) fn by_instruments(
    effects: &[Vec<f64>],
    instruments: &[Vec<f64>],
    data: &[f64],
) -> Option<Instrumental> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let k = effects.len();
    let sizes: Vec<f64> = effects.iter().map(|e| product(e, e).sqrt().max(f64::MIN_POSITIVE)).collect();
    let matrix = |rows: &[Vec<f64>], columns: &[Vec<f64>]| -> DMatrix<f64> {
        let scaled = |i: usize, j: usize| {
            Some(product(rows.get(i)?, columns.get(j)?) / (sizes.get(i)? * sizes.get(j)?))
        };
        DMatrix::from_fn(k, k, |i, j| scaled(i, j).unwrap_or(f64::NAN))
    };
    let (mixed, own) = (matrix(instruments, effects), matrix(instruments, instruments));
    let right =
        DVector::from_iterator(k, instruments.iter().zip(&sizes).map(|(z, size)| product(z, data) / size));
    let inverse = mixed.clone().try_inverse()?;
    let scaled = &inverse * right;
    let residual = |row: usize| {
        let fitted = effects
            .iter()
            .zip(scaled.iter().zip(&sizes))
            .map(|(e, (x, size))| e.get(row).map_or(0.0, |e| e * x / size));
        data.get(row).copied().unwrap_or(0.0) - fitted.sum::<f64>()
    };
    let squares: f64 = (0..data.len()).map(|row| residual(row).powi(2)).sum();
    let per_sample = squares / data.len().checked_sub(k).filter(|d| *d > 0)? as f64;
    let covariance = &inverse * own.clone() * inverse.transpose();
    let size = |i: usize| sizes.get(i).copied().unwrap_or(1.0);
    let value = |i: usize| scaled.get(i).copied().unwrap_or(0.0) / size(i);
    let sd = |i: usize| (covariance.get((i, i)).copied().unwrap_or(f64::NAN) * per_sample).sqrt() / size(i);
    let shared = mixed.get((0, 0))?.powi(2) / own.get((0, 0))?;
    Some(Instrumental {
        coefficients: (0..k).map(value).collect(),
        standard_deviations: (0..k).map(sd).collect(),
        shown: shared * data.len() as f64,
    })
}
