//! Measured quantities: one file each kind. Adding one is one file and one line in [`MEASURANDS`].
//!
//! A measurand is a pure function of what one pass over the recording left behind ([`GyroEvidence`]).

pub mod allan_minimum;
mod correlated_noise;
pub mod earth_rate;
pub mod evidence;
mod noise_terms;
pub mod russian;
pub mod russian_prediction;
mod slope_readout;
mod spectral_line;
pub mod static_bias;
mod temperature;
mod warm_up;

use crate::estimate::Estimate;
pub use crate::ids;
pub use evidence::{Earth, GyroEvidence};
pub use temperature::over_temperature;
pub use warm_up::warm_up;

/// Choices a procedure makes for a measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Whether the Earth rate is taken out of the static bias.
    pub remove_earth_rate: bool,
}

/// One kind of measured quantity.
pub trait Measurand: Sync {
    /// Ids it gives, as in [`ids::MEASURANDS`].
    fn ids(&self) -> &'static [&'static str];

    /// The quantity of one id on one channel; `None` when the channel has nothing to say about it.
    fn evaluate(&self, id: &str, gyro: &GyroEvidence, options: &Options) -> Option<Estimate>;

    /// Every row of one id on one channel: more than one where a quantity is given by zone or by ramp.
    fn evaluate_all(&self, id: &str, gyro: &GyroEvidence, options: &Options) -> Vec<Estimate> {
        self.evaluate(id, gyro, options).into_iter().collect()
    }
}

/// Every measurand of a gyro at rest.
pub static MEASURANDS: &[&dyn Measurand] = &[
    &static_bias::StaticBias,
    &earth_rate::EarthRateComponent,
    &noise_terms::NoiseTerms,
    &allan_minimum::AllanMinimum,
    &russian::Russian,
    &russian_prediction::RussianPrediction,
    &spectral_line::SpectralLine,
    &correlated_noise::CorrelatedNoise,
    &slope_readout::SlopeReadOut,
    &temperature::OverTemperature,
    &warm_up::WarmUp,
];

/// Evaluates a measurand by id.
pub fn evaluate(id: &str, gyro: &GyroEvidence, options: &Options) -> Option<Estimate> {
    MEASURANDS.iter().find(|m| m.ids().contains(&id)).and_then(|m| m.evaluate(id, gyro, options))
}

/// Every row of a measurand by id.
pub fn evaluate_all(id: &str, gyro: &GyroEvidence, options: &Options) -> Vec<Estimate> {
    let giver = MEASURANDS.iter().find(|m| m.ids().contains(&id));
    giver.map_or_else(Vec::new, |m| m.evaluate_all(id, gyro, options))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_available_id_has_exactly_one_measurand() {
        for m in ids::MEASURANDS {
            let givers = MEASURANDS.iter().filter(|g| g.ids().contains(&m.id)).count();
            // What a rate table or an influence shows is determined from stretches, not from a gyro's evidence.
            let here = m.available && !matches!(m.test, ids::Test::RateTable | ids::Test::Influence);
            assert_eq!(givers, usize::from(here), "{}", m.id);
        }
        for giver in MEASURANDS {
            for id in giver.ids() {
                assert!(ids::find(id).is_some(), "{id} is in no table");
            }
        }
    }
}
