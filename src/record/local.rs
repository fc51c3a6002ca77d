//! How a text of a user stands in JSON: under its own name as a string, English where it was written in English too, and
//! beside it, where it was written in several languages, under `<name>_by_language` by language code. A program that
//! reads the string never meets anything else there.

use crate::i18n::LocalText;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

/// A text that is always there, or one that may be absent.
pub(crate) trait Written: Sized {
    /// Its string in JSON.
    type Plain: Serialize + DeserializeOwned + Default;

    /// The string, and the text by language.
    fn parts(&self) -> (Self::Plain, BTreeMap<String, String>);

    /// The text of a string and of the text by language.
    fn of(plain: Self::Plain, by_language: BTreeMap<String, String>) -> Self;
}

impl Written for LocalText {
    type Plain = String;

    fn parts(&self) -> (String, BTreeMap<String, String>) {
        (self.text().to_owned(), self.by_language().clone())
    }

    fn of(plain: String, by_language: BTreeMap<String, String>) -> LocalText {
        LocalText::with_languages(plain, by_language)
    }
}

impl Written for Option<LocalText> {
    type Plain = Option<String>;

    fn parts(&self) -> (Option<String>, BTreeMap<String, String>) {
        let both = self.as_ref().map(Written::parts);
        both.map_or_else(Default::default, |(plain, by_language)| (Some(plain), by_language))
    }

    fn of(plain: Option<String>, by_language: BTreeMap<String, String>) -> Option<LocalText> {
        plain.map(|text| LocalText::with_languages(text, by_language))
    }
}

/// A module for `#[serde(flatten, with = "local::title")]`, and its schema for `schemars(with = "...")`.
macro_rules! field {
    ($(#[$doc:meta])* $name:ident, $plain:literal, $by_language:literal) => {
        pub(crate) mod $name {
            use super::*;

            /// The two members of JSON.
            #[derive(Serialize, Deserialize)]
            #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
            pub(crate) struct Members<T> {
                $(#[$doc])*
                #[serde(rename = $plain, default)]
                #[cfg_attr(feature = "schema", schemars(!default))]
                plain: T,
                /// The same by language code, where it was written in several languages.
                #[serde(rename = $by_language, default, skip_serializing_if = "BTreeMap::is_empty")]
                by_language: BTreeMap<String, String>,
            }

            pub(crate) fn serialize<T: Written, S: Serializer>(
                text: &T,
                serializer: S,
            ) -> Result<S::Ok, S::Error> {
                let (plain, by_language) = text.parts();
                Members { plain, by_language }.serialize(serializer)
            }

            pub(crate) fn deserialize<'de, T: Written, D: Deserializer<'de>>(
                deserializer: D,
            ) -> Result<T, D::Error> {
                let Members { plain, by_language } = Members::<T::Plain>::deserialize(deserializer)?;
                Ok(T::of(plain, by_language))
            }
        }
    };
}

field!(
    /// Title.
    title,
    "title",
    "title_by_language"
);
field!(
    /// Standard followed.
    standard,
    "standard",
    "standard_by_language"
);
field!(
    /// Clause of the standard, for example `12.11`.
    clause,
    "clause",
    "clause_by_language"
);
field!(
    /// Who wrote it.
    author,
    "author",
    "author_by_language"
);
field!(
    /// Organisation that answers for the protocol.
    organisation,
    "organisation",
    "organisation_by_language"
);
field!(
    /// Where the test was made.
    place,
    "place",
    "place_by_language"
);
field!(
    /// Where the values come from.
    source,
    "source",
    "source_by_language"
);
field!(
    /// Family, for example `OIUS-501`.
    family,
    "family",
    "family_by_language"
);
field!(
    /// Name.
    name,
    "name",
    "name_by_language"
);
field!(
    /// What must be known with it.
    note,
    "note",
    "note_by_language"
);
field!(
    /// Footnote.
    footnote,
    "footnote",
    "footnote_by_language"
);
field!(
    /// Free text.
    description,
    "description",
    "description_by_language"
);
field!(
    /// Who decided.
    by,
    "by",
    "by_by_language"
);
field!(
    /// Why.
    reason,
    "reason",
    "reason_by_language"
);

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Clause {
        id: String,
        #[serde(flatten, with = "super::title")]
        title: LocalText,
        #[serde(flatten, with = "super::note")]
        note: Option<LocalText>,
        factor: Option<f64>,
    }

    fn both() -> LocalText {
        let map = [("en", "Bias"), ("ru", "Смещение")].map(|(code, text)| (code.to_owned(), text.to_owned()));
        LocalText::in_languages(map.into(), "en")
    }

    #[test]
    fn a_plain_text_is_a_string_and_nothing_else() {
        let clause = Clause { id: "a".into(), title: "Bias".into(), note: None, factor: None };
        let json = serde_json::to_string(&clause).unwrap();
        assert_eq!(json, r#"{"id":"a","title":"Bias","note":null,"factor":null}"#);
        assert_eq!(serde_json::from_str::<Clause>(&json).unwrap(), clause);
    }

    #[test]
    fn languages_stand_beside_the_string() {
        let clause = Clause { id: "a".into(), title: both(), note: Some("plain".into()), factor: Some(0.5) };
        let json = serde_json::to_value(&clause).unwrap();
        assert_eq!(json["title"], "Bias");
        assert_eq!(json["title_by_language"], serde_json::json!({"en": "Bias", "ru": "Смещение"}));
        assert_eq!(json["note"], "plain");
        assert!(json.get("note_by_language").is_none());
        assert_eq!(serde_json::from_value::<Clause>(json).unwrap(), clause);
    }

    #[test]
    fn a_text_that_is_not_there_is_empty() {
        let read: Clause = serde_json::from_str(r#"{"id":"a","note":null,"factor":null}"#).unwrap();
        assert!(read.title.is_empty() && read.note.is_none());
        assert!(serde_json::from_str::<Clause>(r#"{"id":"a","title":1,"factor":null}"#).is_err());
    }
}
