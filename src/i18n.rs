//! Words: every sentence a report, a diagnostic or a result shows goes through one table per language.
//!
//! A [`Note`] is a sentence by name with its numbers; it becomes words only where it is shown, so that the same
//! result can be read in any language. The tables are `templates/locale/*.toml`.

mod lang;
mod system;

pub use lang::Lang;
pub use sagnac_core::message::{Arg, Note};
pub use sagnac_core::visible::{steers, visible, visible_lines};
pub use system::io_reason;

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

/// The words of a key: what the table says, or else the last part of the key.
pub fn words(key: &str, lang: Lang) -> String {
    lookup(lang, key).map_or_else(|| key.rsplit('.').next().unwrap_or(key).replace('_', " "), str::to_owned)
}

/// What can be said in a language.
pub trait Localize {
    /// The words, with the decimal mark of the language.
    fn say(&self, lang: Lang) -> String;
}

impl Localize for Arg {
    fn say(&self, lang: Lang) -> String {
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
            Arg::Key(k) => words(k, lang),
            Arg::Note(n) => n.say(lang),
            Arg::Several(list, between) => list.iter().map(|a| a.say(lang)).collect::<Vec<_>>().join(between),
        }
    }
}

impl Localize for Note {
    /// The sentence. A key that the table lacks shows as itself, so that it is noticed.
    fn say(&self, lang: Lang) -> String {
        fill(lookup(lang, &self.id).unwrap_or(&self.id), |name| self.args.get(name).map(|arg| arg.say(lang)))
    }
}

impl Localize for sagnac_ingest::IngestError {
    /// The whole diagnostic: place, what is wrong, what was found, what to do.
    fn say(&self, lang: Lang) -> String {
        self.note().say(lang)
    }
}

/// Texts of the catalogue of effects.
pub trait Bilingual {
    /// The text in a language.
    fn of(&self, lang: Lang) -> &'static str;
}

impl Bilingual for sagnac_core::effect::Both {
    fn of(&self, lang: Lang) -> &'static str {
        match lang {
            Lang::En => self.en,
            Lang::Ru => self.ru,
        }
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
