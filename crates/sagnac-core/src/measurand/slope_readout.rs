//! Read-outs of a log-log plot: N, K, Q and R from a line of their slope through σ(τ).

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread, normal_probability};
use crate::message::{Arg, Note};
use crate::noise::data::NoiseType;
use crate::noise::slope::{LARGEST_SHARE, SLOPE_TOLERANCE, SlopePoint, read, reading_time_s, slope};

pub(super) struct SlopeReadOut;

const METHOD: &str = "slope_readout";

/// Part of a reading that a term must make up for the reading to be taken as its own.
const ALONE: f64 = 0.98;

impl Measurand for SlopeReadOut {
    fn ids(&self) -> &'static [&'static str] {
        &[
            "angle_random_walk_readout",
            "rate_random_walk_readout",
            "quantization_readout",
            "rate_ramp_readout",
        ]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let (id, term, unit) = match id {
            "angle_random_walk_readout" => {
                ("angle_random_walk_readout", NoiseType::AngleRandomWalk, "deg/sqrt(h)")
            }
            "rate_random_walk_readout" => {
                ("rate_random_walk_readout", NoiseType::RateRandomWalk, "deg/h/sqrt(h)")
            }
            "quantization_readout" => ("quantization_readout", NoiseType::Quantization, "arcsec"),
            "rate_ramp_readout" => ("rate_ramp_readout", NoiseType::RateRamp, "deg/h/h"),
            _ => return None,
        };
        let samples = gyro.digest.samples as f64;
        let points: Vec<SlopePoint> = gyro
            .octaves
            .iter()
            .filter(|p| p.point.m as f64 <= LARGEST_SHARE * samples && p.point.deviation > 0.0 && p.edf > 0.0)
            .map(|p| SlopePoint {
                tau_s: p.point.m as f64 * gyro.tau0_s,
                deviation: p.point.deviation,
                edf: p.edf,
            })
            .collect();
        let Some(found) = read(&points, term) else {
            let none = Estimate::not_identifiable(id, &gyro.channel, None, unit, METHOD);
            return Some(
                none.note(
                    Note::new("readout.no_slope")
                        .with("slope", Arg::Stated(slope(term)))
                        .with("tolerance", Arg::Stated(SLOPE_TOLERANCE)),
                ),
            );
        };
        let on_line: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
        let own = own_part(gyro, term, on_line.iter().filter(|t| (found.from_s..=found.to_s).contains(*t)));
        let spread = reaching_down(Spread::ChiSquare { dof: found.dof }, found.value, own);
        let estimate = Estimate::measured(id, &gyro.channel, found.value, unit, spread, METHOD).note(
            Note::new("readout.line")
                .with("slope", Arg::Stated(slope(term)))
                .with("tolerance", Arg::Stated(SLOPE_TOLERANCE))
                .with("n", found.points)
                .with("from_s", found.from_s)
                .with("to_s", found.to_s)
                .with("at_s", reading_time_s(term)),
        );
        Some(if own < ALONE {
            estimate.note(Note::new("readout.others").with("percent", Arg::figures(100.0 * (1.0 - own), 2)))
        } else {
            estimate
        })
    }
}

/// Part of a reading that the term itself makes up by the fitted description, 0 to 1: a line read off the curve holds a
/// part of every other term. 1 where nothing was fitted.
fn own_part<'a>(gyro: &GyroEvidence, term: NoiseType, tau_s: impl Iterator<Item = &'a f64>) -> f64 {
    let (model, tau0_s) = (&gyro.identification.described.model, gyro.tau0_s);
    let plateau = gyro.identification.plateau.as_ref().filter(|_| term == NoiseType::AngleRandomWalk);
    let alone = plateau.map_or_else(|| model.alone(term), |plateau| plateau.parts(model));
    let ratios: Vec<f64> = tau_s
        .map(|t| alone.allan_variance(*t, tau0_s) / model.allan_variance(*t, tau0_s))
        .filter(|r| r.is_finite())
        .map(|r| r.clamp(0.0, 1.0).sqrt())
        .collect();
    if ratios.is_empty() { 1.0 } else { ratios.iter().sum::<f64>() / ratios.len() as f64 }
}

/// A spread whose lower side reaches down to the term's own part of the reading.
fn reaching_down(spread: Spread, value: f64, own: f64) -> Spread {
    if own >= ALONE {
        return spread;
    }
    let scores = (-40..=40).map(|i| 0.1 * f64::from(i));
    let bounds = scores.filter_map(|z| {
        let bound = spread.bound(value, normal_probability(z))?;
        Some((z, if z < 0.0 { own * bound } else { bound }))
    });
    Spread::Curve(bounds.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_holds_other_terms_reaches_down_to_its_own_part() {
        let plain = Spread::ChiSquare { dof: 200.0 };
        assert_eq!(reaching_down(plain.clone(), 2.0, 1.0), plain);
        let (before, after) = (plain.interval(2.0, 0.95).unwrap(), {
            let wide = reaching_down(plain.clone(), 2.0, 0.8);
            wide.interval(2.0, 0.95).unwrap()
        });
        assert!((after.low - 0.8 * before.low).abs() < 1e-3 && (after.high - before.high).abs() < 1e-3);
    }
}
