//! Parameters of the chosen effects with their 95 % intervals, and what each adds to the rate.

mod course;
mod placed;
mod spectrum;

use super::candidates::{SpectralDataSet, Tried};
use super::finding::ParameterValue;
use super::select::Slot;
use crate::effect::{Effect, Model, Param, Values};
use course::of_course;
use spectrum::of_spectrum;
use std::collections::BTreeMap;

/// Half width of a 95 % interval in standard deviations.
const TWO_SIDED_95: f64 = 1.959_964;
/// Drop of the log-likelihood at the ends of a 95 % profile interval.
const DROP_95: f64 = 1.920_729;

/// Factor either way within which a parameter must be told for it to be stated.
const OPEN: f64 = 100.0;

/// Name of the parameter that is an instant.
pub const INSTANT: &str = "time_s";

/// An effect's parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimated {
    /// As reports give them.
    pub reported: BTreeMap<String, ParameterValue>,
    /// As the augmented claim states them.
    pub stated: Values,
}

/// The 95 % interval of a parameter; `None` for one that the recording does not tell to within [`OPEN`].
fn interval(param: &Param, value: f64, deviation: f64) -> Option<[f64; 2]> {
    if value > 0.0 && param.lower >= 0.0 {
        let factor = (TWO_SIDED_95 * deviation / value).exp();
        return (factor < OPEN).then_some([value / factor, value * factor]);
    }
    Some([value - TWO_SIDED_95 * deviation, value + TWO_SIDED_95 * deviation])
}

/// The parameters of one effect of a fitted hypothesis.
pub fn of(effect: &'static dyn Effect, slot: Slot, best: &Tried, spectra: &SpectralDataSet) -> Estimated {
    match (slot, effect.model()) {
        (Slot::Mean(i), Model::Mean(course)) => of_course(effect, course, i, best, spectra),
        (Slot::Spectrum(i), Model::Spectrum(_)) => of_spectrum(effect, i, best, spectra),
        _ => Estimated::default(),
    }
}
