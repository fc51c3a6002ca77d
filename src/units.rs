//! Units: parsing, dimensions, conversion.
//!
//! The one unit system inside the program, in which every estimator and every formula works:
//!
//! | quantity | unit inside |
//! |---|---|
//! | angular rate, bias, flicker B, Allan deviation | deg/h |
//! | angle, quantisation Q | arcsec (1 arcsec/s is exactly 1 deg/h) |
//! | time, averaging time τ | s |
//! | angle random walk N | deg/sqrt(h) |
//! | rate random walk K | deg/h/sqrt(h) |
//! | rate ramp R | deg/h/h |
//! | temperature | degC |
//! | frequency | Hz |
//!
//! Other units exist at the edges only: in files that are read and in numbers that are shown.

mod error;

pub use error::UnitError;

use crate::text::{Arg, Note};
use std::fmt;

/// Number of base dimensions a unit is made of.
const BASES: usize = 9;
const ANGLE: usize = 0;
const TIME: usize = 1;
const TEMPERATURE: usize = 2;
const VOLTAGE: usize = 3;
const MAGNETIC: usize = 4;
const PRESSURE: usize = 5;
const LENGTH: usize = 6;
const CURRENT: usize = 7;
const COUNT: usize = 8;

/// Exponents of the base dimensions, in halves, so that `1/sqrt(h)` is exact.
type Dimension = [i8; BASES];

/// A parsed unit: a factor to the base units and the dimension it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    text: String,
    factor: f64,
    offset: f64,
    dimension: Dimension,
}

/// Symbol, factor to the base unit, dimension (in halves).
fn symbol(name: &str) -> Option<(f64, Dimension)> {
    const DEG: f64 = 180.0 / std::f64::consts::PI;
    let one = |i: usize| {
        let mut d = [0; BASES];
        d[i] = 2;
        d
    };
    let rate = |f: f64| {
        let mut d = one(ANGLE);
        d[TIME] = -2;
        (f, d)
    };
    Some(match name {
        "1" => (1.0, [0; BASES]),
        "%" | "percent" => (1e-2, [0; BASES]),
        "ppm" => (1e-6, [0; BASES]),
        "ppb" => (1e-9, [0; BASES]),
        "deg" | "°" | "degree" | "degrees" | "град" => (1.0, one(ANGLE)),
        "mdeg" => (1e-3, one(ANGLE)),
        "udeg" => (1e-6, one(ANGLE)),
        "arcmin" | "угл.мин" => (1.0 / 60.0, one(ANGLE)),
        "arcsec" | "угл.с" | "\"" => (1.0 / 3600.0, one(ANGLE)),
        "marcsec" | "mas" => (1.0 / 3.6e6, one(ANGLE)),
        "rad" | "рад" => (DEG, one(ANGLE)),
        "mrad" | "мрад" => (DEG * 1e-3, one(ANGLE)),
        "urad" | "µrad" | "μrad" | "мкрад" => (DEG * 1e-6, one(ANGLE)),
        "nrad" | "нрад" => (DEG * 1e-9, one(ANGLE)),
        "rev" | "turn" | "об" => (360.0, one(ANGLE)),
        "s" | "sec" | "second" | "с" => (1.0, one(TIME)),
        "ms" | "мс" => (1e-3, one(TIME)),
        "us" | "µs" | "μs" | "мкс" => (1e-6, one(TIME)),
        "ns" | "нс" => (1e-9, one(TIME)),
        "min" | "мин" => (60.0, one(TIME)),
        "h" | "hr" | "hour" | "hours" | "ч" => (3600.0, one(TIME)),
        "d" | "day" | "days" | "сут" => (86400.0, one(TIME)),
        "Hz" | "Гц" => (1.0, inverse(one(TIME))),
        "mHz" => (1e-3, inverse(one(TIME))),
        "kHz" | "кГц" => (1e3, inverse(one(TIME))),
        "dph" => rate(1.0 / 3600.0),
        "dps" => rate(1.0),
        "rpm" => rate(6.0),
        "degC" | "°C" | "K" | "kelvin" | "celsius" => (1.0, one(TEMPERATURE)),
        "mK" => (1e-3, one(TEMPERATURE)),
        "degF" | "°F" => (5.0 / 9.0, one(TEMPERATURE)),
        "V" | "В" => (1.0, one(VOLTAGE)),
        "mV" | "мВ" => (1e-3, one(VOLTAGE)),
        "T" => (1.0, one(MAGNETIC)),
        "mT" | "мТл" => (1e-3, one(MAGNETIC)),
        "uT" | "µT" | "μT" | "мкТл" => (1e-6, one(MAGNETIC)),
        "nT" => (1e-9, one(MAGNETIC)),
        "gauss" | "Oe" => (1e-4, one(MAGNETIC)),
        "Pa" | "Па" => (1.0, one(PRESSURE)),
        "hPa" | "mbar" | "гПа" => (100.0, one(PRESSURE)),
        "kPa" | "кПа" => (1e3, one(PRESSURE)),
        "m" => (1.0, one(LENGTH)),
        "mm" => (1e-3, one(LENGTH)),
        "um" | "µm" | "nm" => (if name == "nm" { 1e-9 } else { 1e-6 }, one(LENGTH)),
        "g" | "gn" => {
            let mut d = one(LENGTH);
            d[TIME] = -4;
            (9.80665, d)
        }
        "mg" => {
            let mut d = one(LENGTH);
            d[TIME] = -4;
            (9.80665e-3, d)
        }
        "A" => (1.0, one(CURRENT)),
        "mA" => (1e-3, one(CURRENT)),
        "count" | "counts" | "cnt" | "LSB" | "lsb" | "pulse" | "pulses" | "имп" => (1.0, one(COUNT)),
        _ => return None,
    })
}

/// Every ASCII symbol offered as a suggestion for a misspelt one.
const SUGGESTED: &[&str] = &[
    "deg", "mdeg", "arcmin", "arcsec", "rad", "mrad", "urad", "nrad", "rev", "s", "ms", "us", "ns", "min",
    "h", "day", "Hz", "kHz", "dph", "dps", "rpm", "degC", "K", "degF", "V", "mV", "mT", "uT", "Oe", "Pa",
    "hPa", "kPa", "m", "mm", "g", "mg", "A", "mA", "count", "LSB", "pulse", "ppm", "ppb", "sqrt",
];

fn inverse(mut d: Dimension) -> Dimension {
    d.iter_mut().for_each(|e| *e = -*e);
    d
}

impl Unit {
    /// Reads a unit such as `deg/h`, `deg/sqrt(h)`, `deg/h^1.5`, `(deg/h)/sqrt(Hz)`, `град/ч`, `°/√h`, `ppm/degC`.
    ///
    /// # Errors
    /// [`UnitError::Unknown`] for a symbol that is no unit, [`UnitError::Grammar`] for anything else.
    pub fn parse(text: &str) -> Result<Unit, UnitError> {
        let trimmed = text.trim();
        if trimmed.is_empty() {
            return Err(UnitError::Grammar { text: text.to_owned(), reason: "unit_error.reason.empty" });
        }
        if trimmed.len() > 64 {
            return Err(UnitError::Grammar {
                text: trimmed.chars().take(24).collect(),
                reason: "unit_error.reason.too_long",
            });
        }
        let mut parser = Parser { text: trimmed, rest: trimmed, depth: 0 };
        let (factor, dimension) = parser.product()?;
        if !parser.rest.is_empty() {
            return Err(parser.grammar("unit_error.reason.rest"));
        }
        let offset = match trimmed {
            "degC" | "°C" | "celsius" => 273.15,
            "degF" | "°F" => 459.67 * 5.0 / 9.0,
            _ => 0.0,
        };
        Ok(Unit { text: trimmed.to_owned(), factor, offset, dimension })
    }

    /// The text the unit was read from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// True when both units measure the same thing.
    pub fn same_dimension(&self, other: &Unit) -> bool {
        self.dimension == other.dimension
    }

    /// The factor that turns a difference in this unit into `other` (an offset of a temperature scale is left out).
    ///
    /// # Errors
    /// [`UnitError::Dimension`] when the two measure different things.
    pub fn factor_to(&self, other: &Unit) -> Result<f64, UnitError> {
        if !self.same_dimension(other) {
            return Err(UnitError::Dimension {
                from: self.text.clone(),
                to: other.text.clone(),
                from_dimension: Box::new(self.describe()),
                to_dimension: Box::new(other.describe()),
            });
        }
        let factor = self.factor / other.factor;
        // An exact ratio such as 3600 must not pick up the rounding of two divisions.
        let rounded = factor.round();
        Ok(if rounded != 0.0 && (factor / rounded - 1.0).abs() < 1e-14 { rounded } else { factor })
    }

    /// Turns a value in this unit into `other`, offsets of temperature scales included.
    ///
    /// # Errors
    /// As [`Unit::factor_to`].
    pub fn convert(&self, value: f64, other: &Unit) -> Result<f64, UnitError> {
        let factor = self.factor_to(other)?;
        if self.offset == other.offset {
            return Ok(value * factor);
        }
        Ok((value * self.factor + self.offset - other.offset) / other.factor)
    }

    /// The affine map `(factor, offset)` with `value_in_other = value * factor + offset`.
    ///
    /// # Errors
    /// As [`Unit::factor_to`].
    pub fn affine_to(&self, other: &Unit) -> Result<(f64, f64), UnitError> {
        let factor = self.factor_to(other)?;
        Ok((
            factor,
            if self.offset == other.offset { 0.0 } else { (self.offset - other.offset) / other.factor },
        ))
    }

    /// What the unit measures, in words.
    pub fn describe(&self) -> Arg {
        for (name, example) in KNOWN_DIMENSIONS {
            if Unit::parse(example).is_ok_and(|u| u.same_dimension(self)) {
                return Note::new(name).into();
            }
        }
        const NAMES: [&str; BASES] = [
            "dimension.base.angle",
            "dimension.base.time",
            "dimension.base.temperature",
            "dimension.base.voltage",
            "dimension.base.field",
            "dimension.base.pressure",
            "dimension.base.length",
            "dimension.base.current",
            "dimension.base.count",
        ];
        let powers = NAMES.into_iter().zip(self.dimension).filter(|(_, halves)| *halves != 0);
        let powers = powers.map(|(name, halves)| {
            let exponent = Arg::Stated(f64::from(halves) / 2.0);
            Note::new("dimension.power").with("base", Note::new(name)).with("exponent", exponent)
        });
        let joined = powers
            .reduce(|left, right| Note::new("dimension.product").with("left", left).with("right", right));
        joined.unwrap_or_else(|| Note::new("dimension.number")).into()
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
    ("dimension.count", "count"),
    ("dimension.angle_per_count", "arcsec/count"),
];

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

struct Parser<'a> {
    text: &'a str,
    rest: &'a str,
    depth: u8,
}

impl Parser<'_> {
    fn grammar(&self, reason: &'static str) -> UnitError {
        UnitError::Grammar { text: self.text.to_owned(), reason }
    }

    fn skip_space(&mut self) {
        self.rest = self.rest.trim_start_matches([' ', '\t', '\u{a0}']);
    }

    fn take(&mut self, c: char) -> bool {
        self.skip_space();
        match self.rest.strip_prefix(c) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn product(&mut self) -> Result<(f64, Dimension), UnitError> {
        self.depth += 1;
        if self.depth > 8 {
            return Err(self.grammar("unit_error.reason.nested"));
        }
        let (mut factor, mut dimension) = self.power()?;
        loop {
            let divide = if self.take('/') {
                true
            } else if self.take('*') || self.take('·') || self.take('⋅') {
                false
            } else {
                break;
            };
            let (f, d) = self.power()?;
            factor = if divide { factor / f } else { factor * f };
            for (a, b) in dimension.iter_mut().zip(d) {
                let sum = i16::from(*a) + if divide { -i16::from(b) } else { i16::from(b) };
                *a = i8::try_from(sum).map_err(|_| self.grammar("unit_error.reason.exponent_large"))?;
            }
        }
        self.depth -= 1;
        Ok((factor, dimension))
    }

    fn power(&mut self) -> Result<(f64, Dimension), UnitError> {
        let (factor, dimension) = self.atom()?;
        let halves: i8 = if self.take('^') {
            self.exponent()?
        } else if self.take('²') {
            4
        } else if self.take('³') {
            6
        } else {
            return Ok((factor, dimension));
        };
        self.raise(factor, dimension, halves)
    }

    fn raise(&self, factor: f64, dimension: Dimension, halves: i8) -> Result<(f64, Dimension), UnitError> {
        let mut out = [0; BASES];
        for (o, d) in out.iter_mut().zip(dimension) {
            let twice = i16::from(d) * i16::from(halves);
            if twice % 2 != 0 {
                return Err(self.grammar("unit_error.reason.fourth_root"));
            }
            *o = i8::try_from(twice / 2).map_err(|_| self.grammar("unit_error.reason.exponent_large"))?;
        }
        Ok((factor.powf(f64::from(halves) / 2.0), out))
    }

    fn exponent(&mut self) -> Result<i8, UnitError> {
        let parenthesised = self.take('(');
        let end = self
            .rest
            .find(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-' || c == '/'))
            .unwrap_or(self.rest.len());
        // Outside parentheses a slash divides the unit, it does not belong to the exponent.
        let end = if parenthesised { end } else { self.rest[..end].find('/').unwrap_or(end) };
        let (number, rest) = self.rest.split_at(end);
        let value = match number.split_once('/') {
            Some((a, b)) => a.parse::<f64>().ok().zip(b.parse::<f64>().ok()).map(|(a, b)| a / b),
            None => number.parse::<f64>().ok(),
        };
        self.rest = rest;
        if parenthesised && !self.take(')') {
            return Err(self.grammar("unit_error.reason.open"));
        }
        let halves = value.map(|v| v * 2.0).filter(|h| h.fract() == 0.0 && h.abs() <= 12.0);
        halves.map(|h| h as i8).ok_or_else(|| self.grammar("unit_error.reason.exponent"))
    }

    fn atom(&mut self) -> Result<(f64, Dimension), UnitError> {
        self.skip_space();
        if self.take('(') {
            let inner = self.product()?;
            return if self.take(')') { Ok(inner) } else { Err(self.grammar("unit_error.reason.open")) };
        }
        if self.take('√') {
            let (factor, dimension) = self.atom()?;
            return self.raise(factor, dimension, 1);
        }
        let end = self.rest.find(|c: char| "/*·⋅^²³() \t√".contains(c)).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        if name.is_empty() {
            return Err(self.grammar("unit_error.reason.symbol"));
        }
        self.rest = rest;
        if (name == "sqrt" || name == "rt") && self.rest.starts_with('(') {
            let (factor, dimension) = self.atom()?;
            return self.raise(factor, dimension, 1);
        }
        symbol(name).ok_or_else(|| UnitError::Unknown {
            symbol: name.to_owned(),
            suggestion: SUGGESTED
                .iter()
                .map(|s| (strsim::damerau_levenshtein(&name.to_lowercase(), &s.to_lowercase()), *s))
                .filter(|(distance, s)| *distance <= 1 + s.len() / 4)
                .min_by_key(|(distance, _)| *distance)
                .map(|(_, s)| s.to_owned()),
        })
    }
}

/// The Earth's rotation rate relative to the stars, deg/h (IERS: 7.292115e-5 rad/s).
pub const EARTH_RATE_DEG_H: f64 = 15.041_067;

#[cfg(test)]
mod tests;
