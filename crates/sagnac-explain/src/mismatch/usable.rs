//! Columns that cannot drive anything.

use super::finding::UnusableColumn;
use crate::numeric::range::ends;

/// Correlation with time from which a column counts it.
const MIN_TIME_CORRELATION: f64 = 1.0 - 1e-9;

/// Reason why a column cannot drive anything; `None` for one that can.
pub(super) fn unusable(values: &[f64]) -> Option<UnusableColumn> {
    if !ends(values).is_wide() {
        return Some(UnusableColumn::Constant);
    }
    let n = values.len() as f64;
    let (mean, middle) = (values.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
    let (mut both, mut of_values, mut of_time) = (0.0, 0.0, 0.0);
    for (i, v) in values.iter().enumerate() {
        let (v, t) = (v - mean, i as f64 - middle);
        both += v * t;
        of_values += v * v;
        of_time += t * t;
    }
    (both.abs() >= MIN_TIME_CORRELATION * (of_values * of_time).sqrt()).then_some(UnusableColumn::CountsTime)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_and_a_counter_drive_nothing() {
        let of = |f: &dyn Fn(usize) -> f64| unusable(&(0..500).map(f).collect::<Vec<f64>>());
        assert_eq!(of(&|_| 3.0), Some(UnusableColumn::Constant));
        assert_eq!(of(&|i| 7.0 - 0.5 * i as f64), Some(UnusableColumn::CountsTime));
        assert_eq!(of(&|i| i as f64 + (i as f64 / 20.0).sin()), None);
    }
}
