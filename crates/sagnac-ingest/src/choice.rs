//! Which format reads a file, and what its metadata say of the unit under test.

use super::error::{IngestError, IngestErrorKind, shorten};
use super::{Candidate, FORMATS, Format};
use sagnac_core::message::{Arg, Note};
use sagnac_core::spelling::nearest;

/// First bytes of kinds of files that are not read, with the keys of what they are and what to do about them.
const NOT_READ: &[(&[u8], &str, &str)] = &[
    (b"PK\x03\x04", "ingest.kind.zip", "ingest.hint.export_sheet"),
    (b"SQLite format 3\0", "ingest.ros.sqlite", "ingest.ros.hint.convert"),
    (b"%PDF", "ingest.kind.pdf", "ingest.hint.give_recording"),
    (b"7z\xbc\xaf", "ingest.kind.seven_zip", "ingest.hint.unpack"),
    (b"BZh", "ingest.kind.bzip2", "ingest.hint.repack"),
    (b"\xfd7zXZ", "ingest.kind.xz", "ingest.hint.repack"),
];

/// The format that the user states, else the first that recognises the file.
///
/// # Errors
/// A file that no format recognises, a format that is not known, or one that the content contradicts.
pub(super) fn format(file: &Candidate) -> Result<&'static dyn Format, IngestError> {
    let unknown = |message: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, message);
    let Some(stated) = file.options.format.as_deref() else { return found(file) };
    let ids = || FORMATS.iter().map(|f| f.id());
    let Some(format) = FORMATS.iter().find(|f| f.id() == stated) else {
        let hint = match nearest(stated, ids()) {
            Some(near) => Note::new("ingest.hint.did_you_mean").with("name", near),
            None => Note::new("ingest.stated.formats").with("formats", ids().collect::<Vec<_>>().join(", ")),
        };
        let note = Note::new("ingest.stated.no_such_format").with("format", shorten(stated));
        return Err(unknown(note).hint(hint));
    };
    if format.may_be(file) {
        return Ok(*format);
    }
    Err(unknown(Note::new("ingest.stated.not_this_format").with("format", stated))
        .hint("ingest.stated.hint_format"))
}

/// The format that recognises a file.
fn found(file: &Candidate) -> Result<&'static dyn Format, IngestError> {
    let unknown = |note: Note| IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note);
    let recognised = FORMATS.iter().find(|f| f.recognises(file));
    // Text is whatever looks like lines, so that kinds known by their first bytes go before it.
    let other = NOT_READ.iter().find(|(magic, ..)| file.head.starts_with(magic));
    match (recognised, other) {
        (Some(format), other) if other.is_none() || format.id() != "csv" => Ok(*format),
        (_, Some((_, what, hint))) => {
            let what = Arg::Key((*what).to_owned());
            Err(unknown(Note::new("ingest.not_read").with("what", what)).hint(*hint))
        }
        _ => {
            let ids: Vec<&str> = FORMATS.iter().map(|f| f.id()).collect();
            let hint = Note::new("ingest.formats.give").with("ids", ids.join(", "));
            Err(unknown("ingest.formats.unknown".into()).hint(hint))
        }
    }
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

/// The serial numbers among metadata, each once.
pub(super) fn serials(metadata: &[(String, String)]) -> Vec<&str> {
    let plain = |key: &str| -> String {
        key.chars().filter(|c| c.is_alphanumeric() && *c != '№').flat_map(char::to_lowercase).collect()
    };
    let mut found: Vec<&str> = Vec::new();
    for (_, value) in metadata.iter().filter(|(key, _)| SERIAL_KEYS.contains(&plain(key).as_str())) {
        let value = value.trim().trim_start_matches('№').trim();
        if !value.is_empty() && !found.contains(&value) {
            found.push(value);
        }
    }
    found
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
            assert_eq!(serials(&metadata), ["SN-0042"], "{key}");
        }
        for key in ["snow", "number", "прибор", "serialisation"] {
            assert!(serials(&[(key.to_owned(), "1".to_owned())]).is_empty(), "{key}");
        }
    }
}
