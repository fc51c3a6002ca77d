//! The key reference of the guide, made from the key tables.

use super::spec::{KeySpec, Kind, Need, TableSpec};
use super::tables::PROCEDURE_FILE;
use super::tables::limits::LIMITS_FILE;
use super::tables::phases::PHASES_FILE;
use crate::config::layout::tables::LAYOUT_FILE;
use crate::config::manifest::tables::MANIFEST_FILE;
use crate::config::model::tables::MODEL_FILE;
use crate::config::proof::tables::PROOF_FILE;
use crate::i18n::{Lang, Localize};
use crate::measurand::MEASURANDS;
use std::fmt::Write;

/// Every key of a procedure file, as Markdown.
pub fn procedure_reference() -> String {
    reference(&PROCEDURE_FILE)
}

/// Every key of a procedure of several phases, as Markdown.
pub fn phases_reference() -> String {
    reference(&PHASES_FILE)
}

/// Every key of a limits file, as Markdown.
pub fn limits_reference() -> String {
    reference(&LIMITS_FILE)
}

/// Every key of a manifest, as Markdown.
pub fn manifest_reference() -> String {
    reference(&MANIFEST_FILE)
}

/// Every key of a layout of raw binary records, as Markdown.
pub fn layout_reference() -> String {
    reference(&LAYOUT_FILE)
}

/// Every key of a claim, as Markdown.
pub fn model_reference() -> String {
    reference(&MODEL_FILE)
}

/// Every key of a proof file, as Markdown.
pub fn proof_reference() -> String {
    reference(&PROOF_FILE)
}

/// Every measurand that may be asked for, as Markdown.
pub fn measurand_reference() -> String {
    let mut out = String::from("| id | unit | what it is |\n|---|---|---|\n");
    for m in MEASURANDS {
        let _ = writeln!(out, "| `{}` | {} | {} |", m.id, m.unit, m.doc);
    }
    out
}

fn reference(root: &'static TableSpec) -> String {
    let mut out = String::new();
    for (spec, list) in tables(root, false) {
        let title = match (spec.name, list) {
            ("", _) => "The file".to_owned(),
            (name, true) => format!("`[[{name}]]`"),
            (name, false) => format!("`[{name}]`"),
        };
        let _ =
            write!(out, "### {title}\n\n{}\n\n| key | value | | meaning |\n|---|---|---|---|\n", spec.doc);
        for key in spec.keys {
            let _ = writeln!(
                out,
                "| `{}` | {} | {} | {} |",
                key.name,
                cell(&value(key)),
                need(key),
                cell(&meaning(key))
            );
        }
        out.push('\n');
    }
    out
}

/// The tables in the order of the file, each with whether it is written as a list.
fn tables(spec: &'static TableSpec, list: bool) -> Vec<(&'static TableSpec, bool)> {
    let mut all = vec![(spec, list)];
    for key in spec.keys {
        if let Some(below) = key.kind.table() {
            all.extend(tables(below, matches!(key.kind, Kind::Tables(_))));
        }
    }
    all
}

fn value(key: &KeySpec) -> String {
    let what = match key.kind {
        Kind::Choice(_) => "one of the words listed".to_owned(),
        Kind::Choices(_) => "a list of the words listed".to_owned(),
        Kind::Columns(_) => "a list of names of columns".to_owned(),
        Kind::Command => "a list of strings: program and arguments".to_owned(),
        Kind::Effects => "a list of ids of effects".to_owned(),
        kind => kind.describe().say(Lang::En),
    };
    if key.example.is_empty() || matches!(key.kind, Kind::Format(_) | Kind::Flag) {
        what
    } else {
        format!("{what}; `{}`", key.example)
    }
}

fn need(key: &KeySpec) -> String {
    match key.need {
        Need::Required => "required".to_owned(),
        Need::Optional => "optional".to_owned(),
        Need::Default(text) => format!("default `{text}`"),
    }
}

fn meaning(key: &KeySpec) -> String {
    let words = match key.kind {
        Kind::Choice(words) | Kind::Choices(words) | Kind::Columns(words) => words,
        _ => return key.doc.to_owned(),
    };
    let list: Vec<String> = words.iter().map(|(word, meaning)| format!("`{word}`: {meaning}")).collect();
    format!("{} {}.", key.doc, list.join("; "))
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
