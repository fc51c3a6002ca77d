//! What the results of some units promise of the population that they come from.

use super::Error;
use crate::acceptance::datasheet::{Refusal, TestedUnit, datasheet, select};
use crate::i18n::{Lang, Note, note};
use crate::lot::tolerance::Promise;
use crate::moment;
use crate::output::Kind;
use crate::report::Results;
use chrono::SecondsFormat;
use rayon::prelude::*;
use std::path::Path;

/// Probabilities that a promise may state: beyond, neither the sample nor the arithmetic tells anything.
const PROMISE_PROBABILITIES: std::ops::RangeInclusive<f64> = 0.5..=0.9999;

/// A result that a data sheet is made of.
pub enum SheetSource<'a> {
    /// A `result.json` file or its folder.
    Path(&'a Path),
    /// A result in memory, and the name that the sheet gives it.
    Result(&'a Results, &'a str),
}

/// Makes the data sheet of some results.
///
/// # Errors
/// [`Error::is_argument`] for a file that is no result, when no result is left, when the results are of several models or
/// procedures, or for a probability outside 0.5 to 0.9999.
pub fn data_sheet(results: &[SheetSource<'_>], promise: Promise) -> Result<Results, Error> {
    for (option, given) in [("proportion", promise.proportion), ("confidence", promise.confidence)] {
        if !PROMISE_PROBABILITIES.contains(&given) {
            let note = note!("datasheet.refused.probability", option);
            return Err(Error::argument(note.with("given", given.to_string())));
        }
    }
    let units: Result<Vec<TestedUnit>, Note> = results.par_iter().map(tested).collect();
    let selected = select(units.map_err(Error::argument)?).map_err(|refusal| match refusal {
        Refusal::None => Error::argument("datasheet.refused.none"),
        Refusal::Mixed(note) => Error::argument(note),
    })?;
    let now = moment::now().to_rfc3339_opts(SecondsFormat::Secs, true);
    Ok(Results::of_datasheet(datasheet(selected, promise, now)))
}

fn tested(source: &SheetSource<'_>) -> Result<TestedUnit, Note> {
    match source {
        SheetSource::Path(path) if path.is_dir() => TestedUnit::read(&path.join(Kind::Result.record_file())),
        SheetSource::Path(path) => TestedUnit::read(path),
        SheetSource::Result(results, name) => {
            let document = results.whole(Lang::En);
            let record = serde_json::to_vec(&document.record()).unwrap_or_default();
            TestedUnit::in_memory(&record, Path::new(name), document.tables)
        }
    }
}
