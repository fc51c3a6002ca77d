//! Cheap global searches for the shape of a course.

use crate::effect::{Drivers, MeanModel, Regressors, SearchContext};
use crate::numeric::cosine::dct2;
use crate::numeric::order::SortByNumber;
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// `count` values from `low` to `high` in equal ratios.
pub(in crate::effect) fn log_grid(low: f64, high: f64, count: usize) -> Vec<f64> {
    if !(low > 0.0 && high >= low) || count == 0 {
        return vec![];
    }
    let step = (high / low).ln() / (count.max(2) - 1) as f64;
    (0..count).map(|i| low * (step * i as f64).exp()).collect()
}

/// Log-likelihood gain of a course for one shape: everything of it fitted, less what the columns beside it gain alone.
pub(in crate::effect) fn gain_of(parts: Regressors, context: &SearchContext<'_>) -> f64 {
    if parts.offset.is_none() && parts.columns.is_empty() {
        return 0.0;
    }
    let mut residual = Cow::Borrowed(context.modes);
    let mut gain = 0.0;
    if let Some(fixed) = parts.offset {
        for ((r, f), p) in residual.to_mut().iter_mut().zip(dct2(&fixed)).zip(context.powers).skip(1) {
            gain += (*r * f - 0.5 * f * f) / p;
            *r -= f;
        }
    }
    let modes = |columns: Vec<Vec<f64>>| columns.into_iter().map(|c| dct2(&c)).collect::<Vec<_>>();
    let (mut all, beside) = (modes(parts.columns), modes(parts.nuisance));
    let alone = explained(&beside, context.modes, context.powers);
    all.extend(beside);
    gain + explained(&all, &residual, context.powers) - alone
}

/// ½ b'A⁻¹b of columns with free coefficients.
fn explained(columns: &[Vec<f64>], residual: &[f64], powers: &[f64]) -> f64 {
    let k = columns.len();
    if k == 0 {
        return 0.0;
    }
    let product =
        |x: &[f64], y: &[f64]| x.iter().zip(y).zip(powers).skip(1).map(|((x, y), p)| x * y / p).sum::<f64>();
    let mut normal = DMatrix::zeros(k, k);
    let mut right = DVector::zeros(k);
    for (i, column) in columns.iter().enumerate() {
        right[i] = product(column, residual);
        for (j, other) in columns.iter().enumerate().take(i + 1) {
            normal[(i, j)] = product(column, other);
            normal[(j, i)] = normal[(i, j)];
        }
    }
    for i in 0..k {
        normal[(i, i)] *= 1.0 + 1e-10;
        if normal[(i, i)] <= 0.0 {
            normal[(i, i)] = 1.0;
        }
    }
    normal.cholesky().map_or(0.0, |c| 0.5 * right.dot(&c.solve(&right)))
}

/// The shapes that gain most, the best first, at most `keep`; those that gain nothing are left out.
pub(in crate::effect) fn best_of(
    course: &dyn MeanModel,
    points: impl IntoIterator<Item = Vec<f64>>,
    keep: usize,
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> Vec<Vec<f64>> {
    let mut rated: Vec<(f64, Vec<f64>)> = points
        .into_iter()
        .map(|s| (gain_of(course.regressors(&s, drivers), context), s))
        .filter(|(g, _)| *g > 0.0)
        .collect();
    rated.sort_descending_by(|a| a.0);
    rated.into_iter().take(keep).map(|(_, s)| s).collect()
}

/// Level of the fast half of the noise, (deg/h)²; 0 where there is none.
pub(in crate::effect) fn fast_level(context: &SearchContext<'_>) -> f64 {
    let mut upper: Vec<f64> = context.powers.iter().skip(context.powers.len() / 2).copied().collect();
    if upper.is_empty() {
        return 0.0;
    }
    let middle = upper.len() / 2;
    *upper.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The shapes that would gain most if the noise were white at the level of its fast half: one pass over the samples each
/// instead of a transform. For courses of one column or of a fixed part alone.
pub(in crate::effect) fn shortlist(
    course: &dyn MeanModel,
    points: impl IntoIterator<Item = Vec<f64>>,
    keep: usize,
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> Vec<Vec<f64>> {
    let level = fast_level(context);
    if level.is_nan() || level <= 0.0 {
        return vec![];
    }
    let rough = |column: &[f64]| {
        let mean = column.iter().sum::<f64>() / column.len().max(1) as f64;
        let both = column.iter().zip(context.score).map(|(z, w)| (z - mean) * w).sum::<f64>();
        (both, column.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / level)
    };
    let gain = |nonlinear_parameters: &Vec<f64>| {
        let parts = course.regressors(nonlinear_parameters, drivers);
        match (&parts.offset, parts.columns.first()) {
            (Some(fixed), _) => {
                let (both, square) = rough(fixed);
                both - 0.5 * square
            }
            (None, Some(column)) => {
                let (both, square) = rough(column);
                if square > 0.0 { 0.5 * both * both / square } else { 0.0 }
            }
            (None, None) => 0.0,
        }
    };
    let mut rated: Vec<(f64, Vec<f64>)> = points.into_iter().map(|s| (gain(&s), s)).collect();
    rated.sort_descending_by(|a| a.0);
    rated.into_iter().take(keep).map(|(_, s)| s).collect()
}

/// Positions of the largest of `gains`, the best first, each at least `apart` from those before it.
pub(in crate::effect) fn peaks(gains: &[f64], keep: usize, apart: usize) -> Vec<usize> {
    let mut left = gains.to_vec();
    let mut out = vec![];
    for _ in 0..keep {
        let Some(best) = (0..left.len()).max_by(|a, b| left[*a].total_cmp(&left[*b])) else { break };
        if left[best].is_nan() || left[best] <= 0.0 {
            break;
        }
        out.push(best);
        let end = (best + apart.max(1)).min(left.len());
        left[best.saturating_sub(apart.saturating_sub(1))..end].fill(0.0);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_of_a_free_column_is_that_of_the_look() {
        let n = 64;
        let column: Vec<f64> = (0..n).map(|i| (0.2 * i as f64).sin()).collect();
        let residual: Vec<f64> = (0..n).map(|i| 0.7 * column[i] + ((i * i * 31) % 17) as f64 * 0.1).collect();
        let (modes, powers) = (dct2(&residual), vec![0.25; n]);
        let context = SearchContext { score: &residual, modes: &modes, powers: &powers };
        let free = Regressors { columns: vec![column.clone()], ..Regressors::default() };
        assert!((gain_of(free, &context) / context.gain(&column) - 1.0).abs() < 1e-8);
        assert!(
            (fast_level(&context) - 0.25).abs() < 1e-12
                && fast_level(&SearchContext { score: &[], modes: &[], powers: &[] }) == 0.0
        );
        // The same column fixed at its best coefficient gains the same; a column beside it takes all of it.
        let (mut zr, mut zz) = (0.0, 0.0);
        for (z, r) in dct2(&column).iter().zip(&modes).skip(1) {
            zr += z * r;
            zz += z * z;
        }
        let fixed = Some(column.iter().map(|x| x * zr / zz).collect());
        let gain = gain_of(Regressors { offset: fixed, ..Regressors::default() }, &context);
        assert!((gain / context.gain(&column) - 1.0).abs() < 1e-9);
        let both =
            Regressors { columns: vec![column.clone()], nuisance: vec![column], ..Regressors::default() };
        assert!(gain_of(both, &context).abs() < 1e-5);
    }

    #[test]
    fn peaks_stand_apart_and_are_placed_between_points() {
        assert_eq!(peaks(&[0.0, 5.0, 4.9, 0.0, 3.0, 0.0], 3, 2), [1, 4]);
        assert_eq!(peaks(&[0.0, 0.0], 2, 1), Vec::<usize>::new());
        // A parabola with its top at 2.3.
        let values: Vec<f64> = (0..5).map(|i| 10.0 - (f64::from(i) - 2.3).powi(2)).collect();
        assert!((crate::numeric::optimize::parabolic_peak(&values, 2) - 0.3).abs() < 1e-12);
    }
}
