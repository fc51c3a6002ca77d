//! Read-outs of a log-log plot: N, K, Q and R from a line of their slope through σ(τ).

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread, normal_probability};
use crate::message::{Arg, Note};
use crate::noise::data::NoiseType;
use crate::noise::slope::{LARGEST_SHARE, SLOPE_TOLERANCE, SlopePoint, read, reading_time_s, slope};

/// N from a line of slope -1/2.
pub static ANGLE_RANDOM_WALK_READOUT: Measurand = Measurand::at_rest(
    "angle_random_walk_readout",
    "deg/sqrt(h)",
    "N at 1 h on a line of slope -1/2 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::AngleRandomWalk)],
)
.needs_stillness();

/// K from a line of slope +1/2.
pub static RATE_RANDOM_WALK_READOUT: Measurand = Measurand::at_rest(
    "rate_random_walk_readout",
    "deg/h/sqrt(h)",
    "K at 3 h on a line of slope +1/2 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::RateRandomWalk)],
)
.needs_stillness();

/// R from a line of slope +1.
pub static RATE_RAMP_READOUT: Measurand = Measurand::at_rest(
    "rate_ramp_readout",
    "deg/h/h",
    "R at sqrt(2) h on a line of slope +1 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::RateRamp)],
)
.needs_stillness();

/// Q from a line of slope -1.
pub static QUANTIZATION_READOUT: Measurand = Measurand::at_rest(
    "quantization_readout",
    "arcsec",
    "Q at sqrt(3) s on a line of slope -1 through the Allan deviation",
    |m, gyro, _| vec![read_out(m, gyro, NoiseType::Quantization)],
)
.needs_stillness();

const METHOD: &str = "slope_readout";

/// Part of a reading that a term must make up for the reading to be taken as its own.
const ALONE: f64 = 0.98;

fn read_out(m: &Measurand, gyro: &GyroEvidence, term: NoiseType) -> Estimate {
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
        return m.not_identifiable(&gyro.channel, None, METHOD).note(
            Note::new("readout.no_slope")
                .with("slope", Arg::Stated(slope(term)))
                .with("tolerance", Arg::Stated(SLOPE_TOLERANCE)),
        );
    };
    let on_line: Vec<f64> = points.iter().map(|p| p.tau_s).collect();
    let own = own_part(gyro, term, on_line.iter().filter(|t| (found.from_s..=found.to_s).contains(*t)));
    let spread = reaching_down(Spread::ChiSquare { dof: found.dof }, found.value, own);
    let estimate = m.measured(&gyro.channel, found.value, spread, METHOD).note(
        Note::new("readout.line")
            .with("slope", Arg::Stated(slope(term)))
            .with("tolerance", Arg::Stated(SLOPE_TOLERANCE))
            .with("n", found.points)
            .with("from_s", found.from_s)
            .with("to_s", found.to_s)
            .with("at_s", reading_time_s(term)),
    );
    if own < ALONE {
        return estimate
            .note(Note::new("readout.others").with("percent", Arg::figures(100.0 * (1.0 - own), 2)));
    }
    estimate
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
