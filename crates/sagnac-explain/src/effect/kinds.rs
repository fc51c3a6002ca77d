//! The registry: one line an effect, or one for the variants of an effect that share a file.

use super::{Effect, Param};

macro_rules! catalogue {
    ($($module:ident :: $name:ident $(, $variant:ident)*;)*) => {
        $(
            mod $module;
            use $module::{$name $(, $variant)*};
        )*
        /// Every effect, in the order of reports and lists.
        pub static EFFECTS: &[&dyn Effect] = &[$(&$name $(, &$variant)*),*];
    };
}

catalogue! {
    temp_linear::TempLinear;
    temp_linear_delayed::TempLinearDelayed;
    temp_polynomial::TempPolynomial;
    temp_rate::TempRate;
    temp_rate_delayed::TempRateDelayed;
    thermal_lag::ThermalLag;
    temp_hysteresis::TempHysteresis;
    temp_hysteresis_loops::TempHysteresisLoops;
    temp_response::TempResponse;
    warmup_exponential::WarmupExponential;
    rate_ramp::RateRamp;
    diurnal::Diurnal;
    line::Line;
    comb::Comb;
    bias_step::BiasStep;
    heading_change::HeadingChange;
    earth_rate_projection::EarthRateProjection;
    table_harmonic::TableHarmonic;
    reset_ripple::ResetRipple;
    sf_error::SfError;
    sf_asymmetry::SfAsymmetry;
    sf_nonlinearity::SfNonlinearity;
    sf_temperature::SfTemperature;
    sf_driver::SfDriver;
    sf_unrecorded::SfUnrecorded;
    dead_zone::DeadZone;
    saturation::Saturation;
    cross_axis::CrossAxis;
    supply_sensitivity::SupplySensitivity;
    column_driver::ColumnDriver;
    time_offset::TimeOffset;
    clock_drift::ClockDrift;
    unobserved_driver::UnobservedDriver;
    excess::ExcessArw, ExcessFlicker, ExcessRrw;
    markov::MarkovShort, MarkovLong;
    quasi_periodic::QuasiPeriodic;
    quantization::Quantization;
    bandwidth_filter::BandwidthFilter;
    noise_variance_time::NoiseVarianceTime;
    noise_variance_rate::NoiseVarianceRate;
    noise_variance_driver::NoiseVarianceDriver;
    outlier_bursts::OutlierBursts;
    random_telegraph::RandomTelegraph;
    dropped_samples::DroppedSamples;
    column_law::ColumnLaw;
    column_product::ColumnProduct;
    column_curve::ColumnCurve;
    drifting_line::DriftingLine;
    power_law_noise::PowerLawNoise;
    repeated_samples::RepeatedSamples;
}

/// The effect of a kind; `None` for a kind that the catalogue does not have.
pub fn find(kind: &str) -> Option<&'static dyn Effect> {
    EFFECTS.iter().copied().find(|e| e.kind() == kind)
}

/// The effect by which the bias follows any column without a role of its own.
pub fn any_column_driver() -> Option<&'static dyn Effect> {
    EFFECTS.iter().copied().find(|e| e.follows_any_column())
}

/// The parameter of that name of whichever effect has one. Effects that share a name share unit, sign and kind of number.
pub fn parameter(name: &str) -> Option<&'static Param> {
    EFFECTS.iter().flat_map(|e| e.params()).find(|p| p.name == name)
}

#[cfg(test)]
mod spectral_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truths;
