//! Autocorrelation: of a regular series by products, and of the full-rate record from its spectrum.
//!
//! Source: Box, Jenkins, Reinsel, Time Series Analysis, chapter 2; Ljung and Box, Biometrika 65 (1978) 297.

use super::data::WelchSpectrum;
use super::welch::hann;
use crate::estimate::SCORE_TWO_SIDED_95;
use sagnac_fft::{Complex, real_forward, real_inverse};

/// Autocorrelation at lags 0, 1, 2, ...
#[derive(Debug, Clone, PartialEq)]
pub struct Autocorrelation {
    /// Coefficients, the first being 1.
    pub coefficients: Vec<f64>,
    /// Values that the estimate rests on.
    pub values: u64,
    /// Half width of the band that holds 95 % of the coefficients of white noise: 1.96/√n.
    pub white_band: f64,
}

impl Autocorrelation {
    /// Ljung–Box statistic over the first `lags` lags: χ² with `lags` degrees of freedom for white noise.
    pub fn ljung_box(&self, lags: usize) -> f64 {
        let n = self.values as f64;
        let terms = self.coefficients.iter().enumerate().skip(1).take(lags);
        n * (n + 2.0) * terms.map(|(k, r)| r * r / (n - k as f64)).sum::<f64>()
    }
}

/// The biased estimate (mean removed, divided by n) up to `max_lag`. Values that are not finite are missing: a lag uses
/// the pairs in which both are present, scaled to what a complete series would hold. `None` without variance.
pub fn of_series(series: &[f64], max_lag: usize) -> Option<Autocorrelation> {
    let n = series.len();
    let present = series.iter().filter(|v| v.is_finite()).count();
    if present < 2 {
        return None;
    }
    let first = series.iter().copied().find(|v| v.is_finite())?;
    let finite = || series.iter().filter(|v| v.is_finite());
    // Taken off one after the other: their sum would be rounded to the digits of a large offset.
    let rest = finite().map(|v| v - first).sum::<f64>() / present as f64;
    let max_lag = max_lag.min(n - 1);
    let length = (n + max_lag + 1).next_power_of_two();
    let products = lagged_products(
        series.iter().map(|v| if v.is_finite() { (v - first) - rest } else { 0.0 }),
        length,
        max_lag,
    )?;
    let pairs = if present == n {
        (0..=max_lag).map(|k| (n - k) as f64).collect()
    } else {
        lagged_products(series.iter().map(|v| f64::from(u8::from(v.is_finite()))), length, max_lag)?
    };
    let c0 = products.first()? / present as f64;
    if c0 <= 0.0 || c0.is_nan() {
        return None;
    }
    let coefficients = products
        .iter()
        .zip(&pairs)
        .enumerate()
        .map(|(k, (sum, pairs))| {
            let whole = (n - k) as f64 / n as f64;
            if *pairs < 0.5 { f64::NAN } else { sum / pairs * whole / c0 }
        })
        .collect();
    Some(Autocorrelation {
        coefficients,
        values: present as u64,
        white_band: SCORE_TWO_SIDED_95 / (present as f64).sqrt(),
    })
}

/// Sums of products of values `k` apart, k = 0 to `max_lag`; `length` of the transform, at least the values and the lags
/// together. `None` where a transform fails.
pub fn lagged_products(values: impl Iterator<Item = f64>, length: usize, max_lag: usize) -> Option<Vec<f64>> {
    let (forward, inverse) = (real_forward(length), real_inverse(length));
    let (mut time, mut frequency) = (forward.make_input_vec(), forward.make_output_vec());
    time.iter_mut().zip(values).for_each(|(t, v)| *t = v);
    forward.process(&mut time, &mut frequency).ok()?;
    frequency.iter_mut().for_each(|z| *z = Complex::new(z.norm_sqr(), 0.0));
    inverse.process(&mut frequency, &mut time).ok()?;
    time.truncate(max_lag + 1);
    time.iter_mut().for_each(|t| *t /= length as f64);
    Some(time)
}

/// Autocorrelation of the full-rate samples from their averaged periodogram, up to `max_lag` samples (at most an eighth
/// of a segment): the inverse transform, corrected for the autocorrelation of the window. Noise slower than a segment
/// is removed with the segment means. `values` counts the samples that the segments stand for.
pub fn of_spectrum(spectrum: &WelchSpectrum, max_lag: usize) -> Option<Autocorrelation> {
    let length = spectrum.segment_len;
    if length < 2 || spectrum.density.len() != length / 2 + 1 {
        return None;
    }
    let max_lag = max_lag.min(length / 8);
    // The circular transform of the periodogram folds far lags onto near ones; a Hann window leaves next to nothing
    // there.
    let inverse = real_inverse(length);
    let mut frequency: Vec<Complex<f64>> = spectrum.density.iter().map(|p| Complex::new(*p, 0.0)).collect();
    let mut time = inverse.make_output_vec();
    inverse.process(&mut frequency, &mut time).ok()?;
    let window = hann(length);
    let overlap = |k: usize| window.iter().zip(window.iter().skip(k)).map(|(a, b)| a * b).sum::<f64>();
    let whole = overlap(0);
    let c0 = *time.first()?;
    if c0 <= 0.0 || c0.is_nan() {
        return None;
    }
    let coefficients =
        time.iter().take(max_lag + 1).enumerate().map(|(k, c)| c / c0 * whole / overlap(k)).collect();
    let values = ((spectrum.segments + 1) * length as u64 / 2).max(1);
    Some(Autocorrelation { coefficients, values, white_band: SCORE_TWO_SIDED_95 / (values as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::super::welch::WelchAccumulator;
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_thousand_point_suite() {
        let mut n = 1_234_567_890u64;
        let y: Vec<f64> = (0..1000)
            .map(|_| {
                let v = n as f64 / 2_147_483_647.0;
                n = 16807 * n % 2_147_483_647;
                v
            })
            .collect();
        let a = of_series(&y, 10).unwrap();
        for (lag, r) in [
            (0, 1.0),
            (1, -0.02665814),
            (2, 0.01838910),
            (3, -0.00330871),
            (4, 0.03116798),
            (5, -0.04954114),
            (10, -0.04139815),
        ] {
            assert!((a.coefficients[lag] - r).abs() < 6e-9, "{lag} {}", a.coefficients[lag]);
        }
        assert!((a.ljung_box(10) - 10.0107438).abs() < 6e-8, "{}", a.ljung_box(10));
    }

    fn ar1(count: usize, p: f64, seed: u64) -> Vec<f64> {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut state = 0.0;
        (0..count)
            .map(|_| {
                let step: f64 = StandardNormal.sample(&mut rng);
                state = p * state + step;
                state
            })
            .collect()
    }

    #[test]
    fn missing_values_do_not_bias() {
        let mut y = ar1(50_000, 0.8, 7);
        y.iter_mut().enumerate().filter(|(i, _)| i % 7 < 2).for_each(|(_, v)| *v = f64::NAN);
        let a = of_series(&y, 8).unwrap();
        for (k, r) in a.coefficients.iter().enumerate() {
            assert!((r - 0.8f64.powi(k as i32)).abs() < 0.03, "{k} {r}");
        }
        assert_eq!(a.values, y.iter().filter(|v| v.is_finite()).count() as u64);
        assert!(of_series(&[1.0, 1.0, 1.0], 2).is_none() && of_series(&[f64::NAN; 4], 2).is_none());
    }

    #[test]
    fn the_spectrum_gives_the_same_as_products() {
        let y = ar1(1 << 18, 0.9, 8);
        let direct = of_series(&y, 100).unwrap();
        let mut welch = WelchAccumulator::with_segment(4096);
        welch.push(&y, false);
        let from_spectrum = of_spectrum(&welch.finish().spectrum, 100).unwrap();
        for (a, b) in direct.coefficients.iter().zip(&from_spectrum.coefficients) {
            assert!((a - b).abs() < 0.01, "{a} {b}");
        }
    }
}
