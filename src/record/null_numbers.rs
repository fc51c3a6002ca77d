//! JSON in which `null` stands for a number that is none.
//!
//! JSON has no NaN; where a record holds one, `result.json` has `null`, as it has for an absent value. Read back through
//! [`NullNumbers`], a `null` is NaN where a number is expected and `None` where it may be absent.

use serde::de::value::{MapAccessDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, Unexpected, Visitor};
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
            // Not by the deserializer of `Value`: that would compile every type of a record a second time.
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(value),
            Value::Number(number) => number.deserialize_any(visitor),
            Value::String(text) => visitor.visit_string(text),
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
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.0 {
            Value::String(name) => visitor.visit_enum(name.into_deserializer()),
            Value::Object(map) if map.len() == 1 => {
                let entries = map.into_iter().map(|(name, value)| (name, NullNumbers(value)));
                visitor.visit_enum(MapAccessDeserializer::new(MapDeserializer::new(entries)))
            }
            other => Err(Error::invalid_type(unexpected(&other), &"enum")),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier ignored_any
    }
}

/// The JSON value that stands where an enum was expected.
fn unexpected(value: &Value) -> Unexpected<'_> {
    match value {
        Value::Null => Unexpected::Unit,
        Value::Bool(value) => Unexpected::Bool(*value),
        Value::Number(number) => Unexpected::Float(number.as_f64().unwrap_or(f64::NAN)),
        Value::String(text) => Unexpected::Str(text),
        Value::Array(_) => Unexpected::Seq,
        Value::Object(_) => Unexpected::Map,
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

    #[derive(Debug, PartialEq, Deserialize)]
    enum Kind {
        Plain,
        Number(f64),
        Named { value: Option<f64> },
    }

    #[test]
    fn enums_are_read_with_what_they_hold() {
        assert_eq!(from_value::<Kind>(json!("Plain")).unwrap(), Kind::Plain);
        assert!(matches!(from_value(json!({"Number": null})).unwrap(), Kind::Number(v) if v.is_nan()));
        assert_eq!(
            from_value::<Kind>(json!({"Named": {"value": null}})).unwrap(),
            Kind::Named { value: None }
        );
        for wrong in [
            json!(null),
            json!(true),
            json!(1),
            json!("Other"),
            json!([]),
            json!({}),
            json!({"Plain": 1, "Number": 2}),
        ] {
            assert!(from_value::<Kind>(wrong.clone()).is_err(), "{wrong}");
        }
    }
}
