//! A sentence as it stands in results: in English, and by name with its arguments for other languages.

use crate::i18n::{Arg, Lang, LocalText, Localize, Note};
use serde::de::Error as _;
use serde::ser::{Error as _, SerializeMap, SerializeStruct};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;

/// A sentence of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Message(pub Note);

impl From<Note> for Message {
    fn from(note: Note) -> Message {
        Message(note)
    }
}

impl From<Message> for Arg {
    fn from(message: Message) -> Arg {
        message.0.into()
    }
}

impl From<&'static str> for Message {
    fn from(id: &'static str) -> Message {
        Message(Note::new(id))
    }
}

impl Localize for Message {
    fn say(&self, lang: Lang) -> String {
        self.0.say(lang)
    }
}

impl std::ops::Deref for Message {
    type Target = Note;

    fn deref(&self) -> &Note {
        &self.0
    }
}

/// How a [`Message`] appears in JSON.
#[derive(Default, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "NoteSchema", !default))]
#[allow(dead_code)]
struct MessageSchema {
    /// The sentence in English.
    text: String,
    /// Its name in the locale tables.
    id: String,
    /// Its arguments.
    args: BTreeMap<String, Value>,
    /// How arguments are presented, by name, where their plain value does not tell it.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(with = "Option<BTreeMap<String, Value>>"))]
    show: BTreeMap<String, Presentation>,
}

/// How an argument is presented, where its plain JSON value does not tell it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Presentation {
    /// Every digit of a number as it was stated.
    Stated,
    /// A key of the locale tables, not a text.
    Key,
    /// A text of a user by language code; the plain value stands in for other languages.
    ByLanguage(BTreeMap<String, String>),
    /// A fixed number of decimals.
    Decimals {
        /// Decimals.
        digits: usize,
        /// Whether trailing zeros are kept.
        zeros: bool,
    },
    /// A fixed number of significant digits.
    Figures {
        /// Significant digits.
        digits: usize,
        /// Whether trailing zeros are kept.
        zeros: bool,
    },
    /// A list; the plain value is the English text of it.
    List {
        /// The elements.
        items: Vec<Item>,
        /// The text between each two.
        separator: String,
    },
    /// Positive infinity, which JSON has no number for.
    Infinity,
    /// Negative infinity.
    NegativeInfinity,
}

/// One element of a list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Item {
    /// Plain value, as in `args`.
    value: Value,
    /// Presentation, as in `show`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    show: Option<Presentation>,
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Message {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        MessageSchema::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        MessageSchema::json_schema(generator)
    }
}

impl Serialize for Message {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        note(&self.0, serializer)
    }
}

impl<'de> Deserialize<'de> for Message {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Message, D::Error> {
        let MessageSchema { text: _, id, args, mut show } = MessageSchema::deserialize(deserializer)?;
        let mut note = Note::new(id);
        for (name, value) in args {
            let arg = argument(value, show.remove(&name)).map_err(D::Error::custom)?;
            note = note.with(name, arg);
        }
        Ok(Message(note))
    }
}

fn note<S: Serializer>(note: &Note, serializer: S) -> Result<S::Ok, S::Error> {
    let mut show = BTreeMap::new();
    for (name, arg) in &note.args {
        if let Some(presentation) = presentation(arg).map_err(S::Error::custom)? {
            show.insert(name.as_ref(), presentation);
        }
    }
    let mut s = serializer.serialize_struct("Note", if show.is_empty() { 3 } else { 4 })?;
    s.serialize_field("text", &note.say(Lang::En))?;
    s.serialize_field("id", &note.id)?;
    s.serialize_field("args", &Args(note))?;
    if !show.is_empty() {
        s.serialize_field("show", &show)?;
    }
    s.end()
}

/// What the plain value of an argument loses.
fn presentation(arg: &Arg) -> serde_json::Result<Option<Presentation>> {
    let number = match arg {
        Arg::Number(v) | Arg::Stated(v) => *v,
        Arg::Decimals { value, .. } | Arg::Figures { value, .. } => *value,
        _ => 0.0,
    };
    if number.is_infinite() {
        return Ok(Some(if number > 0.0 { Presentation::Infinity } else { Presentation::NegativeInfinity }));
    }
    Ok(match arg {
        Arg::Number(_) | Arg::Count(_) | Arg::Text(_) | Arg::Note(_) => None,
        Arg::Local(text) => Some(Presentation::ByLanguage(text.by_language().clone())),
        Arg::Stated(_) => Some(Presentation::Stated),
        Arg::Key(_) => Some(Presentation::Key),
        Arg::Decimals { digits, zeros, .. } => {
            Some(Presentation::Decimals { digits: *digits, zeros: *zeros })
        }
        Arg::Figures { digits, zeros, .. } => Some(Presentation::Figures { digits: *digits, zeros: *zeros }),
        Arg::Several(list, separator) => {
            let item = |arg| Ok(Item { value: serde_json::to_value(Plain(arg))?, show: presentation(arg)? });
            let items = list.iter().map(item).collect::<serde_json::Result<_>>()?;
            Some(Presentation::List { items, separator: separator.to_string() })
        }
    })
}

/// The argument of a plain value and its presentation. Without one, as in files written before there was any, a number
/// is shown with four significant digits and a string is a text.
fn argument(value: Value, show: Option<Presentation>) -> Result<Arg, String> {
    let wrong = |value: &Value| format!("{value} is not an argument of this presentation");
    let number = |value: &Value| match value {
        Value::Null => Ok(f64::NAN),
        other => other.as_f64().ok_or_else(|| wrong(other)),
    };
    Ok(match (show, value) {
        (None, Value::Object(map)) => {
            let inner = Message::deserialize(Value::Object(map)).map_err(|e| e.to_string())?;
            Arg::Note(Box::new(inner.0))
        }
        (None, Value::String(text)) => Arg::Text(text),
        (None, value) => match value.as_u64() {
            Some(count) => Arg::Count(count),
            None => Arg::Number(number(&value)?),
        },
        (Some(Presentation::Key), Value::String(key)) => Arg::Key(key),
        (Some(Presentation::ByLanguage(texts)), Value::String(text)) => {
            Arg::Local(LocalText::with_languages(text, texts))
        }
        (Some(Presentation::Stated), value) => Arg::Stated(number(&value)?),
        (Some(Presentation::Decimals { digits, zeros }), value) => {
            Arg::Decimals { value: number(&value)?, digits, zeros }
        }
        (Some(Presentation::Figures { digits, zeros }), value) => {
            Arg::Figures { value: number(&value)?, digits, zeros }
        }
        (Some(Presentation::List { items, separator }), _) => {
            let list = items.into_iter().map(|i| argument(i.value, i.show)).collect::<Result<_, _>>()?;
            Arg::Several(list, separator.into())
        }
        (Some(Presentation::Infinity), _) => Arg::Number(f64::INFINITY),
        (Some(Presentation::NegativeInfinity), _) => Arg::Number(f64::NEG_INFINITY),
        (Some(Presentation::Key | Presentation::ByLanguage(_)), value) => return Err(wrong(&value)),
    })
}

struct Args<'a>(&'a Note);

impl Serialize for Args<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.args.len()))?;
        for (name, arg) in &self.0.args {
            map.serialize_entry(name, &Plain(arg))?;
        }
        map.end()
    }
}

struct Plain<'a>(&'a Arg);

impl Serialize for Plain<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Arg::Number(v) | Arg::Stated(v) => serializer.serialize_f64(*v),
            Arg::Decimals { value, .. } | Arg::Figures { value, .. } => serializer.serialize_f64(*value),
            Arg::Count(v) => serializer.serialize_u64(*v),
            Arg::Text(text) | Arg::Key(text) => serializer.serialize_str(text),
            Arg::Local(text) => serializer.serialize_str(text.text()),
            Arg::Note(inner) => note(inner, serializer),
            several @ Arg::Several(..) => serializer.serialize_str(&several.say(Lang::En)),
        }
    }
}

/// For `#[serde(with = "notes")]`: a list of notes in the form of [`Message`].
pub(crate) mod notes {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(notes: &[Note], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(notes.iter().cloned().map(Message))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Note>, D::Error> {
        Ok(Vec::<Message>::deserialize(deserializer)?.into_iter().map(|m| m.0).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::note;

    fn read_back(message: &Message) -> Message {
        serde_json::from_str(&serde_json::to_string(message).unwrap()).unwrap()
    }

    fn every_argument() -> Note {
        note!(
            "note.russian_too_short",
            number = 0.1,
            whole = 3.0,
            count = 3_u64,
            stated = Arg::Stated(12.50),
            text = "measurand.static_bias",
            local =
                LocalText::in_languages([("en".into(), "a".into()), ("ru".into(), "б".into())].into(), "en"),
            key = Arg::key("measurand", "static_bias"),
            fixed = Arg::fixed(1.0, 2),
            rounded = Arg::rounded(-1e-300, 3),
            infinite = f64::NEG_INFINITY
        )
    }

    #[test]
    fn every_presentation_survives() {
        let list = Arg::Several(vec![Arg::fixed(2.0, 1), every_argument().into(), "a".into()], "; ".into());
        let message = Message(every_argument().with("inner", every_argument()).with("list", list));
        let read = read_back(&message);
        assert_eq!(read, message);
        assert_eq!(read.say(Lang::Ru), message.say(Lang::Ru));
    }

    #[test]
    fn a_message_without_presentations_is_read_as_plain_values() {
        let json = r#"{"text": "", "id": "a", "args": {"n": 1, "x": 1.5, "t": "word", "nothing": null}}"#;
        let read: Message = serde_json::from_str(json).unwrap();
        assert_eq!(read.args["n"], Arg::Count(1));
        assert_eq!(read.args["x"], Arg::Number(1.5));
        assert_eq!(read.args["t"], Arg::Text("word".into()));
        assert!(matches!(read.args["nothing"], Arg::Number(v) if v.is_nan()));
    }

    #[test]
    fn arguments_of_the_wrong_type_are_refused() {
        for json in [
            r#"{"text": "", "id": "a", "args": {"n": [1]}}"#,
            r#"{"text": "", "id": "a", "args": {"n": 1}, "show": {"n": "key"}}"#,
            r#"{"text": "", "id": "a", "args": {"n": "x"}, "show": {"n": "stated"}}"#,
            r#"{"text": "", "id": "a", "args": {"n": 1}, "show": {"n": "unknown"}}"#,
        ] {
            assert!(serde_json::from_str::<Message>(json).is_err(), "{json}");
        }
    }
}
