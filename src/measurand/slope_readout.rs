//! Read-outs of a log-log plot: N, K, Q and R from a line of their slope through σ(τ).

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};
use crate::noise::data::NoiseType;
use crate::noise::slope::{LARGEST_SHARE, SLOPE_TOLERANCE, SlopePoint, read, reading_time_s, slope};
use crate::text::{Arg, Note};

pub(super) struct SlopeReadOut;

const METHOD: &str = "slope_readout";

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
        let spread = Spread::ChiSquare { dof: found.dof };
        Some(
            Estimate::measured(id, &gyro.channel, found.value, unit, spread, METHOD).note(
                Note::new("readout.line")
                    .with("slope", Arg::Stated(slope(term)))
                    .with("tolerance", Arg::Stated(SLOPE_TOLERANCE))
                    .with("n", found.points)
                    .with("from_s", found.from_s)
                    .with("to_s", found.to_s)
                    .with("at_s", reading_time_s(term)),
            ),
        )
    }
}
