//! Parameters of the chosen effects with their 95 % intervals, and what each adds to the rate.

mod course;
mod estimated;
mod instant;
mod placed;
mod spectrum;

use super::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use super::select::Slot;
use crate::effect::{Effect, Model};
use course::of_course;
pub use estimated::Estimated;
use spectrum::of_spectrum;

/// The parameters of one effect of a fitted hypothesis.
pub fn of(
    effect: &'static dyn Effect,
    slot: Slot,
    best: &FittedHypothesis,
    spectra: &SpectralDataSet,
) -> Estimated {
    match (slot, effect.model()) {
        (Slot::Mean(i), Model::Mean(course)) => of_course(effect, course, i, best, spectra),
        (Slot::Spectrum(i), Model::Spectrum(_)) => of_spectrum(effect, i, best, spectra),
        _ => Estimated::default(),
    }
}
