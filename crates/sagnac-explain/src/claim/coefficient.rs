//! What an analysis knows of a coefficient, as a claim states it: a value with a deviation, or the deviation of nothing.

use crate::estimate::SCORE_TWO_SIDED_95;

/// Upper limit of a coefficient that is not resolved, in deviations of its prior. A value beyond the prior is no mismatch
/// yet: the recording itself is asked. A wide prior would let a random walk stand for a single jump.
const LIMIT_OF_PRIOR: f64 = 6.0;
/// Logarithm of the ratio of a value to the end of its interval that counts at most.
const LARGEST: f64 = 3.0;

/// A coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coefficient {
    /// Value; 0 where the record does not show it.
    pub value: f64,
    /// Relative standard deviation.
    pub relative: f64,
    /// Upper limit of a value of 0, in its own unit.
    pub at_most: f64,
}

/// Deviation of the prior of a coefficient that is stated as 0: what its author gives it, or what follows from an upper limit.
pub fn prior_of_zero(deviation: f64, at_most: f64) -> f64 {
    if deviation > 0.0 { deviation } else { at_most / LIMIT_OF_PRIOR }
}

impl Coefficient {
    /// A value, with its 95 % interval, low and high, if there is one.
    pub fn found(value: f64, interval: Option<(f64, f64)>) -> Coefficient {
        // The prior of the engine is that of the logarithm: the longer side of an interval of unequal sides counts.
        let relative = interval.map_or(0.0, |(low, high)| {
            let below = if low > 0.0 { (value / low).ln().min(LARGEST) } else { LARGEST };
            let above = (high / value).max(1.0).ln();
            below.max(above) / SCORE_TWO_SIDED_95
        });
        Coefficient { value, relative: if relative.is_finite() { relative } else { LARGEST }, at_most: 0.0 }
    }

    /// An upper limit.
    pub fn at_most(limit: f64) -> Coefficient {
        Coefficient { at_most: if limit.is_finite() { limit } else { 0.0 }, ..Coefficient::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longer_side_of_an_interval_counts() {
        let near = Coefficient::found(1.0, Some((0.9, 1.05)));
        assert!((near.relative - (1.0f64 / 0.9).ln() / SCORE_TWO_SIDED_95).abs() < 1e-12, "{near:?}");
        // An interval that reaches nothing is as wide as any that counts.
        let open = Coefficient::found(1.0, Some((0.0, 1.1)));
        assert!((open.relative - 3.0 / SCORE_TWO_SIDED_95).abs() < 1e-12, "{open:?}");
        assert_eq!(Coefficient::found(1.0, None).relative, 0.0);
        assert_eq!(Coefficient::at_most(6.0), Coefficient { at_most: 6.0, ..Coefficient::default() });
        assert_eq!(Coefficient::at_most(f64::INFINITY).at_most, 0.0);
        assert_eq!(
            (prior_of_zero(0.0, 6.0), prior_of_zero(0.5, 6.0), prior_of_zero(0.0, 0.0)),
            (1.0, 0.5, 0.0)
        );
    }
}
