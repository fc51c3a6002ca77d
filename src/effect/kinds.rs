//! The registry: one line an effect.

use super::{Domain, Effect, Place, SpectralLook};
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;

macro_rules! catalogue {
    ($($module:ident :: $name:ident),* $(,)?) => {
        $(mod $module;)*
        /// Every effect, in the order of reports and lists.
        pub static EFFECTS: &[&dyn Effect] = &[$(&$module::$name),*];
    };
}

catalogue! {
    temp_linear::TempLinear,
    bias_step::BiasStep,
    excess_arw::ExcessArw,
    markov_long::MarkovLong,
}

/// The effect of a kind.
pub fn find(kind: &str) -> Option<&'static dyn Effect> {
    EFFECTS.iter().copied().find(|e| e.kind() == kind)
}

/// Where a power-law term lives: the frequencies at which it is the largest part of the observed spectrum, or, where it
/// nowhere is, those at which it comes nearest to that.
fn power_law_places(term: NoiseType, fitted: &[f64], look: &SpectralLook<'_>) -> Vec<Place> {
    let Some(coefficient) = fitted.first() else { return vec![] };
    let share = |i: usize| {
        let bin = &look.bins[i];
        coefficient * coefficient * unit_density(term, bin.frequency_hz, bin.dt_s)
            / look.observed[i].max(look.expected[i])
    };
    let shares: Vec<f64> = (0..look.bins.len()).map(share).collect();
    let largest = shares.iter().copied().fold(0.0, f64::max);
    let enough = (0.5f64).min(0.5 * largest);
    let among = || look.bins.iter().zip(&shares).filter(|(_, s)| **s >= enough).map(|(b, _)| b.frequency_hz);
    let (from, to) = (among().fold(f64::INFINITY, f64::min), among().fold(0.0, f64::max));
    if from <= to { vec![Place { domain: Domain::Frequency, from, to }] } else { vec![] }
}
