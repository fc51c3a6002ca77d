//! Whether values scatter normally, by the test of Anderson and Darling with estimated mean and deviation.

use crate::estimate::normal_probability;
use crate::numeric::order::SortNumbers;

/// Values from which the test is made.
pub const MIN_VALUES: usize = 8;

/// The probability that a normal sample fits worse than these values (D'Agostino and Stephens 1986, table 4.9). `None` below
/// [`MIN_VALUES`] values, or where all are the same.
pub fn normality(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    if values.len() < MIN_VALUES || !(deviation > 0.0 && deviation.is_finite()) {
        return None;
    }
    let mut z: Vec<f64> = values.iter().map(|v| (v - mean) / deviation).collect();
    z.sort_ascending();
    let tail = |z: f64| normal_probability(z).max(f64::MIN_POSITIVE).ln();
    let sum: f64 = z
        .iter()
        .zip(z.iter().rev())
        .enumerate()
        .map(|(i, (low, high))| (2.0 * i as f64 + 1.0) * (tail(*low) + tail(-high)))
        .sum();
    let statistic = (-n - sum / n) * (1.0 + 0.75 / n + 2.25 / (n * n));
    Some(probability(statistic))
}

fn probability(a: f64) -> f64 {
    if a < 0.2 {
        1.0 - (-13.436 + 101.14 * a - 223.73 * a * a).exp()
    } else if a < 0.34 {
        1.0 - (-8.318 + 42.796 * a - 59.938 * a * a).exp()
    } else if a < 0.6 {
        (0.9177 - 4.279 * a - 1.38 * a * a).exp()
    } else if a < 13.0 {
        (1.2937 - 5.709 * a + 0.0186 * a * a).exp()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::normal_quantile;

    #[test]
    fn the_probability_is_that_of_the_table() {
        // D'Agostino and Stephens, table 4.7: upper 10, 5 and 1 % points of the modified statistic.
        for (a, p) in [(0.631, 0.10), (0.752, 0.05), (1.035, 0.01)] {
            assert!((probability(a) / p - 1.0).abs() < 0.04, "{a}: {}", probability(a));
        }
    }

    #[test]
    fn the_published_example_is_normal_and_an_exponential_sample_is_not() {
        // CMH-17 finds an observed significance of the normal law well above 0.05 for the example.
        assert!(normality(&super::super::free::STAT_17).unwrap() > 0.4);
        let exponential: Vec<f64> = (0..40).map(|i| -(1.0 - (f64::from(i) + 0.5) / 40.0_f64).ln()).collect();
        assert!(normality(&exponential).unwrap() < 0.005);
        let normal: Vec<f64> = (0..40).map(|i| normal_quantile((f64::from(i) + 0.5) / 40.0)).collect();
        assert!(normality(&normal).unwrap() > 0.99);
    }

    #[test]
    fn few_or_equal_values_are_not_judged() {
        assert_eq!(normality(&[1.0, 2.0, 3.0]), None);
        assert_eq!(normality(&[4.0; 20]), None);
        assert_eq!(normality(&[]), None);
    }
}
