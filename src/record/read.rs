//! Reads a `result.json` back into a [`RunRecord`].

use super::{RESULT_FORMAT, RunRecord};
use serde::Deserialize;

/// Largest file that is read, bytes; results of shipped samples take about a tenth of a megabyte.
pub const MAX_BYTES: usize = 256 << 20;

/// Why a file is no result that this program reads.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReadError {
    /// The file is larger than [`MAX_BYTES`].
    #[error("the result has {bytes} bytes; at most {MAX_BYTES} are read")]
    TooLarge {
        /// Its size.
        bytes: usize,
    },
    /// It is not JSON, or it is cut off.
    #[error("the file is not JSON: {0}")]
    NotJson(String),
    /// It is JSON without a text `format`.
    #[error("the file names no result format; `{RESULT_FORMAT}` is read")]
    NoFormat,
    /// It names a format of another kind or version.
    #[error("the file has the format `{found}`; `{RESULT_FORMAT}` is read")]
    OtherFormat {
        /// The format that it names.
        found: String,
    },
    /// It names the right format, and a field is missing or of another type.
    #[error("the file does not follow `{RESULT_FORMAT}`: {0}")]
    Malformed(String),
}

#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    format: Option<serde_json::Value>,
}

/// The record that the bytes of a `result.json` hold.
///
/// # Errors
/// [`ReadError`] where the bytes are too many, not JSON, of another format or version, or do not follow the format.
pub fn from_slice(bytes: &[u8]) -> Result<RunRecord, ReadError> {
    if bytes.len() > MAX_BYTES {
        return Err(ReadError::TooLarge { bytes: bytes.len() });
    }
    let header: Header = serde_json::from_slice(bytes).map_err(|e| match e.classify() {
        serde_json::error::Category::Data => ReadError::NoFormat,
        _ => ReadError::NotJson(e.to_string()),
    })?;
    match header.format {
        Some(serde_json::Value::String(format)) if format == RESULT_FORMAT => {}
        Some(serde_json::Value::String(found)) => return Err(ReadError::OtherFormat { found }),
        _ => return Err(ReadError::NoFormat),
    }
    serde_json::from_slice(bytes).map_err(|e| ReadError::Malformed(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_files_are_refused_each_by_its_cause() {
        let refused = |text: &str| from_slice(text.as_bytes()).unwrap_err();
        for text in ["", "gyro", "{\"format\": \"result/1\"", &"[".repeat(100_000)] {
            assert!(matches!(refused(text), ReadError::NotJson(_) | ReadError::NoFormat), "{text:.20}");
        }
        for text in ["{}", "1", "[]", "null", "{\"format\": 1}"] {
            assert_eq!(refused(text), ReadError::NoFormat, "{text}");
        }
        assert_eq!(
            refused("{\"format\": \"result/0\"}"),
            ReadError::OtherFormat { found: "result/0".into() }
        );
        assert!(matches!(refused("{\"format\": \"result/1\"}"), ReadError::Malformed(_)));
        assert!(matches!(refused("{\"format\": \"result/1\", \"kind\": 3}"), ReadError::Malformed(_)));
    }
}
