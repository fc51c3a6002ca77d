//! Levels of noise by regression: mean squares of groups follow scaled χ² laws whose logarithm is linear in columns.

use crate::effect::Knot;
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::numeric::order::SortByNumber;
use crate::numeric::range::{Bounds, ends};
use nalgebra::{DMatrix, DVector};

/// Groups over the values of a column.
const COLUMN_GROUPS: usize = 256;
/// Fewest samples of a group.
pub(in crate::effect) const MIN_GROUP_SAMPLES: usize = 16;
/// Knots of a law over time.
const MAX_KNOTS: usize = 128;

/// Mean square of a group and its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::effect) struct Group {
    /// Mean square.
    pub square: f64,
    /// Values in it.
    pub dof: f64,
}

/// A fit of ln g² = Σ β x.
#[derive(Debug, Clone)]
pub(in crate::effect) struct GammaFit {
    /// ln g² of each group.
    pub log_squares: Vec<f64>,
    /// Covariance of the coefficients, that of the constant first.
    pub covariance: DMatrix<f64>,
    /// Log-likelihood over that of one level for all.
    pub gain: f64,
}

/// Mean square of all groups.
pub(in crate::effect) fn mean_square(groups: &[Group]) -> f64 {
    let dof: f64 = groups.iter().map(|g| g.dof).sum();
    groups.iter().map(|g| g.dof * g.square).sum::<f64>() / dof.max(1e-300)
}

fn log_likelihood(groups: &[Group], log_squares: &[f64]) -> f64 {
    -0.5 * groups.iter().zip(log_squares).map(|(g, l)| g.dof * (l + g.square * (-l).exp())).sum::<f64>()
}

/// Fits columns beside a constant by Fisher scoring.
pub(in crate::effect) fn fit(groups: &[Group], columns: &[Vec<f64>]) -> Option<GammaFit> {
    let p = columns.len() + 1;
    let level = mean_square(groups);
    if !(level > 0.0 && level.is_finite()) || groups.len() < 2 * p {
        return None;
    }
    let x = |j: usize, i: usize| if j == 0 { 1.0 } else { columns[j - 1][i] };
    let mut information = DMatrix::zeros(p, p);
    for (i, group) in groups.iter().enumerate() {
        for a in 0..p {
            for b in 0..p {
                information[(a, b)] += 0.5 * group.dof * x(a, i) * x(b, i);
            }
        }
    }
    let covariance = information.clone().cholesky()?.inverse();
    let mut beta = DVector::zeros(p);
    beta[0] = level.ln();
    let logs = |beta: &DVector<f64>| -> Vec<f64> {
        (0..groups.len()).map(|i| (0..p).map(|j| beta[j] * x(j, i)).sum::<f64>()).collect()
    };
    let mut log_squares = logs(&beta);
    let constant = log_likelihood(groups, &log_squares);
    let mut best = constant;
    for _ in 0..40 {
        let gradient = DVector::from_fn(p, |j, _| {
            let one =
                |(i, g): (usize, &Group)| 0.5 * g.dof * x(j, i) * (g.square * (-log_squares[i]).exp() - 1.0);
            groups.iter().enumerate().map(one).sum::<f64>()
        });
        let mut step = &covariance * gradient;
        let mut moved = false;
        for _ in 0..20 {
            let next = &beta + &step;
            let tried = logs(&next);
            let got = log_likelihood(groups, &tried);
            if got > best {
                moved = got - best > 1e-9;
                (beta, log_squares, best) = (next, tried, got);
                break;
            }
            step *= 0.4;
        }
        if !moved {
            break;
        }
    }
    Some(GammaFit { log_squares, covariance, gain: best - constant })
}

/// Spread of the groups about a fit over what χ² laws give, at least 1: the factor by which heavy tails or correlation
/// make gains of nothing larger.
pub(in crate::effect) fn overdispersion(groups: &[Group], log_squares: &[f64], parameters: usize) -> f64 {
    let one = |(g, l): (&Group, &f64)| 0.5 * g.dof * (g.square * (-l).exp() - 1.0).powi(2);
    let sum: f64 = groups.iter().zip(log_squares).map(one).sum();
    (sum / (groups.len() as f64 - parameters as f64).max(1.0)).max(1.0)
}

/// Groups of samples of like values, with the mean value of each. `flat` holds the deviation of each sample.
pub(in crate::effect) fn by_value(
    values: impl Fn(usize) -> f64,
    flat: &[f64],
    samples: &[usize],
) -> (Vec<Group>, Vec<f64>) {
    let mut order = samples.to_vec();
    order.sort_ascending_by(|a| values(*a));
    let size = order.len().div_ceil(COLUMN_GROUPS).max(MIN_GROUP_SAMPLES);
    order
        .chunks(size)
        .map(|group| {
            let dof = group.len() as f64;
            let square = group.iter().map(|i| flat[*i].powi(2)).sum::<f64>() / dof;
            (Group { square, dof }, group.iter().map(|i| values(*i)).sum::<f64>() / dof)
        })
        .unzip()
}

/// Largest deviation over the smallest, with its interval.
pub(in crate::effect) fn contrast(
    log_squares: &[f64],
    covariance: &DMatrix<f64>,
    columns: &[Vec<f64>],
) -> (f64, [f64; 2]) {
    let by = |a: &usize, b: &usize| log_squares[*a].total_cmp(&log_squares[*b]);
    let top = (0..log_squares.len()).max_by(by).unwrap_or(0);
    let bottom = (0..log_squares.len()).min_by(by).unwrap_or(0);
    let steps: Vec<f64> = columns.iter().map(|c| c[top] - c[bottom]).collect();
    let mut variance = 0.0;
    for (a, x) in steps.iter().enumerate() {
        for (b, y) in steps.iter().enumerate() {
            variance += x * y * covariance[(a + 1, b + 1)];
        }
    }
    let log = 0.5 * (log_squares[top] - log_squares[bottom]);
    let half = 0.5 * SCORE_TWO_SIDED_95 * variance.max(0.0).sqrt();
    (log.exp(), [(log - half).max(0.0).exp(), (log + half).exp()])
}

/// An interval of the contrast that holds those of all forms of the level that are nearly as likely as the best: each form has a contrast
/// of its own. `forms` has twice the logarithm of the likelihood of each, less the price of its parameters, and its interval.
pub(in crate::effect) fn contrast_of_forms(forms: &[(f64, [f64; 2])]) -> Option<[f64; 2]> {
    /// Difference of BIC within which two forms are equivalent.
    const MAX_DIFFERENCE: f64 = 6.0;
    let best = forms.iter().map(|f| f.0).fold(f64::NEG_INFINITY, f64::max);
    let likely = forms.iter().filter(|f| f.0 >= best - MAX_DIFFERENCE).map(|f| f.1);
    likely.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// The interval of `at` in which the level is in the upper half of its range.
pub(in crate::effect) fn raised(at: &[f64], log_squares: &[f64]) -> Bounds {
    let Bounds { low, high } = ends(log_squares);
    let among = at.iter().zip(log_squares).filter(|(_, l)| **l >= 0.5 * (low + high)).map(|(x, _)| *x);
    ends(&among.collect::<Vec<f64>>())
}

/// A value on the lines between knots.
pub(in crate::effect) fn between(knots: &[Knot], at: f64) -> f64 {
    let i = knots.partition_point(|k| k.at < at);
    match (i.checked_sub(1).and_then(|j| knots.get(j)), knots.get(i)) {
        (Some(a), Some(b)) if b.at > a.at => a.value + (b.value - a.value) * (at - a.at) / (b.at - a.at),
        (Some(a), _) => a.value,
        (None, Some(b)) => b.value,
        (None, None) => 1.0,
    }
}

/// At most about [`MAX_KNOTS`] of the knots, the ends among them.
pub(in crate::effect) fn thinned(knots: &[Knot]) -> Vec<Knot> {
    let step = knots.len().div_ceil(MAX_KNOTS).max(1);
    let last = knots.len().saturating_sub(1);
    let kept = knots.iter().enumerate().filter(|(i, _)| i % step == 0 || *i == last);
    kept.map(|(_, k)| *k).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(squares: &[f64], dof: f64) -> Vec<Group> {
        squares.iter().map(|square| Group { square: *square, dof }).collect()
    }

    #[test]
    fn a_level_that_grows_by_a_constant_factor_is_a_line_in_its_logarithm() {
        // Mean squares 1, 4, 16, ...: ln g² = 2 ln 2 · i, whatever the noise; the fit is exact.
        let groups = groups(&[1.0, 4.0, 16.0, 64.0, 256.0], 100.0);
        let x: Vec<f64> = (0..5).map(|i| f64::from(i) - 2.0).collect();
        let fitted = fit(&groups, std::slice::from_ref(&x)).unwrap();
        for (i, l) in fitted.log_squares.iter().enumerate() {
            assert!((l - 4f64.ln() * i as f64).abs() < 1e-5, "{i}: {l}");
        }
        // Against one level, the mean of 68.2: ½ · 100 Σ (ln 68.2 − ln g²).
        let gain = 50.0 * (5.0 * 68.2f64.ln() - 10.0 * 4f64.ln());
        assert!((fitted.gain - gain).abs() < 1e-4, "{} {gain}", fitted.gain);
        // ½ · 100 Σ x² of information.
        assert!((fitted.covariance[(1, 1)] - 1.0 / 500.0).abs() < 1e-12);
        // Both ends: a deviation 16 times as large, 4 steps of a coefficient known to 1/√500.
        let (ratio, ci95) = contrast(&fitted.log_squares, &fitted.covariance, &[x]);
        assert!(
            (ratio / 16.0 - 1.0).abs() < 1e-4
                && (ci95[1] / ratio - (0.98f64 * 4.0 / 500f64.sqrt()).exp()).abs() < 1e-3
        );
        assert!(fit(&groups[..3], &[vec![0.0; 3]]).is_none());
    }

    #[test]
    fn groups_that_scatter_more_than_their_law_are_overdispersed() {
        assert_eq!(overdispersion(&groups(&[1.0; 4], 50.0), &[0.0; 4], 1), 1.0);
        // ½ · 50 · 0.4² from each of four, over three.
        let wild = groups(&[0.6, 1.4, 0.6, 1.4], 50.0);
        assert!((overdispersion(&wild, &[0.0; 4], 1) - 16.0 / 3.0).abs() < 1e-12);
        assert_eq!(mean_square(&wild), 1.0);
    }

    #[test]
    fn lines_between_knots_end_with_them() {
        let knots: Vec<Knot> = (0..300).map(|i| Knot { at: f64::from(i), value: f64::from(2 * i) }).collect();
        assert_eq!(
            [-1.0, 0.0, 10.5, 299.0, 400.0].map(|x| between(&knots, x)),
            [0.0, 0.0, 21.0, 598.0, 598.0]
        );
        let few = thinned(&knots);
        assert!(few.len() <= MAX_KNOTS + 1 && few.first() == knots.first() && few.last() == knots.last());
        assert_eq!(between(&few, 100.25), 200.5);
        assert_eq!(between(&[], 3.0), 1.0);
    }

    #[test]
    fn a_level_is_raised_in_the_upper_half_of_its_range() {
        let raised = raised(&[1.0, 2.0, 3.0, 4.0], &[0.0, 1.9, 2.0, 4.0]);
        assert_eq!(raised, Bounds::new(3.0, 4.0));
    }

    #[test]
    fn samples_of_like_values_are_grouped_with_their_mean_square() {
        // Forty values in falling order: groups of 16, 16 and 8 from the smallest up.
        let flat: Vec<f64> = (0..40).map(|i| if i >= 24 { 2.0 } else { -1.0 }).collect();
        let samples: Vec<usize> = (0..40).collect();
        let (groups, values) = by_value(|i| (40 - i) as f64, &flat, &samples);
        let told: Vec<(f64, f64)> = groups.iter().map(|g| (g.square, g.dof)).collect();
        assert_eq!(told, [(4.0, 16.0), (1.0, 16.0), (1.0, 8.0)]);
        assert_eq!(values, [8.5, 24.5, 36.5]);
    }

    #[test]
    fn a_ratio_with_its_interval_counts_every_coefficient() {
        // Columns move by 2 and −1: variance 4·0.01 + 0.04 − 2·2·0.005 of ln g².
        let covariance = DMatrix::from_row_slice(3, 3, &[1.0, 0.3, 0.2, 0.3, 0.01, 0.005, 0.2, 0.005, 0.04]);
        let columns = [vec![0.0, 1.0, 2.0], vec![1.0, 3.0, 0.0]];
        let (ratio, ci95) = contrast(&[0.0, 1.0, 4.0], &covariance, &columns);
        let half = 0.5 * SCORE_TWO_SIDED_95 * (0.04f64 + 0.04 - 0.02).sqrt();
        assert!((ratio.ln() - 2.0).abs() < 1e-12);
        assert!((ci95[0].ln() - 2.0 + half).abs() < 1e-12 && (ci95[1].ln() - 2.0 - half).abs() < 1e-12);
        // An interval of the largest over the smallest does not reach below 1.
        assert_eq!(contrast(&[0.0, 0.1, 0.1], &covariance, &columns).1[0], 1.0);
        // A form 7 behind in BIC is none of the likely ones.
        let forms = [(100.0, [1.2, 1.3]), (95.0, [1.25, 1.5]), (93.0, [1.0, 2.0])];
        assert_eq!(contrast_of_forms(&forms), Some([1.2, 1.5]));
        assert_eq!(contrast_of_forms(&[]), None);
    }
}
