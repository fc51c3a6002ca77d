//! Sheets of spreadsheets: `.xlsx`, `.xls`, `.ods`.

use super::loaded::{self, About, LoadedColumn};
use crate::byte_stream::io_error;
use crate::error::{IngestError, IngestErrorKind};
use crate::open_file;
use crate::{Candidate, Format, Opened};
use calamine::{Data, Range, Reader, open_workbook_auto_from_rs};
use sagnac_core::message::note;
use std::io::{Cursor, Read};
use std::sync::Arc;

/// A sheet of a spreadsheet.
pub(super) struct Spreadsheet;

/// First bytes of old spreadsheets, a compound file.
const COMPOUND: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";

/// Days from the zero of spreadsheets to 1970.
const TO_1970_D: f64 = 25_569.0;

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// True for the first bytes of a spreadsheet.
pub(super) fn is_spreadsheet(head: &[u8]) -> bool {
    let holds = |name: &[u8]| head.windows(name.len()).any(|w| w == name);
    let zip = head.starts_with(b"PK\x03\x04");
    (zip && (holds(b"xl/") || holds(b"opendocument.spreadsheet"))) || head.starts_with(COMPOUND)
}

impl Format for Spreadsheet {
    fn id(&self) -> &'static str {
        "xlsx"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        is_spreadsheet(&file.head)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let mut bytes = Vec::new();
        let read = open_file(&file.path).and_then(|mut handle| handle.read_to_end(&mut bytes));
        read.map_err(|e| io_error(&file.path, &e))?;
        let bytes: Arc<[u8]> = bytes.into();
        let damaged = |reason: String| {
            let note = note!("ingest.xlsx.damaged", reason);
            IngestError::new(IngestErrorKind::Damaged, &file.path, note).hint("ingest.xlsx.hint_export")
        };
        let mut book = open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(|e| damaged(e.to_string()))?;
        let names = book.sheet_names();
        let stated = file.options.part.as_deref();
        if let Some(part) = stated.filter(|p| names.iter().all(|n| n != p)) {
            let note = note!("ingest.xlsx.no_such_sheet", sheet = part);
            return Err(IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note)
                .hint(note!("ingest.xlsx.hint_sheets", sheets = names.join(", "))));
        }
        let mut best: Option<(String, Sheet)> = None;
        for name in names.iter().filter(|n| stated.is_none_or(|s| s == n.as_str())) {
            let range = book.worksheet_range(name).map_err(|e| damaged(e.to_string()))?;
            let sheet = Sheet::of(&range);
            if best.as_ref().is_none_or(|(_, b)| sheet.numbers() > b.numbers()) {
                best = Some((name.clone(), sheet));
            }
        }
        let Some((name, sheet)) = best else { return Err(damaged("-".to_owned())) };
        let notes = vec![note!("ingest.xlsx.read", sheet = name.as_str(), count = names.len())];
        let metadata = sheet.above;
        loaded::opened(file, sheet.columns, About { notes, metadata, sample_rate_hz: None })
    }
}

/// What a sheet holds: columns below their names, and what stands above.
struct Sheet {
    columns: Vec<LoadedColumn>,
    above: Vec<(String, String)>,
}

impl Sheet {
    fn of(range: &Range<Data>) -> Sheet {
        let rows: Vec<&[Data]> = range.rows().collect();
        let number =
            |d: &Data| matches!(d, Data::Int(_) | Data::Float(_) | Data::DateTime(_) | Data::DateTimeIso(_));
        let numbers = |row: &[Data]| row.iter().filter(|d| number(d)).count();
        // Data begin with the first of three rows that hold as many numbers as any.
        let most = rows.iter().take(200).map(|r| numbers(r)).max().unwrap_or(0);
        let full = |r: &&[Data]| 2 * numbers(r) > most;
        let begins = rows.windows(3).position(|w| w.iter().all(full));
        let first = begins.unwrap_or_else(|| rows.iter().position(full).unwrap_or(rows.len()));
        let named = first.checked_sub(1).and_then(|i| rows.get(i)).copied().unwrap_or_default();
        let width = rows.iter().map(|r| r.len()).max().unwrap_or(0);
        let columns = (0..width)
            .map(|i| {
                let cells = rows.get(first..).unwrap_or_default().iter().map(|r| r.get(i));
                let name = named.get(i).map(|d| d.to_string().trim().to_owned()).filter(|n| !n.is_empty());
                column(name.unwrap_or_else(|| format!("column_{}", i + 1)), cells)
            })
            .filter(|c| c.values.iter().any(|v| v.is_finite()))
            .collect();
        let above = rows.get(..first.saturating_sub(1)).unwrap_or_default().iter().filter_map(|row| {
            let mut filled = row.iter().map(ToString::to_string).filter(|t| !t.trim().is_empty());
            let (key, value) = (filled.next()?, filled.next());
            Some(value.map_or_else(|| ("title".to_owned(), key.clone()), |value| (key.clone(), value)))
        });
        Sheet { columns, above: above.take(64).collect() }
    }

    fn numbers(&self) -> usize {
        self.columns.iter().map(|c| c.values.iter().filter(|v| v.is_finite()).count()).sum()
    }
}

/// A column of a sheet; dates become seconds from midnight of the first day.
fn column<'a>(name: String, cells: impl Iterator<Item = Option<&'a Data>> + Clone) -> LoadedColumn {
    let date = |d: Option<&Data>| match d {
        Some(Data::DateTime(of)) => Some(of.as_f64()),
        _ => None,
    };
    let dates = cells.clone().filter(|d| date(*d).is_some()).count();
    if 2 * dates > cells.clone().count() {
        let day = cells.clone().find_map(date).unwrap_or(0.0).floor();
        let values = cells.map(|d| date(d).map_or(f64::NAN, |v| (v - day) * DAY_S)).collect();
        let column = LoadedColumn::new(name, Some("s"), values);
        return if day > 0.0 { column.since((day - TO_1970_D) * DAY_S) } else { column };
    }
    let value = |d: Option<&Data>| match d {
        Some(Data::Int(v)) => *v as f64,
        Some(Data::Float(v)) => *v,
        Some(Data::Bool(on)) => f64::from(u8::from(*on)),
        Some(Data::String(text)) => text.trim().replace(',', ".").parse().unwrap_or(f64::NAN),
        _ => f64::NAN,
    };
    LoadedColumn::new(name, None, cells.map(value).collect())
}
