//! Russian against Allan figures of units.

use super::{Error, RunResult};
use crate::acceptance::compare::{Comparison, Origin, Unit, mark_repeated, name_apart, units_of};
use crate::moment;
use crate::report::Results;
use chrono::SecondsFormat;

/// A result that is compared.
pub struct Compared<'a> {
    /// The result.
    pub result: &'a RunResult,
    /// Name of its unit, where it states no serial number.
    pub name: &'a str,
    /// Where it was read from, as the table shows it.
    pub path: &'a str,
    /// Whether it was read as a result, or made from a recording for the comparison.
    pub origin: Origin,
}

/// Compares results: Russian against Allan figures of each unit.
///
/// # Errors
/// [`Error::is_argument`] for a result that holds none of the figures that are compared.
pub fn compare(results: &[Compared<'_>]) -> Result<Results, Error> {
    let mut units: Vec<Unit> = vec![];
    for one in results {
        let found = units_of(one.result.record(), one.path, one.name, one.origin);
        units.extend(found.map_err(Error::argument)?);
    }
    name_apart(&mut units);
    mark_repeated(&mut units);
    let now = moment::now().to_rfc3339_opts(SecondsFormat::Secs, true);
    Ok(Results::of_comparison(Comparison::of_units(units, now)))
}
