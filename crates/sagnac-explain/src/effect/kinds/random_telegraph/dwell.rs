//! A test of dwells whose values are those of two levels: the same within a dwell, and the same from one dwell to the
//! next. Pulses that rise and die away, and pulses of different heights, are not.

use crate::estimate::ln_chi_square_tail;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Dwells of a path that have a beginning and an end within the record, with their level.
fn dwells(path: &[bool]) -> Vec<(Range<usize>, usize)> {
    let mut out = vec![];
    let mut first = 0;
    for end in 1..path.len() {
        if path[end] != path[first] {
            if first > 0 {
                out.push((first..end, usize::from(path[first])));
            }
            first = end;
        }
    }
    out
}

/// Standard normal number of the common slope within the dwells at one level, by a path through the samples and what is left of
/// them beside the slow noise; `white` is the variance of a sample. The one of the two levels that is farther from zero.
pub(super) fn slope(path: &[bool], left: &[f64], white: f64) -> f64 {
    let mut sums = [(0.0, 0.0); 2];
    for (dwell, level) in dwells(path).into_iter().filter(|(d, _)| d.len() > 2) {
        let (both, square) = &mut sums[level];
        let length = dwell.len() as f64;
        let middle = 0.5 * (length - 1.0);
        for (i, x) in left[dwell].iter().enumerate() {
            // Of the same size in short and in long dwells: a pulse of any length falls by its height.
            let along = (i as f64 - middle) / length;
            *both += along * x;
            *square += along * along;
        }
    }
    let number = |(both, square): (f64, f64)| if square > 0.0 { both / (white * square).sqrt() } else { 0.0 };
    let [lower, upper] = sums.map(number);
    if upper.abs() > lower.abs() { upper } else { lower }
}

/// Difference between the dwells at one level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// Mean square of their departure from the common level, in those of white noise: about 1.
    pub ratio: f64,
    /// Natural logarithm of the probability of as much.
    pub ln_p: f64,
}

/// Difference between the dwells at the rarer level, of which the other is the rest.
pub(super) fn spread(path: &[bool], left: &[f64], white: f64) -> Spread {
    let raised = path.iter().filter(|p| **p).count();
    let rare = usize::from(2 * raised <= path.len());
    let of_level = dwells(path).into_iter().filter(|(_, level)| *level == rare);
    let means: Vec<(f64, f64)> = of_level
        .map(|(d, _)| {
            let length = d.len() as f64;
            (length, left[d].iter().sum::<f64>() / length)
        })
        .collect();
    let weight: f64 = means.iter().map(|m| m.0).sum();
    if means.len() < 3 || weight <= 0.0 {
        return Spread { ratio: 1.0, ln_p: 0.0 };
    }
    let level = means.iter().map(|(w, m)| w * m).sum::<f64>() / weight;
    let square = means.iter().map(|(w, m)| w * (m - level).powi(2)).sum::<f64>() / white;
    let free = (means.len() - 1) as f64;
    Spread { ratio: square / free, ln_p: ln_chi_square_tail(square, free) }
}

/// Pulses: visits to the rarer level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Visits {
    /// Number of them.
    pub count: usize,
    /// Samples of each, on average.
    pub length: f64,
    /// Two-sided probability of times at the two levels as different as these, if both were left at one rate: the ratio of their
    /// means follows a law of F.
    pub p_value: f64,
}

/// The visits to the rarer level of a path; `None` for a path that does not return.
pub(super) fn visits(path: &[bool]) -> Option<Visits> {
    let raised = path.iter().filter(|p| **p).count();
    let rare = 2 * raised <= path.len();
    let begins = |level: bool| (1..path.len()).filter(|i| path[*i] == level && path[i - 1] != level).count();
    let first = |level: bool| usize::from(path.first() == Some(&level));
    let [rarer, other] = [rare, !rare].map(|level| begins(level) + first(level));
    let time = if rare { raised } else { path.len() - raised } as f64;
    if rarer == 0 || other == 0 || time <= 0.0 {
        return None;
    }
    let length = time / rarer as f64;
    let ratio = length * other as f64 / (path.len() as f64 - time);
    let law = FisherSnedecor::new(2.0 * rarer as f64, 2.0 * other as f64).ok()?;
    Some(Visits { count: rarer, length, p_value: (2.0 * law.cdf(ratio)).min(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path of dwells of 20 and 30 samples.
    fn path() -> Vec<bool> {
        (0..1000).map(|i| i % 50 >= 30).collect()
    }

    #[test]
    fn levels_have_no_slope_and_pulses_have_one() {
        let path = path();
        let scatter = |i: usize| if i.is_multiple_of(2) { 0.1 } else { -0.1 };
        let flat: Vec<f64> =
            path.iter().enumerate().map(|(i, p)| scatter(i) + if *p { 1.0 } else { 0.0 }).collect();
        assert!(slope(&path, &flat, 0.01).abs() < 2.5, "{}", slope(&path, &flat, 0.01));
        // From 1 to 1/e of it in a dwell of 20.
        let pulses: Vec<f64> = (0..1000)
            .map(|i| scatter(i) + if path[i] { (-((i % 50 - 30) as f64) / 20.0).exp() } else { 0.0 })
            .collect();
        assert!(slope(&path, &pulses, 0.01) < -20.0, "{}", slope(&path, &pulses, 0.01));
    }

    #[test]
    fn dwells_of_different_heights_are_no_level() {
        let path = path();
        let raised = |height: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let scatter = |i: usize| if i.is_multiple_of(2) { 0.1 } else { -0.1 };
            (0..1000).map(|i| scatter(i) + if path[i] { height(i / 50) } else { 0.0 }).collect()
        };
        let same = spread(&path, &raised(&|_| 1.0), 0.01);
        assert!(same.ratio < 1.5 && same.ln_p > -3.0, "{same:?}");
        // Of 1 and 0.9 by turns: 20 samples of variance 0.01 tell 0.05 by √5 deviations.
        let other = spread(&path, &raised(&|k| if k.is_multiple_of(2) { 1.0 } else { 0.9 }), 0.01);
        assert!((other.ratio - 5.0 * 20.0 / 19.0).abs() < 0.6 && other.ln_p < -20.0, "{other:?}");
        assert_eq!(spread(&path[..120], &[0.0; 120], 1.0).ln_p, 0.0);
    }

    #[test]
    fn rare_short_visits_are_told_from_levels_that_are_left_at_one_rate() {
        let even = visits(&path()).unwrap();
        assert!((even.count, even.length) == (20, 20.0) && even.p_value > 0.1, "{even:?}");
        // Ten visits of 10 samples in 1000: nine times as long at the other level.
        let rare: Vec<bool> = (0..1000).map(|i| i % 100 >= 90).collect();
        let found = visits(&rare).unwrap();
        assert!((found.count, found.length) == (10, 10.0) && found.p_value < 1e-4, "{found:?}");
        let opposite: Vec<bool> = rare.iter().map(|p| !p).collect();
        assert_eq!(visits(&opposite), Some(found));
        assert!(visits(&[true; 10]).is_none() && visits(&[]).is_none());
    }

    #[test]
    fn the_slope_is_a_standard_normal_number() {
        // One dwell of three samples, (x₃ − x₁)/3 over √(2/9): 3 of variance 4 is 3/√8.
        let path = [false, true, true, true, false];
        let z = slope(&path, &[0.0, -1.0, 0.0, 2.0, 0.0], 4.0);
        assert!((z - 3.0 / 8f64.sqrt()).abs() < 1e-12, "{z}");
        assert_eq!(slope(&[true, true, true], &[1.0, 2.0, 3.0], 1.0), 0.0);
        assert_eq!(slope(&[], &[], 1.0), 0.0);
    }
}
