//! Units of products, quotients and powers.

use super::Unit;
use super::dimension::{BASE_COUNT, Dimension};

impl Unit {
    /// The unit of a pure number.
    pub fn pure() -> Unit {
        Unit { text: "1".to_owned(), factor: 1.0, offset: 0.0, dimension: [0; BASE_COUNT] }
    }

    /// Factor to the base units; the offset of a temperature scale is left out.
    pub fn base_factor(&self) -> f64 {
        self.factor
    }

    /// True for the unit of a pure number, such as `%`.
    pub fn is_pure(&self) -> bool {
        self.dimension == [0; BASE_COUNT]
    }

    /// The unit of a product; `None` where an exponent is too large.
    pub fn times(&self, other: &Unit) -> Option<Unit> {
        let dimension = combined(self.dimension, other.dimension, |a, b| a + b)?;
        let text = format!("{}*{}", self.text, factor_text(&other.text));
        Some(Unit { text, factor: self.factor * other.factor, offset: 0.0, dimension })
    }

    /// The unit of a quotient; `None` where an exponent is too large.
    pub fn over(&self, other: &Unit) -> Option<Unit> {
        let dimension = combined(self.dimension, other.dimension, |a, b| a - b)?;
        let text = format!("{}/{}", self.text, factor_text(&other.text));
        Some(Unit { text, factor: self.factor / other.factor, offset: 0.0, dimension })
    }

    /// The unit of a power; `None` where an exponent is too large or no multiple of a half.
    pub fn to_power(&self, exponent: f64) -> Option<Unit> {
        let mut dimension = self.dimension;
        for d in &mut dimension {
            let raised = f64::from(*d) * exponent;
            if raised.fract() != 0.0 || raised.abs() > f64::from(i8::MAX) {
                return None;
            }
            *d = raised as i8;
        }
        let text = format!("({})^{exponent}", self.text);
        Some(Unit { text, factor: self.factor.powf(exponent), offset: 0.0, dimension })
    }
}

/// A unit as the second factor of a product or the divisor of a quotient.
fn factor_text(text: &str) -> String {
    if text.contains(['/', '*', '·']) { format!("({text})") } else { text.to_owned() }
}

fn combined(a: Dimension, b: Dimension, of: impl Fn(i16, i16) -> i16) -> Option<Dimension> {
    let mut out = [0; BASE_COUNT];
    for ((o, a), b) in out.iter_mut().zip(a).zip(b) {
        *o = i8::try_from(of(i16::from(a), i16::from(b))).ok()?;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(text: &str) -> Unit {
        Unit::parse(text).unwrap()
    }

    #[test]
    fn products_quotients_and_powers_are_the_units_that_their_texts_say() {
        for (made, text) in [
            (unit("deg/h/mT").times(&unit("mT")), "deg/h"),
            (unit("deg/sqrt(h)").over(&unit("sqrt(h)")), "deg/h"),
            (unit("deg/h").to_power(2.0), "deg^2/h^2"),
            (unit("deg^2/h").to_power(0.5), "deg/sqrt(h)"),
            (unit("deg/h").over(&unit("deg/s")), "1"),
        ] {
            let (made, expected) = (made.unwrap(), unit(text));
            assert!(made.same_dimension(&expected), "{} {text}", made.text());
            let factor = made.factor_to(&expected).unwrap();
            let by_text = unit(made.text()).factor_to(&expected).unwrap();
            assert!((factor / by_text - 1.0).abs() < 1e-12, "{}", made.text());
        }
        assert!(unit("%").is_pure() && Unit::pure().is_pure() && !unit("deg").is_pure());
        assert_eq!(unit("%").base_factor(), 0.01);
        assert_eq!(unit("deg/sqrt(h)").to_power(0.5), None, "a fourth root");
        assert_eq!(unit("deg").to_power(1e9), None);
    }
}
