//! What the results of some units promise of the population that they come from.

use super::Error;
use crate::acceptance::datasheet::{Refusal, TestedUnit, datasheet, select};
use crate::i18n::Note;
use crate::lot::tolerance::Promise;
use crate::output::Kind;
use crate::report::Results;
use chrono::{SecondsFormat, Utc};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Probabilities that a promise may state: beyond, neither the sample nor the arithmetic tells anything.
const PROBABILITIES: std::ops::RangeInclusive<f64> = 0.5..=0.9999;

/// Makes the data sheet of some results: `result.json` files or their folders.
///
/// # Errors
/// [`Error::is_argument`] for a file that is no result, when no result is left, when the results are of several models or
/// procedures, or for a probability outside 0.5 to 0.9999.
pub fn data_sheet<P: AsRef<Path> + Sync>(results: &[P], promise: Promise) -> Result<Results, Error> {
    for (option, given) in [("proportion", promise.proportion), ("confidence", promise.confidence)] {
        if !PROBABILITIES.contains(&given) {
            let note = Note::new("datasheet.refused.probability").with("option", option);
            return Err(Error::argument(note.with("given", given.to_string())));
        }
    }
    let file = |path: &Path| -> PathBuf {
        if path.is_dir() { path.join(Kind::Result.record_file()) } else { path.to_owned() }
    };
    let units: Result<Vec<TestedUnit>, Note> =
        results.par_iter().map(|path| TestedUnit::read(&file(path.as_ref()))).collect();
    let selected = select(units.map_err(Error::argument)?).map_err(|refusal| match refusal {
        Refusal::None => Error::argument("datasheet.refused.none"),
        Refusal::Mixed(note) => Error::argument(note),
    })?;
    let now = Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true);
    Ok(Results::of_datasheet(datasheet(selected, promise, now)))
}
