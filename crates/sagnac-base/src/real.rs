//! Numbers of any kind in formats that know finite ones only, such as JSON: NaN is `null`, an infinity is a text.
//!
//! For `#[serde(with = "real")]`.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number with a form for NaN and infinities.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Real {
    Finite(f64),
    Infinite(Infinite),
    Nan(()),
}

#[derive(Clone, Copy, Serialize, Deserialize)]
pub(crate) enum Infinite {
    #[serde(rename = "∞")]
    Positive,
    #[serde(rename = "-∞")]
    Negative,
}

impl From<f64> for Real {
    fn from(v: f64) -> Real {
        match v {
            f64::INFINITY => Real::Infinite(Infinite::Positive),
            f64::NEG_INFINITY => Real::Infinite(Infinite::Negative),
            v if v.is_nan() => Real::Nan(()),
            // The sum has no negative zero, whose sign says nothing and depends on the optimisation of a maximum.
            v => Real::Finite(v + 0.0),
        }
    }
}

impl From<Real> for f64 {
    fn from(v: Real) -> f64 {
        match v {
            Real::Finite(v) => v,
            Real::Infinite(Infinite::Positive) => f64::INFINITY,
            Real::Infinite(Infinite::Negative) => f64::NEG_INFINITY,
            Real::Nan(()) => f64::NAN,
        }
    }
}

/// A type made of numbers, with the form in which it is written.
pub(crate) trait Numbers: Sized {
    type Written: Serialize + DeserializeOwned;
    fn written(&self) -> Self::Written;
    fn read(written: Self::Written) -> Self;
}

impl Numbers for f64 {
    type Written = Real;
    fn written(&self) -> Real {
        (*self).into()
    }
    fn read(written: Real) -> f64 {
        written.into()
    }
}

impl Numbers for (f64, f64) {
    type Written = [Real; 2];
    fn written(&self) -> [Real; 2] {
        [self.0, self.1].map(Real::from)
    }
    fn read(written: [Real; 2]) -> (f64, f64) {
        written.map(f64::from).into()
    }
}

impl Numbers for (f64, f64, f64) {
    type Written = [Real; 3];
    fn written(&self) -> [Real; 3] {
        [self.0, self.1, self.2].map(Real::from)
    }
    fn read(written: [Real; 3]) -> (f64, f64, f64) {
        written.map(f64::from).into()
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    type Written = Vec<T::Written>;
    fn written(&self) -> Vec<T::Written> {
        self.iter().map(T::written).collect()
    }
    fn read(written: Vec<T::Written>) -> Vec<T> {
        written.into_iter().map(T::read).collect()
    }
}

impl<T: Numbers> Numbers for Option<T> {
    type Written = Option<T::Written>;
    fn written(&self) -> Option<T::Written> {
        self.as_ref().map(T::written)
    }
    fn read(written: Option<T::Written>) -> Option<T> {
        written.map(T::read)
    }
}

pub(crate) fn serialize<T: Numbers, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.written().serialize(serializer)
}

pub(crate) fn deserialize<'de, T: Numbers, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Written::deserialize(deserializer).map(T::read)
}
