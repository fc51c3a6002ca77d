//! N, B, K, R and Q of the joint fit (IEEE Std 952 Annex C).

use super::descriptor::{Measurand, PowerModel};
use crate::noise::data::NoiseType;

/// N as it is read from the curve.
pub static ANGLE_RANDOM_WALK: Measurand = Measurand::at_rest(
    "angle_random_walk",
    "deg/sqrt(h)",
    "N of the joint noise fit: white noise with every process that is white where it is read",
    |m, gyro, _| vec![m.named(gyro.identification.read_angle_random_walk())],
)
.also_called(&["n", "arw", "white_noise"])
.power(PowerModel::NoiseTerm(NoiseType::AngleRandomWalk))
.needs_stillness();

/// The part of N that is white noise.
pub static ANGLE_RANDOM_WALK_WHITE: Measurand = Measurand::at_rest(
    "angle_random_walk_white",
    "deg/sqrt(h)",
    "the part of N that is white noise at every averaging time",
    |m, gyro, _| vec![m.named(&gyro.identification.angle_random_walk)],
)
.needs_stillness();

/// B of the joint fit.
pub static BIAS_INSTABILITY: Measurand = Measurand::at_rest(
    "bias_instability",
    "deg/h",
    "flicker coefficient B of the joint noise fit",
    |m, gyro, _| vec![m.named(&gyro.identification.bias_instability)],
)
.also_called(&["b", "bi", "flicker", "bias_stability"])
.power(PowerModel::NoiseTerm(NoiseType::Flicker))
.needs_stillness()
.drift();

/// K of the joint fit.
pub static RATE_RANDOM_WALK: Measurand =
    Measurand::at_rest("rate_random_walk", "deg/h/sqrt(h)", "K of the joint noise fit", |m, gyro, _| {
        vec![m.named(&gyro.identification.rate_random_walk)]
    })
    .also_called(&["k", "rrw", "random_walk"])
    .power(PowerModel::NoiseTerm(NoiseType::RateRandomWalk))
    .needs_stillness();

/// R of the joint fit.
pub static RATE_RAMP: Measurand =
    Measurand::at_rest("rate_ramp", "deg/h/h", "R of the joint noise fit", |m, gyro, _| {
        vec![m.named(&gyro.identification.rate_ramp)]
    })
    .also_called(&["r", "rr", "ramp", "drift"])
    .power(PowerModel::NoiseTerm(NoiseType::RateRamp))
    .needs_stillness();

/// Q of the joint fit.
pub static QUANTIZATION: Measurand =
    Measurand::at_rest("quantization", "arcsec", "Q of the joint noise fit", |m, gyro, _| {
        vec![m.named(&gyro.identification.quantization)]
    })
    .also_called(&["q", "qn"])
    .power(PowerModel::NoiseTerm(NoiseType::Quantization))
    .needs_stillness();

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{gyro, shows};
    use super::*;
    use crate::estimate::{Estimate, Spread};

    #[test]
    fn every_term_is_its_own_estimate_under_its_own_name() {
        let mut gyro = gyro();
        for (value, estimate) in (1..).zip(gyro.identification.estimates_mut()) {
            estimate.value = Some(f64::from(value));
        }
        let all = [
            (&ANGLE_RANDOM_WALK, 1.0),
            (&ANGLE_RANDOM_WALK_WHITE, 1.0),
            (&BIAS_INSTABILITY, 2.0),
            (&RATE_RANDOM_WALK, 3.0),
            (&RATE_RAMP, 4.0),
            (&QUANTIZATION, 5.0),
        ];
        let row =
            |m: &Measurand, gyro: &_| m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0);
        for (m, value) in all {
            let found = row(m, &gyro);
            shows(&found, value, gyro.identification.method);
            assert_eq!((found.id, found.unit), (m.id, m.unit));
        }
        // Where a process is white beside the white noise, N is the level that is read.
        let level = Estimate::measured("angle_random_walk", "g", 7.0, "deg/sqrt(h)", Spread::Unknown, "read");
        gyro.identification.white_plateau = Some(level);
        shows(&row(&ANGLE_RANDOM_WALK, &gyro), 7.0, "read");
        shows(&row(&ANGLE_RANDOM_WALK_WHITE, &gyro), 1.0, gyro.identification.method);
    }
}
