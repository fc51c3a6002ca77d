//! Distribution of the whitened residual against the normal one: skewness, kurtosis, and how many lie beyond four
//! standard deviations.
//!
//! Sources: R. B. D'Agostino, Biometrika 57 (1970) 679 (skewness); F. J. Anscombe, W. J. Glynn, Biometrika 70 (1983)
//! 227 (kurtosis).

use super::view::{Departure, Judged, View};
use super::whiten::Whitened;
use crate::estimate::normal_probability;
use statrs::distribution::{DiscreteCDF, Poisson};

/// Standard deviations beyond which values are counted.
pub const TAIL_DEVIATIONS: f64 = 4.0;

/// The distribution of a whitened residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Values.
    pub values: u64,
    /// Skewness.
    pub skewness: f64,
    /// Kurtosis less 3.
    pub excess_kurtosis: f64,
    /// Values beyond four standard deviations.
    pub beyond: u64,
    /// How many of them a normal distribution has.
    pub expected_beyond: f64,
    /// Probabilities of a larger departure under a normal law: of skewness, kurtosis, and the count.
    pub p_values: [f64; 3],
}

/// Normal score of a skewness of n normal values (D'Agostino).
fn skewness_score(skewness: f64, n: f64) -> f64 {
    let y = skewness * ((n + 1.0) * (n + 3.0) / (6.0 * (n - 2.0))).sqrt();
    let beta = 3.0 * (n * n + 27.0 * n - 70.0) * (n + 1.0) * (n + 3.0)
        / ((n - 2.0) * (n + 5.0) * (n + 7.0) * (n + 9.0));
    let w2 = (2.0 * (beta - 1.0)).sqrt() - 1.0;
    let delta = (0.5 * w2.ln()).sqrt().recip();
    let alpha = (2.0 / (w2 - 1.0)).sqrt();
    delta * (y / alpha).asinh()
}

/// Normal score of a kurtosis of n normal values (Anscombe and Glynn).
fn kurtosis_score(excess: f64, n: f64) -> f64 {
    let mean = -6.0 / (n + 1.0);
    let variance = 24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0).powi(2) * (n + 3.0) * (n + 5.0));
    let x = (excess - mean) / variance.sqrt();
    let third = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0))
        * (6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0))).sqrt();
    let a = 6.0 + 8.0 / third * (2.0 / third + (1.0 + 4.0 / (third * third)).sqrt());
    let inner = (1.0 - 2.0 / a) / (1.0 + x * (2.0 / (a - 4.0)).sqrt());
    ((1.0 - 2.0 / (9.0 * a)) - inner.cbrt()) / (2.0 / (9.0 * a)).sqrt()
}

fn two_sided(score: f64) -> f64 {
    2.0 * normal_probability(-score.abs())
}

/// The distribution of the residual; `None` without spread.
pub(super) fn of(whitened: &Whitened) -> Option<Amplitude> {
    let n = whitened.values.len() as f64;
    let moment = |k: i32| whitened.values.iter().map(|v| v.powi(k)).sum::<f64>() / n;
    // The mean is zero: the mode that holds it was left out.
    let variance = moment(2);
    if n < 64.0 || !(variance > 0.0 && variance.is_finite()) {
        return None;
    }
    let sigma = variance.sqrt();
    let (skewness, excess_kurtosis) = (moment(3) / sigma.powi(3), moment(4) / variance.powi(2) - 3.0);
    let beyond = whitened.values.iter().filter(|v| v.abs() > TAIL_DEVIATIONS * sigma).count() as u64;
    let expected_beyond = n * two_sided(TAIL_DEVIATIONS);
    let law = Poisson::new(expected_beyond).ok()?;
    let few = law.cdf(beyond);
    let many = if beyond == 0 { 1.0 } else { law.sf(beyond - 1) };
    Some(Amplitude {
        values: n as u64,
        skewness,
        excess_kurtosis,
        beyond,
        expected_beyond,
        p_values: [
            two_sided(skewness_score(skewness, n)),
            two_sided(kurtosis_score(excess_kurtosis, n)),
            (2.0 * few.min(many)).min(1.0),
        ],
    })
}

/// The view of amplitudes: the smallest of the three probabilities, counted as three looks.
pub(super) fn judge(found: &Amplitude) -> Judged {
    let smallest = found.p_values.iter().copied().fold(1.0, f64::min);
    Judged {
        view: View::Amplitude,
        statistic: found.excess_kurtosis,
        p_value: (3.0 * smallest).min(1.0),
        departure: Departure {
            from: TAIL_DEVIATIONS,
            to: f64::INFINITY,
            excess: found.beyond as f64 / found.expected_beyond - 1.0,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_of_published_critical_values() {
        // Percentage points of normal samples (Pearson and Hartley, Biometrika Tables vol. 1, table 34): two-sided 10 %
        // of the skewness at n = 100 is 0.389 and at n = 1000 is 0.127; upper 5 % of the kurtosis at n = 1000 is 3.26.
        for (skewness, n) in [(0.389, 100.0), (0.127, 1000.0)] {
            assert!((skewness_score(skewness, n) - 1.645).abs() < 0.02, "{}", skewness_score(skewness, n));
        }
        assert!((kurtosis_score(0.26, 1000.0) - 1.645).abs() < 0.05, "{}", kurtosis_score(0.26, 1000.0));
    }

    #[test]
    fn moments_and_far_values_of_a_hundred_by_hand() {
        let of_values = |values: Vec<f64>| {
            let modes = values.len();
            super::of(&Whitened {
                step_s: 1.0,
                values,
                modes,
                share: 1.0,
                means: vec![],
                from_s: 0.0,
                jump: None,
                jump_instead: None,
            })
        };
        let mut values: Vec<f64> = (0..98).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        values.extend([8.0, -2.0]);
        // Second, third and fourth moments 1.66, 5.04 and 42.1; 8 lies beyond four deviations of 1.29.
        let found = of_values(values).unwrap();
        assert!((found.skewness - 5.04 / 1.66f64.powf(1.5)).abs() < 1e-12);
        assert!((found.excess_kurtosis - (42.1 / (1.66 * 1.66) - 3.0)).abs() < 1e-12);
        assert_eq!((found.values, found.beyond), (100, 1));
        // A normal law has 6.334e-5 there: at least one of a hundred with 1 − exp(−0.006334), counted twice.
        assert!((found.expected_beyond / 0.006_334_2 - 1.0).abs() < 1e-4);
        assert!((found.p_values[2] / (2.0 * -(-found.expected_beyond).exp_m1()) - 1.0).abs() < 1e-9);
        assert!((judge(&found).departure.excess - (1.0 / found.expected_beyond - 1.0)).abs() < 1e-9);
        let even: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let found = of_values(even).unwrap();
        assert_eq!(
            (found.beyond, found.skewness, found.excess_kurtosis, found.p_values[2]),
            (0, 0.0, -2.0, 1.0)
        );
        assert!(of_values(vec![1.0; 63]).is_none() && of_values(vec![0.0; 100]).is_none());
    }
}
