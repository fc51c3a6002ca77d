//! Exact one-sided tolerance factors of a normal sample.

use crate::estimate::{normal_probability, normal_quantile};
use crate::numeric::optimize::bisect;

/// Points of the quadrature; its error is below 1e-12 from 200 on, since the integrand is smooth and falls to nothing.
const QUADRATURE_POINTS: u32 = 600;

/// A proportion of the population that a bound holds for, and the confidence in that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Promise {
    /// Proportion of the population, between 0 and 1.
    pub proportion: f64,
    /// Confidence, between 0 and 1.
    pub confidence: f64,
}

/// The factor k for which mean + k·s bounds the proportion of a normal population from above with the confidence: the
/// quantile of the noncentral t distribution (Owen 1968). `size` is the number of values behind the mean, `dof` the degrees
/// of freedom of s. `None` below one of either, and outside of probabilities.
pub fn normal_factor(size: f64, dof: f64, promise: Promise) -> Option<f64> {
    let probability = |p: f64| p > 0.0 && p < 1.0;
    if !(size >= 1.0 && dof >= 1.0 && probability(promise.proportion) && probability(promise.confidence)) {
        return None;
    }
    let shift = normal_quantile(promise.proportion) * size.sqrt();
    let spread = Spread::new(dof);
    let below =
        |k: f64| spread.mean(|s| normal_probability(k * size.sqrt() * s - shift)) < promise.confidence;
    let (mut low, mut high) = (-1.0, 1.0);
    while !below(low) && low > -1e12 {
        low *= 2.0;
    }
    while below(high) && high < 1e12 {
        high *= 2.0;
    }
    Some(bisect(low, high, 100, below).middle())
}

/// The distribution of s/σ with some degrees of freedom, as points and weights.
struct Spread(Vec<(f64, f64)>);

impl Spread {
    fn new(dof: f64) -> Spread {
        // In w = ln(s/σ) the density is exp(dof·(w − (e^2w − 1)/2)) but for a constant, with its peak at 0.
        let log_density = |w: f64| dof * (w - 0.5 * (2.0 * w).exp_m1());
        let end = |sign: f64| {
            let mut w = sign / (2.0 * dof).sqrt();
            while log_density(w) > -45.0 {
                w *= 1.2;
            }
            w
        };
        let (low, high) = (end(-1.0), end(1.0));
        let step = (high - low) / f64::from(QUADRATURE_POINTS);
        let points: Vec<(f64, f64)> = (0..=QUADRATURE_POINTS)
            .map(|i| low + step * f64::from(i))
            .map(|w| (w.exp(), log_density(w).exp()))
            .collect();
        let total: f64 = points.iter().map(|p| p.1).sum();
        Spread(points.into_iter().map(|(s, weight)| (s, weight / total)).collect())
    }

    fn mean(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.0.iter().map(|(s, weight)| weight * of(*s)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_agree_with_published_ones() {
        for (proportion, confidence, n, k) in [
            (0.90, 0.99, 43.0, 1.87395),
            (0.90, 0.99, 40.0, 1.90173),
            (0.95, 0.95, 10.0, 2.91096),
            (0.95, 0.95, 20.0, 2.396),
            (0.95, 0.95, 30.0, 2.21984),
            (0.95, 0.95, 100.0, 1.92654),
            (0.90, 0.95, 10.0, 2.35464),
            (0.99, 0.95, 10.0, 3.98112),
        ] {
            let found = normal_factor(n, n - 1.0, Promise { proportion, confidence }).unwrap();
            assert!((found - k).abs() < 6e-6, "{proportion} {confidence} {n}: {found} is not {k}");
        }
        // Two values: table of Owen, 95/95 is 26.26.
        let two = normal_factor(2.0, 1.0, Promise { proportion: 0.95, confidence: 0.95 }).unwrap();
        assert!((two - 26.26).abs() < 5e-3, "{two}");
    }

    #[test]
    fn what_is_no_promise_has_no_factor() {
        for (size, dof, proportion, confidence) in
            [(0.0, 1.0, 0.9, 0.9), (2.0, 0.0, 0.9, 0.9), (5.0, 4.0, 1.0, 0.9), (5.0, 4.0, 0.9, f64::NAN)]
        {
            assert_eq!(normal_factor(size, dof, Promise { proportion, confidence }), None);
        }
    }

    #[test]
    fn lower_bounds_of_the_published_example() {
        // CMH-17, the example of STAT-17: 18 values; lower bounds 90/95 and 99/95.
        let values = super::super::free::STAT_17;
        let n = values.len() as f64;
        let bound = |of: &dyn Fn(f64) -> f64, proportion: f64| {
            let mean = values.iter().map(|v| of(*v)).sum::<f64>() / n;
            let squares = values.iter().map(|v| (of(*v) - mean).powi(2)).sum::<f64>();
            let k = normal_factor(n, n - 1.0, Promise { proportion, confidence: 0.95 }).unwrap();
            mean - k * (squares / (n - 1.0)).sqrt()
        };
        for (proportion, plain, log) in [(0.90, 129.290, 129.664), (0.99, 120.355, 121.710)] {
            let found = bound(&|v| v, proportion);
            assert!((found - plain).abs() < 6e-4, "{found} is not {plain}");
            // The published values have factors of an approximation, which is 0.02 off.
            let found = bound(&f64::ln, proportion).exp();
            assert!((found - log).abs() < 0.03, "{found} is not {log}");
        }
    }
}
