//! The registry: one line an effect.

use super::{Domain, Effect, Place, SpectralLook};
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;

/// What every effect says of itself.
macro_rules! describe {
    (
        $name:ident, $kind:literal, $model:ident in $domain:ident,
        needs [$($need:ident),*], confusers [$($confuser:literal),*]
    ) => {
        impl $crate::effect::Effect for $name {
            fn kind(&self) -> &'static str {
                $kind
            }
            fn doc(&self) -> &'static $crate::effect::Doc {
                &DOC
            }
            fn params(&self) -> &'static [$crate::effect::Param] {
                &PARAMS
            }
            fn needs(&self) -> &'static [$crate::effect::Column] {
                &[$($crate::effect::Column::$need),*]
            }
            fn domain(&self) -> $crate::effect::Domain {
                $crate::effect::Domain::$domain
            }
            fn confusers(&self) -> &'static [&'static str] {
                &[$($confuser),*]
            }
            fn model(&self) -> $crate::effect::Model {
                $crate::effect::Model::$model(&$name)
            }
        }
    };
}

macro_rules! catalogue {
    ($($module:ident :: $name:ident),* $(,)?) => {
        $(mod $module;)*
        /// Every effect, in the order of reports and lists.
        pub static EFFECTS: &[&dyn Effect] = &[$(&$module::$name),*];
    };
}

mod delay;
mod reach;
mod search;
mod sinusoid;
mod thermal;

catalogue! {
    temp_linear::TempLinear,
    temp_polynomial::TempPolynomial,
    temp_rate::TempRate,
    thermal_lag::ThermalLag,
    warmup_exponential::WarmupExponential,
    rate_ramp::RateRamp,
    diurnal::Diurnal,
    line::Line,
    bias_step::BiasStep,
    supply_sensitivity::SupplySensitivity,
    time_offset::TimeOffset,
    clock_drift::ClockDrift,
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
