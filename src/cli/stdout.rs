//! Standard output. Every write and every flush is checked: what did not reach a disk that is full was not said, and the command
//! did not succeed. A reader that went away (`| head`) is no error.

use super::printer::choice;
use super::{exit, place};
use crate::i18n::{Lang, Note, io_reason};
use anstream::AutoStream;
use std::io::{self, ErrorKind, Write};
use std::sync::{Mutex, PoisonError};

/// The first failure of this process.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Writes bytes as they are.
pub fn write(bytes: &[u8]) {
    let mut out = io::stdout().lock();
    check(out.write_all(bytes).and_then(|()| out.flush()));
}

/// Writes text with its control sequences, or without them where colours are not wanted.
pub fn write_styled(text: &str) {
    let mut out = AutoStream::new(io::stdout().lock(), choice());
    check(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
}

/// Takes note of what came of a write.
pub fn check(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        FAILED.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }
}

/// The exit code of a command that would end with `code`: where a part of what it said could not be written, it did not
/// succeed.
pub fn settled(code: u8, lang: Lang) -> u8 {
    check(io::stdout().lock().flush());
    match FAILED.lock().unwrap_or_else(PoisonError::into_inner).take() {
        Some(error) => {
            let note = Note::new("system.stdout").with("reason", io_reason(&error));
            place::eprint_diagnostic(&place::error(&note, lang));
            exit::ERROR
        }
        None => code,
    }
}
