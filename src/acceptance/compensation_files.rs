//! A compensation table as files for firmware: TOML, JSON, C header.

use super::request::Table;
use serde::Serialize;

/// The files of a table, by the stem of their names.
pub fn files(stem: &str, table: &impl Serialize, header: String) -> Vec<Table> {
    vec![
        (format!("{stem}.toml"), toml::to_string(table).unwrap_or_default()),
        (format!("{stem}.json"), serde_json::to_string_pretty(table).unwrap_or_default() + "\n"),
        (format!("{stem}.h"), header),
    ]
}
