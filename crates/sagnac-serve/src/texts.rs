//! The texts of the pages, one table for each language.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A language of the pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lang {
    /// English.
    En,
    /// Russian.
    Ru,
}

impl Lang {
    /// Every language.
    pub const ALL: [Lang; 2] = [Lang::En, Lang::Ru];

    /// Its code.
    pub fn code(self) -> &'static str {
        match self {
            Lang::En => "en",
            Lang::Ru => "ru",
        }
    }

    /// The language with this code.
    pub fn from_code(code: &str) -> Option<Lang> {
        Lang::ALL.into_iter().find(|lang| lang.code() == code)
    }

    /// The decimal mark.
    pub fn decimal_mark(self) -> &'static str {
        match self {
            Lang::En => ".",
            Lang::Ru => ",",
        }
    }
}

/// Dotted key to text with `{argument}` places.
type Table = BTreeMap<String, String>;

static TABLES: LazyLock<[Table; 2]> =
    LazyLock::new(|| [include_str!("../locale/en.toml"), include_str!("../locale/ru.toml")].map(flatten));

fn flatten(source: &str) -> Table {
    let mut out = Table::new();
    for (section, table) in source.parse::<toml::Table>().unwrap_or_default() {
        for (key, text) in table.as_table().into_iter().flatten() {
            if let Some(text) = text.as_str() {
                out.insert(format!("{section}.{key}"), text.to_owned());
            }
        }
    }
    out
}

fn table(lang: Lang) -> &'static Table {
    let [en, ru] = &*TABLES;
    match lang {
        Lang::En => en,
        Lang::Ru => ru,
    }
}

/// The text of a key. A key without one shows as itself, so that it is noticed.
pub fn text(key: &str, lang: Lang) -> &str {
    table(lang).get(key).map_or(key, String::as_str)
}

/// The text of a key with its arguments.
pub fn filled(key: &str, arguments: &[(&str, &str)], lang: Lang) -> String {
    let mut out = text(key, lang).to_owned();
    for (name, value) in arguments {
        out = out.replace(&format!("{{{name}}}"), value);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_languages_have_the_same_keys_and_arguments() {
        let places = |text: &str| {
            let mut found: Vec<String> =
                text.split('{').skip(1).filter_map(|t| Some(t.split_once('}')?.0.to_owned())).collect();
            found.sort();
            found
        };
        let (en, ru) = (table(Lang::En), table(Lang::Ru));
        assert!(en.len() > 40, "{}", en.len());
        assert_eq!(en.keys().collect::<Vec<_>>(), ru.keys().collect::<Vec<_>>());
        for (key, text) in en {
            assert_eq!(places(text), places(&ru[key]), "{key}");
            let is_russian = ru[key].chars().any(|c| ('\u{400}'..='\u{4ff}').contains(&c));
            assert_eq!(is_russian, !key.starts_with("symbol.") && key != "page.english", "{key}");
        }
    }

    #[test]
    fn every_text_is_used_and_every_key_has_one() {
        let sources = [
            include_str!("../templates/page.html"),
            include_str!("../templates/bench.html"),
            include_str!("../templates/blocks.html"),
            include_str!("../templates/unit.html"),
            include_str!("../templates/units.html"),
            include_str!("../templates/lots.html"),
            include_str!("../templates/live.html"),
            include_str!("../templates/login.html"),
            include_str!("../templates/refused.html"),
        ];
        let mut used = std::collections::BTreeSet::new();
        for key in sources.iter().flat_map(|source| source.split("t('").skip(1)) {
            used.insert(key.split('\'').next().unwrap().to_owned());
        }
        let computed = ["verdict.", "symbol.", "state.", "next.", "refusal."];
        for key in used.iter().filter(|key| !key.ends_with('.')) {
            assert!(table(Lang::En).contains_key(key), "no text for {key}");
        }
        for key in table(Lang::En).keys() {
            let is_computed = computed.iter().any(|section| key.starts_with(section));
            assert!(is_computed || used.contains(key), "{key} is not used");
        }
    }
}
