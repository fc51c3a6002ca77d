//! Conditions of the test with what was found, and how it is known, in words and units.

use super::common::{required, status};
use super::faults;
use crate::record::{ConditionRecord, RunRecord};
use crate::report::number::{NOTHING, count, duration, limit_digits, percent};
use crate::report::translator::Translator;
use serde::Serialize;
use serde_json::Value;

/// A condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
        evidence: words.name("evidence", c.evidence.map_or("none", crate::record::Evidence::id)),
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
