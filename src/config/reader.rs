//! What the reading of one TOML file goes along with: its text, its description and the problems found so far.

use super::diagnostics::{Problems, SourceText, Span};
use super::spec::{KeySpec, TableSpec};
use crate::i18n::{Note, note};
use crate::measurand::{self, Measurand};
use sagnac_core::spelling::nearest;
use toml::de::DeValue;

/// Errors after which the reader stops looking for more.
const MAX_ERRORS: usize = 200;

/// A value as it stands in the file, with the description of its key.
#[derive(Clone, Copy)]
pub(crate) struct Value<'a> {
    pub key: &'static KeySpec,
    pub toml: &'a DeValue<'a>,
    /// Where it stands.
    pub span: &'a Span,
}

impl<'a> Value<'a> {
    /// A value inside this one, such as an item of a list.
    pub fn with(self, toml: &'a DeValue<'a>, span: &'a Span) -> Value<'a> {
        Value { toml, span, ..self }
    }
}

/// One file while it is read.
pub(crate) struct Reader<'s> {
    /// Its text.
    pub source: &'s SourceText,
    /// Description of the file as a whole.
    pub(super) root: &'static TableSpec,
    /// Its problems so far.
    pub problems: Problems,
}

impl Reader<'_> {
    /// Adds an error at a place, while there are not too many.
    pub fn error(&mut self, span: &Span, message: impl Into<Note>, help: Option<Note>) {
        if self.problems.list.len() < MAX_ERRORS {
            let mut problem = self.source.error(span, message);
            problem.help = help;
            self.problems.list.push(problem);
        }
    }

    /// Adds a warning at a place, while there are not too many problems.
    pub fn warning(&mut self, span: &Span, message: impl Into<Note>, help: Option<Note>) {
        if self.problems.list.len() < MAX_ERRORS {
            let mut problem = self.source.warning(span, message);
            problem.help = help;
            self.problems.list.push(problem);
        }
    }

    /// Looks up a measurand; reports an unknown one.
    pub fn measurand(&mut self, name: &str, span: &Span) -> Option<&'static Measurand> {
        let found = measurand::find(name);
        if found.is_none() {
            let message = note!("keyed.unknown_measurand", name = shorten(name));
            self.error(span, message, Some(measurand_meant(name)));
        }
        found
    }

    /// Reports a value of the wrong type.
    pub fn wrong<T>(&mut self, value: Value<'_>) -> Option<T> {
        let Value { key, toml, span } = value;
        let message = note!(
            "keyed.wrong",
            key = key.name,
            wanted = key.kind.describe(),
            given = Note::new(type_name(toml))
        );
        let help = if key.example.is_empty() {
            key.kind.table().map(|t| note!("keyed.help.write_table", table = t.name))
        } else {
            Some(for_example(key))
        };
        self.error(span, message, help);
        None
    }
}

/// A key with its value, as it is written.
pub(super) fn example(key: &KeySpec) -> String {
    format!("{} = {}", key.name, key.example)
}

/// Shows how a key is written.
pub(crate) fn for_example(key: &KeySpec) -> Note {
    note!("keyed.help.example", example = example(key))
}

/// Offers a name that is spelt nearly the same.
pub(crate) fn meant(near: &str) -> Note {
    note!("keyed.help.did_you_mean", name = near)
}

/// The measurand that a name means: by its symbol or abbreviation, else those whose ids hold the word,
/// else by its spelling.
fn measurand_meant(name: &str) -> Note {
    let known = || measurand::MEASURANDS.iter().map(|m| m.id);
    let by_word = || match measurand::with_word(name).as_slice() {
        [] => None,
        [one] => Some(meant(one.id)),
        several => {
            let names: Vec<&str> = several.iter().map(|m| m.id).collect();
            Some(note!("keyed.help.one_of", values = names.join(", ")))
        }
    };
    measurand::called(name)
        .map(|m| meant(m.id))
        .or_else(by_word)
        .or_else(|| nearest(name, known()).map(meant))
        .unwrap_or_else(|| note!("keyed.help.measurands", names = known().collect::<Vec<_>>().join(", ")))
}

/// A name short enough for a message.
pub(crate) fn shorten(name: &str) -> String {
    if name.chars().count() <= 60 {
        name.to_owned()
    } else {
        name.chars().take(57).chain("...".chars()).collect()
    }
}

fn type_name(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "keyed.type.text",
        DeValue::Integer(_) | DeValue::Float(_) => "keyed.type.number",
        DeValue::Boolean(_) => "keyed.type.flag",
        DeValue::Datetime(_) => "keyed.type.date",
        DeValue::Array(_) => "keyed.type.list",
        DeValue::Table(_) => "keyed.type.table",
    }
}
