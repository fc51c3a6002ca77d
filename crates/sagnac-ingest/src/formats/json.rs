//! JSON: an object a line (JSON lines), or one list of objects. What stands deeper is named with points.

use super::loaded::{self, About, LoadedColumn};
use crate::error::{IngestError, IngestErrorKind};
use crate::{Candidate, Format, Opened};
use sagnac_core::message::note;
use serde_json::Value;
use std::collections::BTreeMap;

/// JSON lines or a list of objects.
pub(super) struct JsonObjects;

/// Most columns.
const MAX_JSON_COLUMNS: usize = 1024;

/// Deepest value that is read.
const DEPTH: usize = 6;

/// True for the first bytes of JSON objects.
pub(super) fn is_json(head: &[u8]) -> bool {
    let text = head.trim_ascii_start();
    let inner = text.strip_prefix(b"[").unwrap_or(text).trim_ascii_start();
    inner.starts_with(b"{") && inner.get(1..).is_some_and(|rest| rest.trim_ascii_start().starts_with(b"\""))
}

impl Format for JsonObjects {
    fn id(&self) -> &'static str {
        "json"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        is_json(&file.head)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let text = loaded::text(file)?;
        let wrong = |line: usize, e: &serde_json::Error| {
            let note = note!("ingest.json.damaged", reason = e.to_string());
            IngestError::new(IngestErrorKind::Damaged, &file.path, note)
                .at(line as u64, None)
                .hint("ingest.hint.damaged")
        };
        let mut columns = Columns::default();
        if text.trim_start().starts_with('[') {
            let all: Vec<Value> = serde_json::from_str(&text).map_err(|e| wrong(e.line(), &e))?;
            all.iter().for_each(|value| columns.push(value));
        } else {
            for (number, line) in (1..).zip(text.lines()).filter(|(_, l)| !l.trim().is_empty()) {
                columns.push(&serde_json::from_str(line).map_err(|e| wrong(number, &e))?);
            }
        }
        let notes = vec![note!("ingest.json.read", count = columns.rows)];
        loaded::opened(file, columns.finish(), About { notes, ..About::default() })
    }
}

/// Columns by the path of their values, in the order in which they come first.
#[derive(Default)]
struct Columns {
    places: BTreeMap<String, usize>,
    names: Vec<String>,
    values: Vec<Vec<f64>>,
    /// Day of the first stamp of a column of dates, s since 1970.
    days_s: BTreeMap<usize, f64>,
    rows: usize,
}

impl Columns {
    fn push(&mut self, value: &Value) {
        self.add("", value, 0);
        self.rows += 1;
        for column in &mut self.values {
            column.resize(self.rows, f64::NAN);
        }
    }

    fn add(&mut self, path: &str, value: &Value, depth: usize) {
        let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            Value::Object(of) if depth < DEPTH => {
                of.iter().for_each(|(key, value)| self.add(&join(key), value, depth + 1));
            }
            Value::Array(of) if depth < DEPTH => {
                of.iter()
                    .enumerate()
                    .for_each(|(i, value)| self.add(&format!("{path}[{i}]"), value, depth + 1));
            }
            Value::Number(number) => self.set(path, number.as_f64().unwrap_or(f64::NAN), None),
            Value::Bool(on) => self.set(path, f64::from(u8::from(*on)), None),
            Value::String(text) => match chrono::DateTime::parse_from_rfc3339(text) {
                Ok(date) => {
                    let seconds = date.timestamp() as f64;
                    let day_s = (seconds / 86_400.0).floor() * 86_400.0;
                    let fraction = f64::from(date.timestamp_subsec_nanos()) * 1e-9;
                    self.set(path, fraction, Some((seconds, day_s)));
                }
                Err(_) => self.set(path, text.trim().parse().unwrap_or(f64::NAN), None),
            },
            _ => self.set(path, f64::NAN, None),
        }
    }

    /// Sets a value of the row; of a date its fraction, with its whole seconds and its day, s since 1970.
    fn set(&mut self, path: &str, value: f64, date: Option<(f64, f64)>) {
        let place = match self.places.get(path) {
            Some(place) => *place,
            None if self.names.len() < MAX_JSON_COLUMNS => {
                self.places.insert(path.to_owned(), self.names.len());
                self.names.push(path.to_owned());
                self.values.push(vec![f64::NAN; self.rows]);
                self.names.len() - 1
            }
            None => return,
        };
        let value = match date {
            Some((seconds, day_s)) => seconds - *self.days_s.entry(place).or_insert(day_s) + value,
            None => value,
        };
        if let Some(column) = self.values.get_mut(place) {
            column.resize(self.rows, f64::NAN);
            column.push(value);
        }
    }

    fn finish(self) -> Vec<LoadedColumn> {
        let days_s = self.days_s;
        let columns = self.names.into_iter().zip(self.values).enumerate();
        columns
            .map(|(place, (name, values))| match days_s.get(&place) {
                Some(day_s) => LoadedColumn::new(name, Some("s"), values).since(*day_s),
                None => LoadedColumn::new(name, None, values),
            })
            .collect()
    }
}
