//! Which results count: one a unit, all of one model and one procedure.

use super::compensation_table::Table;
use crate::estimate::Verdict;
use crate::i18n::{Arg, LocalText, Note, note};
use crate::output::sha256;
use crate::record::{ProcedureRecord, RunRecord, SheetProcedure, read};
use std::collections::BTreeSet;
use std::path::Path;

/// Serial numbers that a note names at most.
const MAX_NAMED_SERIALS: usize = 5;

/// Members of a result that a data sheet reads.
const SHEET_MEMBERS: &[&str] = &[
    "procedure.id",
    "procedure.revision",
    "unit_under_test.serial",
    "unit_under_test.family",
    "unit_under_test.model",
    "unit_under_test.lot",
    "verdict",
    "session.evaluated_at",
    "window",
    "deviations",
    "conditions.id",
    "conditions.observed",
    "recording.sample_interval_s",
    "measurands.id",
    "measurands.channel",
    "measurands.phase",
    "measurands.unit",
    "measurands.value",
    "measurands.interval",
    "measurands.common_standard_uncertainty",
    "measurands.identifiable",
    "measurands.upper_limit",
    "measurands.most_likely",
    "measurands.method",
    "measurands.limit.min",
    "measurands.limit.max",
];

/// A unit with its result.
#[derive(Debug, Clone)]
pub struct TestedUnit {
    /// Serial number.
    pub serial: String,
    /// The file as named.
    pub path: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Its result, as far as a data sheet reads it.
    pub result: RunRecord,
    /// The compensation tables beside it.
    pub tables: Vec<Table>,
}

impl TestedUnit {
    /// The unit of a result file.
    ///
    /// # Errors
    /// A file that cannot be read, is no result, or names no unit.
    pub fn read(file: &Path) -> Result<TestedUnit, Note> {
        let bytes = read::bytes(file).map_err(|e| e.note(file))?;
        TestedUnit::of_record(&bytes, file, Table::beside(file))
    }

    /// The unit of a result in memory: the record as JSON, its name, and the files beside it by name.
    ///
    /// # Errors
    /// As [`TestedUnit::read`].
    pub fn in_memory(record: &[u8], name: &Path, files: &[(String, String)]) -> Result<TestedUnit, Note> {
        TestedUnit::of_record(record, name, Table::among(files))
    }

    fn of_record(bytes: &[u8], file: &Path, tables: Vec<Table>) -> Result<TestedUnit, Note> {
        let result = read::of_any_program(bytes, SHEET_MEMBERS).map_err(|e| e.note(file))?;
        let path = file.display().to_string();
        let serial = result.unit_under_test.serial.as_deref().map(str::trim).unwrap_or_default().to_owned();
        if serial.is_empty() {
            return Err(note!("datasheet.refused.no_serial", path));
        }
        Ok(TestedUnit { serial, path, sha256: sha256(bytes), result, tables })
    }

    /// Name of the lot; empty where none is named.
    pub fn lot_name(&self) -> &str {
        self.result.unit_under_test.lot.as_deref().unwrap_or_default()
    }

    fn model(&self) -> Option<&str> {
        let unit = &self.result.unit_under_test;
        unit.model
            .as_deref()
            .or(unit.family.as_ref().map(LocalText::text))
            .map(str::trim)
            .filter(|m| !m.is_empty())
    }

    fn procedure(&self) -> SheetProcedure {
        let of = |p: &ProcedureRecord| SheetProcedure { id: p.id.clone(), revision: p.revision.clone() };
        self.result.procedure.as_ref().map(of).unwrap_or_default()
    }

    fn evaluated_at(&self) -> Option<&str> {
        Some(self.result.session.evaluated_at.as_str()).filter(|moment| !moment.is_empty())
    }
}

/// The units that count.
pub struct Selected {
    /// The units, in the order named.
    pub units: Vec<TestedUnit>,
    /// Their model.
    pub model: Option<String>,
    /// Their procedure.
    pub procedure: SheetProcedure,
    /// Results that were left out, and remarks.
    pub notes: Vec<Note>,
}

/// Why units make no data sheet.
#[derive(Debug)]
pub enum Refusal {
    /// No result is left.
    None,
    /// Units of several models, or tests by several procedures.
    Mixed(Note),
}

/// Takes of every unit the result that counts: the later one.
///
/// # Errors
/// [`Refusal`] where nothing is left, or where the results are of several models or procedures.
pub fn select(results: Vec<TestedUnit>) -> Result<Selected, Refusal> {
    let mut notes = vec![];
    let (tested, untested): (Vec<_>, Vec<_>) =
        results.into_iter().partition(|u| u.result.verdict != Verdict::Error);
    if !untested.is_empty() {
        notes.push(named("datasheet.note.untested", untested.iter().map(|u| u.serial.as_str())));
    }
    let (units, retested) = last_of_each(tested);
    if !retested.is_empty() {
        notes.push(named("datasheet.note.retested", retested.iter().map(String::as_str)));
    }
    let Some(first) = units.first() else { return Err(Refusal::None) };
    let model = one(&units, "datasheet.refused.models", |u| u.model().unwrap_or_default().to_owned())?;
    let id = one(&units, "datasheet.refused.procedures", |u| u.procedure().id)?;
    let procedures: Vec<SheetProcedure> = units.iter().map(TestedUnit::procedure).collect();
    let revisions: BTreeSet<&str> = procedures.iter().map(|p| p.revision.as_str()).collect();
    if revisions.len() > 1 {
        let list = revisions.iter().copied().collect::<Vec<_>>().join(", ");
        notes.push(note!("datasheet.note.revisions", revisions = list));
    }
    let lots: BTreeSet<&str> = units.iter().map(TestedUnit::lot_name).collect();
    notes.push(match lots.len() {
        1 => "datasheet.note.one_lot".into(),
        n => note!("datasheet.note.lots", n),
    });
    let judged = |u: &TestedUnit| {
        u.result.measurands.iter().any(|m| m.limit.is_some()) || u.result.verdict == Verdict::Pass
    };
    if judged(first) && units.iter().all(|u| u.result.verdict == Verdict::Pass) {
        notes.push("datasheet.note.all_pass".into());
    }
    let procedure = joined(&id, &revisions);
    let model = Some(model).filter(|m| !m.is_empty());
    Ok(Selected { units, model, procedure, notes })
}

/// The procedure whose revisions are those of some units.
fn joined(id: &str, revisions: &BTreeSet<&str>) -> SheetProcedure {
    let revision = revisions.iter().copied().collect::<Vec<_>>().join(", ");
    SheetProcedure { id: id.to_owned(), revision }
}

/// The one text that all units have.
fn one(
    units: &[TestedUnit],
    refused: &'static str,
    of: impl Fn(&TestedUnit) -> String,
) -> Result<String, Refusal> {
    let all: BTreeSet<String> = units.iter().map(of).collect();
    if all.len() > 1 {
        let shown = all.iter().map(|m| if m.is_empty() { "–" } else { m.as_str() });
        let list = shown.collect::<Vec<_>>().join(", ");
        return Err(Refusal::Mixed(Note::new(refused).with("list", list)));
    }
    Ok(all.into_iter().next().unwrap_or_default())
}

/// The last result of every unit, and the serial numbers of which there are several.
fn last_of_each(results: Vec<TestedUnit>) -> (Vec<TestedUnit>, Vec<String>) {
    let mut units: Vec<TestedUnit> = vec![];
    let mut again: Vec<String> = vec![];
    for result in results {
        let Some(earlier) = units.iter_mut().find(|u| u.serial == result.serial) else {
            units.push(result);
            continue;
        };
        if !again.contains(&result.serial) {
            again.push(result.serial.clone());
        }
        // Without both moments, the one that is named later is the later one.
        let later = match (earlier.evaluated_at(), result.evaluated_at()) {
            (Some(a), Some(b)) => b >= a,
            _ => true,
        };
        if later {
            *earlier = result;
        }
    }
    (units, again)
}

/// A note that names some serial numbers.
fn named<'a>(key: &'static str, serials: impl Iterator<Item = &'a str>) -> Note {
    let all: Vec<&str> = serials.collect();
    let mut shown = all.iter().take(MAX_NAMED_SERIALS).copied().collect::<Vec<_>>().join(", ");
    if all.len() > MAX_NAMED_SERIALS {
        shown.push_str(", …");
    }
    Note::new(key).with("n", all.len()).with("serials", Arg::from(shown))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;
    use crate::i18n::Localize;

    fn unit(serial: &str, more: &str) -> TestedUnit {
        let text = format!(r#"{{"unit_under_test": {{"serial": "{serial}"}}, "measurands": [] {more}}}"#);
        let result = read::with_members(serde_json::from_str(&text).unwrap(), SHEET_MEMBERS).unwrap();
        TestedUnit {
            serial: serial.to_owned(),
            path: more.to_owned(),
            sha256: String::new(),
            result,
            tables: vec![],
        }
    }

    const PASS: &str = r#", "verdict": "pass""#;

    #[test]
    fn of_two_results_of_a_unit_the_later_counts() {
        let at = |stamp: &str| format!(r#"{PASS}, "session": {{"evaluated_at": "{stamp}"}}"#);
        let found =
            select(vec![unit("1", &at("2026-02-01T00:00:00Z")), unit("1", &at("2026-01-01T00:00:00Z"))]);
        let found = found.unwrap_or_else(|_| panic!("one unit"));
        assert_eq!(found.units.len(), 1);
        assert!(found.units[0].path.contains("2026-02"));
        assert!(found.notes.iter().any(|n| n.id == "datasheet.note.retested"));
        let plain =
            select(vec![unit("1", PASS), unit("1", r#", "verdict": "fail""#)]).unwrap_or_else(|_| panic!());
        assert_eq!(plain.units[0].result.verdict, Verdict::Fail);
    }

    #[test]
    fn mixed_models_are_refused_by_name() {
        let of = |serial: &str, model: &str| {
            let mut unit = unit(serial, PASS);
            unit.result.unit_under_test.model = Some(model.to_owned());
            unit
        };
        let Err(Refusal::Mixed(note)) = select(vec![of("1", "A-1"), of("2", "B-2")]) else {
            panic!("two models");
        };
        assert!(note.say(Lang::En).contains("A-1, B-2"), "{}", note.say(Lang::En));
        assert!(matches!(select(vec![]), Err(Refusal::None)));
        assert!(matches!(select(vec![unit("1", r#", "verdict": "error""#)]), Err(Refusal::None)));
    }
}
