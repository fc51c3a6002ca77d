//! Which procedures a limits file belongs to, and what is worth knowing of it with them.

use super::diagnostics::Problem;
use super::limits::{EffectiveLimits, LimitsFile, effective};
use super::model::{Loaded, Procedure};
use super::power::{LengthQuestion, PowerQuestion, lengths, questions, warnings};
use crate::i18n::Note;

/// Says of a limit that it cannot be decided, and what to do; `None` where it can.
pub type Answer<'a> = &'a dyn Fn(&PowerQuestion) -> Option<(Note, Option<Note>)>;

/// Says how long a record must be for a slow term; `None` where nothing tells.
pub type LengthAnswer<'a> = &'a dyn Fn(&LengthQuestion) -> Option<Note>;

/// How long a record must be for what a file limits or gives typical values for, with the first procedure that it belongs to.
pub fn lengths_of_limits(
    file: &Loaded<LimitsFile>,
    procedures: &[&Loaded<Procedure>],
    answer: LengthAnswer<'_>,
) -> Vec<Note> {
    let asked = match belonging(&file.value, procedures).first() {
        Some(procedure) => lengths(&effective(procedure, Some(file)).set, Some(&procedure.value)),
        None => lengths(&file.value.set, None),
    };
    asked.iter().filter_map(answer).collect()
}

/// The same of the limits and typical values that stand in a procedure itself.
pub fn lengths_of_procedure(procedure: &Loaded<Procedure>, answer: LengthAnswer<'_>) -> Vec<Note> {
    let p = &procedure.value;
    lengths(&p.limits, Some(p)).iter().filter_map(answer).collect()
}

/// The procedures that measure something of what a file limits, or, where it has no limits, of what it gives values for.
pub fn belonging<'a>(file: &LimitsFile, procedures: &[&'a Loaded<Procedure>]) -> Vec<&'a Loaded<Procedure>> {
    let set = &file.set;
    let mut ids: Vec<&str> = set.limits.iter().map(|l| l.measurand.id).collect();
    if set.count() == 0 {
        ids.extend(set.references.iter().map(|r| r.measurand.id));
        ids.extend(set.expected.iter().map(|e| e.measurand.id));
    }
    let has = |p: &Procedure, id: &str| p.derived.iter().any(|d| d.id == id);
    let measures = |p: &&&Loaded<Procedure>| {
        ids.iter().any(|id| p.value.measures(id, None))
            || set.derived.iter().any(|l| has(&p.value, &l.derived))
    };
    procedures.iter().filter(measures).copied().collect()
}

/// Remarks on a limits file with the procedures that it belongs to.
///
/// A limit that one of them uses is not reported for the others: a file may serve several tests.
pub fn of_limits(
    file: &Loaded<LimitsFile>,
    procedures: &[&Loaded<Procedure>],
    answer: Answer<'_>,
) -> Vec<Problem> {
    let own = belonging(&file.value, procedures);
    if own.is_empty() {
        return decides_nothing(file, procedures).into_iter().collect();
    }
    let pairs: Vec<(&Loaded<Procedure>, EffectiveLimits)> =
        own.into_iter().map(|p| (p, effective(p, Some(file)))).collect();
    let set = &file.value.set;
    let spans = || set.limits.iter().map(|l| &l.span).chain(set.derived.iter().map(|l| &l.span));
    let is_limit = |w: &Problem| spans().any(|span| *span == w.span);
    let in_every = |w: &Problem| pairs.iter().all(|(_, e)| e.warnings.iter().any(|o| o.span == w.span));
    let mut found = vec![];
    for (i, (procedure, effective)) in pairs.iter().enumerate() {
        let told = |w: &&Problem| !is_limit(w) || i == 0 && in_every(w);
        found.extend(effective.warnings.iter().filter(told).cloned());
        let asked = questions(&procedure.value, effective);
        found.extend(warnings(&asked, procedure, Some(file), answer));
    }
    let idle = pairs.iter().map(|(_, e)| e.idle.clone()).collect::<Option<Vec<Note>>>();
    let judges = set.count() > 0;
    let first = idle.filter(|_| judges).and_then(|notes| notes.into_iter().next());
    found.extend(first.map(|note| Problem::remark_on_file(&file.path, note)));
    found
}

/// Remarks on the limits that stand in a procedure itself.
pub fn of_procedure(procedure: &Loaded<Procedure>, answer: Answer<'_>) -> Vec<Problem> {
    let effective = effective(procedure, None);
    let asked = questions(&procedure.value, &effective);
    effective.warnings.iter().cloned().chain(warnings(&asked, procedure, None, answer)).collect()
}

/// A file with limits that none of the procedures measures.
fn decides_nothing(file: &Loaded<LimitsFile>, procedures: &[&Loaded<Procedure>]) -> Option<Problem> {
    if procedures.is_empty() || file.value.set.count() == 0 {
        return None;
    }
    let names: Vec<&str> = procedures.iter().map(|p| p.value.id.as_str()).collect();
    let key = if names.len() == 1 { "check.none_applies" } else { "check.none_applies_to_any" };
    let note = Note::new(key).with("path", file.path.as_str()).with("procedure", names.join(", "));
    Some(Problem::remark_on_file(&file.path, note))
}
