//! Powers of a column, and sums of columns by coefficients.

use crate::numeric::range::ends;

/// The range of a column that is taken as −1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) struct Scale {
    /// Middle of the range.
    pub center: f64,
    /// Half of its width.
    pub half: f64,
}

impl Scale {
    /// That of the values of a column; a narrow one keeps some width.
    pub fn of(values: &[f64]) -> Scale {
        let bounds = ends(values);
        Scale { center: 0.5 * (bounds.low + bounds.high), half: (0.5 * bounds.width()).max(1e-12) }
    }

    /// A value in units of the range.
    pub fn scaled(self, value: f64) -> f64 {
        (value - self.center) / self.half
    }
}

/// A scaled column to the powers 1 to `order`.
pub(in crate::effect) fn powers(values: &[f64], scale: Scale, order: usize) -> Vec<Vec<f64>> {
    (1..=order as i32).map(|k| values.iter().map(|v| scale.scaled(*v).powi(k)).collect()).collect()
}

/// Σ coefficient · column; empty without columns.
pub(in crate::effect) fn sum(coefficients: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let mut out = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (c, column) in coefficients.iter().zip(columns) {
        out.iter_mut().zip(column).for_each(|(o, x)| *o += c * x);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_of_the_scaled_column() {
        let columns = powers(&[10.0, 40.0], Scale { center: 20.0, half: 10.0 }, 3);
        assert_eq!(columns, [[-1.0, 2.0], [1.0, 4.0], [-1.0, 8.0]]);
        assert_eq!(sum(&[1.0, 0.5], &columns), [-0.5, 4.0]);
        assert!(sum(&[1.0], &[]).is_empty());
    }
}
