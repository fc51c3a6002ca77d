//! What attributes say: units, dates, scales, the sample rate.

use crate::metadata::stated_sample_rate_hz;
use hdf5_reader::Attribute;

/// What the attributes of a dataset say of its values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DatasetAttributes {
    /// Unit.
    pub unit: Option<String>,
    /// Seconds from 1970 to the zero of the values, where the unit is `seconds since ...`.
    pub epoch_s: Option<f64>,
    /// Factor from the unit of stamps with a date to seconds, 1 elsewhere.
    pub to_s: f64,
    /// Factor from the number stored to the value.
    pub factor: Option<f64>,
    /// Offset added after the factor.
    pub offset: Option<f64>,
    /// Number that stands for a missing value.
    pub missing: Option<f64>,
    /// Sample rate, Hz.
    pub rate_hz: Option<f64>,
    /// True when MATLAB wrote the dataset.
    pub matlab: bool,
    /// True when the dataset is a text that MATLAB wrote as numbers.
    pub matlab_text: bool,
}

impl Default for DatasetAttributes {
    fn default() -> DatasetAttributes {
        DatasetAttributes {
            unit: None,
            epoch_s: None,
            to_s: 1.0,
            factor: None,
            offset: None,
            missing: None,
            rate_hz: None,
            matlab: false,
            matlab_text: false,
        }
    }
}

/// Reads the attributes of a dataset.
pub(super) fn read(attributes: &[Attribute]) -> DatasetAttributes {
    let mut told = DatasetAttributes::default();
    for a in attributes {
        let name = a.name.to_lowercase();
        let number = || number(a).filter(|v| v.is_finite());
        match name.as_str() {
            "unit" | "units" | "unit_string" => {
                let text = text(a).filter(|t| !t.is_empty());
                if let Some((to_s, epoch_s)) = text.as_deref().and_then(since) {
                    told.unit = Some("s".to_owned());
                    told.to_s = to_s;
                    told.epoch_s = Some(epoch_s);
                } else {
                    told.unit = text;
                }
            }
            "scale_factor" => told.factor = number(),
            "add_offset" => told.offset = number(),
            "_fillvalue" | "missing_value" => told.missing = number(),
            "matlab_class" => {
                told.matlab = true;
                told.matlab_text = text(a).is_some_and(|t| t == "char");
            }
            _ => told.rate_hz = told.rate_hz.or_else(|| stated_sample_rate_hz(&name, number()?)),
        }
    }
    told
}

/// The text of an attribute.
pub(super) fn text(attribute: &Attribute) -> Option<String> {
    let text = match &attribute.decoded_strings {
        Some(strings) => strings.first().cloned(),
        None => attribute.read_string().ok(),
    }?;
    Some(text.trim_matches(['\0', ' ']).to_owned())
}

/// The number of an attribute, or of an array of one.
pub(super) fn number(attribute: &Attribute) -> Option<f64> {
    let one = attribute.shape.iter().all(|n| *n == 1);
    one.then(|| {
        super::number::Storage::of(&attribute.datatype)
            .filter(|s| attribute.raw_data.len() >= s.bytes())
            .map(|s| s.number(&attribute.raw_data))
    })?
}

/// Factor to seconds and epoch of `milliseconds since 2026-01-01 00:00:00`, s from 1970.
fn since(text: &str) -> Option<(f64, f64)> {
    let (unit, date) = text.split_once(" since ")?;
    let to_s = match unit.trim().to_lowercase().as_str() {
        "s" | "sec" | "secs" | "second" | "seconds" => 1.0,
        "ms" | "msec" | "millisecond" | "milliseconds" => 1e-3,
        "us" | "microsecond" | "microseconds" => 1e-6,
        "ns" | "nanosecond" | "nanoseconds" => 1e-9,
        "min" | "minute" | "minutes" => 60.0,
        "h" | "hour" | "hours" => 3600.0,
        _ => return None,
    };
    let date = date.trim().trim_end_matches("UTC").trim().trim_end_matches('Z').trim();
    let date = date.replace('T', " ");
    let seconds = ["%Y-%m-%d %H:%M:%S%.f", "%Y-%m-%d %H:%M"]
        .iter()
        .find_map(|f| chrono::NaiveDateTime::parse_from_str(&date, f).ok())
        .or_else(|| chrono::NaiveDate::parse_from_str(&date, "%Y-%m-%d").ok()?.and_hms_opt(0, 0, 0))?;
    Some((to_s, seconds.and_utc().timestamp() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_with_a_date_is_unit_and_epoch() {
        assert_eq!(since("seconds since 1970-01-02"), Some((1.0, 86_400.0)));
        assert_eq!(since("milliseconds since 1970-01-01T00:01:00Z"), Some((1e-3, 60.0)));
        assert_eq!(since("ns since 1970-01-01 00:00:01.000 UTC"), Some((1e-9, 1.0)));
        assert_eq!(since("deg/h"), None);
        assert_eq!(since("days since the flood"), None);
    }
}
