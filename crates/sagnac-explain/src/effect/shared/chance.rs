//! A test of a column that follows the rate by chance: the same column shifted in time can only do so by chance.

use super::pursuit::dot;
use super::response::{ResponseFound, regressors, search};
use crate::effect::{Drivers, SearchContext};
use crate::numeric::cosine::dct2;
use crate::numeric::parallel;

/// Shifts of the column.
const COLUMN_SHIFTS: usize = 8;
/// Times the largest gain of a shifted column that a response must gain.
const MIN_GAIN_RATIO: f64 = 10.0;
/// Terms from which a response bends to any slow course, so that it leaves nothing to a shifted column: then shifted columns are given as
/// many.
const MIN_FLEXIBLE_TERMS: u32 = 4;
/// Ratio of what such a response is worth to what that of a shifted column is worth, at least.
const MIN_WORTH_RATIO: f64 = 1.15;
/// Gain of shifted columns up to which nothing is left unexplained: what the best of their terms gains in plain noise.
const MAX_NOISE_GAIN: f64 = 12.0;

/// True where the response to a column gains no more than chance may, given how much the column gains on what the response
/// leaves when it is shifted in time.
///
/// A column shifted by a good part of the record drives nothing. Where the noise is as modelled, a shifted column gains next to
/// nothing on what is left; where the noise is wrong or something slow is unexplained, it gains a good part of what it gains
/// in its own place, and so does a column that has nothing to do with the rate. A response of several terms must also be worth more than
/// those of all shifted columns to the whole rate.
pub(in crate::effect) fn follows_by_chance(
    found: &ResponseFound,
    values: &[f64],
    drivers: &Drivers,
    context: &SearchContext<'_>,
) -> bool {
    let of_slide =
        |slide: usize, context: &SearchContext<'_>| search(&moved(values, slide), drivers, context);
    if found.mask.count_ones() >= MIN_FLEXIBLE_TERMS {
        let worth = |i: usize| of_slide(i + 1, context).map_or(0.0, |other| other.worth());
        let others = parallel::map(COLUMN_SHIFTS, worth).into_iter().fold(0.0, f64::max);
        if found.worth() < MIN_WORTH_RATIO * others {
            return true;
        }
    }
    let roots: Vec<f64> = context.powers.iter().map(|p| p.sqrt()).collect();
    let whitened = |modes: &[f64]| -> Vec<f64> {
        modes.iter().zip(&roots).map(|(x, r)| if r.is_finite() { x / r } else { 0.0 }).collect()
    };
    let own = regressors(found.mask, values, drivers);
    let own = own.columns.iter().chain(&own.nuisance).map(|c| whitened(&dct2(c))).collect();
    let mut left = whitened(context.modes);
    for direction in orthonormal(own) {
        let share = dot(&direction, &left);
        left.iter_mut().zip(&direction).for_each(|(l, d)| *l -= share * d);
    }
    let modes: Vec<f64> =
        left.iter().zip(&roots).map(|(l, r)| if r.is_finite() { l * r } else { 0.0 }).collect();
    let on_left = SearchContext { modes: &modes, ..*context };
    is_chance(found.gain, MAX_NOISE_GAIN, |slide| of_slide(slide, &on_left).map_or(0.0, |other| other.gain))
}

/// True where columns shifted in time gain more than `nothing`, and no small part of what they gain in their own place.
pub(in crate::effect) fn is_chance(
    gain: f64,
    nothing: f64,
    of_slide: impl Fn(usize) -> f64 + Sync + Send,
) -> bool {
    let by_chance = parallel::map(COLUMN_SHIFTS, |i| of_slide(i + 1)).into_iter().fold(0.0, f64::max);
    by_chance > nothing && gain < MIN_GAIN_RATIO * by_chance
}

/// A column in the place of one of the slides, counted from 1.
pub(in crate::effect) fn moved(values: &[f64], slide: usize) -> Vec<f64> {
    mirrored_shift(values, slide * 2 * values.len() / (COLUMN_SHIFTS + 1))
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

/// Orthonormal directions that span some columns; what others hold already is left out.
pub(super) fn orthonormal(columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_series_is_its_even_extension() {
        assert_eq!(mirrored_shift(&[1.0, 2.0, 3.0], 2), [3.0, 3.0, 2.0]);
        assert_eq!(mirrored_shift(&[1.0, 2.0, 3.0], 6), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn many_terms_of_a_slow_column_are_chance_where_shifted_ones_are_worth_as_much() {
        let n = 1500;
        let drivers = Drivers { dt_s: 20.0, samples: n, averaged: 1, ..Drivers::default() };
        let at = |i: usize| i as f64 / n as f64;
        // A slow column, and a rate with another slow course that as many terms of it bend to.
        let column: Vec<f64> = (0..n).map(|i| at(i) + 0.2 * (5.0 * at(i)).sin()).collect();
        let rate: Vec<f64> = (0..n).map(|i| (7.0 * at(i) + 1.0).sin() + 0.5 * (13.0 * at(i)).cos()).collect();
        let mut powers = vec![0.02; n];
        powers[0] = f64::INFINITY;
        let modes = dct2(&rate);
        let context = SearchContext { score: &rate, modes: &modes, powers: &powers };
        let found = search(&column, &drivers, &context).unwrap();
        assert!(found.mask.count_ones() >= MIN_FLEXIBLE_TERMS, "{:b}", found.mask);
        assert!(follows_by_chance(&found, &column, &drivers, &context));
    }

    #[test]
    fn a_column_follows_unexplained_noise_by_chance_and_a_driven_rate_not_so() {
        let n = 1500;
        let drivers = Drivers { dt_s: 20.0, samples: n, averaged: 1, ..Drivers::default() };
        let mut chance = 0;
        for seed in 1..=10u64 {
            let mut state = seed;
            let mut normal = || {
                let mut uniform = || {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
                };
                (0..12).map(|_| uniform()).sum::<f64>()
            };
            // Correlated over 20 samples, with a deviation of 1.
            let mut process = || -> Vec<f64> {
                let mut at = 0.0;
                let mut next = || {
                    at = 0.95 * at + 0.312 * normal();
                    at
                };
                (0..n).map(|_| next()).collect()
            };
            let (column, other) = (process(), process());
            // The noise is taken for white: the process in the rate is unexplained.
            let mut powers = vec![1.0; n];
            powers[0] = f64::INFINITY;
            let judged = |rate: &[f64]| {
                let modes = dct2(rate);
                let context = SearchContext { score: rate, modes: &modes, powers: &powers };
                search(&column, &drivers, &context)
                    .is_none_or(|found| follows_by_chance(&found, &column, &drivers, &context))
            };
            let rate: Vec<f64> = other.iter().map(|o| o + normal()).collect();
            chance += usize::from(judged(&rate));
            let driven: Vec<f64> = column.iter().map(|c| c + normal()).collect();
            assert!(!judged(&driven), "seed {seed}: it follows");
        }
        assert!(chance >= 9, "{chance} of 10 by chance");
    }
}
