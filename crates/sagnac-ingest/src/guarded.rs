//! Decoders of other hands that may panic on damaged input: the panic becomes an error of the file, without a word on
//! the terminal.

use super::{IngestError, IngestErrorKind};
use sagnac_core::message::Note;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::path::Path;
use std::sync::Once;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder on this thread; what it holds must not be used again when it fails.
///
/// # Errors
/// Its own, and [`IngestErrorKind::Damaged`] where it panics.
pub(super) fn guarded<T>(
    path: &Path,
    decoder: impl FnOnce() -> Result<T, IngestError>,
) -> Result<T, IngestError> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !GUARDED.get() {
                before(panic);
            }
        }));
    });
    let outer = GUARDED.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(decoder));
    GUARDED.set(outer);
    outcome.unwrap_or_else(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("");
        Err(IngestError::new(
            IngestErrorKind::Damaged,
            path,
            Note::new("ingest.guarded.gave_up").with("reason", format!("`{said}`")),
        )
        .hint("ingest.hint.damaged"))
    })
}
