//! What several tables of a report share.

use crate::record::{ConditionRecord, ConditionStatus};
use crate::report::number::{digits, limit, limit_digits};
use crate::report::translator::Translator;

/// Notes that belong to the noise model of a channel and not to one row.
pub const MODEL_NOTES: &[&str] = &["note.fit_restricted", "note.model_misfit"];

/// What was required, in words.
pub fn required(c: &ConditionRecord, words: Translator) -> String {
    c.requirement.as_ref().map_or_else(|| c.required.clone(), |r| words.say(r))
}

/// The id of a state, for colours and words.
pub fn status(status: ConditionStatus) -> &'static str {
    match status {
        ConditionStatus::Ok => "ok",
        ConditionStatus::Remark => "remark",
        ConditionStatus::Invalid => "invalid",
    }
}

/// Name of the measurand or condition that a waiver is about.
pub fn row_name(id: &str, words: Translator) -> String {
    ["measurand", "condition"]
        .iter()
        .find_map(|prefix| crate::i18n::lookup(words.lang, &format!("{prefix}.{id}")))
        .map_or_else(|| id.to_owned(), str::to_owned)
}

/// A probability; below a millionth a bound.
pub fn probability(p: f64, words: Translator) -> String {
    if p < 1e-6 {
        return format!("<\u{202f}{}", limit(1e-6, words.lang));
    }
    if p < 1e-3 { digits(p, 2, words.lang) } else { limit_digits(p, 3, words.lang) }
}
