//! Mean rate at rest with the Earth rate removed (IEEE Std 952, 12.11).
//!
//! The uncertainty is that of a mean of correlated noise, not σ/√n: the noise terms that the record allows, claimed or
//! not, and the Earth rate.

use super::descriptor::{EARTH_RATE_OPTION, Measurand, Options, PowerModel};
use super::evidence::GyroEvidence;
use crate::estimate::{Component, Estimate, InputQuantity, Spread, normal_probability};
use crate::message::note;
use crate::noise::coarse::RateRounding;
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
    let (spread, rounded) = match gyro.rounding {
        RateRounding::Harmless => (spread, None),
        RateRounding::Forgotten { step_deg_h: step } => {
            let note = note!("note.bias_rounded", step);
            (beside_rounding(&spread, value, 0.5 * step), Some(note))
        }
        RateRounding::Constant => (Spread::Unknown, None),
    };
    let earth = match removed {
        Some(e) => note!("note.earth_rate_removed", rate = e.rate_deg_h),
        None => note!("note.earth_rate_kept"),
    };
    let longest =
        note!("note.bias_uncertainty", u = standard_uncertainty, longest_h = 1.0 / (3600.0 * u.lowest_hz));
    let of_site = removed.map(|e| Component::of(InputQuantity::EarthRate, e.uncertainty_deg_h, "deg/h", 1.0));
    let of_rounding = match gyro.rounding {
        RateRounding::Forgotten { step_deg_h } => {
            Some(Component::of(InputQuantity::Rounding, 0.5 * step_deg_h / 3f64.sqrt(), "deg/h", 1.0))
        }
        RateRounding::Harmless | RateRounding::Constant => None,
    };
    let components: Vec<Component> = of_site.into_iter().chain(of_rounding).collect();
    let estimate =
        m.measured(&gyro.channel, value, spread, "mean").components(&components).note(earth).note(longest);
    vec![rounded.into_iter().fold(estimate, Estimate::note)]
}

/// A spread beside an error of rounding that lies anywhere within half a step.
fn beside_rounding(spread: &Spread, value: f64, half_step: f64) -> Spread {
    let scores = (-40..=40).map(|i| 0.1 * f64::from(i));
    let bounds = scores.filter_map(|z| {
        let confidence = normal_probability(z);
        Some((z, spread.bound(value, confidence)? + half_step * (2.0 * confidence - 1.0)))
    });
    Spread::Curve(bounds.collect())
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Earth;
    use super::super::test_evidence::{gyro, near, notes, number, shows, student, within};
    use super::*;
    use crate::noise::model::NoiseModel;
    use crate::noise::static_bias::flicker_bracket;

    /// An hour of 12.5 deg/h.
    fn hour(noise: NoiseModel) -> GyroEvidence {
        let mut gyro = gyro();
        (gyro.digest.samples, gyro.digest.mean) = (7200, 12.5);
        gyro.identification.allowed = noise.into();
        gyro.identification.supported = noise;
        gyro.earth = Some(Earth { rate_deg_h: 12.0, uncertainty_deg_h: 0.004 });
        gyro
    }

    fn row(gyro: &GyroEvidence, remove_earth_rate: bool) -> Estimate {
        STATIC_BIAS.evaluate_gyro(gyro, &Options { remove_earth_rate }).remove(0)
    }

    #[test]
    fn the_mean_is_stated_with_or_without_the_earth_rate() {
        // N²/T + K²T/3 over one hour: 9e-6 + 4e-6/3.
        let gyro = hour(NoiseModel { n: 0.003, k: 0.002, ..Default::default() });
        let kept = row(&gyro, false);
        shows(&kept, 12.5, "mean");
        let own = 9e-6 + 4e-6 / 3.0;
        within(student(&kept).0, f64::sqrt(own), 1e-12);
        assert_eq!(
            (student(&kept).1, notes(&kept)),
            (5.0, vec!["note.earth_rate_kept", "note.bias_uncertainty"])
        );
        let removed = row(&gyro, true);
        shows(&removed, 0.5, "mean");
        within(student(&removed).0, f64::sqrt(own + 1.6e-5), 1e-12);
        near(number(&removed, "note.earth_rate_removed", "rate"), 12.0);
        near(number(&removed, "note.bias_uncertainty", "u"), f64::sqrt(own + 1.6e-5));
        // Flicker is counted from 1/(2πT): periods up to 2π hours.
        near(number(&removed, "note.bias_uncertainty", "longest_h"), 2.0 * std::f64::consts::PI);
        near(uncertainty(&gyro, false).standard(), f64::sqrt(own));
        let unknown = GyroEvidence { earth: None, ..gyro };
        shows(&row(&unknown, true), 12.5, "mean");
    }

    #[test]
    fn degrees_of_freedom_follow_from_what_is_known_of_every_term() {
        let noise = NoiseModel { n: 0.003, b: 0.001, k: 0.002, q: 5.0, r: 0.0 };
        let mut gyro = hour(noise);
        let known = [1e-4f64, 2e-4, 4e-4, 1.5, 0.0];
        for (i, u) in known.iter().enumerate() {
            gyro.identification.covariance[i][i] = u * u;
        }
        assert_eq!(student(&row(&gyro, false)).1, LEAST_DOF);
        gyro.identification.claimed = vec![NoiseType::RateRandomWalk];
        // Parts N²/T, B²/π·bracket(1), K²T/3 and 2Q²/T² (T in s) of the squared uncertainty; each goes with the square of
        // its coefficient, so that its deviation is 2·part·u(c)/c.
        let bracket = flicker_bracket(1.0);
        let parts = [9e-6, 1e-6 / std::f64::consts::PI * bracket, 4e-6 / 3.0, 50.0 / 3600f64.powi(2)];
        let relative = [1.0 / 30.0, 0.2, 0.2, 0.3];
        let variance: f64 = parts.iter().zip(relative).map(|(p, u): (&f64, f64)| (2.0 * p * u).powi(2)).sum();
        let total: f64 = parts.iter().sum();
        within(student(&row(&gyro, false)).1, 2.0 * total * total / variance, 1e-9);
        // Poorly known, it has the least; so it has where nothing is known.
        gyro.identification.covariance[2][2] = 1.0;
        assert_eq!(student(&row(&gyro, false)).1, LEAST_DOF);
        gyro.identification.covariance = [[0.0; 5]; 5];
        assert_eq!(student(&row(&gyro, false)).1, LEAST_DOF);
    }
}
