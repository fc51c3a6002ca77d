//! Estimated parameters and their intervals.

use crate::effect::{Param, Values};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::mismatch::finding::ParameterValue;
use std::collections::BTreeMap;

/// Drop of the log-likelihood at the ends of a 95 % profile interval.
pub(super) const DROP_95: f64 = 1.920_729;

/// Factor either way within which a parameter must be known for it to be stated.
const MAX_UNCERTAINTY_FACTOR: f64 = 100.0;

/// An effect's parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimated {
    /// As reports give them.
    pub reported: BTreeMap<String, ParameterValue>,
    /// Its texts, such as the name of the column that it follows.
    pub texts: BTreeMap<String, String>,
    /// The law that was found, as a formula in the units of the columns.
    pub formula: Option<String>,
    /// As the augmented claim states them.
    pub stated: Values,
}

/// The 95 % interval of a parameter; `None` for one that the recording does not tell to within [`MAX_UNCERTAINTY_FACTOR`].
pub(super) fn interval(param: &Param, value: f64, deviation: f64) -> Option<[f64; 2]> {
    if value > 0.0 && param.lower >= 0.0 {
        let factor = (SCORE_TWO_SIDED_95 * deviation / value).exp();
        return (factor < MAX_UNCERTAINTY_FACTOR).then_some([value / factor, value * factor]);
    }
    Some([value - SCORE_TWO_SIDED_95 * deviation, value + SCORE_TWO_SIDED_95 * deviation])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_even_in_the_logarithm_of_a_size_and_in_a_number_with_a_sign() {
        let size = Param::reported("size", "deg/h", 0.0, 1e6);
        let number = Param::reported("number", "deg/h", -1e6, 1e6);
        // exp(1.959964 · 0.5).
        let [low, high] = interval(&size, 2.0, 1.0).unwrap();
        assert!(
            (low - 2.0 / 2.664_408).abs() < 1e-5 && (high - 2.0 * 2.664_408).abs() < 1e-5,
            "{low} {high}"
        );
        let [low, high] = interval(&number, 2.0, 1.0).unwrap();
        assert!((low - 0.040_036).abs() < 1e-6 && (high - 3.959_964).abs() < 1e-6, "{low} {high}");
        // Told to within a factor of 100 either way, or not at all: ln 100 = 1.959964 · 2.3496.
        assert!(interval(&size, 1.0, 2.349).is_some() && interval(&size, 1.0, 2.350).is_none());
        assert!(interval(&number, 1.0, 2.350).is_some());
    }
}
