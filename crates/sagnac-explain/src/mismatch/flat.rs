//! The residual of a hypothesis in single samples.

use super::departures::White;
use super::fitted_hypothesis::FittedHypothesis;
use super::problem::Problem;
use crate::effect::FlatResidual;
use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::numeric::order::SortNumbers;
use crate::numeric::order::{NORMAL_MEDIAN, upper_median};

/// Samples on either side of a running median: courses slower than this are none of a burst.
const MEDIAN_HALF_WIDTH: usize = 64;
/// Modes on either side over which the own spectrum is averaged where it stands out, and elsewhere: a narrow average
/// follows chance, and dividing by it would smear what happens in time.
const NARROW_MODES: usize = 12;
const WIDE_MODES: usize = 250;
/// Power of a narrow average over a wide one within which the wide one is taken.
const EVEN_POWER_RATIOS: (f64, f64) = (0.4, 2.0);
/// Levelled power from which the ends of the record show the leakage of cosine modes, and how far.
const LEAKAGE_POWER: f64 = 8.0;
const LEAKAGE_SAMPLES: usize = 64;

/// The residual of a fitted hypothesis in single samples, whitened and with its own spectrum levelled, so that what a wrong
/// spectrum or a missing course leaves is not taken for an effect on samples.
pub fn flat<'a>(tried: &FittedHypothesis, problem: &'a Problem) -> FlatResidual<'a> {
    let white = White::of(tried, &problem.spectra);
    let slow = running_median(&white.series, MEDIAN_HALF_WIDTH);
    let fast: Vec<f64> = white.series.iter().zip(&slow).map(|(e, s)| e - s).collect();
    // Few large values must not be what the spectrum is levelled by.
    let bound = 4.0 * deviation(&fast);
    let clipped: Vec<f64> = fast.iter().map(|e| e.clamp(-bound, bound)).collect();
    let squares: Vec<f64> = dct2(&clipped).iter().map(|u| u * u).collect();
    let (narrow, wide) = (smooth(&squares, NARROW_MODES), smooth(&squares, WIDE_MODES));
    let even = |(p, w): (&f64, &f64)| {
        if *p > EVEN_POWER_RATIOS.0 * w && *p < EVEN_POWER_RATIOS.1 * w { *w } else { *p }
    };
    let powers: Vec<f64> = narrow.iter().zip(&wide).map(even).collect();
    let level = upper_median(&mut powers.clone());
    let strong = powers.iter().any(|p| *p > LEAKAGE_POWER * level);
    let modes: Vec<f64> = dct2(&fast).iter().zip(&powers).map(|(u, p)| u / p.max(1e-12).sqrt()).collect();
    let n = modes.len().max(2);
    let gains = white.roots.iter().zip(&powers).skip(1).map(|(r, p)| 1.0 / (r * p.max(1e-12).sqrt()));
    let per_deg_h = gains.sum::<f64>() / (n - 1) as f64;
    let ends = if strong { LEAKAGE_SAMPLES.min(n / 16) } else { 0 };
    let step = problem.spectra.grid_step_arcsec.map_or(0.0, |a| a / problem.drivers.dt_s * per_deg_h);
    FlatResidual {
        white: white.series,
        flat: inverse_dct2(&modes),
        per_deg_h,
        ends,
        usable: &problem.usable,
        drivers: &problem.drivers,
        rounding_step: step,
    }
}

/// Standard deviation by the median of the absolute values.
fn deviation(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    upper_median(&mut sizes) / NORMAL_MEDIAN
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
    window.sort_ascending();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_by_the_median_bears_outliers() {
        // Quantiles of a normal law, a tenth of them moved far out.
        let mut values: Vec<f64> = (0..1000)
            .map(|i| 2.5 * crate::estimate::normal_quantile((f64::from(i) + 0.5) / 1000.0))
            .collect();
        assert!((deviation(&values) / 2.5 - 1.0).abs() < 0.01);
        values.iter_mut().step_by(100).for_each(|v| *v = 1e9);
        assert!((deviation(&values) / 2.5 - 1.0).abs() < 0.03);
    }

    #[test]
    fn running_means_of_powers_leave_the_mean_of_the_record_out() {
        assert_eq!(smooth(&[1e9, 2.0, 4.0, 9.0], 1), [2.0, 3.0, 5.0, 6.5]);
    }

    #[test]
    fn a_running_median_is_the_median_of_its_window() {
        let values: Vec<f64> = (0..50).map(|i| f64::from(i * 37 % 50)).collect();
        let got = running_median(&values, 5);
        for (i, g) in got.iter().enumerate() {
            let mut window = values[i.saturating_sub(5)..(i + 6).min(50)].to_vec();
            window.sort_ascending();
            let m = window.len();
            let expected = if m % 2 == 1 { window[m / 2] } else { 0.5 * (window[m / 2 - 1] + window[m / 2]) };
            assert_eq!(*g, expected, "{i}");
        }
    }
}
