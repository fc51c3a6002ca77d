//! Faults of the recording: what was found against what is allowed, and the first of each kind one by one.

use super::common::{required, status};
use crate::record::{ConditionRecord, FaultRecord, Integrity, RunRecord};
use crate::report::number::{NOTHING, count, duration, limit_digits, percent};
use crate::report::translator::{Field, Translator};
use serde::Serialize;

/// Faults of one kind that a report lists; more would bury the rest of it.
const SHOWN_OF_A_KIND: usize = 10;

/// Printed faults.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Faults {
    /// Kinds that were found, and those whose budget is broken.
    pub found_faults: Vec<FaultKind>,
    /// Kinds that were looked for and not found, with what is allowed, as a sentence.
    pub absent_faults: String,
    /// Kinds that could not be looked for, as a sentence.
    pub unexamined_faults: String,
    /// True when it was looked for faults and none was found.
    pub faultless: bool,
    /// Jitter, quantisation step, threshold.
    pub integrity_facts: Vec<Field>,
    /// Faults one by one, the first of each kind.
    pub faults: Vec<Fault>,
    /// How many of the listed faults are shown; empty when all are.
    pub faults_shown: String,
}

/// One kind of fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultKind {
    /// Name.
    pub name: String,
    /// How many or how much was found.
    pub found: String,
    /// Share of the rows; empty for what is no count.
    pub share: String,
    /// What is allowed.
    pub allowed: String,
    /// Id of the state; empty without a budget.
    pub status: &'static str,
    /// State in words.
    pub status_word: String,
}

/// A fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// Kind, in words.
    pub kind: String,
    /// Channel.
    pub channel: String,
    /// Row.
    pub row: String,
    /// Time.
    pub time: String,
    /// Samples concerned.
    pub count: String,
    /// What was seen.
    pub note: String,
}

/// Counted faults: id and count.
fn counts(i: &Integrity) -> [(&'static str, u64); 10] {
    [
        ("gaps", i.gaps),
        ("missing_samples", i.missing_samples),
        ("duplicate_timestamps", i.duplicate_timestamps),
        ("backward_timestamps", i.backward_timestamps),
        ("non_finite", i.non_finite),
        ("unparsable", i.unparsable),
        ("outliers", i.outliers),
        ("saturated", i.saturated),
        ("stuck", i.stuck),
        ("repeated", i.repeated),
    ]
}

/// Counted faults for which there is no budget: id and count.
fn grave(i: &Integrity) -> [(&'static str, u64); 2] {
    [("implausible", i.implausible), ("cut_off", i.cut_off)]
}

/// Faults that are times: id of the condition.
const TIME_CONDITIONS: &[&str] = &["longest_gap", "timestamp_jitter"];

/// True when a condition is about a fault of the recording.
pub fn is_fault(id: &str) -> bool {
    let none = Integrity::default();
    TIME_CONDITIONS.contains(&id)
        || grave(&none).iter().any(|c| c.0 == id)
        || counts(&none).iter().any(|c| c.0 == id)
}

impl Faults {
    /// Prints the faults of a record.
    pub(crate) fn new(record: &RunRecord, words: Translator) -> Faults {
        let integrity = &record.integrity;
        let rows: u64 = record.recording.iter().map(|f| f.samples).sum();
        let condition = |id: &str| record.conditions.iter().find(|c| c.id == id);
        let (mut found, mut absent, mut unexamined) = (vec![], vec![], vec![]);
        for (id, n) in counts(integrity) {
            let share = if rows > 0 { percent(n as f64 / rows as f64, words.lang) } else { String::new() };
            if n == 0 && !integrity.has_examined(id) {
                unexamined.push(words.name("condition", id));
                continue;
            }
            let kind = kind(id, count(n, words.lang), share, condition(id), words);
            if n > 0 || kind.status == "invalid" { found.push(kind) } else { absent.push(kind) }
        }
        // These are never allowed: they are listed where they were found.
        for (id, n) in grave(integrity).into_iter().filter(|(_, n)| *n > 0) {
            found.push(kind(id, count(n, words.lang), String::new(), condition(id), words));
        }
        for c in TIME_CONDITIONS.iter().filter_map(|id| condition(id)) {
            let seconds = c.observed.get("seconds").and_then(serde_json::Value::as_f64).unwrap_or(0.0);
            let kind = kind(&c.id, duration(seconds, words.lang), String::new(), Some(c), words);
            if seconds > 0.0 || kind.status == "invalid" { found.push(kind) } else { absent.push(kind) }
        }
        let shown = first_of_each_kind(&integrity.faults);
        Faults {
            unexamined_faults: match unexamined.len() {
                0 => String::new(),
                _ if integrity.examined.is_empty() && found.is_empty() => words.t("report.none_examined"),
                _ => words.with("report.unexamined", &[("kinds", &unexamined.join("; "))]),
            },
            faultless: !integrity.examined.is_empty()
                && counts(integrity).iter().chain(&grave(integrity)).all(|c| c.1 == 0)
                && integrity.faults.is_empty(),
            found_faults: found,
            absent_faults: sentence(&absent, words),
            integrity_facts: facts(integrity, words),
            faults_shown: if shown.len() < integrity.faults.len() {
                let listed = count(integrity.faults.len() as u64, words.lang);
                let n = count(shown.len() as u64, words.lang);
                words.with("report.faults_shown", &[("shown", &n), ("listed", &listed)])
            } else {
                String::new()
            },
            faults: shown.into_iter().map(|f| fault(f, words)).collect(),
        }
    }
}

fn kind(id: &str, found: String, share: String, c: Option<&ConditionRecord>, words: Translator) -> FaultKind {
    let allowed = c.map(|c| required(c, words)).filter(|r| !r.is_empty());
    FaultKind {
        name: words.name("condition", id),
        found,
        share,
        allowed: allowed.unwrap_or_else(|| NOTHING.to_owned()),
        status: c.map_or("", |c| status(c.status)),
        status_word: c.map_or_else(String::new, |c| words.name("status", status(c.status))),
    }
}

/// `Looked for and not found: gaps (at most 10), …`
fn sentence(absent: &[FaultKind], words: Translator) -> String {
    let listed: Vec<String> = absent
        .iter()
        .map(|k| if k.allowed == NOTHING { k.name.clone() } else { format!("{} ({})", k.name, k.allowed) })
        .collect();
    if listed.is_empty() {
        String::new()
    } else {
        words.with("report.absent", &[("kinds", &listed.join("; "))])
    }
}

fn facts(i: &Integrity, words: Translator) -> Vec<Field> {
    let lang = words.lang;
    [
        i.timestamp_jitter_s.map(|v| ("report.jitter", duration(v, lang))),
        i.quantization_step_deg_h
            .map(|v| ("report.step", words.quantity(&limit_digits(v, 4, lang), "deg/h"))),
        i.outlier_threshold.map(|v| {
            let v = limit_digits(v, 3, lang);
            ("report.outlier_threshold", words.with("report.robust_deviations", &[("value", &v)]))
        }),
    ]
    .into_iter()
    .flatten()
    .map(|(key, value)| Field { label: words.t(key), value })
    .collect()
}

/// The faults that a report lists, in the order of the record.
fn first_of_each_kind(faults: &[FaultRecord]) -> Vec<&FaultRecord> {
    let mut seen: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    faults
        .iter()
        .filter(|f| {
            let n = seen.entry(&f.kind).or_default();
            *n += 1;
            *n <= SHOWN_OF_A_KIND
        })
        .collect()
}

fn fault(f: &FaultRecord, words: Translator) -> Fault {
    let note = f.seen.message.as_ref().map_or_else(|| f.seen.note.clone(), |m| words.say(m));
    Fault {
        kind: words.name("fault", &f.kind),
        channel: f.channel.clone().unwrap_or_default(),
        row: count(f.row, words.lang),
        time: f
            .time_s
            .map_or_else(|| NOTHING.to_owned(), |t| words.quantity(&limit_digits(t, 9, words.lang), "s")),
        count: count(f.count, words.lang),
        note: f.file.as_ref().map_or_else(|| note.clone(), |file| format!("{file}: {note}")),
    }
}
