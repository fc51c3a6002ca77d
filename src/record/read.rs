//! Reads a `result.json`, or another file that this program wrote, back into its type.
//!
//! A whole result is one of this program. A reader that needs a few members names them, and reads the results of any program:
//! [`of_any_program`].

use super::null_numbers;
use super::{RESULT_FORMAT, RunRecord};
use crate::i18n::{Note, io_reason};
use crate::output::MAX_RECORD_BYTES;
use sagnac_ingest::{FileFault, read_file};
use serde::de::{DeserializeOwned, Error as _};
use serde_json::{Map, Value};
use std::path::Path;

/// Largest file that is read, bytes.
pub const MAX_BYTES: usize = MAX_RECORD_BYTES as usize;

/// Members that every result has, whichever program wrote it.
const REQUIRED_OF_ANY_PROGRAM: [&str; 3] = ["unit_under_test", "verdict", "measurands"];

/// Why a file is no result that this program reads.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error("the file cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// The file is larger than [`MAX_BYTES`].
    #[error("the result has more than {MAX_BYTES} bytes")]
    TooLarge,
    /// It is not JSON, or it is cut off.
    #[error("the file is not JSON: {0}")]
    NotJson(serde_json::Error),
    /// It is JSON of another program: it names no format, or one of another kind.
    #[error("the file is not of the format `{expected}`")]
    Foreign {
        /// The format that is read.
        expected: &'static str,
    },
    /// It is of another version of the format.
    #[error("the file has the format `{found}`; `{expected}` is read")]
    OtherVersion {
        /// The format that it names.
        found: String,
        /// The format that is read.
        expected: &'static str,
    },
    /// It names the right format, and a field is missing or of another type.
    #[error("the file does not follow `{expected}`: {reason}")]
    Malformed {
        /// The format that it names.
        expected: &'static str,
        /// What does not fit.
        reason: String,
    },
}

impl ReadError {
    /// The fault of the file at `path`, as a note. The words of the JSON reader on a field are English.
    pub fn note(&self, path: &Path) -> Note {
        let note = |key: &'static str| Note::new(key).with("path", path.display().to_string());
        match self {
            ReadError::Io(e) => note("result_error.unreadable").with("reason", io_reason(e)),
            ReadError::TooLarge => note("result_error.too_large").with("most", MAX_BYTES),
            ReadError::NotJson(e) => {
                note(if e.is_eof() { "result_error.cut_short" } else { "result_error.no_json" })
                    .with("line", e.line())
                    .with("column", e.column())
            }
            ReadError::Foreign { expected } => note("result_error.foreign").with("format", *expected),
            ReadError::OtherVersion { found, expected } => {
                note("result_error.other_version").with("found", found.as_str()).with("format", *expected)
            }
            ReadError::Malformed { expected, reason } => {
                note("result_error.malformed").with("format", *expected).with("reason", reason.as_str())
            }
        }
    }
}

/// The bytes of a file that is not larger than any result.
///
/// # Errors
/// [`ReadError::Io`] and [`ReadError::TooLarge`].
pub fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    read_file(path, MAX_RECORD_BYTES).map_err(|e| match FileFault::of(&e) {
        Some(FileFault::TooLarge { .. }) => ReadError::TooLarge,
        _ => ReadError::Io(e),
    })
}

/// The record in a `result.json`.
///
/// # Errors
/// [`ReadError::Io`], and as [`from_slice`].
pub fn open(path: &Path) -> Result<RunRecord, ReadError> {
    from_slice(&bytes(path)?)
}

/// The record that the bytes of a `result.json` hold.
///
/// # Errors
/// [`ReadError`] where the bytes are too many, not JSON, of another format or version, or do not follow the format.
pub fn from_slice(bytes: &[u8]) -> Result<RunRecord, ReadError> {
    of_format(bytes, RESULT_FORMAT)
}

/// The `format` that a JSON file names, if any.
///
/// # Errors
/// [`ReadError::NotJson`].
pub fn format_of(bytes: &[u8]) -> Result<Option<String>, ReadError> {
    let value: Value = serde_json::from_slice(bytes).map_err(ReadError::NotJson)?;
    Ok(value.get("format").and_then(Value::as_str).map(str::to_owned))
}

/// The value that the bytes of a JSON file hold whose `format` is `expected`, such as `result/1`.
///
/// # Errors
/// As [`from_slice`].
pub fn of_format<T: DeserializeOwned>(bytes: &[u8], expected: &'static str) -> Result<T, ReadError> {
    read_as(bytes, expected, null_numbers::from_value)
}

/// Some members of a `result.json` of any program: those that `members` names by their paths, such as `verdict` and
/// `measurands.id`. All others are as in an empty record, whatever stands there: another program may use their names for
/// something else.
///
/// # Errors
/// As [`from_slice`]; and where no unit, no verdict or no measurands are named, or a row has no id.
pub fn of_any_program(bytes: &[u8], members: &[&str]) -> Result<RunRecord, ReadError> {
    read_as(bytes, RESULT_FORMAT, |given| with_members(given, members))
}

/// [`of_any_program`] of a value that was parsed.
pub(crate) fn with_members(given: Value, members: &[&str]) -> serde_json::Result<RunRecord> {
    for name in REQUIRED_OF_ANY_PROGRAM {
        if given.get(name).is_none_or(Value::is_null) {
            return Err(serde_json::Error::missing_field(name));
        }
    }
    let mut all = serde_json::to_value(RunRecord::default())?;
    if let (Value::Object(all), Value::Object(given)) = (&mut all, selected(given, members)) {
        all.extend(given);
    }
    let record: RunRecord = null_numbers::from_value(all)?;
    if record.measurands.iter().any(|row| row.id.is_empty()) {
        return Err(serde_json::Error::missing_field("id"));
    }
    Ok(record)
}

/// The members at some paths, in every element of a list, as far as they are there and not `null`.
fn selected(given: Value, paths: &[&str]) -> Value {
    match given {
        Value::Array(list) => list.into_iter().map(|element| selected(element, paths)).collect(),
        Value::Object(members) => {
            let mut kept = Map::new();
            for (name, value) in members.into_iter().filter(|(_, value)| !value.is_null()) {
                let below: Vec<&str> =
                    paths.iter().filter_map(|path| path.strip_prefix(name.as_str())).collect();
                let deeper: Vec<&str> = below.iter().filter_map(|path| path.strip_prefix('.')).collect();
                if below.contains(&"") {
                    kept.insert(name, value);
                } else if !deeper.is_empty() {
                    kept.insert(name, selected(value, &deeper));
                }
            }
            Value::Object(kept)
        }
        other => other,
    }
}

/// The value of a file of the format `expected`, by a function that reads its JSON.
fn read_as<T>(
    bytes: &[u8],
    expected: &'static str,
    read: impl FnOnce(Value) -> serde_json::Result<T>,
) -> Result<T, ReadError> {
    if bytes.len() > MAX_BYTES {
        return Err(ReadError::TooLarge);
    }
    let value: Value = serde_json::from_slice(bytes).map_err(ReadError::NotJson)?;
    let kind = |format: &str| format.split('/').next().map(str::to_owned);
    match value.get("format").and_then(Value::as_str) {
        Some(found) if found == expected => {}
        Some(found) if kind(found) == kind(expected) => {
            return Err(ReadError::OtherVersion { found: found.to_owned(), expected });
        }
        _ => return Err(ReadError::Foreign { expected }),
    }
    read(value).map_err(|e| ReadError::Malformed { expected, reason: e.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Limits, Verdict};

    #[test]
    fn members_that_are_not_asked_for_may_be_anything() {
        let text = r#"{"format": "result/1", "unit_under_test": {"serial": "7", "lot": null, "attributes": 3},
            "verdict": "fail", "window": "all", "notes": ["free"], "recording": [{"samples": "many"}, {"bytes": 8}],
            "measurands": [{"id": "static_bias", "value": null, "method": null, "notes": ["free"],
                "limit": {"max": 2, "rule": "own"}}]}"#;
        let members = [
            "unit_under_test.serial",
            "unit_under_test.lot",
            "verdict",
            "recording.bytes",
            "measurands.id",
            "measurands.value",
            "measurands.method",
            "measurands.limit.max",
        ];
        let read = of_any_program(text.as_bytes(), &members).unwrap();
        assert_eq!((read.unit_under_test.serial.as_deref(), read.verdict), (Some("7"), Verdict::Fail));
        assert_eq!(read.recording.iter().map(|f| f.bytes).collect::<Vec<_>>(), [0, 8]);
        let row = &read.measurands[0];
        assert!(row.identifiable && row.value.is_none() && row.method.is_empty());
        assert_eq!(row.limits(), Limits { min: None, max: Some(2.0) });
        assert!(from_slice(text.as_bytes()).is_err(), "it is no whole result");
    }

    #[test]
    fn what_every_result_has_is_asked_for_by_name() {
        let refused = |text: &str| match of_any_program(text.as_bytes(), &["verdict", "measurands.id"]) {
            Err(ReadError::Malformed { reason, .. }) => reason,
            other => panic!("{other:?}"),
        };
        let unit = r#"{"format": "result/1", "unit_under_test": {}"#;
        assert!(refused(r#"{"format": "result/1"}"#).contains("unit_under_test"));
        assert!(refused(&format!(r#"{unit}, "verdict": null}}"#)).contains("verdict"));
        assert!(refused(&format!(r#"{unit}, "verdict": "pass", "measurands": [{{}}]}}"#)).contains("`id`"));
        assert!(refused(&format!(r#"{unit}, "verdict": "fine", "measurands": []}}"#)).contains("fine"));
    }

    #[test]
    fn broken_files_are_refused_each_by_its_cause() {
        let refused = |text: &str| from_slice(text.as_bytes()).unwrap_err();
        for text in ["", "gyro", "{\"format\": \"result/1\"", &"[".repeat(100_000)] {
            assert!(matches!(refused(text), ReadError::NotJson(_)), "{text:.20}");
        }
        for text in ["{}", "1", "[]", "null", "{\"format\": \"comparison/1\"}", "{\"format\": 1}"] {
            assert!(matches!(refused(text), ReadError::Foreign { .. }), "{text}");
        }
        for version in ["result/0", "result/2"] {
            let refused = refused(&format!("{{\"format\": \"{version}\"}}"));
            assert!(matches!(refused, ReadError::OtherVersion { found, .. } if found == version));
        }
        assert!(matches!(refused("{\"format\": \"result/1\"}"), ReadError::Malformed { .. }));
        assert!(matches!(refused("{\"format\": \"result/1\", \"kind\": 3}"), ReadError::Malformed { .. }));
    }
}
