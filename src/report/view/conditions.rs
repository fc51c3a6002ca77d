//! Conditions of the test with what was found, and how it is known, in words and units.

use super::common::{required, status};
use super::part::Part;
use super::{faults, instruments};
use crate::record::{ConditionRecord, ConditionStatus, Evidence, RunRecord};
use crate::report::number::{NOTHING, count, duration, limit_digits, percent};
use crate::report::page::{self, Block, Facts, Table};
use crate::report::translator::Translator;
use serde_json::Value;
use std::collections::BTreeSet;

/// A condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    /// Name.
    pub name: String,
    /// Id of the state.
    pub status: &'static str,
    /// State in words.
    pub status_word: String,
    /// What was required.
    pub required: String,
    /// How it is known, in words.
    pub evidence: String,
    /// What was found.
    pub found: String,
    /// Explanation.
    pub note: String,
}

/// Units that the name of a value found ends in, longest first, with the unit.
const ENDINGS: &[(&str, &str)] = &[
    ("_deg_c_h", "degC/h"),
    ("_arw", "deg/sqrt(h)"),
    ("_deg_c", "degC"),
    ("_deg_h", "deg/h"),
    ("_deg_s", "deg/s"),
    ("_hz", "Hz"),
    ("_s", "s"),
    ("_h", "h"),
];

/// Values that say nothing without their name, even where they stand alone.
const ALWAYS_NAMED: &[&str] = &["factor", "probability", "stretches"];

/// Values that the explanation states better.
const IN_WORDS: &[&str] = &["difference"];

/// The conditions of the test; faults and instruments, which have tables of their own, in a line each.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let all = all(part.record, words);
    if all.is_empty() {
        return vec![];
    }
    let text = |of: fn(&Condition) -> &String| all.iter().map(move |c| of(c).clone());
    let sentence = |of: fn(&Condition) -> &String| text(of).map(page::Value::Sentence);
    let table = Table::new("conditions cards", all.len())
        .column(words.column("report.condition"), text(|c| &c.name))
        .column(words.column("report.required"), sentence(|c| &c.required))
        .column(words.column("report.value_found"), sentence(|c| &c.found))
        .column(words.column("report.evidence"), text(|c| &c.evidence))
        .column(
            words.column("report.state"),
            all.iter().map(|c| page::Value::state(c.status, c.status_word.as_str())),
        );
    vec![Block::section("", words.t("report.conditions"), vec![Block::Table(table)])]
}

/// What is to be said of single conditions.
pub fn remarks(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let rows: Vec<(page::Value, page::Value)> = conditions(part.record, words)
        .into_iter()
        .filter(|c| !c.note.is_empty())
        .map(|c| (c.name.into(), page::Value::Sentence(c.note)))
        .collect();
    if rows.is_empty() {
        return vec![];
    }
    let facts = Block::Facts(Facts { class: "options", rows });
    vec![Block::section("", words.t("report.condition_remarks"), vec![facts])]
}

/// The conditions, then faults and instruments in a line each.
pub fn all(record: &RunRecord, words: Translator) -> Vec<Condition> {
    conditions(record, words).into_iter().chain(in_short(record, words)).collect()
}

/// Names of the conditions that are only declared, in alphabetical order.
pub fn declared(record: &RunRecord, words: Translator) -> Vec<String> {
    let declared = record.conditions.iter().filter(|c| c.evidence == Some(Evidence::Declared));
    let names = declared.map(|c| words.name("condition", c.id.split('.').next().unwrap_or(&c.id)));
    names.collect::<BTreeSet<String>>().into_iter().collect()
}

/// The faults of the recording and the instruments, a line each.
fn in_short(record: &RunRecord, words: Translator) -> Vec<Condition> {
    let line =
        |key: &str, worst: ConditionStatus, required: String, found: String, evidence: &str| Condition {
            name: words.t(key),
            status: status(worst),
            status_word: words.name("status", status(worst)),
            required,
            evidence: words.name("evidence", evidence),
            found,
            note: String::new(),
        };
    let worst = |of: &dyn Fn(&str) -> bool| {
        let states = record.conditions.iter().filter(|c| of(&c.id)).map(|c| c.status);
        states.max().unwrap_or(ConditionStatus::Ok)
    };
    let mut lines = vec![];
    if record.conditions.iter().any(|c| faults::is_fault(&c.id)) {
        let found: Vec<String> = faults::FaultKinds::new(record, words)
            .found
            .iter()
            .map(|f| format!("{}\u{a0}{}", f.name, f.found))
            .collect();
        let found = if found.is_empty() { words.t("report.faultless") } else { found.join("; ") };
        let allowed = words.t("report.within_budget");
        lines.push(line("report.integrity", worst(&faults::is_fault), allowed, found, "recorded"));
    }
    if !record.instruments.is_empty() {
        let calibrated = record.conditions.iter().find(|c| c.id == "calibration");
        let required = calibrated.map_or_else(String::new, |c| required(c, words));
        let mut found: Vec<(String, u64)> = vec![];
        let states = record.instruments.iter().map(|i| instruments::state(i, record, words));
        let mut is_remarkable = false;
        for state in states {
            is_remarkable |= state.id != "ok";
            match found.iter_mut().find(|(word, _)| *word == state.word) {
                Some((_, n)) => *n += 1,
                None => found.push((state.word, 1)),
            }
        }
        let found: Vec<String> =
            found.iter().map(|(word, n)| format!("{word} ({})", count(*n, words.lang))).collect();
        let mut state = worst(&|id| id == "calibration");
        if state == ConditionStatus::Ok && is_remarkable {
            state = ConditionStatus::Remark;
        }
        lines.push(line("condition.calibration", state, required, found.join("; "), "declared"));
    }
    lines
}

/// The conditions that have no table of their own.
pub fn conditions(record: &RunRecord, words: Translator) -> Vec<Condition> {
    record
        .conditions
        .iter()
        .filter(|c| !faults::is_fault(&c.id) && c.id != "calibration")
        .map(|c| condition(c, words))
        .collect()
}

fn condition(c: &ConditionRecord, words: Translator) -> Condition {
    let (kind, channel) = c.id.split_once('.').unwrap_or((&c.id, ""));
    let name = words.name("condition", kind);
    Condition {
        name: if channel.is_empty() { name } else { format!("{name} · {channel}") },
        status: status(c.status),
        status_word: words.name("status", status(c.status)),
        required: required(c, words),
        evidence: words.name("evidence", c.evidence.map_or("none", Evidence::id)),
        found: found(kind, c, words),
        note: c.message.as_ref().map_or_else(|| c.note.clone(), |m| words.say(m)),
    }
}

/// What was found. Of a quantity that is held, the range and the mean; the rest stands in the explanation and in
/// the result file.
fn found(kind: &str, c: &ConditionRecord, words: Translator) -> String {
    let number = |name: &str| c.observed.get(name).and_then(Value::as_f64);
    if let (Some(low), Some(high)) = (number("min"), number("max")) {
        let unit = match kind {
            "temperature" => "degC",
            "supply" => "V",
            _ => "",
        };
        let shown = |v: f64| limit_digits(v, 4, words.lang);
        let range = words.with("report.interval", &[("low", &shown(low)), ("high", &shown(high))]);
        let range = words.quantity(&range, unit);
        return match number("mean") {
            Some(mean) => {
                let mean = words.quantity(&shown(mean), unit);
                words.with("report.range_and_mean", &[("range", &range), ("mean", &mean)])
            }
            None => range,
        };
    }
    let values: Vec<_> = c.observed.iter().filter(|(name, _)| !IN_WORDS.contains(&name.as_str())).collect();
    let alone = values.len() == 1;
    let shown: Vec<String> = values.into_iter().map(|(name, value)| one(name, value, alone, words)).collect();
    shown.join(", ")
}

fn one(name: &str, value: &Value, alone: bool, words: Translator) -> String {
    let unit = ENDINGS.iter().find(|(ending, _)| name.ends_with(ending));
    let shown = match (value, unit) {
        (Value::Number(n), Some((_, "s"))) => {
            n.as_f64().map_or_else(|| n.to_string(), |v| duration(v, words.lang))
        }
        (Value::Number(n), _) if name == "probability" => {
            n.as_f64().map_or_else(|| n.to_string(), |p| percent(p, words.lang))
        }
        (Value::Number(n), _) => {
            let text = match n.as_u64() {
                Some(whole) => count(whole, words.lang),
                None => n.as_f64().map_or_else(|| n.to_string(), |v| limit_digits(v, 4, words.lang)),
            };
            words.quantity(&text, unit.map_or("", |u| u.1))
        }
        (Value::String(s), _) => s.clone(),
        (Value::Bool(b), _) => words.t(if *b { "report.yes" } else { "report.no" }),
        (Value::Null, _) => NOTHING.to_owned(),
        (other, _) => other.to_string(),
    };
    let is_clear = alone && !ALWAYS_NAMED.contains(&name);
    if is_clear || name == "value" { shown } else { format!("{}\u{a0}{shown}", words.name("observed", name)) }
}
