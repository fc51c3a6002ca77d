//! Results of other tests, in procedures and manifests: what no recording shows, so that one report is complete.

use super::reader::{Reader, shorten};
use super::section::Section;
use super::table::Table;
use crate::i18n::note;
use crate::record::ExternalResult;
use crate::units::Unit;

/// Characters of a SHA-256, hexadecimal.
const SHA256_DIGITS: usize = 64;

/// A result of another test of the unit, such as leak, insulation, mass or EMC. A procedure states `id` and `unit` of what it
/// asks for; the manifest of a unit states the result. It has a row of its own, and limits by [[derived_limit]].
#[derive(Table)]
#[table("external")]
pub(crate) struct ExternalKeys {
    /// Id of the quantity in results and limits; no id of a measurand.
    #[key(id, required, example = "leak_rate")]
    pub id: Option<String>,
    /// Unit of value and interval.
    #[key(required, example = "Pa")]
    pub unit: Option<Unit>,
    /// Value that the certificate states.
    #[key(example = 0.02)]
    pub value: Option<f64>,
    /// Lowest and highest value with 95 %. Default: unknown; a limit is then undecided.
    #[key(example = [0.018, 0.022])]
    pub interval: Option<Vec<f64>>,
    /// Number of the certificate or protocol.
    #[key(example = "LT-2026-114")]
    pub certificate: Option<String>,
    /// Laboratory that tested.
    #[key(example = "Leak laboratory")]
    pub laboratory: Option<String>,
    /// SHA-256 of the certificate.
    #[key(example = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")]
    pub sha256: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// A quantity of another test that a procedure asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct ExternalSpec {
    /// Id in results and limits.
    pub id: String,
    /// Unit of the row.
    pub unit: Unit,
    /// The result, where the procedure itself states it.
    pub stated: Option<ExternalResult>,
}

/// True for what is written as a SHA-256.
pub(crate) fn is_sha256(text: &str) -> bool {
    text.len() == SHA256_DIGITS && text.bytes().all(|c| c.is_ascii_hexdigit())
}

/// Reads what a procedure asks for.
pub(crate) fn asked(tables: Vec<ExternalKeys>, reader: &mut Reader<'_>) -> Vec<ExternalSpec> {
    let mut found: Vec<ExternalSpec> = vec![];
    for keys in tables {
        let stated = if keys.value.is_some() { result(&keys, reader) } else { None };
        let ExternalKeys { id: Some(id), unit: Some(unit), section, .. } = keys else { continue };
        let at = section.span_of("id");
        if crate::measurand::find(&id).is_some() || crate::measurand::called(&id).is_some() {
            reader.error(&at, note!("external.of_standard", id = id.as_str()), None);
        } else if found.iter().any(|f| f.id == id) {
            reader.error(&at, note!("external.twice", id = id.as_str()), None);
        } else {
            found.push(ExternalSpec { id, unit, stated });
        }
    }
    found
}

/// Reads the results that a manifest states.
pub(crate) fn results(tables: &[ExternalKeys], reader: &mut Reader<'_>) -> Vec<ExternalResult> {
    let mut found: Vec<ExternalResult> = vec![];
    for keys in tables {
        if keys.value.is_none() {
            reader.error(&keys.section.span, "external.no_value", None);
            continue;
        }
        let Some(result) = result(keys, reader) else { continue };
        if found.iter().any(|f| f.id == result.id) {
            let id = result.id.as_str();
            reader.error(&keys.section.span_of("id"), note!("external.twice", id), None);
        } else {
            found.push(result);
        }
    }
    found
}

/// One result; `None` where it was reported or lacks what is required.
fn result(keys: &ExternalKeys, reader: &mut Reader<'_>) -> Option<ExternalResult> {
    let (id, unit, value) = (keys.id.clone()?, keys.unit.as_ref()?, keys.value?);
    let interval = match keys.interval.as_deref() {
        None => None,
        Some([low, high]) if *low <= value && value <= *high => Some([*low, *high]),
        Some(_) => {
            reader.error(&keys.section.span_of("interval"), "external.interval", None);
            return None;
        }
    };
    if let Some(sum) = &keys.sha256
        && !is_sha256(sum)
    {
        reader.error(&keys.section.span_of("sha256"), note!("external.sha256", given = shorten(sum)), None);
        return None;
    }
    Some(ExternalResult {
        id,
        value,
        unit: unit.text().to_owned(),
        interval,
        certificate: keys.certificate.clone(),
        laboratory: keys.laboratory.clone(),
        sha256: keys.sha256.as_ref().map(|s| s.to_lowercase()),
    })
}
