//! What a unit measures, in words.

use super::{BASE_COUNT, Unit};
use crate::message::{Arg, Note, note};

impl Unit {
    /// What the unit measures, in words.
    pub fn describe(&self) -> Arg {
        for (name, example) in KNOWN_DIMENSIONS {
            if Unit::parse(example).is_ok_and(|u| u.same_dimension(self)) {
                return Note::new(*name).into();
            }
        }
        const BASE_NAMES: [&str; BASE_COUNT] = [
            "dimension.base.angle",
            "dimension.base.time",
            "dimension.base.temperature",
            "dimension.base.voltage",
            "dimension.base.field",
            "dimension.base.pressure",
            "dimension.base.length",
            "dimension.base.current",
            "dimension.base.count",
            "dimension.base.level",
        ];
        let powers = BASE_NAMES.into_iter().zip(self.dimension).filter(|(_, halves)| *halves != 0);
        let powers = powers.map(|(name, halves)| {
            let exponent = Arg::Stated(f64::from(halves) / 2.0);
            note!("dimension.power", base = Note::new(name), exponent)
        });
        let joined = powers.reduce(|left, right| note!("dimension.product", left, right));
        joined.unwrap_or_else(|| note!("dimension.number")).into()
    }
}

/// Names of the dimensions that occur in gyro work, each with one unit of it.
const KNOWN_DIMENSIONS: &[(&str, &str)] = &[
    ("dimension.number", "1"),
    ("dimension.angle", "deg"),
    ("dimension.time", "s"),
    ("dimension.frequency", "Hz"),
    ("dimension.rate", "deg/h"),
    ("dimension.angle_random_walk", "deg/sqrt(h)"),
    ("dimension.rate_random_walk", "deg/h/sqrt(h)"),
    ("dimension.rate_ramp", "deg/h/h"),
    ("dimension.temperature", "degC"),
    ("dimension.temperature_rate", "degC/h"),
    ("dimension.rate_per_temperature", "deg/h/degC"),
    ("dimension.rate_per_temperature_rate", "deg/h/(degC/min)"),
    ("dimension.per_temperature", "ppm/degC"),
    ("dimension.voltage", "V"),
    ("dimension.rate_per_voltage", "deg/h/V"),
    ("dimension.field", "mT"),
    ("dimension.rate_per_field", "deg/h/mT"),
    ("dimension.pressure", "hPa"),
    ("dimension.acceleration", "g"),
    ("dimension.rate_per_acceleration_squared", "deg/h/g^2"),
    ("dimension.level", "dB"),
    ("dimension.electric_current", "A"),
    ("dimension.electric_power", "W"),
    ("dimension.count", "count"),
    ("dimension.angle_per_count", "arcsec/count"),
];
