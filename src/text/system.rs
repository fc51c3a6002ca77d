//! What the operating system answers, in words of the tables.

use super::Note;
use std::io::{Error, ErrorKind};

/// Why the operating system refused, as a note. A reason that the tables do not know is shown as the system says it.
pub fn io_reason(error: &Error) -> Note {
    let key = match error.kind() {
        ErrorKind::NotFound => "system.not_found",
        ErrorKind::PermissionDenied => "system.permission_denied",
        ErrorKind::AlreadyExists => "system.already_exists",
        ErrorKind::StorageFull => "system.storage_full",
        ErrorKind::ReadOnlyFilesystem => "system.read_only",
        ErrorKind::NotADirectory => "system.not_a_folder",
        ErrorKind::IsADirectory => "system.is_a_folder",
        ErrorKind::DirectoryNotEmpty => "system.not_empty",
        ErrorKind::QuotaExceeded => "system.quota",
        _ => "",
    };
    match error.raw_os_error() {
        Some(code) if !key.is_empty() => Note::new(key).with("code", code.to_string()),
        _ => Note::new("system.other").with("reason", error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Lang;

    #[cfg(target_os = "linux")]
    #[test]
    fn english_is_what_the_system_says_and_russian_is_russian() {
        for code in [2, 13, 17, 28, 30, 20, 21, 39, 122] {
            let error = Error::from_raw_os_error(code);
            assert_eq!(io_reason(&error).say(Lang::En), error.to_string());
            let russian = io_reason(&error).say(Lang::Ru);
            assert!(!russian.contains("rror") && russian.contains(&code.to_string()), "{russian}");
        }
        let own = Error::other("odd");
        assert_eq!(io_reason(&own).say(Lang::Ru), "odd");
    }
}
