//! Words: every sentence a report, a diagnostic or a result shows goes through one table per language.
//!
//! A [`Note`] is a sentence by name with its numbers; it becomes words only where it is shown, so that the same
//! result can be read in any language. The tables are `templates/locale/*.toml`.

mod effect_text;
mod lang;
mod system;

pub use effect_text::{EffectText, effect_key, effect_text};
pub use lang::Lang;
pub use sagnac_core::local_text::LocalText;
pub use sagnac_core::message::{Arg, Note, note};
use sagnac_core::render;
pub use sagnac_core::render::{fill, significant, with_decimals};
pub use sagnac_core::visible::{steers, visible, visible_lines};
pub use system::io_reason;

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Dotted key to text with `{argument}` places.
type Table = BTreeMap<String, String>;

/// The table of each language, in the order of [`Lang::ALL`]; read when the language is first asked for.
static LOCALE_TABLES: [OnceLock<Table>; Lang::ALL.len()] = [const { OnceLock::new() }; Lang::ALL.len()];

static EMPTY_TABLE: Table = Table::new();

/// Turns the nested tables of a locale file into dotted keys.
fn flatten(source: &str) -> Table {
    fn walk(prefix: &str, table: &toml::Table, out: &mut Table) {
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
    let mut out = Table::new();
    if let Ok(table) = source.parse::<toml::Table>() {
        walk("", &table, &mut out);
    }
    out
}

/// The table of a language: dotted key → text with `{argument}` places.
pub fn table(lang: Lang) -> &'static BTreeMap<String, String> {
    let place = Lang::ALL.iter().position(|of| *of == lang).and_then(|place| LOCALE_TABLES.get(place));
    place.map_or(&EMPTY_TABLE, |table| table.get_or_init(|| flatten(lang.source())))
}

/// The text of a key, in English where the table of the language lacks it; `None` when no table has it.
pub fn lookup(lang: Lang, key: &str) -> Option<&'static str> {
    table(lang).get(key).or_else(|| table(Lang::En).get(key)).map(String::as_str)
}

/// The words of a key: what the table says, or else the last part of the key.
pub fn words(key: &str, lang: Lang) -> String {
    render::words(key, &|key| lookup(lang, key))
}

/// An ASCII number with the decimal mark of a language. What was rounded to zero has no sign.
pub fn decimal(ascii: &str, lang: Lang) -> String {
    render::decimal(ascii, &|key| lookup(lang, key))
}

/// A message or a text that can be said in a language.
pub trait Localize {
    /// The words, with the decimal mark of the language.
    fn say(&self, lang: Lang) -> String;
}

impl Localize for LocalText {
    /// The text that the user wrote for the language, or the one that stands in for it.
    fn say(&self, lang: Lang) -> String {
        self.in_language(lang.code()).to_owned()
    }
}

impl Localize for Arg {
    fn say(&self, lang: Lang) -> String {
        self.render(&|key| lookup(lang, key))
    }
}

impl Localize for Note {
    /// The sentence. A key that the table lacks shows as itself, so that it is noticed.
    fn say(&self, lang: Lang) -> String {
        self.render(&|key| lookup(lang, key))
    }
}

impl Localize for sagnac_ingest::IngestError {
    /// The whole diagnostic: place, what is wrong, what was found, what to do.
    fn say(&self, lang: Lang) -> String {
        self.note().say(lang)
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
