//! What shows in single samples: groups of outliers, a noise level that changes, jumps between two levels.
//!
//! Bursts and the level are judged on a flat residual: the whitened residual of a hypothesis without its slow course
//! and with its own spectrum levelled, so that what a wrong spectrum or a missing course leaves is not taken for them.

pub mod bursts;
mod gamma;
pub mod level;
mod path;
mod rate_law;
mod rivals;
pub mod telegraph;
mod time_level;
mod two_level;

pub use bursts::{Bursts, bursts};
pub use level::{Law, Level, level};
pub use telegraph::{Telegraph, telegraph};

use super::departures::White;
use super::problem::Problem;
use super::tried::Tried;
use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::numeric::range::{Bounds, ends};
use crate::numeric::sums::cumulated;

/// Samples on either side of a running median: courses slower than this are none of a burst.
const SLOW: usize = 64;
/// Modes on either side over which the own spectrum is averaged where it stands out, and elsewhere: a narrow average
/// follows chance, and dividing by it would smear what happens in time.
const NARROW: usize = 12;
const WIDE: usize = 250;
/// Power of a narrow average over a wide one within which the wide one is taken.
const EVEN: (f64, f64) = (0.4, 2.0);
/// Levelled power from which the ends of the record show the leakage of cosine modes, and how far.
const STRONG: f64 = 8.0;
const ENDS: usize = 64;
/// Steps of a lattice, in deviations of a sample, from which values are seen to jump between them.
const COARSE: f64 = 2.0;
/// A median of absolute values over the deviation of a normal law.
const MEDIAN: f64 = 0.674_489_750_196_082;

/// The residual of a hypothesis in single samples.
pub struct Flat {
    /// Whitened by the hypothesis.
    pub white: Vec<f64>,
    /// Without the slow course, its own spectrum levelled.
    pub flat: Vec<f64>,
    /// What a deviation of 1 deg/h of one sample is in `flat`.
    pub per_deg_h: f64,
    /// Samples at either end that say nothing of single samples.
    pub ends: usize,
}

impl Flat {
    /// Of the fit of a hypothesis.
    pub fn of(tried: &Tried, problem: &Problem) -> Flat {
        let white = White::of(tried, &problem.spectra);
        let slow = running_median(&white.series, SLOW);
        let fast: Vec<f64> = white.series.iter().zip(&slow).map(|(e, s)| e - s).collect();
        // Few large values must not be what the spectrum is levelled by.
        let bound = 4.0 * deviation(&fast);
        let clipped: Vec<f64> = fast.iter().map(|e| e.clamp(-bound, bound)).collect();
        let squares: Vec<f64> = dct2(&clipped).iter().map(|u| u * u).collect();
        let (narrow, wide) = (smooth(&squares, NARROW), smooth(&squares, WIDE));
        let even = |(p, w): (&f64, &f64)| if *p > EVEN.0 * w && *p < EVEN.1 * w { *w } else { *p };
        let powers: Vec<f64> = narrow.iter().zip(&wide).map(even).collect();
        let level = median(&mut powers.clone());
        let strong = powers.iter().any(|p| *p > STRONG * level);
        let modes: Vec<f64> = dct2(&fast).iter().zip(&powers).map(|(u, p)| u / p.max(1e-12).sqrt()).collect();
        let n = modes.len().max(2);
        let gains = white.roots.iter().zip(&powers).skip(1).map(|(r, p)| 1.0 / (r * p.max(1e-12).sqrt()));
        let per_deg_h = gains.sum::<f64>() / (n - 1) as f64;
        let ends = if strong { ENDS.min(n / 16) } else { 0 };
        Flat { white: white.series, flat: inverse_dct2(&modes), per_deg_h, ends }
    }

    /// True for a sample that counts.
    fn counts(&self, problem: &Problem, i: usize) -> bool {
        let inside = i >= self.ends && i + self.ends < self.flat.len();
        inside && problem.usable.get(i).copied().unwrap_or(false)
    }
}

/// Standard deviation by the median of the absolute values.
fn deviation(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    median(&mut sizes) / MEDIAN
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Running mean of the powers of modes; mode 0 stays out.
fn smooth(powers: &[f64], half: usize) -> Vec<f64> {
    let n = powers.len();
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for (k, p) in powers.iter().enumerate() {
        sum += if k == 0 { 0.0 } else { *p };
        sums.push(sum);
    }
    (0..n)
        .map(|k| {
            let (from, to) = (k.saturating_sub(half).max(1), (k + half + 1).min(n));
            if to > from { (sums[to] - sums[from]) / (to - from) as f64 } else { 1.0 }
        })
        .collect()
}

/// Median of each value with `half` neighbours on either side, fewer at the ends.
fn running_median(values: &[f64], half: usize) -> Vec<f64> {
    let n = values.len();
    let mut window: Vec<f64> = values.iter().take(half).copied().collect();
    window.sort_by(f64::total_cmp);
    let mut out = Vec::with_capacity(n);
    for i in 0..n {
        if i + half < n {
            let new = values[i + half];
            let at = window.partition_point(|w| w.total_cmp(&new).is_lt());
            window.insert(at, new);
        }
        if i > half {
            let old = values[i - half - 1];
            let at = window.partition_point(|w| w.total_cmp(&old).is_lt());
            window.remove(at.min(window.len() - 1));
        }
        let middle = window.len() / 2;
        out.push(if window.len() % 2 == 1 {
            window[middle]
        } else {
            0.5 * (window[middle - 1] + window[middle])
        });
    }
    out
}

/// True where a problem's column changes at all.
fn varies(values: &[f64]) -> bool {
    let Bounds { low, high } = ends(values);
    high - low > 1e-9 * low.abs().max(high.abs())
}

/// Step of the lattice of the values in the unit of the flat residual; 0 where there is none.
fn lattice_step(problem: &Problem, flat: &Flat) -> f64 {
    problem.spectra.grid_step_arcsec.map_or(0.0, |a| a / problem.drivers.dt_s * flat.per_deg_h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_median_is_the_median_of_its_window() {
        let values: Vec<f64> = (0..50).map(|i| f64::from(i * 37 % 50)).collect();
        let got = running_median(&values, 5);
        for (i, g) in got.iter().enumerate() {
            let mut window = values[i.saturating_sub(5)..(i + 6).min(50)].to_vec();
            window.sort_by(f64::total_cmp);
            let m = window.len();
            let expected = if m % 2 == 1 { window[m / 2] } else { 0.5 * (window[m / 2 - 1] + window[m / 2]) };
            assert_eq!(*g, expected, "{i}");
        }
    }
}
