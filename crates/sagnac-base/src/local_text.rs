//! A text that a user wrote, in one language for all readers or in several.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A text of a user, such as a title or a note, as a reader of each language sees it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct LocalText {
    /// The text where the language of the reader has none of its own.
    text: String,
    /// Text by language code, such as `en` and `ru`; empty where one text serves every language.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    by_language: BTreeMap<String, String>,
}

impl LocalText {
    /// A text in the languages that it was written in, by code. The text of the `default` language stands in for
    /// languages without one; where the default itself is missing, the first by code does. One language alone is a text
    /// for every language.
    pub fn in_languages(mut by_language: BTreeMap<String, String>, default: &str) -> LocalText {
        let text = by_language.get(default).or_else(|| by_language.values().next()).cloned();
        if by_language.len() < 2 {
            by_language.clear();
        }
        LocalText { text: text.unwrap_or_default(), by_language }
    }

    /// A text and what it is in each language, as a result has them.
    pub fn with_languages(text: String, by_language: BTreeMap<String, String>) -> LocalText {
        LocalText { text, by_language }
    }

    /// The text for languages that it was not written in.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text by language code; empty where one text serves every language.
    pub fn by_language(&self) -> &BTreeMap<String, String> {
        &self.by_language
    }

    /// The text for the reader of a language.
    pub fn in_language(&self, code: &str) -> &str {
        self.by_language.get(code).unwrap_or(&self.text)
    }

    /// True where nothing is written.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }
}

impl From<String> for LocalText {
    fn from(text: String) -> LocalText {
        LocalText { text, by_language: BTreeMap::new() }
    }
}

impl From<&str> for LocalText {
    fn from(text: &str) -> LocalText {
        text.to_owned().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pairs: &[(&str, &str)]) -> LocalText {
        let map = pairs.iter().map(|(code, text)| ((*code).to_owned(), (*text).to_owned())).collect();
        LocalText::in_languages(map, "en")
    }

    #[test]
    fn each_reader_sees_the_own_language_and_others_the_default() {
        let text = of(&[("en", "bias"), ("ru", "смещение")]);
        assert_eq!(
            (text.in_language("ru"), text.in_language("en"), text.in_language("de")),
            ("смещение", "bias", "bias")
        );
    }

    #[test]
    fn one_language_serves_all() {
        let text = of(&[("ru", "смещение")]);
        assert_eq!(text, LocalText::from("смещение"));
        assert_eq!(text.in_language("en"), "смещение");
    }

    #[test]
    fn without_the_default_the_first_by_code_stands_in() {
        assert_eq!(of(&[("ru", "смещение"), ("de", "Nullpunkt")]).in_language("en"), "Nullpunkt");
        assert!(of(&[]).is_empty());
    }
}
