//! Means of neighbours, so that a long series fits on paper.

use crate::numeric::order::SortByNumber;

/// Most points of a curve over time.
pub const MAX_TIME_POINTS: usize = 900;

/// One mean with the standard deviation of it, from the scatter of what was averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Mean abscissa.
    pub x: f64,
    /// Mean ordinate.
    pub y: f64,
    /// Standard deviation of the mean; 0 for a single value.
    pub spread: f64,
}

/// Means over groups of equally many neighbours, at most [`MAX_TIME_POINTS`] of them. Values that are no numbers are left out; a
/// group without any other breaks the curve.
pub fn over_time(x: &[f64], y: &[f64]) -> (Vec<(f64, f64)>, usize) {
    let n = x.len().min(y.len());
    let group = n.div_ceil(MAX_TIME_POINTS).max(1);
    let mean = |v: &[f64]| {
        let (sum, count) = v.iter().filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, c), v| (s + v, c + 1.0));
        sum / count
    };
    let points = x[..n].chunks(group).zip(y[..n].chunks(group)).map(|(a, b)| (mean(a), mean(b))).collect();
    (points, group)
}

/// Means over groups of equally many values after sorting by abscissa: as the column is met with, not as it is spaced.
pub fn by_abscissa(x: &[f64], y: &[f64], groups: usize) -> Vec<Mean> {
    let mut pairs: Vec<(f64, f64)> =
        x.iter().zip(y).map(|(a, b)| (*a, *b)).filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    pairs.sort_ascending_by(|a| a.0);
    let size = pairs.len().div_ceil(groups.max(1)).max(1);
    pairs.chunks(size).map(mean).collect()
}

fn mean(group: &[(f64, f64)]) -> Mean {
    let n = group.len() as f64;
    let x = group.iter().map(|p| p.0).sum::<f64>() / n;
    let y = group.iter().map(|p| p.1).sum::<f64>() / n;
    let squares = group.iter().map(|p| (p.1 - y).powi(2)).sum::<f64>();
    let spread = if group.len() > 1 { (squares / (n - 1.0) / n).sqrt() } else { 0.0 };
    Mean { x, y, spread }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_time_keep_the_mean_and_stay_few() {
        let x: Vec<f64> = (0..10_000).map(f64::from).collect();
        let y: Vec<f64> = x.iter().map(|t| 3.0 + 0.5 * t).collect();
        let (points, group) = over_time(&x, &y);
        assert!(points.len() <= MAX_TIME_POINTS && group == 12);
        // The means of a straight line lie on it.
        assert!(points.iter().all(|(t, v)| (v - 3.0 - 0.5 * t).abs() < 1e-9));
        assert_eq!(over_time(&[], &[]).0, vec![]);
        let gaps = over_time(&x[..4], &[1.0, f64::NAN, 3.0, 4.0]).0;
        assert!(gaps[1].1.is_nan() && gaps[2].1 == 3.0);
    }

    #[test]
    fn the_spread_is_the_standard_deviation_of_the_mean() {
        let x = [2.0, 1.0, 4.0, 3.0, f64::NAN];
        let y = [10.0, 12.0, 1.0, 5.0, 7.0];
        let means = by_abscissa(&x, &y, 2);
        assert_eq!(means.len(), 2);
        assert_eq!((means[0].x, means[0].y, means[1].y), (1.5, 11.0, 3.0));
        // Of 10 and 12 the standard deviation is √2, of their mean 1; of 1 and 5 it is √8 and 2.
        assert!((means[0].spread - 1.0).abs() < 1e-12 && (means[1].spread - 2.0).abs() < 1e-12);
    }
}
