//! Results that stand in Parquet tables, one row each: those of an archive. The column `result_json` holds the record, `uri` names the
//! recording.

use crate::i18n::{Arg, Note, note};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use parquet::schema::types::Type;
use sagnac_ingest::open_file;
use std::path::{Path, PathBuf};

/// Column with the record, as the text of `result.json`; null where a recording gave none.
const RECORD_COLUMN: &str = "result_json";

/// Column with the place of the recording.
const URI_COLUMN: &str = "uri";

/// Folders in folders that are looked into.
const MAX_FOLDER_DEPTH: usize = 12;

/// A result of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableResult {
    /// Name of the recording in the table; the table and the row where it has no such column.
    pub name: String,
    /// The record, as the text of `result.json`; `None` where the recording gave none.
    pub record: Option<String>,
}

/// The tables that a path stands for: itself, or those below a folder, in the order of their names; nothing where it is another kind
/// of file.
pub fn tables_at(path: &Path) -> Vec<PathBuf> {
    let is_table = |p: &Path| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"));
    if !path.is_dir() {
        return if is_table(path) { vec![path.to_owned()] } else { vec![] };
    }
    let mut found = vec![];
    let mut open = vec![(path.to_owned(), 0)];
    while let Some((folder, depth)) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            // A link could lead round in a circle.
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() && depth < MAX_FOLDER_DEPTH {
                open.push((path, depth + 1));
            } else if kind.is_file() && is_table(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The results of a table, in its order, a row at a time.
///
/// # Errors
/// A sentence that names the file: it cannot be read, or has no column of records.
pub fn results_in(path: &Path) -> Result<impl Iterator<Item = Result<TableResult, Note>> + use<>, Note> {
    let shown = path.display().to_string();
    let unreadable = {
        let shown = shown.clone();
        move |why: Arg| note!("result_table.unreadable", path = shown.as_str(), reason = why)
    };
    let file = open_file(path).map_err(|e| unreadable(sagnac_ingest::io_reason(&e).into()))?;
    let reader = SerializedFileReader::new(file).map_err(|e| unreadable(e.to_string().into()))?;
    let root = reader.metadata().file_metadata().schema();
    let (name, fields) = (root.name().to_owned(), root.get_fields().to_vec());
    let has = |name: &str| fields.iter().any(|f| f.name() == name && f.is_primitive());
    if !has(RECORD_COLUMN) {
        return Err(note!("result_table.no_records", path = shown, column = RECORD_COLUMN));
    }
    let named = has(URI_COLUMN);
    let wanted = fields
        .into_iter()
        .filter(|f| f.name() == RECORD_COLUMN || (named && f.name() == URI_COLUMN))
        .collect();
    let schema = Type::group_type_builder(&name).with_fields(wanted).build();
    let schema = schema.map_err(|e| unreadable(e.to_string().into()))?;
    let rows = reader.into_iter().project(Some(schema)).map_err(|e| unreadable(e.to_string().into()))?;
    Ok(rows.enumerate().map(move |(i, row)| {
        let row = row.map_err(|e| unreadable(e.to_string().into()))?;
        let text = |column: &str| {
            let at = row.get_column_iter().position(|(name, _)| name == column)?;
            row.get_string(at).ok().cloned()
        };
        let name = text(URI_COLUMN).unwrap_or_else(|| format!("{shown}:{}", i + 1));
        Ok(TableResult { name, record: text(RECORD_COLUMN) })
    }))
}
