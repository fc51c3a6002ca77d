//! Decoders may panic on damaged input, above all those of other crates: the panic becomes an error of the file.
//!
//! Every format is opened, and every decoder on a thread of its own is run, by [`guarded`]. No panic hook is set here: a
//! program that wants no message of such a panic on its terminal sets one that asks [`decoder_is_running`].

use crate::error::{IngestError, IngestErrorKind};
use sagnac_core::message::note;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// True while this thread runs a decoder whose panics are caught and reported as an error of the file. For the panic hook
/// of a program.
pub fn decoder_is_running() -> bool {
    GUARDED.get()
}

/// Runs a decoder on this thread; what it holds must not be used again when it fails.
///
/// # Errors
/// Its own, and [`IngestErrorKind::Damaged`] where it panics.
pub(super) fn guarded<T>(
    path: &Path,
    decoder: impl FnOnce() -> Result<T, IngestError>,
) -> Result<T, IngestError> {
    let outer = GUARDED.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(decoder));
    GUARDED.set(outer);
    outcome.unwrap_or_else(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("");
        Err(IngestError::new(
            IngestErrorKind::Damaged,
            path,
            note!("ingest.guarded.gave_up", reason = format!("`{said}`")),
        )
        .hint("ingest.hint.damaged"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::english::english;

    #[test]
    fn a_panic_becomes_an_error_of_the_file() {
        let path = Path::new("unit.rec");
        let outcome: Result<(), _> = guarded(path, || {
            assert!(decoder_is_running());
            let inner = guarded(path, || Ok(1));
            assert!(inner.is_ok() && decoder_is_running());
            panic!("index out of range")
        });
        assert!(!decoder_is_running());
        let error = outcome.unwrap_err();
        assert_eq!(error.kind(), IngestErrorKind::Damaged);
        assert!(english(&error.note()).contains("index out of range"));
    }
}
