//! Messages as data: a key with arguments.
//!
//! This crate has no sentences. A [`Note`] becomes text where it is shown, by a locale table that the program owns.

use crate::local_text::LocalText;
use crate::real;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// One argument of a note.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arg {
    /// A number; shown with up to four significant digits.
    Number(#[serde(with = "real")] f64),
    /// A number as it was stated, such as a requirement; shown with every digit.
    Stated(#[serde(with = "real")] f64),
    /// A count; shown in full.
    Count(u64),
    /// A text, shown on one line without control characters.
    Text(String),
    /// A text of a user, shown like `Text` in the language of the reader.
    Local(LocalText),
    /// A key of the locale tables, shown as its text there, or as its last part if the tables lack it.
    Key(String),
    /// A message within the message.
    Note(Box<Note>),
    /// Several arguments, joined by a text.
    Several(Vec<Arg>, Cow<'static, str>),
    /// A number with a fixed number of decimals.
    Decimals {
        /// The number.
        #[serde(with = "real")]
        value: f64,
        /// Decimals.
        digits: usize,
        /// Whether trailing zeros are kept.
        zeros: bool,
    },
    /// A number with a given number of significant digits.
    Figures {
        /// The number.
        #[serde(with = "real")]
        value: f64,
        /// Significant digits.
        digits: usize,
        /// Whether trailing zeros are kept.
        zeros: bool,
    },
}

impl Arg {
    /// A number with `digits` significant digits, trailing zeros kept.
    pub fn figures(value: f64, digits: usize) -> Arg {
        Arg::Figures { value, digits, zeros: true }
    }

    /// A number with at most `digits` significant digits.
    pub fn rounded(value: f64, digits: usize) -> Arg {
        Arg::Figures { value, digits, zeros: false }
    }

    /// A number with `digits` decimals, trailing zeros kept.
    pub fn fixed(value: f64, digits: usize) -> Arg {
        Arg::Decimals { value, digits, zeros: true }
    }

    /// A number with at most `digits` decimals.
    pub fn decimals(value: f64, digits: usize) -> Arg {
        Arg::Decimals { value, digits, zeros: false }
    }

    /// A length of time as it was stated, s, in the largest unit that shows it in a few digits.
    pub fn span(seconds: f64) -> Arg {
        let is_short = |value: f64| {
            let scaled = value * 100.0;
            value >= 1.0 && (scaled - scaled.round()).abs() < 1e-6
        };
        let (key, value) = [("span.hours", seconds / 3600.0), ("span.minutes", seconds / 60.0)]
            .into_iter()
            .find(|(_, value)| is_short(*value))
            .unwrap_or(("span.seconds", seconds));
        Arg::from(Note::new(key).with("n", Arg::Stated(value)))
    }

    /// An id under a prefix of the locale tables, such as `measurand` and `static_bias`.
    pub fn key(prefix: &str, id: &str) -> Arg {
        Arg::Key(format!("{prefix}.{id}"))
    }
}

impl Arg {
    /// The number of an argument that is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Arg::Number(v) | Arg::Stated(v) => Some(*v),
            Arg::Decimals { value, .. } | Arg::Figures { value, .. } => Some(*value),
            Arg::Count(n) => Some(*n as f64),
            _ => None,
        }
    }

    fn plain(&self) -> String {
        match self {
            Arg::Number(v) | Arg::Stated(v) => v.to_string(),
            Arg::Decimals { value, .. } | Arg::Figures { value, .. } => value.to_string(),
            Arg::Count(v) => v.to_string(),
            Arg::Text(text) => format!("{text:?}"),
            Arg::Local(text) => format!("{:?}", text.text()),
            Arg::Key(key) => key.clone(),
            Arg::Note(note) => note.plain(),
            Arg::Several(list, between) => list.iter().map(Arg::plain).collect::<Vec<_>>().join(between),
        }
    }
}

impl From<f64> for Arg {
    fn from(v: f64) -> Self {
        Arg::Number(v)
    }
}
impl From<u64> for Arg {
    fn from(v: u64) -> Self {
        Arg::Count(v)
    }
}
impl From<usize> for Arg {
    fn from(v: usize) -> Self {
        Arg::Count(v as u64)
    }
}
impl From<Note> for Arg {
    fn from(v: Note) -> Self {
        Arg::Note(Box::new(v))
    }
}
impl From<&str> for Arg {
    fn from(v: &str) -> Self {
        Arg::Text(v.to_owned())
    }
}
impl From<LocalText> for Arg {
    /// A text that serves every language is a plain one.
    fn from(v: LocalText) -> Self {
        if v.by_language().is_empty() { Arg::Text(v.text().to_owned()) } else { Arg::Local(v) }
    }
}
impl From<String> for Arg {
    fn from(v: String) -> Self {
        Arg::Text(v)
    }
}

/// A message: its key in the locale tables, and its arguments.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Note {
    /// Key in the locale tables, for example `note.russian_too_short`.
    pub id: Cow<'static, str>,
    /// Arguments by name.
    pub args: BTreeMap<Cow<'static, str>, Arg>,
}

impl Note {
    /// A message without arguments.
    pub fn new(id: impl Into<Cow<'static, str>>) -> Note {
        Note { id: id.into(), args: BTreeMap::new() }
    }

    /// Adds an argument.
    #[must_use]
    pub fn with(mut self, name: impl Into<Cow<'static, str>>, value: impl Into<Arg>) -> Note {
        self.args.insert(name.into(), value.into());
        self
    }
}

impl Note {
    /// The key and its arguments as text, for errors that are printed without a locale table.
    pub fn plain(&self) -> String {
        let args: Vec<String> =
            self.args.iter().map(|(name, arg)| format!("{name} = {}", arg.plain())).collect();
        if args.is_empty() { self.id.to_string() } else { format!("{} ({})", self.id, args.join(", ")) }
    }
}

impl From<&'static str> for Note {
    /// A message without arguments.
    fn from(id: &'static str) -> Note {
        Note::new(id)
    }
}

/// A message by its key and its arguments: `note!("plan.note.unplanned", n, kinds = kinds.join(", "))`. An argument without a value is
/// the variable of its name.
#[macro_export]
macro_rules! note {
    (@value $name:ident) => { $name };
    (@value $name:ident = $value:expr) => { $value };
    ($key:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::message::Note::new($key)
            $(.with(stringify!($name), $crate::message::note!(@value $name $(= $value)?)))*
    };
}

pub use note;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_macro_names_the_arguments_of_a_note() {
        let n = 3_usize;
        let made = note!("table.key", n, value = -2.5_f64.abs(), inner = note!("table.inner", n));
        let inner = Note::new("table.inner").with("n", 3_usize);
        assert_eq!(made, Note::new("table.key").with("n", 3_usize).with("value", -2.5).with("inner", inner));
        assert_eq!(note!("table.key"), Note::new("table.key"));
    }
}
