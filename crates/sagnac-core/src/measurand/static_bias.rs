//! Mean rate at rest with the Earth rate removed (IEEE Std 952, 12.11).
//!
//! The uncertainty is that of a mean of correlated noise, not σ/√n: the noise terms that the record allows, claimed or
//! not, and the Earth rate.

use super::descriptor::{EARTH_RATE_OPTION, Measurand, Options, PowerModel};
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::Note;
use crate::noise::data::NoiseType;
use crate::noise::model::TERMS;
use crate::noise::static_bias::BiasUncertainty;

/// Mean rate at rest.
pub static STATIC_BIAS: Measurand =
    Measurand::at_rest("static_bias", "deg/h", "mean rate at rest, Earth rate removed", evaluate)
        .options(&[EARTH_RATE_OPTION])
        .also_called(&["bias", "offset", "zero_offset", "mean", "mean_rate"])
        .power(PowerModel::Mean)
        .signed();

/// Uncertainty of the mean of a channel.
pub fn uncertainty(gyro: &GyroEvidence, earth_removed: bool) -> BiasUncertainty {
    let earth: Vec<(&'static str, f64)> = gyro
        .earth
        .filter(|_| earth_removed)
        .map(|e| ("earth_rate", e.uncertainty_deg_h))
        .into_iter()
        .collect();
    BiasUncertainty::of_mean(&gyro.identification.allowed, gyro.usable_s(), None, &earth)
}

/// Least degrees of freedom of the uncertainty. Slow noise rules it, and a record shows little of that: below what it
/// can show, a random walk may still move the mean (set by simulation).
const LEAST_DOF: f64 = 5.0;

/// Degrees of freedom of the uncertainty (GUM G.4, with the variance of the squared uncertainty in place of the sum):
/// what is known of the random walk where it is claimed, else [`LEAST_DOF`].
fn degrees_of_freedom(gyro: &GyroEvidence, u: &BiasUncertainty) -> f64 {
    let found = &gyro.identification;
    if !found.claims(NoiseType::RateRandomWalk) {
        return LEAST_DOF;
    }
    let mut variance = 0.0;
    for (i, term) in TERMS.iter().enumerate() {
        let part = match term {
            NoiseType::AngleRandomWalk => u.angle_random_walk,
            NoiseType::Flicker => u.flicker,
            NoiseType::RateRandomWalk => u.rate_random_walk,
            NoiseType::Quantization => u.quantization,
            NoiseType::RateRamp => 0.0,
        };
        let coefficient = found.supported.coefficient(*term);
        let spread = found.covariance.get(i).and_then(|row| row.get(i)).copied().unwrap_or(0.0);
        if coefficient > 0.0 {
            variance += (2.0 * part / coefficient).powi(2) * spread;
        }
    }
    if variance > 0.0 { (2.0 * u.variance().powi(2) / variance).max(LEAST_DOF) } else { LEAST_DOF }
}

fn evaluate(m: &Measurand, gyro: &GyroEvidence, options: &Options) -> Vec<Estimate> {
    let removed = gyro.earth.filter(|_| options.remove_earth_rate);
    let value = gyro.digest.mean - removed.map_or(0.0, |e| e.rate_deg_h);
    let u = uncertainty(gyro, removed.is_some());
    let standard_uncertainty = u.standard();
    let spread = Spread::StudentT { standard_uncertainty, dof: degrees_of_freedom(gyro, &u) };
    let earth = match removed {
        Some(e) => Note::new("note.earth_rate_removed").with("rate", e.rate_deg_h),
        None => Note::new("note.earth_rate_kept"),
    };
    let longest = Note::new("note.bias_uncertainty")
        .with("u", standard_uncertainty)
        .with("longest_h", 1.0 / (3600.0 * u.lowest_hz));
    vec![m.measured(&gyro.channel, value, spread, "mean").note(earth).note(longest)]
}
