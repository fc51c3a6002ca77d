//! `sagnac inspect`: what a recording holds and which tests it can support, in plain text.
//!
//! Columns are told apart first (`columns`), the recording is read once (`collect`), every judgement is made from
//! what was collected (`clock_check`, `support`), and the words are laid out last (`show`).

mod clock_check;
mod collect;
mod columns;
mod layout;
mod quantity;
mod show;
mod show_gyro;
mod support;
mod tracks;

use crate::acceptance::column_choice::ColumnChoice;
use crate::acceptance::request::RunError;
use crate::i18n::Lang;
use crate::ingest::Source;
use std::path::Path;

/// Reads a recording and says what it holds. `sample_rate_hz` is used where no time column serves, and
/// before what the file states; `progress` gets bytes read and bytes in all.
///
/// # Errors
/// [`RunError::Ingest`] when the file cannot be read at all, or holds no column of numbers.
pub fn inspect(
    path: &Path,
    sample_rate_hz: Option<f64>,
    lang: Lang,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<String, RunError> {
    inspect_source(&crate::ingest::open(path)?, sample_rate_hz, lang, progress)
}

/// The same for an opened recording.
///
/// # Errors
/// As [`inspect`].
pub fn inspect_source(
    source: &Source,
    sample_rate_hz: Option<f64>,
    lang: Lang,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<String, RunError> {
    inspect_columns(source, &ColumnChoice { sample_rate_hz, ..ColumnChoice::default() }, lang, progress)
}

/// The same with columns as the user chooses them.
///
/// # Errors
/// As [`inspect`], and columns that are not there.
pub fn inspect_columns(
    source: &Source,
    choice: &ColumnChoice,
    lang: Lang,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<String, RunError> {
    let found = collect::collect(source, choice, progress)?;
    Ok(show::text(source, &found, lang))
}

#[cfg(test)]
mod tests;
