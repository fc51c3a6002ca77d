//! Words: every sentence a report, a diagnostic or a result shows goes through one table per language.
//!
//! A [`Note`] is a sentence by name with its numbers; it becomes words only where it is shown, so that the same
//! result can be read in any language. The tables are `templates/locale/*.toml`.

mod lang;
mod system;
mod visible;

pub use lang::Lang;
pub use system::io_reason;
pub use visible::{steers, visible, visible_lines};

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::LazyLock;

static ENGLISH: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| flatten(include_str!("../templates/locale/en.toml")));

static RUSSIAN: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| flatten(include_str!("../templates/locale/ru.toml")));

/// Turns the nested tables of a locale file into dotted keys.
fn flatten(source: &str) -> BTreeMap<String, String> {
    fn walk(prefix: &str, table: &toml::Table, out: &mut BTreeMap<String, String>) {
        for (key, value) in table {
            let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
            match value {
                toml::Value::Table(inner) => walk(&path, inner, out),
                toml::Value::String(text) => {
                    out.insert(path, text.clone());
                }
                _ => {}
            }
        }
    }
    let mut out = BTreeMap::new();
    if let Ok(table) = source.parse::<toml::Table>() {
        walk("", &table, &mut out);
    }
    out
}

/// The table of a language: dotted key → text with `{argument}` places.
pub fn table(lang: Lang) -> &'static BTreeMap<String, String> {
    match lang {
        Lang::En => &ENGLISH,
        Lang::Ru => &RUSSIAN,
    }
}

/// The text of a key, in English where the table of the language lacks it; `None` when no table has it.
pub fn lookup(lang: Lang, key: &str) -> Option<&'static str> {
    table(lang).get(key).or_else(|| table(Lang::En).get(key)).map(String::as_str)
}

/// One argument of a note.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Arg {
    /// A number; shown with up to four significant digits.
    Number(f64),
    /// A number as it was stated, such as a requirement; shown with every digit.
    Stated(f64),
    /// A count; shown in full.
    Count(u64),
    /// A text, shown as one line, without what steers a terminal.
    Text(String),
    /// A key of the locale tables, shown as what stands there; as its last part where nothing does.
    Key(String),
    /// A sentence within the sentence.
    Note(Box<Note>),
    /// Several arguments with a text between each two; serialised in English.
    #[serde(serialize_with = "joined")]
    Several(Vec<Arg>, &'static str),
    /// A number with so many decimals, whatever its size, with or without idle zeros; serialised as the number.
    #[serde(serialize_with = "bare")]
    Decimals {
        /// The number.
        value: f64,
        /// Decimals.
        digits: usize,
        /// Whether zeros that fill the decimals are shown.
        zeros: bool,
    },
    /// A number with its own count of significant digits, with or without idle zeros behind the decimal mark;
    /// serialised as the number.
    #[serde(serialize_with = "bare")]
    Figures {
        /// The number.
        value: f64,
        /// Significant digits.
        digits: usize,
        /// Whether zeros that fill the digits are shown.
        zeros: bool,
    },
}

impl Arg {
    /// The words of a key: what the table says, or else the last part of the key.
    pub fn words(key: &str, lang: Lang) -> String {
        lookup(lang, key)
            .map_or_else(|| key.rsplit('.').next().unwrap_or(key).replace('_', " "), str::to_owned)
    }

    /// A number with significant digits, idle zeros among them.
    pub fn figures(value: f64, digits: usize) -> Arg {
        Arg::Figures { value, digits, zeros: true }
    }

    /// A number with at most so many significant digits, without idle zeros.
    pub fn rounded(value: f64, digits: usize) -> Arg {
        Arg::Figures { value, digits, zeros: false }
    }

    /// A number with a fixed count of decimals.
    pub fn fixed(value: f64, digits: usize) -> Arg {
        Arg::Decimals { value, digits, zeros: true }
    }

    /// A number with at most so many decimals.
    pub fn decimals(value: f64, digits: usize) -> Arg {
        Arg::Decimals { value, digits, zeros: false }
    }

    /// The argument in words, with the decimal mark of the language.
    pub fn say(&self, lang: Lang) -> String {
        match self {
            Arg::Number(v) => decimal(&trimmed(significant(*v, 4)), lang),
            Arg::Stated(v) => decimal(&trimmed(significant(*v, 12)), lang),
            Arg::Figures { value, digits, zeros: true } => decimal(&significant(*value, *digits), lang),
            Arg::Figures { value, digits, zeros: false } => {
                decimal(&trimmed(significant(*value, *digits)), lang)
            }
            Arg::Decimals { value, digits, zeros: true } => decimal(&format!("{value:.digits$}"), lang),
            Arg::Decimals { value, digits, zeros: false } => {
                decimal(&trimmed(format!("{value:.digits$}")), lang)
            }
            Arg::Count(v) => v.to_string(),
            Arg::Text(t) => visible(t).into_owned(),
            Arg::Key(k) => Arg::words(k, lang),
            Arg::Note(n) => n.say(lang),
            Arg::Several(list, between) => list.iter().map(|a| a.say(lang)).collect::<Vec<_>>().join(between),
        }
    }

    /// An id under a prefix of the locale tables, such as `measurand` and `static_bias`.
    pub fn key(prefix: &str, id: &str) -> Arg {
        Arg::Key(format!("{prefix}.{id}"))
    }
}

/// A number without its presentation.
fn bare<S: Serializer>(value: &f64, _: &usize, _: &bool, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(*value)
}

fn joined<S: Serializer>(list: &[Arg], between: &&str, serializer: S) -> Result<S::Ok, S::Error> {
    let words: Vec<String> = list.iter().map(|a| a.say(Lang::En)).collect();
    serializer.serialize_str(&words.join(between))
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
impl From<String> for Arg {
    fn from(v: String) -> Self {
        Arg::Text(v)
    }
}

/// A sentence by name, with its arguments. Serialised as the English text plus name and arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Key in the locale tables, for example `note.record_too_short`.
    pub id: &'static str,
    /// Arguments by name.
    pub args: BTreeMap<&'static str, Arg>,
}

impl Note {
    /// A note with no arguments yet.
    pub fn new(id: &'static str) -> Note {
        Note { id, args: BTreeMap::new() }
    }

    /// Adds an argument.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Into<Arg>) -> Note {
        self.args.insert(name, value.into());
        self
    }

    /// The sentence in a language. A key the table lacks shows as itself, so that it is noticed.
    pub fn say(&self, lang: Lang) -> String {
        fill(lookup(lang, self.id).unwrap_or(self.id), |name| self.args.get(name).map(|arg| arg.say(lang)))
    }
}

impl std::fmt::Display for Note {
    /// In English: the language of `result.json`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.say(Lang::En))
    }
}

impl From<&'static str> for Note {
    /// A sentence without arguments, by its key.
    fn from(id: &'static str) -> Note {
        Note::new(id)
    }
}

impl Serialize for Note {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut s = serializer.serialize_struct("Note", 3)?;
        s.serialize_field("text", &self.say(Lang::En))?;
        s.serialize_field("id", self.id)?;
        s.serialize_field("args", &self.args)?;
        s.end()
    }
}

/// Replaces every `{name}` in a pattern.
pub(crate) fn fill(pattern: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(pattern.len() + 16);
    let mut rest = pattern;
    while let Some(open) = rest.find('{') {
        let Some(close) = rest[open..].find('}').map(|i| open + i) else { break };
        out.push_str(&rest[..open]);
        let name = &rest[open + 1..close];
        match value(name) {
            Some(text) => out.push_str(&text),
            None => out.push_str(&rest[open..=close]),
        }
        rest = &rest[close + 1..];
    }
    out.push_str(rest);
    out
}

/// Without zeros behind the decimal mark that say nothing.
fn trimmed(text: String) -> String {
    let (mantissa, exponent) = match text.split_once('e') {
        Some((m, e)) => (m, Some(e)),
        None => (text.as_str(), None),
    };
    if !mantissa.contains('.') {
        return text;
    }
    let short = mantissa.trim_end_matches('0').trim_end_matches('.');
    exponent.map_or_else(|| short.to_owned(), |e| format!("{short}e{e}"))
}

/// An ASCII number with the decimal mark of a language. What was rounded to zero has no sign.
pub fn decimal(ascii: &str, lang: Lang) -> String {
    let zero = |rest: &&str| rest.bytes().all(|b| matches!(b, b'0' | b'.'));
    let ascii = ascii.strip_prefix('-').filter(zero).unwrap_or(ascii);
    ascii.replace('.', lookup(lang, "number.decimal").unwrap_or("."))
}

/// A number with the given count of significant digits, plain where that reads well and with an exponent elsewhere.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "–".to_owned();
    }
    let digits = digits.max(1);
    // Rounding may carry into the next decade (9.9996 → 10.00), so the exponent is read after rounding.
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-5..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let plain = format!("{value:.decimals$}");
        if plain.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { "0".into() } else { plain }
    } else {
        format!("{mantissa}e{exponent}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_rounded_to_zero_has_no_sign() {
        assert_eq!(Arg::decimals(-0.0004, 2).say(Lang::En), "0");
        assert_eq!(Arg::fixed(-0.004, 2).say(Lang::Ru), "0,00");
        assert_eq!(Arg::decimals(-0.04, 2).say(Lang::En), "-0.04");
    }

    #[test]
    fn numbers_keep_their_significant_digits() {
        assert_eq!(significant(0.0023149, 3), "0.00231");
        assert_eq!(significant(-9.9996, 4), "-10.00");
        assert_eq!(significant(36000.0, 4), "36000");
        assert_eq!(significant(1.5e-9, 3), "1.50e-9");
        assert_eq!(significant(f64::NAN, 3), "–");
    }

    #[test]
    fn arguments_are_put_in_and_missing_ones_show() {
        assert_eq!(fill("{a} of {b}", |n| (n == "a").then(|| "1".to_owned())), "1 of {b}");
    }

    #[test]
    fn the_english_table_is_valid_toml() {
        assert!(!table(Lang::En).is_empty());
    }
}
