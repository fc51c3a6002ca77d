//! A sentence as it stands in results: in English, and by name with its arguments for other languages.

use crate::i18n::{Arg, Lang, Localize, Note};
use schemars::JsonSchema;
use serde::ser::{SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};

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
#[derive(JsonSchema)]
#[allow(dead_code)]
#[schemars(rename = "NoteSchema")]
struct MessageSchema {
    /// The sentence in English.
    text: String,
    /// Its name in the locale tables.
    id: String,
    /// Its arguments.
    args: std::collections::BTreeMap<String, serde_json::Value>,
}

impl JsonSchema for Message {
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

fn note<S: Serializer>(note: &Note, serializer: S) -> Result<S::Ok, S::Error> {
    let mut s = serializer.serialize_struct("Note", 3)?;
    s.serialize_field("text", &note.say(Lang::En))?;
    s.serialize_field("id", &note.id)?;
    s.serialize_field("args", &Args(note))?;
    s.end()
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
            Arg::Note(inner) => note(inner, serializer),
            several @ Arg::Several(..) => serializer.serialize_str(&several.say(Lang::En)),
        }
    }
}

/// Notes of a record that keeps them as notes.
pub(crate) fn messages<S: Serializer>(notes: &[Note], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(notes.iter().cloned().map(Message))
}
