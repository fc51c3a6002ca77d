//! Texts: plain ones, and those that a user may write in one language for all readers or in several, such as
//! `title = "Bias"` or `title = { en = "Bias", ru = "Смещение нуля" }`.

use super::diagnostics::Span;
use super::reader::{Reader, Value, meant, shorten};
use crate::i18n::{Lang, LocalText, Note, note};
use sagnac_core::spelling::nearest;
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// Longest text that is taken, characters.
const MAX_TEXT_CHARACTERS: usize = 2000;

/// Whether a text may be blank.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Blank {
    /// It may; it is then empty.
    Allowed,
    /// It may not.
    Refused,
}

/// A text of one language.
pub(super) fn text(reader: &mut Reader<'_>, value: Value<'_>, blank: Blank) -> Option<String> {
    let DeValue::String(text) = value.toml else { return reader.wrong(value) };
    if text.trim().is_empty() {
        if blank == Blank::Allowed {
            return Some(String::new());
        }
        let message = note!("keyed.empty", key = value.key.name);
        reader.error(value.span, message, Some("keyed.help.fill_in".into()));
        return None;
    }
    if text.chars().count() > MAX_TEXT_CHARACTERS
        || text.chars().any(|c| c.is_control() && c != '\n' && c != '\t')
    {
        let message = note!("keyed.no_text", key = value.key.name);
        let help = note!("keyed.help.text", most = MAX_TEXT_CHARACTERS);
        reader.error(value.span, message, Some(help));
        return None;
    }
    Some(text.trim().to_owned())
}

/// Reads a text, or a table of texts by language.
pub(super) fn local(reader: &mut Reader<'_>, value: Value<'_>, blank: Blank) -> Option<LocalText> {
    match value.toml {
        DeValue::String(_) => text(reader, value, blank).map(LocalText::from),
        DeValue::Table(table) if table.is_empty() => {
            let message = note!("local_text.empty", key = value.key.name);
            reader.error(value.span, message, Some(written(value.key.name)));
            None
        }
        DeValue::Table(table) => by_language(reader, value, table, blank),
        _ => reader.wrong(value),
    }
}

fn by_language(
    reader: &mut Reader<'_>,
    value: Value<'_>,
    table: &DeTable<'_>,
    blank: Blank,
) -> Option<LocalText> {
    let mut texts = BTreeMap::new();
    let mut sound = true;
    for (code, given) in table.iter() {
        if Lang::from_code(code.get_ref()).is_none() {
            unknown(reader, value.key.name, code.get_ref(), &code.span());
            sound = false;
            continue;
        }
        let at = given.span();
        let read = match given.get_ref() {
            DeValue::String(_) => text(reader, value.with(given.get_ref(), &at), blank),
            _ => {
                let message = note!("local_text.no_text", key = value.key.name);
                reader.error(
                    &at,
                    message.with("code", code.get_ref().as_ref()),
                    Some(written(value.key.name)),
                );
                None
            }
        };
        match read {
            Some(text) => {
                texts.insert(code.get_ref().to_string(), text);
            }
            None => sound = false,
        }
    }
    let default = Lang::default().code();
    if sound && !texts.contains_key(default) {
        let message = note!(
            "local_text.no_default",
            key = value.key.name,
            default,
            shown = texts.keys().next().map_or("", String::as_str)
        );
        reader.warning(value.span, message, Some(note!("local_text.help.default", key = value.key.name)));
    }
    sound.then(|| LocalText::in_languages(texts, default))
}

fn unknown(reader: &mut Reader<'_>, key: &str, code: &str, at: &Span) {
    let known = || Lang::ALL.iter().map(|l| l.code());
    let help = match nearest(code, known()) {
        Some(near) => meant(near),
        None => note!("local_text.help.languages", codes = known().collect::<Vec<_>>().join(", ")),
    };
    let message = note!("local_text.unknown", key, code = shorten(code));
    reader.error(at, message, Some(help));
}

/// How a text is written in every language.
fn written(key: &str) -> Note {
    let texts: Vec<String> = Lang::ALL.iter().map(|l| format!("{key}.{} = \"...\"", l.code())).collect();
    note!("local_text.help.written", example = texts.join("; "))
}
