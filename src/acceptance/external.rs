//! Rows of results of other tests, as their certificates state them.

use super::derived::own_row;
use crate::config::external::ExternalSpec;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::estimate::{Estimate, Spread};
use crate::i18n::note;
use crate::record::{ExternalResult, MeasurandRecord, UnitUnderTest};
use crate::units::Unit;

/// Method of these rows.
const METHOD: &str = "external";

/// The rows that a procedure asks for: stated for the unit, or else by the procedure. One that nobody states is there too and
/// decides nothing.
pub(super) fn rows(
    procedure: &Procedure,
    limits: &EffectiveLimits,
    unit: &UnitUnderTest,
) -> Vec<MeasurandRecord> {
    let row = |spec: &ExternalSpec| {
        let of_unit = unit.external.iter().find(|r| r.id == spec.id);
        let estimate = match of_unit.or(spec.stated.as_ref()) {
            Some(result) => estimate(result, &spec.unit),
            None => not_stated().note(note!("external.missing")),
        };
        own_row(&estimate, &spec.id, &spec.unit, limits)
    };
    procedure.externals.iter().map(row).collect()
}

fn not_stated() -> Estimate {
    Estimate::not_identifiable("", "", None, "", METHOD)
}

/// A stated result in the unit of the row.
fn estimate(result: &ExternalResult, unit: &Unit) -> Estimate {
    let factor = Unit::parse(&result.unit).ok().and_then(|given| given.factor_to(unit).ok());
    let Some(factor) = factor else {
        let (given, unit) = (result.unit.as_str(), unit.text());
        return not_stated().note(note!("external.other_unit", given, unit));
    };
    let value = factor * result.value;
    let spread = match result.interval {
        Some([low, high]) => Spread::of_interval(factor * low, value, factor * high),
        None => Spread::Unknown,
    };
    let text = |of: &Option<String>| of.clone().unwrap_or_else(|| "–".to_owned());
    let told = note!(
        "external.certificate",
        certificate = text(&result.certificate),
        laboratory = text(&result.laboratory),
        sha256 = text(&result.sha256)
    );
    Estimate::measured("", "", value, "", spread, METHOD).note(told)
}
