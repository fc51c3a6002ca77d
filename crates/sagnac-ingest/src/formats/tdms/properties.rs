//! Properties of TDMS objects, and the paths that name the objects.

use super::bytes::{MetadataFault, Reader};
use std::collections::BTreeMap;

/// Seconds from 1904 to 1970.
pub(super) const FROM_1904_S: i64 = 2_082_844_800;

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Text(String),
    /// Seconds from 1970 and 2^-64 of a second.
    Stamp(i64, u64),
    /// A type that has no meaning here.
    Other,
}

impl Value {
    /// Reads type and value.
    pub fn read(reader: &mut Reader<'_>) -> Result<Value, MetadataFault> {
        let code = reader.u32()?;
        Ok(match code {
            1..=4 => {
                let bytes = 1usize << (code - 1);
                let shift = 64 - 8 * bytes as u32;
                Value::Number((((reader.word(bytes)? << shift) as i64) >> shift) as f64)
            }
            5..=8 => Value::Number(reader.word(1 << (code - 5))? as f64),
            9 | 0x19 => Value::Number(f64::from(f32::from_bits(reader.u32()?))),
            10 | 0x1a => Value::Number(f64::from_bits(reader.u64()?)),
            0x20 => Value::Text(reader.text()?),
            0x21 => Value::Number(reader.word(1)? as f64),
            0x44 => {
                let (seconds, fraction) = reader.stamp()?;
                Value::Stamp(seconds.saturating_sub(FROM_1904_S), fraction)
            }
            0 => Value::Other,
            0x0008_000c => reader.take(8).map(|_| Value::Other)?,
            11 | 0x1b | 0x0010_000d => reader.take(16).map(|_| Value::Other)?,
            _ => return Err(MetadataFault::Short),
        })
    }

    /// The value in words.
    pub fn words(&self) -> Option<String> {
        match self {
            Value::Number(v) => Some(v.to_string()),
            Value::Text(t) => Some(t.clone()),
            Value::Stamp(s, f) => {
                let ns = ((u128::from(*f) * 1_000_000_000) >> 64) as u32;
                chrono::DateTime::from_timestamp(*s, ns)
                    .map(|d| d.to_rfc3339_opts(chrono::SecondsFormat::AutoSi, true))
            }
            Value::Other => None,
        }
    }
}

/// Properties by name.
#[derive(Debug, Clone, Default)]
pub(super) struct Properties(BTreeMap<String, Value>);

impl Properties {
    pub fn set(&mut self, name: String, value: Value) {
        self.0.insert(name, value);
    }

    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }

    pub fn number(&self, name: &str) -> Option<f64> {
        match self.get(name)? {
            Value::Number(v) => Some(*v),
            _ => None,
        }
    }

    pub fn text(&self, name: &str) -> Option<&str> {
        match self.get(name)? {
            Value::Text(t) => Some(t.as_str()),
            _ => None,
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v))
    }
}

/// The names in a path such as `/'group'/'channel'`, in which a quote within a name stands twice.
pub(super) fn split_path(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut name: Option<String> = None;
    let mut chars = path.chars().peekable();
    while let Some(c) = chars.next() {
        match (&mut name, c) {
            (None, '\'') => name = Some(String::new()),
            (None, _) => {}
            (Some(n), '\'') => {
                if chars.next_if_eq(&'\'').is_some() {
                    n.push('\'');
                } else {
                    names.extend(name.take());
                }
            }
            (Some(n), c) => n.push(c),
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_split_at_quotes() {
        assert_eq!(split_path("/"), Vec::<String>::new());
        assert_eq!(split_path("/'Bench'"), ["Bench"]);
        assert_eq!(split_path("/'Dr. T''s / group'/'rate'"), ["Dr. T's / group", "rate"]);
    }

    #[test]
    fn a_stamp_is_told_as_a_date() {
        // 2026-01-01 00:00:00.5 UTC.
        assert_eq!(Value::Stamp(1_767_225_600, 1 << 63).words().unwrap(), "2026-01-01T00:00:00.500Z");
    }
}
