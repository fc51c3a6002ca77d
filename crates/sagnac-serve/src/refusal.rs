//! Requests that are refused, with a reason in the language of the reader.

use crate::texts::{Lang, filled};
use axum::http::StatusCode;
use serde::Serialize;

/// Most characters of a given text that a reason repeats.
const MAX_DETAIL_CHARACTERS: usize = 200;

/// A request that is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Status of the answer.
    pub status: StatusCode,
    /// Id of the reason, stable for programs.
    pub code: &'static str,
    /// What was given or is allowed.
    pub detail: String,
}

/// A refusal as JSON.
#[derive(Debug, Serialize)]
pub struct RefusalBody {
    error: &'static str,
    message: String,
}

impl Refusal {
    /// A refusal without a detail.
    pub fn new(status: StatusCode, code: &'static str) -> Refusal {
        Refusal { status, code, detail: String::new() }
    }

    /// A refusal of something that was given.
    pub fn of(status: StatusCode, code: &'static str, detail: &str) -> Refusal {
        Refusal { status, code, detail: shown(detail) }
    }

    /// The reason in words.
    pub fn message(&self, lang: Lang) -> String {
        filled(&format!("refusal.{}", self.code), &[("detail", &self.detail)], lang)
    }

    /// The refusal as JSON.
    pub fn body(&self, lang: Lang) -> RefusalBody {
        RefusalBody { error: self.code, message: self.message(lang) }
    }
}

/// A text from outside on one line: without what steers, of bounded length.
pub fn shown(text: &str) -> String {
    let is_shown =
        |c: &char| !c.is_control() && !matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    text.chars().filter(is_shown).take(MAX_DETAIL_CHARACTERS).collect()
}
