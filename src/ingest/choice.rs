//! Which format reads a file, and what its metadata say of the unit under test.

use super::error::{IngestError, IngestErrorKind};
use super::{Candidate, FORMATS, Format};
use crate::text::Note;

/// The format that the user states, else the first that recognises the file.
///
/// # Errors
/// A file that no format recognises, a format that is not known, or one that the content contradicts.
pub(super) fn format(file: &Candidate) -> Result<&'static dyn Format, IngestError> {
    let unknown = |message: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, message);
    let Some(stated) = file.options.format.as_deref() else {
        let found = FORMATS.iter().find(|f| f.recognises(file)).copied();
        return found.ok_or_else(|| unknown(Note::new("ingest.unknown")).hint("ingest.hint.give_known"));
    };
    let ids = || FORMATS.iter().map(|f| f.id()).collect::<Vec<_>>().join(", ");
    let Some(format) = FORMATS.iter().find(|f| f.id() == stated) else {
        return Err(unknown(Note::new("ingest.stated.no_such_format").with("format", stated))
            .hint(Note::new("ingest.stated.formats").with("formats", ids())));
    };
    if format.recognises(file) {
        return Ok(*format);
    }
    Err(unknown(Note::new("ingest.stated.not_this_format").with("format", stated))
        .hint("ingest.stated.hint_format"))
}

/// Keys under which files state the serial number of a unit, without signs and in lower case.
const SERIAL_KEYS: &[&str] = &[
    "serial",
    "serialnumber",
    "serialno",
    "serialnum",
    "sn",
    "unitserial",
    "deviceserial",
    "deviceserialnumber",
    "зав",
    "завномер",
    "заводскойномер",
    "заводской",
    "номерприбора",
    "серийныйномер",
];

/// The serial number among metadata.
pub(super) fn serial(metadata: &[(String, String)]) -> Option<&str> {
    let plain = |key: &str| -> String {
        key.chars().filter(|c| c.is_alphanumeric() && *c != '№').flat_map(char::to_lowercase).collect()
    };
    let stated = metadata.iter().find(|(key, _)| SERIAL_KEYS.contains(&plain(key).as_str()));
    stated.map(|(_, value)| value.trim().trim_start_matches('№').trim()).filter(|v| !v.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serial_numbers_stand_under_many_keys() {
        for key in [
            "serial",
            "Serial Number",
            "serial_number",
            "S/N",
            "sn",
            "SN.",
            "Зав. №",
            "зав.№",
            "Заводской номер",
            "заводской №",
            "Номер прибора",
            "Serial No.",
        ] {
            let metadata = [("rate".to_owned(), "10".to_owned()), (key.to_owned(), " SN-0042 ".to_owned())];
            assert_eq!(serial(&metadata), Some("SN-0042"), "{key}");
        }
        for key in ["snow", "number", "прибор", "serialisation"] {
            assert_eq!(serial(&[(key.to_owned(), "1".to_owned())]), None, "{key}");
        }
    }
}
