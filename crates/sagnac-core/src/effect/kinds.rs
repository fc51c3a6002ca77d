//! The registry: one line an effect.

use super::{Domain, Effect, Place, SpectralContext};
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;

/// What every effect says of itself.
macro_rules! describe {
    (
        $name:ident, $kind:literal, $model:ident in $domain:ident,
        needs [$($need:ident),*], confusers [$($confuser:literal),*] $(, lists [$($list:expr),*])?
    ) => {
        impl $crate::effect::Effect for $name {
            fn kind(&self) -> &'static str {
                $kind
            }
            fn params(&self) -> &'static [$crate::effect::Param] {
                &PARAMS
            }
            $(
                fn list_params(&self) -> &'static [$crate::effect::Param] {
                    const LISTS: &[$crate::effect::Param] = &[$($list),*];
                    LISTS
                }
            )?
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

/// A spectrum that is a stated coefficient set free.
macro_rules! frees {
    ($name:ident, $term:ident, $field:ident, course $course:literal) => {
        impl $crate::effect::Spectrum for $name {
            fn act(&self) -> $crate::effect::SpectrumAct {
                $crate::effect::SpectrumAct::Frees($crate::noise::data::NoiseType::$term)
            }
            fn density(&self, _fitted: &[f64], _bin: &$crate::effect::ModeBin) -> f64 {
                0.0
            }
            fn starts(&self, _look: &$crate::effect::SpectralContext<'_>) -> Vec<Vec<f64>> {
                vec![vec![]]
            }
            fn bounds(
                &self,
                _look: &$crate::effect::SpectralContext<'_>,
            ) -> Vec<$crate::numeric::range::Bounds> {
                vec![]
            }
            fn trials(&self, _look: &$crate::effect::SpectralContext<'_>) -> f64 {
                1.0
            }
            fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
                fitted.to_vec()
            }
            fn stated(&self, values: &$crate::effect::Values) -> Option<Vec<f64>> {
                $crate::effect::number(values, PARAMS[0].name).map(|c| vec![c])
            }
            fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut $crate::noise::composite::Composite) {
                if let [coefficient] = fitted {
                    noise.terms.$field = *coefficient;
                }
            }
            fn places(
                &self,
                fitted: &[f64],
                context: &$crate::effect::SpectralContext<'_>,
            ) -> Vec<$crate::effect::Place> {
                super::power_law_places($crate::noise::data::NoiseType::$term, fitted, context)
            }
            fn has_course(&self) -> bool {
                $course
            }
        }
    };
}

/// A course that is one column times its only parameter: `column(drivers)`, where `applies(drivers)`.
macro_rules! linear {
    ($name:ident, replaces $nuisance:expr, places $places:ident) => {
        impl $crate::effect::MeanModel for $name {
            fn resolution(&self) -> $crate::effect::Resolution {
                $crate::effect::Resolution::FullRate
            }
            fn replaces(&self) -> Option<$crate::effect::Nuisance> {
                $nuisance
            }
            fn applies(&self, drivers: &Drivers) -> bool {
                applies(drivers)
            }
            fn starts(
                &self,
                _drivers: &Drivers,
                _look: &$crate::effect::SearchContext<'_>,
            ) -> $crate::effect::Starts {
                $crate::effect::Starts::linear()
            }
            fn bounds(&self, _drivers: &Drivers) -> Vec<$crate::numeric::range::Bounds> {
                vec![]
            }
            fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> $crate::effect::Regressors {
                $crate::effect::Regressors {
                    columns: column(drivers).into_iter().collect(),
                    ..Default::default()
                }
            }
            fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
                vec![coefficients.first().copied().unwrap_or(f64::NAN)]
            }
            fn course(&self, values: &$crate::effect::Values, drivers: &Drivers) -> Option<Vec<f64>> {
                let coefficient = $crate::effect::number(values, PARAMS[0].name)?;
                Some(column(drivers)?.into_iter().map(|x| coefficient * x).collect())
            }
            fn places(
                &self,
                _shape: &[f64],
                _coefficients: &[f64],
                drivers: &Drivers,
            ) -> Vec<$crate::effect::Place> {
                $places(drivers)
            }
        }
    };
}

macro_rules! catalogue {
    (
        $($module:ident :: $name:ident),* $(,)?;
        without a kind in the format of explanations: $($own_module:ident :: $own:ident),* $(,)?
    ) => {
        $(mod $module;)*
        $(mod $own_module;)*
        /// Every effect, in the order of reports and lists.
        pub static EFFECTS: &[&dyn Effect] = &[$(&$module::$name,)* $(&$own_module::$own),*];
        static OWN: &[&dyn Effect] = &[$(&$own_module::$own),*];
    };
}

mod delay;
mod knots;
mod noise_level;
mod polynomial;
mod reach;
mod search;
mod sinusoid;
mod thermal;

catalogue! {
    temp_linear::TempLinear,
    temp_polynomial::TempPolynomial,
    temp_rate::TempRate,
    thermal_lag::ThermalLag,
    temp_hysteresis::TempHysteresis,
    warmup_exponential::WarmupExponential,
    rate_ramp::RateRamp,
    diurnal::Diurnal,
    line::Line,
    bias_step::BiasStep,
    heading_change::HeadingChange,
    earth_rate_projection::EarthRateProjection,
    table_harmonic::TableHarmonic,
    reset_ripple::ResetRipple,
    sf_error::SfError,
    sf_asymmetry::SfAsymmetry,
    sf_nonlinearity::SfNonlinearity,
    sf_temperature::SfTemperature,
    dead_zone::DeadZone,
    saturation::Saturation,
    cross_axis::CrossAxis,
    supply_sensitivity::SupplySensitivity,
    time_offset::TimeOffset,
    clock_drift::ClockDrift,
    unobserved_driver::UnobservedDriver,
    excess_arw::ExcessArw,
    excess_flicker::ExcessFlicker,
    excess_rrw::ExcessRrw,
    markov_short::MarkovShort,
    markov_long::MarkovLong,
    quasi_periodic::QuasiPeriodic,
    quantization::Quantization,
    bandwidth_filter::BandwidthFilter,
    noise_variance_time::NoiseVarianceTime,
    noise_variance_rate::NoiseVarianceRate,
    outlier_bursts::OutlierBursts,
    random_telegraph::RandomTelegraph,
    dropped_samples::DroppedSamples;
    without a kind in the format of explanations:
    column_product::ColumnProduct,
    column_curve::ColumnCurve,
    drifting_line::DriftingLine,
    power_law_noise::PowerLawNoise,
    repeated_samples::RepeatedSamples,
}

/// True for an effect of this catalogue that the format of explanations has no kind for.
pub(super) fn is_own(kind: &str) -> bool {
    OWN.iter().any(|e| e.kind() == kind)
}

/// The effect of a kind.
pub fn find(kind: &str) -> Option<&'static dyn Effect> {
    EFFECTS.iter().copied().find(|e| e.kind() == kind)
}

/// Where a power-law term lives: the frequencies at which it is the largest part of the observed spectrum, or, where it
/// nowhere is, those at which it comes nearest to that.
fn power_law_places(term: NoiseType, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
    let Some(coefficient) = fitted.first() else { return vec![] };
    let share = |i: usize| {
        let bin = &context.bins[i];
        coefficient * coefficient * unit_density(term, bin.frequency_hz, bin.dt_s)
            / context.observed[i].max(context.expected[i])
    };
    let shares: Vec<f64> = (0..context.bins.len()).map(share).collect();
    let largest = shares.iter().copied().fold(0.0, f64::max);
    let enough = (0.5f64).min(0.5 * largest);
    let among =
        || context.bins.iter().zip(&shares).filter(|(_, s)| **s >= enough).map(|(b, _)| b.frequency_hz);
    let (from, to) = (among().fold(f64::INFINITY, f64::min), among().fold(0.0, f64::max));
    if from <= to { vec![Place { domain: Domain::Frequency, from, to }] } else { vec![] }
}

#[cfg(test)]
mod spectral_tests;
#[cfg(test)]
mod tests;
