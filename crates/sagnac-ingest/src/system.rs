//! What the operating system answers, in words of the tables.

use super::named_file::FileFault;
use sagnac_core::message::{Note, note};
use std::io::{Error, ErrorKind};

/// The reason of an error of the operating system as a note; a reason without a translation is quoted as it is.
pub fn io_reason(error: &Error) -> Note {
    match FileFault::of(error) {
        Some(FileFault::Special) => return note!("system.no_file"),
        Some(FileFault::TooLarge { most }) => return note!("system.too_large", most),
        None => {}
    }
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
        _ => note!("system.other", reason = error.to_string()),
    }
}
