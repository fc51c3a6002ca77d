//! Mean rate at rest with the Earth rate removed (IEEE Std 952, 12.11).
//!
//! The uncertainty is that of a mean of correlated noise, not σ/√n: the noise terms that the record allows, claimed or
//! not, and the Earth rate.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};
use crate::noise::static_bias::BiasUncertainty;
use crate::text::Note;

pub(super) struct StaticBias;

/// Uncertainty of the mean of a channel.
pub fn uncertainty(gyro: &GyroEvidence, earth_removed: bool) -> BiasUncertainty {
    let earth: Vec<(&'static str, f64)> = gyro
        .earth
        .filter(|_| earth_removed)
        .map(|e| ("earth_rate", e.uncertainty_deg_h))
        .into_iter()
        .collect();
    BiasUncertainty::of_mean(&gyro.identification.full, gyro.usable_s(), None, &earth)
}

impl Measurand for StaticBias {
    fn ids(&self) -> &'static [&'static str] {
        &["static_bias"]
    }

    fn evaluate(&self, _: &str, gyro: &GyroEvidence, options: &Options) -> Option<Estimate> {
        let removed = gyro.earth.filter(|_| options.remove_earth_rate);
        let value = gyro.digest.mean - removed.map_or(0.0, |e| e.rate_deg_h);
        let u = uncertainty(gyro, removed.is_some());
        let standard_uncertainty = u.standard();
        let mut estimate = Estimate::measured(
            "static_bias",
            &gyro.channel,
            value,
            "deg/h",
            Spread::Normal { standard_uncertainty },
            "mean",
        );
        estimate = match removed {
            Some(e) => estimate.note(Note::new("note.earth_rate_removed").with("rate", e.rate_deg_h)),
            None => estimate.note(Note::new("note.earth_rate_kept")),
        };
        Some(
            estimate.note(
                Note::new("note.bias_uncertainty")
                    .with("u", standard_uncertainty)
                    .with("longest_h", 1.0 / (3600.0 * u.lowest_hz)),
            ),
        )
    }
}
