//! Quantities by a formula: reading, checks without data, and limits.

pub use super::derived_rows::{DerivedLimit, DerivedSpec, Stated};
use super::diagnostics::Span;
use super::limit_set::gyro_of;
use super::model::Procedure;
use super::quantity;
use super::reader::{Reader, meant, shorten};
use super::tables::derived::{DerivedKeys, DerivedLimitKeys};
use crate::formula::{Channels, Formula, Reference};
use crate::i18n::{Note, note};
use crate::measurand;
use crate::units::Unit;
use sagnac_core::spelling::nearest;

/// Reads the formulas.
pub(super) fn read(tables: Vec<DerivedKeys>, reader: &mut Reader<'_>) -> Vec<DerivedSpec> {
    let mut found = vec![];
    for keys in tables {
        let (Some(id), Some(unit), Some(text)) = (keys.id, keys.unit, keys.value) else { continue };
        let span = reader.source.inside_quotes(&keys.section.span_of("value"));
        match Formula::parse(&text) {
            Ok(formula) => {
                let id_span = keys.section.span_of("id");
                found.push(DerivedSpec { id, unit, formula, span, id_span });
            }
            Err(e) => {
                let at = span.start + e.span.start..span.start + e.span.end;
                reader.error(&at, e.message, Some("derived.help.grammar".into()));
            }
        }
    }
    found
}

/// Reads the limits.
pub(super) fn read_limits(tables: Vec<DerivedLimitKeys>, reader: &mut Reader<'_>) -> Vec<DerivedLimit> {
    let mut found: Vec<DerivedLimit> = vec![];
    for keys in tables {
        let DerivedLimitKeys { derived: Some(derived), min, max, rule, risk, section } = keys else {
            continue;
        };
        if min.is_none() && max.is_none() {
            reader.error(&section.span, note!("derived.no_bound", id = shorten(&derived)), None);
            continue;
        }
        if found.iter().any(|l| l.derived == derived) {
            reader.error(&section.span, note!("derived.second_limit", id = shorten(&derived)), None);
            continue;
        }
        let mut bound = |key: &'static str, text: Option<String>| {
            let span = reader.source.inside_quotes(&section.span_of(key));
            text.and_then(|text| stated(&text, span, reader))
        };
        let (min, max) = (bound("min", min), bound("max", max));
        let source = reader.source.name.clone();
        found.push(DerivedLimit { derived, min, max, rule, risk, source, span: section.span });
    }
    found
}

/// A number with its unit; a number alone is a pure one.
fn stated(text: &str, span: Span, reader: &mut Reader<'_>) -> Option<Stated> {
    let (value, unit) = match quantity::split(text) {
        Ok(found) => found,
        Err(e) => {
            let at = span.start + e.span.start..span.start + e.span.end;
            reader.error(&at, e.message, e.help);
            return None;
        }
    };
    let unit = if unit.is_empty() { Ok(Unit::pure()) } else { Unit::parse(unit) };
    match unit {
        Ok(unit) => Some(Stated { value, unit, span }),
        Err(e) => {
            reader.error(&span, e.note(), None);
            None
        }
    }
}

/// Reports formulas that no recording could give a value for, and limits that are for none of them.
pub(super) fn validate(procedure: &Procedure, reader: &mut Reader<'_>) {
    for (i, spec) in procedure.derived.iter().enumerate() {
        let earlier = procedure.derived.get(..i).unwrap_or_default();
        let at = reader.source.inside_quotes(&spec.id_span);
        if measurand::find(&spec.id).is_some() || measurand::called(&spec.id).is_some() {
            let help = Some("derived.help.own_id".into());
            reader.error(&at, note!("derived.of_standard", id = spec.id.as_str()), help);
        }
        if earlier.iter().any(|other| other.id == spec.id)
            || procedure.unit_from_elsewhere(&spec.id).is_some()
        {
            reader.error(&at, note!("derived.twice", id = spec.id.as_str()), None);
        }
        unit_fits(procedure, spec, earlier, reader);
    }
    for limit in &procedure.limits.derived {
        if let Some((span, message)) = unusable(procedure, limit) {
            reader.error(&span, message, None);
        }
    }
}

/// Why a limit is for no quantity of a procedure, and where that stands; `None` where it is for one.
pub(super) fn unusable(procedure: &Procedure, limit: &DerivedLimit) -> Option<(Span, Note)> {
    let derived = procedure.derived.iter().find(|d| d.id == limit.derived).map(|d| &d.unit);
    let Some(unit) = derived.or_else(|| procedure.unit_from_elsewhere(&limit.derived)) else {
        let message =
            note!("derived.no_such", id = shorten(&limit.derived), procedure = procedure.id.as_str());
        return Some((limit.span.clone(), message));
    };
    let wrong = limit.in_unit(unit).err();
    wrong.map(|(bound, e)| (bound.span.clone(), e.note()))
}

/// The parts of a formula have units that fit, and the whole measures what its unit says.
fn unit_fits(procedure: &Procedure, spec: &DerivedSpec, earlier: &[DerivedSpec], reader: &mut Reader<'_>) {
    let shifted = |span: &Span| spec.span.start + span.start..spec.span.start + span.end;
    let mut units = vec![];
    for (reference, place) in &spec.formula.references {
        match unit_of(procedure, reference, earlier) {
            Ok(unit) => units.push(unit),
            Err((message, help)) => reader.error(&shifted(place), message, help),
        }
    }
    if units.len() < spec.formula.references.len() {
        return;
    }
    match spec.formula.unit(&units) {
        Err(e) => reader.error(&shifted(&e.span), e.message, None),
        Ok(unit) => {
            if let Err(e) = unit.factor_to(&spec.unit) {
                reader.error(&spec.span, e.note(), Some("derived.help.unit".into()));
            }
        }
    }
}

/// The unit of a quantity that a formula names.
fn unit_of(
    procedure: &Procedure,
    reference: &Reference,
    earlier: &[DerivedSpec],
) -> Result<Unit, (Note, Option<Note>)> {
    let channel = match &reference.of {
        Channels::Named(channel) => Some(channel.as_str()),
        Channels::Own | Channels::Worst => None,
    };
    if let Some(channel) = channel
        && procedure.gyro_channels().all(|c| c.channel.id != gyro_of(channel))
    {
        let known: Vec<&str> = procedure.gyro_channels().map(|c| c.channel.id.as_str()).collect();
        let message = note!("derived.no_channel", channel = shorten(channel), known = known.join(", "));
        return Err((message, nearest(channel, known).map(meant)));
    }
    if let Some(other) = earlier.iter().find(|d| d.id == reference.id) {
        return Ok(other.unit.clone());
    }
    let Some(found) = measurand::find(&reference.id) else {
        let own = procedure.measurands.iter().map(|m| m.measurand.id);
        let known: Vec<&str> = own.chain(earlier.iter().map(|d| d.id.as_str())).collect();
        let called = measurand::called(&reference.id).map(|m| m.id);
        let near = called.or_else(|| nearest(&reference.id, known));
        return Err((note!("derived.unknown", id = shorten(&reference.id)), near.map(meant)));
    };
    if !procedure.measures(found.id, channel.map(gyro_of)) {
        let help = note!("check.help.measure", id = found.id);
        return Err((note!("derived.not_measured", id = found.id), Some(help)));
    }
    Unit::parse(found.unit).map_err(|_| (note!("derived.as_recorded", id = found.id), None))
}
