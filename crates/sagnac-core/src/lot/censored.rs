//! Maximum likelihood for a normal sample of which some values are only known to lie below a bound: a check of
//! [`super::population`] by another way.

use crate::estimate::{normal_probability, normal_quantile};
use crate::numeric::optimize::{bisect, golden_section, golden_section_maximum};

/// Sections of a search; each leaves 0.618 of the span.
const SEARCH_SECTIONS: usize = 60;

/// A normal sample in which some values are only bounded.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Values.
    pub values: Vec<f64>,
    /// Bounds of the others from above.
    pub bounds: Vec<f64>,
}

/// Normal distribution of the largest likelihood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Sample {
    /// The mean and standard deviation of largest likelihood; `None` below two different values.
    pub fn fit(&self) -> Option<Normal> {
        let (low, high) = self.span()?;
        let mean = golden_section_maximum(low, high, SEARCH_SECTIONS, |mean| self.profile(mean).1);
        Some(Normal { mean, deviation: self.profile(mean).0 })
    }

    /// The interval of the mean by its profile likelihood, of some coverage; `None` as with [`Sample::fit`].
    pub fn mean_interval(&self, coverage: f64) -> Option<(f64, f64)> {
        let (low, high) = self.span()?;
        let best = self.fit()?;
        let drop = 0.5 * normal_quantile(0.5 + 0.5 * coverage).powi(2);
        let least = self.profile(best.mean).1 - drop;
        let end = |outside: f64| {
            bisect(best.mean, outside, SEARCH_SECTIONS, |mean| self.profile(mean).1 >= least).middle()
        };
        Some((end(low), end(high)))
    }

    /// A span that has the mean.
    fn span(&self) -> Option<(f64, f64)> {
        let all = || self.values.iter().chain(&self.bounds).copied();
        let least = all().fold(f64::INFINITY, f64::min);
        let most = all().fold(f64::NEG_INFINITY, f64::max);
        if !all().all(f64::is_finite) {
            return None;
        }
        let differ = self.values.iter().any(|v| Some(v) != self.values.first());
        let width = 5.0 * (most - least);
        (differ && width.is_finite()).then_some((least - width, most + width))
    }

    /// The best deviation for a mean, and the logarithm of its likelihood.
    fn profile(&self, mean: f64) -> (f64, f64) {
        let far = self.values.iter().chain(&self.bounds).map(|v| (v - mean).abs()).fold(0.0, f64::max);
        let far = far.max(f64::MIN_POSITIVE).ln();
        let log =
            golden_section(far - 12.0, far + 3.0, SEARCH_SECTIONS, |l| -self.log_likelihood(mean, l.exp()));
        (log.exp(), self.log_likelihood(mean, log.exp()))
    }

    fn log_likelihood(&self, mean: f64, deviation: f64) -> f64 {
        let z = |v: &f64| (v - mean) / deviation;
        let values: f64 = self.values.iter().map(|v| -0.5 * z(v).powi(2) - deviation.ln()).sum();
        let bounds: f64 =
            self.bounds.iter().map(|v| normal_probability(z(v)).max(f64::MIN_POSITIVE).ln()).sum();
        values + bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Manganese in ground water, example 15-1 of EPA 530/R-09-007 (2009): 25 values, 6 of them censored, in ppb.
    pub(crate) fn manganese() -> Sample {
        let log = |values: &[f64]| values.iter().map(|v| v.ln()).collect();
        Sample {
            values: log(&[
                12.1, 16.9, 21.6, 7.7, 53.6, 9.5, 45.9, 5.3, 12.6, 106.3, 34.5, 6.3, 11.9, 10.0, 77.2, 17.9,
                22.7, 3.3, 8.4,
            ]),
            bounds: log(&[5.0, 2.0, 5.0, 5.0, 2.0, 2.0]),
        }
    }

    #[test]
    fn the_published_example_has_the_published_estimate() {
        let found = manganese().fit().unwrap();
        assert!((found.mean - 2.215905).abs() < 2e-6, "{}", found.mean);
        assert!((found.deviation - 1.356291).abs() < 2e-6, "{}", found.deviation);
        let (low, high) = manganese().mean_interval(0.95).unwrap();
        assert!((low - 1.595062).abs() < 1e-5 && (high - 2.771197).abs() < 1e-5, "{low} to {high}");
    }

    #[test]
    fn without_bounds_the_estimate_is_the_mean() {
        let sample = Sample { values: vec![1.0, 2.0, 6.0], bounds: vec![] };
        let found = sample.fit().unwrap();
        assert!((found.mean - 3.0).abs() < 1e-7);
        assert!((found.deviation - (14.0_f64 / 3.0).sqrt()).abs() < 1e-6);
        assert_eq!(Sample { values: vec![1.0], bounds: vec![2.0] }.fit(), None);
        assert_eq!(Sample { values: vec![f64::NAN, 1.0], bounds: vec![] }.fit(), None);
    }
}
