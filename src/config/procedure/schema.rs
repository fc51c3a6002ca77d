//! JSON Schema (draft 2020-12) of procedure and limits files, for completion and checking in editors.
//!
//! Made from the key tables, so it holds every key that is read and no other.

use super::spec::{KeySpec, Kind, Need, Range, TableSpec, Word};
use super::tables::PROCEDURE_FILE;
use super::tables::limits::LIMITS_FILE;
use super::tables::phases::PHASES_FILE;
use crate::config::alternatives::ALTERNATIVES_FILE;
use crate::config::bench::tables::BENCH_FILE;
use crate::config::layout::tables::LAYOUT_FILE;
use crate::config::manifest::tables::MANIFEST_FILE;
use crate::config::model::tables::MODEL_FILE;
use crate::config::proof::tables::PROOF_FILE;
use crate::config::schedule::tables::SCHEDULE_FILE;
use crate::config::serve::SERVE_FILE;
use crate::config::sheet::tables::SHEET_FILE;
use crate::config::watch::tables::WATCH_FILE;
use crate::effect::EFFECTS;
use crate::i18n::{EffectText, Lang, effect_text};
use crate::measurand::MEASURANDS;
use serde_json::{Map, Value, json};

/// The draft that schemas are written in.
const SCHEMA_DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Pattern of a number with its unit.
const QUANTITY_PATTERN: &str = r"^\s*[+\-−]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\s*\S.*$";

/// The schema of a procedure file: of one recording, or of several phases.
pub fn procedure() -> Value {
    json!({
        "$schema": SCHEMA_DRAFT,
        "title": "Sagnac procedure",
        "oneOf": [table(&PROCEDURE_FILE), table(&PHASES_FILE)],
    })
}

/// The schema of a limits file.
pub fn limits() -> Value {
    document(&LIMITS_FILE, "Sagnac limits")
}

/// The schema of a manifest.
pub fn manifest() -> Value {
    document(&MANIFEST_FILE, "Sagnac manifest")
}

/// The schema of a claim.
pub fn model() -> Value {
    with_kinds(document(&MODEL_FILE, "Sagnac model"), "/properties/effect/items/properties/kind")
}

/// The schema of a sheet file.
pub fn sheet() -> Value {
    document(&SHEET_FILE, "Sagnac sheet")
}

/// The schema of a file of watch rules.
pub fn watch() -> Value {
    document(&WATCH_FILE, "Sagnac watch rules")
}

/// The schema of a file of a bench.
pub fn bench() -> Value {
    document(&BENCH_FILE, "Sagnac bench")
}

/// The schema of a file of rules of a bench.
pub fn serve() -> Value {
    document(&SERVE_FILE, "Sagnac bench rules")
}

/// The schema of a proof file.
pub fn proof() -> Value {
    document(&PROOF_FILE, "Sagnac proof")
}

/// The schema of a schedule.
pub fn schedule() -> Value {
    document(&SCHEDULE_FILE, "Sagnac schedule")
}

/// The schema of alternatives.
pub fn alternatives() -> Value {
    let kind = "/properties/alternative/items/properties/effect/items/properties/kind";
    with_kinds(document(&ALTERNATIVES_FILE, "Sagnac alternatives"), kind)
}

/// A schema in which the kinds of effects are listed at some place.
fn with_kinds(mut schema: Value, place: &str) -> Value {
    let title = |kind: &str| effect_text(kind, EffectText::Title, Lang::En);
    // Editors offer the kinds; the reader knows them from the catalogue.
    let kinds: Vec<Value> =
        EFFECTS.iter().map(|e| json!({"const": e.kind(), "description": title(e.kind())})).collect();
    if let Some(kind) = schema.pointer_mut(place)
        && let Some(object) = kind.as_object_mut()
    {
        object.remove("type");
        object.remove("pattern");
        object.insert("oneOf".into(), Value::Array(kinds));
    }
    schema
}

/// The schema of a layout of raw binary records.
pub fn layout() -> Value {
    document(&LAYOUT_FILE, "Sagnac layout")
}

fn document(root: &'static TableSpec, title: &str) -> Value {
    let mut schema = table(root);
    if let Some(object) = schema.as_object_mut() {
        object.insert("$schema".into(), json!(SCHEMA_DRAFT));
        object.insert("title".into(), json!(title));
    }
    schema
}

fn table(spec: &'static TableSpec) -> Value {
    let properties: Map<String, Value> = spec.keys.iter().map(|k| (k.name.to_owned(), key(k))).collect();
    let required: Vec<&str> = spec.keys.iter().filter(|k| k.need == Need::Required).map(|k| k.name).collect();
    json!({
        "type": "object",
        "description": spec.doc,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn key(spec: &'static KeySpec) -> Value {
    let mut schema = value(spec.kind);
    let Some(object) = schema.as_object_mut() else { return schema };
    object.insert("description".into(), json!(spec.doc));
    if let Need::Default(text) = spec.need
        && let Some(default) = plain(text)
    {
        object.insert("default".into(), default);
    }
    if let Some(example) = plain(spec.example) {
        object.insert("examples".into(), json!([example]));
    }
    schema
}

/// A TOML literal as JSON. Dates become text.
fn plain(literal: &str) -> Option<Value> {
    let table = format!("x = {literal}").parse::<toml::Table>().ok()?;
    fn convert(value: &toml::Value) -> Option<Value> {
        Some(match value {
            toml::Value::String(s) => json!(s),
            toml::Value::Integer(i) => json!(i),
            toml::Value::Float(f) => json!(f),
            toml::Value::Boolean(b) => json!(b),
            toml::Value::Datetime(d) => json!(d.to_string()),
            toml::Value::Array(a) => Value::Array(a.iter().map(convert).collect::<Option<_>>()?),
            toml::Value::Table(_) => return None,
        })
    }
    convert(table.get("x")?)
}

fn value(kind: Kind) -> Value {
    let quantity = || json!({"type": "string", "pattern": QUANTITY_PATTERN});
    match kind {
        Kind::Text | Kind::UnitText => json!({"type": "string", "minLength": 1}),
        Kind::LocalText => local_text(json!({"type": "string", "minLength": 1})),
        Kind::LocalRemark => local_text(json!({"type": "string"})),
        Kind::Format(text) => json!({"const": text}),
        Kind::Id => json!({"type": "string", "pattern": "^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$"}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Number(range) => number(range),
        Kind::Numbers(range) => json!({"type": "array", "items": number(range), "minItems": 1}),
        Kind::Values => json!({
            "type": "object",
            "additionalProperties": {"oneOf": [
                {"type": "number"},
                {"type": "array", "items": {"type": "number"}, "minItems": 1},
            ]},
        }),
        Kind::Remark => json!({"type": "string"}),
        Kind::Date => json!({"type": "string", "format": "date"}),
        Kind::Choice(words) => one_of(words),
        Kind::Choices(words) => json!({"type": "array", "items": one_of(words)}),
        Kind::Command => json!({"type": "array", "minItems": 1, "items": {"type": "string"}}),
        Kind::Columns(_) => json!({"type": "array", "items": {"type": "string"}}),
        Kind::Effects => {
            let ids: Vec<&str> = EFFECTS.iter().map(|e| e.kind()).chain(["unknown"]).collect();
            json!({"type": "array", "items": {"enum": ids}})
        }
        Kind::Quantity { .. } | Kind::QuantityBy(_) => quantity(),
        Kind::QuantityMap => {
            let properties: Map<String, Value> = available().map(|id| (id.to_owned(), quantity())).collect();
            json!({"type": "object", "properties": properties, "additionalProperties": false})
        }
        Kind::Column => {
            json!({"oneOf": [{"type": "string", "minLength": 1}, {"type": "integer", "minimum": 1}]})
        }
        Kind::Taus => json!({"oneOf": [
            {"enum": ["octave", "decade", "all"]},
            {"type": "array", "items": quantity(), "minItems": 1},
        ]}),
        Kind::Looks => json!({
            "type": "array",
            "items": {"oneOf": [{"type": "number", "exclusiveMinimum": 0, "maximum": 1}, quantity()]},
            "minItems": 1,
        }),
        Kind::Allowance => json!({"oneOf": [{"type": "integer", "minimum": 0}, quantity()]}),
        Kind::Measurand => json!({"enum": available().collect::<Vec<_>>()}),
        Kind::Table(spec) => table(spec),
        Kind::Tables(spec) => json!({"type": "array", "items": table(spec)}),
        Kind::TableOrTables(spec) => {
            let one = table(spec);
            json!({"oneOf": [one.clone(), {"type": "array", "items": one}]})
        }
    }
}

/// A text for every language, or one for each.
fn local_text(text: Value) -> Value {
    let of = |lang: &Lang| {
        let mut text = text.clone();
        text["description"] = json!(format!("Text of reports in the language `{}`.", lang.code()));
        (lang.code().to_owned(), text)
    };
    let languages: Map<String, Value> = Lang::ALL.iter().map(of).collect();
    let table = json!({
        "type": "object",
        "properties": languages,
        "minProperties": 1,
        "additionalProperties": false,
    });
    json!({"oneOf": [text, table]})
}

fn available() -> impl Iterator<Item = &'static str> {
    MEASURANDS.iter().map(|m| m.id)
}

fn number(range: Range) -> Value {
    let mut schema = json!({"type": "number"});
    if let Some(object) = schema.as_object_mut() {
        if range.low > f64::MIN {
            object.insert(if range.open { "exclusiveMinimum" } else { "minimum" }.into(), json!(range.low));
        }
        if range.high < f64::MAX {
            object.insert("maximum".into(), json!(range.high));
        }
    }
    schema
}

/// A choice as editors show it best: each word with its meaning.
fn one_of(words: &[Word]) -> Value {
    let options: Vec<Value> =
        words.iter().map(|(word, meaning)| json!({"const": word, "description": meaning})).collect();
    json!({"oneOf": options})
}
