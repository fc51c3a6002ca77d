//! Diagnostics in English, for tests: the table belongs to the program.

use sagnac_core::message::Note;
use std::sync::LazyLock;

static TABLE: LazyLock<toml::Table> =
    LazyLock::new(|| include_str!("../../../templates/locale/en.toml").parse().unwrap_or_default());

/// The sentence of a note.
pub fn english(note: &Note) -> String {
    note.render(&|key| {
        let mut parts = key.split('.');
        let first = TABLE.get(parts.next()?)?;
        parts.try_fold(first, |at, part| at.get(part))?.as_str()
    })
}
