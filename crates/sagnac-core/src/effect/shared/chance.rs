//! Whether a column follows the rate by chance: the same column shifted in time can only do so by chance.

use super::response::{ResponseFound, regressors};
use crate::effect::{Drivers, SearchContext};
use crate::estimate::chi_square_tail;
use crate::numeric::cosine::dct2;

/// Shifts of the column.
const SLIDES: usize = 24;
/// Terms of which the power in a shifted column is taken: the curve to the third order and the rate of change.
const TERMS: u32 = 0b100_0111;
/// Probability of a response above which it may be chance.
const CHANCE: f64 = 1e-4;

/// True where the response to a column gains no more than chance may, given how much the column gains on what the response
/// leaves when it is shifted in time.
///
/// A column shifted by a good part of the record drives nothing. Under noise as modelled it gains ½χ² on what is left; where
/// the noise is wrong or something slow is unexplained it gains more, and so does a column that has nothing to do with the
/// rate: the gain is divided by that ratio before it is judged.
pub(in crate::effect) fn follows_by_chance(
    found: &ResponseFound,
    values: &[f64],
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> bool {
    let roots: Vec<f64> = context.powers.iter().map(|p| 1.0 / p.sqrt()).collect();
    let whitened = |series: &[f64]| -> Vec<f64> {
        let modes = dct2(series);
        modes.iter().zip(&roots).skip(1).map(|(x, r)| if r.is_finite() { x * r } else { 0.0 }).collect()
    };
    let mut left: Vec<f64> = context
        .modes
        .iter()
        .zip(&roots)
        .skip(1)
        .map(|(x, r)| if r.is_finite() { x * r } else { 0.0 })
        .collect();
    let own = regressors(found.mask, values, drivers);
    let own: Vec<Vec<f64>> = own.columns.iter().chain(&own.nuisance).map(|c| whitened(c)).collect();
    for direction in orthonormal(own) {
        let share = dot(&direction, &left);
        left.iter_mut().zip(&direction).for_each(|(l, d)| *l -= share * d);
    }
    let (mut power, mut dimensions) = (0.0, 0usize);
    for slide in 1..=SLIDES {
        let shifted = mirrored_shift(values, slide * 2 * values.len() / (SLIDES + 1));
        let columns = regressors(TERMS, &shifted, drivers).columns;
        for direction in orthonormal(columns.iter().map(|c| whitened(c)).collect()) {
            power += dot(&direction, &left).powi(2);
            dimensions += 1;
        }
    }
    let inflation = if dimensions > 0 { (power / dimensions as f64).max(1.0) } else { 1.0 };
    let p_value =
        found.trials * chi_square_tail(2.0 * found.gain / inflation, f64::from(found.mask.count_ones()));
    p_value > CHANCE
}

/// A series moved along its even extension: what leaves at one end comes back at the other without a jump.
fn mirrored_shift(values: &[f64], shift: usize) -> Vec<f64> {
    let n = values.len();
    let at = |i: usize| {
        let i = (i + shift) % (2 * n);
        if i < n { values[i] } else { values[2 * n - 1 - i] }
    };
    (0..n).map(at).collect()
}

fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut out: Vec<Vec<f64>> = vec![];
    for mut column in columns {
        let size = dot(&column, &column);
        for direction in &out {
            let share = dot(direction, &column);
            column.iter_mut().zip(direction).for_each(|(c, d)| *c -= share * d);
        }
        let left = dot(&column, &column);
        if left > 1e-6 * size && left > 0.0 {
            let scale = 1.0 / left.sqrt();
            column.iter_mut().for_each(|c| *c *= scale);
            out.push(column);
        }
    }
    out
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::shared::response::search;

    #[test]
    fn a_shifted_series_is_its_even_extension() {
        assert_eq!(mirrored_shift(&[1.0, 2.0, 3.0], 2), [3.0, 3.0, 2.0]);
        assert_eq!(mirrored_shift(&[1.0, 2.0, 3.0], 6), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn two_random_walks_follow_each_other_by_chance_and_a_driven_rate_does_not() {
        let n = 1500;
        let drivers = Drivers { dt_s: 20.0, samples: n, averaged: 1, ..Drivers::default() };
        let mut chance = 0;
        for seed in 1..=10u64 {
            let mut state = seed;
            let mut step = || {
                let mut uniform = || {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
                };
                (0..12).map(|_| uniform()).sum::<f64>()
            };
            let mut walk = || -> Vec<f64> {
                let mut at = 0.0;
                let mut next = || {
                    at += 0.15 * step();
                    at
                };
                (0..n).map(|_| next()).collect()
            };
            let (column, other) = (walk(), walk());
            let rate: Vec<f64> = other.iter().map(|o| o + step()).collect();
            // The noise is taken for white: the walk in the rate is unexplained.
            let mut powers = vec![1.0; n];
            powers[0] = f64::INFINITY;
            let judged = |rate: &[f64]| {
                let modes = dct2(rate);
                let context = SearchContext { score: rate, modes: &modes, powers: &powers };
                search(&column, &drivers, &context)
                    .is_none_or(|found| follows_by_chance(&found, &column, &drivers, &context))
            };
            chance += usize::from(judged(&rate));
            let driven: Vec<f64> = column.iter().map(|c| 2.0 * c + step()).collect();
            assert!(!judged(&driven), "seed {seed}: it follows");
        }
        assert!(chance >= 8, "{chance} of 10 by chance");
    }
}
