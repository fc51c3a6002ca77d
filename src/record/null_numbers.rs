//! JSON in which `null` stands for a number that is none.
//!
//! JSON has no NaN; where a record holds one, `result.json` has `null`, as it has for an absent value. Read back through
//! [`NullNumbers`], a `null` is NaN where a number is expected and `None` where it may be absent.

use serde::de::value::{MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;
use serde_json::{Error, Value};

struct NullNumbers(Value);

/// The value that JSON holds, `null` read as NaN where a number is expected.
pub(super) fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, Error> {
    T::deserialize(NullNumbers(value))
}

impl IntoDeserializer<'_, Error> for NullNumbers {
    type Deserializer = NullNumbers;

    fn into_deserializer(self) -> NullNumbers {
        self
    }
}

impl<'de> Deserializer<'de> for NullNumbers {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0 {
            Value::Array(list) => visitor.visit_seq(SeqDeserializer::new(list.into_iter().map(NullNumbers))),
            Value::Object(map) => {
                let entries = map.into_iter().map(|(name, value)| (name, NullNumbers(value)));
                visitor.visit_map(MapDeserializer::new(entries))
            }
            plain => plain.deserialize_any(visitor),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.0.is_null() { visitor.visit_f64(f64::NAN) } else { self.deserialize_any(visitor) }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if self.0.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.0.deserialize_enum(name, variants, visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde_json::json;

    #[derive(Debug, Deserialize)]
    struct Given {
        number: f64,
        pair: [f64; 2],
        absent: Option<f64>,
        left_out: Option<f64>,
        list: Vec<Option<f64>>,
    }

    #[test]
    fn null_is_nan_for_a_number_and_none_for_an_option() {
        let read: Given =
            from_value(json!({"number": null, "pair": [1, null], "absent": null, "list": [null, 2]}))
                .unwrap();
        assert!(read.number.is_nan() && read.pair[1].is_nan());
        assert_eq!(
            (read.pair[0], read.absent, read.left_out, read.list),
            (1.0, None, None, vec![None, Some(2.0)])
        );
        assert!(from_value::<Given>(json!({"number": "1"})).is_err());
        assert!(
            from_value::<Given>(json!({"pair": [1, 2], "list": []})).is_err(),
            "a number that is left out"
        );
    }
}
