//! Numbers of 704 bits: sums of doubles of very different size lose nothing that a double could show.

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

const BITS: usize = 704;
const ROUNDING: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("room for constants"));
}

/// A number of extended precision.
#[derive(Debug, Clone)]
pub struct X(BigFloat);

impl X {
    pub fn zero() -> X {
        X::from(0.0)
    }

    pub fn sqrt(&self) -> X {
        X(self.0.sqrt(BITS, ROUNDING))
    }

    pub fn square(&self) -> X {
        self * self
    }

    pub fn ln(&self) -> X {
        CONSTANTS.with_borrow_mut(|c| X(self.0.ln(BITS, ROUNDING, c)))
    }

    pub fn pi() -> X {
        CONSTANTS.with_borrow_mut(|c| X(c.pi(BITS, ROUNDING)))
    }

    pub fn sin(&self) -> X {
        CONSTANTS.with_borrow_mut(|c| X(self.0.sin(BITS, ROUNDING, c)))
    }

    pub fn cos(&self) -> X {
        CONSTANTS.with_borrow_mut(|c| X(self.0.cos(BITS, ROUNDING, c)))
    }

    pub fn abs(&self) -> X {
        X(self.0.abs())
    }

    pub fn is_positive(&self) -> bool {
        !self.0.is_zero() && self.0.is_positive()
    }

    /// The nearest double, within a unit of its last place.
    pub fn to_f64(&self) -> f64 {
        let Some((words, _, sign, exponent, _)) = self.0.as_raw_parts() else { return f64::NAN };
        let mut fraction = 0.0;
        for (place, word) in words.iter().rev().take(2).enumerate() {
            fraction += *word as f64 * 2f64.powi(-64 * (place as i32 + 1));
        }
        // In two steps, since one power of two of such size can leave the range of a double.
        let half = exponent / 2;
        let value = fraction * 2f64.powi(half) * 2f64.powi(exponent - half);
        if sign == Sign::Neg { -value } else { value }
    }
}

impl From<f64> for X {
    fn from(value: f64) -> X {
        assert!(value.is_finite(), "{value} has no place in a reference");
        X(BigFloat::from_f64(value, BITS))
    }
}

impl From<usize> for X {
    fn from(value: usize) -> X {
        X(BigFloat::from_u64(value as u64, BITS))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait<&X> for &X {
            type Output = X;
            fn $method(self, other: &X) -> X {
                X(self.0.$method(&other.0, BITS, ROUNDING))
            }
        }
        impl $trait<X> for X {
            type Output = X;
            fn $method(self, other: X) -> X {
                (&self).$method(&other)
            }
        }
        impl $trait<&X> for X {
            type Output = X;
            fn $method(self, other: &X) -> X {
                (&self).$method(other)
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for X {
    type Output = X;
    fn neg(self) -> X {
        X(self.0.neg())
    }
}

/// Sum of many numbers.
pub fn sum(terms: impl IntoIterator<Item = X>) -> X {
    terms.into_iter().fold(X::zero(), |a, b| a + b)
}

#[test]
fn extended_numbers_are_read_back_as_they_were() {
    for v in [1.0, -0.1, 1e60, -1e308, 1e-300, 123_456_789.123, f64::MAX, f64::MIN_POSITIVE] {
        assert_eq!(X::from(v).to_f64(), v);
    }
    assert_eq!(X::zero().to_f64(), 0.0);
    // Nothing is lost between 1e60 and 1e-60.
    let kept = X::from(1e60) + X::from(1e-60) - X::from(1e60);
    assert_eq!(kept.to_f64(), 1e-60);
    assert!((X::pi().to_f64() - std::f64::consts::PI).abs() < 1e-15);
    assert_eq!(X::from(2.0).sqrt().to_f64(), 2f64.sqrt());
    assert_eq!(X::from(0.3).sin().to_f64(), 0.3f64.sin());
    assert_eq!(X::from(7.0).ln().to_f64(), 7f64.ln());
}
