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

mod arithmetic;
mod describe;
mod dimension;
mod error;
mod parse;
mod rate;
mod symbols;

use dimension::*;
pub use error::UnitError;
use parse::Parser;
pub use rate::RateUnit;
use std::fmt;
use symbols::{CELSIUS_SYMBOLS, FAHRENHEIT_SYMBOLS};

/// A conversion of values: `value * factor + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Factor.
    pub factor: f64,
    /// Offset added after, in the new unit.
    pub offset: f64,
}

impl Affine {
    /// Leaves values as they are.
    pub const IDENTITY: Affine = Affine { factor: 1.0, offset: 0.0 };

    /// The converted value.
    #[inline]
    pub fn apply(self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// Converts values in place.
    pub fn apply_all(self, values: &mut [f64]) {
        if self != Affine::IDENTITY {
            values.iter_mut().for_each(|v| *v = self.apply(*v));
        }
    }
}

/// A parsed unit: a factor to the base units and the dimension it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    text: String,
    factor: f64,
    offset: f64,
    dimension: Dimension,
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
        // An abbreviation may have a blank behind its point: `угл. с`.
        let joined = trimmed.replace(". ", ".");
        let mut parser = Parser { text: trimmed, rest: &joined, depth: 0 };
        let (factor, dimension) = parser.product()?;
        if !parser.rest.is_empty() {
            return Err(parser.grammar("unit_error.reason.rest"));
        }
        let offset = match trimmed {
            name if CELSIUS_SYMBOLS.contains(&name) => 273.15,
            name if FAHRENHEIT_SYMBOLS.contains(&name) => 459.67 * 5.0 / 9.0,
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

    /// The conversion of values in this unit into `other`.
    ///
    /// # Errors
    /// As [`Unit::factor_to`].
    pub fn affine_to(&self, other: &Unit) -> Result<Affine, UnitError> {
        let factor = self.factor_to(other)?;
        let apart = self.offset - other.offset;
        Ok(Affine { factor, offset: if apart == 0.0 { 0.0 } else { apart / other.factor } })
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// The Earth's rotation rate relative to the stars, deg/h (IERS: 7.292115e-5 rad/s).
pub const EARTH_RATE_DEG_H: f64 = 15.041_067;

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(from: &str, to: &str) -> f64 {
        Unit::parse(from).unwrap().factor_to(&Unit::parse(to).unwrap()).unwrap()
    }

    #[test]
    fn conversions_that_gyro_work_lives_on_are_exact() {
        assert_eq!(factor("deg/s", "deg/h"), 3600.0);
        assert_eq!(factor("arcsec/s", "deg/h"), 1.0);
        assert!((factor("rad/s", "deg/h") / 206_264.806_247_096_36 - 1.0).abs() < 1e-14);
        assert!((factor("deg/sqrt(s)", "deg/sqrt(h)") - 60.0).abs() < 1e-12);
        assert!((factor("(deg/h)/sqrt(Hz)", "deg/sqrt(h)") - 1.0 / 60.0).abs() < 1e-16);
        assert!((factor("deg/h^1.5", "deg/h/sqrt(h)") - 1.0).abs() < 1e-15);
        assert_eq!(factor("deg/h/(degC/h)", "deg/h/(degC/min)"), 60.0);
    }

    #[test]
    fn other_spellings_mean_the_same() {
        for (a, b) in [
            ("град/ч", "deg/h"),
            ("град/√ч", "deg/sqrt(h)"),
            ("°/√h", "deg/sqrt(h)"),
            ("deg/hr", "deg/h"),
            ("dph", "deg/h"),
            ("deg/h²", "deg/h/h"),
            ("deg/h^(3/2)", "deg/h/sqrt(h)"),
            ("град/час", "deg/h"),
            ("°·ч⁻¹", "deg/h"),
            ("º/s", "deg/s"),
            ("град/с", "deg/s"),
            ("рад/с", "rad/s"),
            ("мрад/с", "mrad/s"),
            ("мград/с", "mdeg/s"),
            ("угл.с", "arcsec"),
            ("угл.сек", "arcsec"),
            ("угл. с", "arcsec"),
            ("″", "arcsec"),
            ("ʺ/с", "arcsec/s"),
            ("мкрад", "urad"),
            ("µrad", "urad"),
            ("мкс", "us"),
            ("нс", "ns"),
            ("мин", "min"),
            ("град.С", "degC"),
            ("°С", "degC"),
            ("К", "K"),
            ("мВ", "mV"),
            ("мА", "mA"),
            ("отсч.", "count"),
            ("ед.", "count"),
            ("имп", "count"),
            ("м/с²", "m/s^2"),
            ("об/мин", "rpm"),
            ("град/√ч", "deg/sqrt(h)"),
            ("rad s^-1", "rad/s"),
            ("rad.s-1", "rad/s"),
            ("rad s-1", "rad/s"),
            ("rad*s**-1", "rad/s"),
            ("deg s-1", "deg/s"),
            ("deg·s⁻¹", "deg/s"),
            ("Degrees/s", "deg/s"),
            ("DPS", "dps"),
            ("Deg/Sec", "deg/s"),
            ("radps", "rad/s"),
            ("degrees/second", "deg/s"),
            ("m s^-2", "m/s^2"),
            ("m/s2", "m/s^2"),
            ("m.s-2", "m/s^2"),
            ("°F", "degF"),
        ] {
            assert!((factor(a, b) - 1.0).abs() < 1e-14, "{a} {b}");
        }
    }

    #[test]
    fn temperatures_carry_their_offset_and_differences_do_not() {
        let (c, k, f) =
            (Unit::parse("degC").unwrap(), Unit::parse("K").unwrap(), Unit::parse("degF").unwrap());
        assert!((c.convert(20.0, &k).unwrap() - 293.15).abs() < 1e-12);
        for russian in ["°С", "град.С", "гр.C", "℃"] {
            assert!(
                (Unit::parse(russian).unwrap().convert(20.0, &k).unwrap() - 293.15).abs() < 1e-12,
                "{russian}"
            );
        }
        assert!((f.convert(68.0, &c).unwrap() - 20.0).abs() < 1e-12);
        assert_eq!(factor("ppm/K", "ppm/degC"), 1.0);
    }

    #[test]
    fn prefixes_count_and_no_suggestion_leaves_one_out() {
        for (a, b, by) in
            [("mdps", "dps", 1e-3), ("udps", "dps", 1e-6), ("kHz", "Hz", 1e3), ("mradps", "rad/s", 1e-3)]
        {
            assert!((factor(a, b) / by - 1.0).abs() < 1e-12, "{a}");
        }
        for odd in ["cdps", "xdps", "zrad"] {
            assert!(
                matches!(Unit::parse(odd), Err(UnitError::Unknown { suggestion: None, .. })),
                "{odd}: {:?}",
                Unit::parse(odd)
            );
        }
    }

    #[test]
    fn a_wrong_dimension_is_named() {
        let e = Unit::parse("deg/sqrt(h)")
            .unwrap()
            .factor_to(&Unit::parse("deg/h").unwrap())
            .unwrap_err()
            .to_string();
        assert!(e.contains("dimension.angle_random_walk") && e.contains("dimension.rate"), "{e}");
    }

    #[test]
    fn nonsense_is_refused_with_a_hint() {
        assert_eq!(
            Unit::parse("dge/h").unwrap_err(),
            UnitError::Unknown { symbol: "dge".into(), suggestion: Some("deg".into()) }
        );
        for bad in
            ["", "deg/", "(deg", "deg/h)", "deg^0.3", "((((((((((deg))))))))))", "sqrt", "deg//h", "/h"]
        {
            assert!(Unit::parse(bad).is_err(), "{bad}");
        }
    }
}
