//! Facts about units known before they are tested: a table in CSV with a row for each.
//!
//! The first line names the columns: `serial`, and as far as there are any `model`, `lot`, `build_date` and `reference`; every
//! other column is a free attribute of the unit. Fields are separated by commas, semicolons or tabulators.

use super::serial::plain;
use crate::config::diagnostics::{Problem, Problems, SourceText, Span};
use crate::config::text_file::{self, Wording};
use crate::i18n::{Note, note};
use crate::record::UnitUnderTest;
use chrono::NaiveDate;
use csv::{ByteRecord, ReaderBuilder, StringRecord};
use std::collections::BTreeMap;
use std::path::Path;

/// Messages about a table that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "unit_data.unreadable", folder: "unit_data.folder" };

/// The units of a table, by their serial numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UnitData {
    units: BTreeMap<String, UnitUnderTest>,
}

impl UnitData {
    /// The facts of a unit in the table.
    pub fn of(&self, serial: &str) -> Option<&UnitUnderTest> {
        self.units.get(&plain(serial))
    }

    /// Reads a table.
    ///
    /// # Errors
    /// Every problem, each with its place.
    pub fn load(path: &Path) -> Result<UnitData, Problems> {
        parse(&path.display().to_string(), &text_file::bytes(path, &READ_MESSAGES)?)
    }
}

/// The columns that have a meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Known {
    Serial,
    Model,
    Lot,
    BuildDate,
    Reference,
}

impl Known {
    fn of(name: &str) -> Option<Known> {
        match name.to_lowercase().as_str() {
            "serial" => Some(Known::Serial),
            "model" => Some(Known::Model),
            "lot" => Some(Known::Lot),
            "build_date" => Some(Known::BuildDate),
            "reference" => Some(Known::Reference),
            _ => None,
        }
    }
}

fn parse(name: &str, bytes: &[u8]) -> Result<UnitData, Problems> {
    let source = text_file::source(name, bytes)?;
    let mut problems = Problems::default();
    let head = source.text.lines().next().unwrap_or_default();
    let delimiter = *[b';', b'\t'].iter().find(|d| head.as_bytes().contains(d)).unwrap_or(&b',');
    let mut rows = ReaderBuilder::new()
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(source.text.as_bytes());
    let columns: Vec<String> = match rows.headers() {
        Ok(head) => head.iter().map(str::to_owned).collect(),
        Err(e) => return Err(source.error(&(0..0), broken(&e)).into()),
    };
    if !columns.iter().any(|c| Known::of(c) == Some(Known::Serial)) {
        let problem =
            source.error(&(0..head.len()), "unit_data.no_serial_column").help("unit_data.help.columns");
        return Err(problem.into());
    }
    let mut data = UnitData::default();
    let mut raw = ByteRecord::new();
    loop {
        match rows.read_byte_record(&mut raw) {
            Ok(false) => break,
            Err(e) => {
                problems.list.push(source.error(&(0..0), broken(&e)));
                break;
            }
            Ok(true) => {}
        }
        let start = raw.position().map_or(0, |p| p.byte() as usize);
        // The text is UTF-8, and so are its fields.
        let Ok(row) = StringRecord::from_byte_record(raw.clone()) else { continue };
        if row.iter().all(str::is_empty) {
            continue;
        }
        match unit(&columns, &row, &source, start) {
            Ok((key, unit)) => {
                if data.units.insert(key, unit).is_some() {
                    let at = line(&source, start);
                    problems.list.push(source.error(&at, "unit_data.twice").help("unit_data.help.twice"));
                }
            }
            Err(problem) => problems.list.push(*problem),
        }
    }
    if problems.list.is_empty() { Ok(data) } else { Err(problems) }
}

fn broken(error: &csv::Error) -> Note {
    note!("unit_data.broken", reason = error.to_string())
}

/// The line that begins at a byte. What precedes the first character of a row, such as the end of the line before, is not of it.
fn line(source: &SourceText, start: usize) -> Span {
    let rest = source.text.get(start..).unwrap_or_default();
    let from = start + rest.len() - rest.trim_start().len();
    let text = source.text.get(from..).unwrap_or_default();
    from..from + text.lines().next().unwrap_or_default().len()
}

/// The place of a field in a row: where its text stands for the first time, else the row.
fn field(source: &SourceText, start: usize, text: &str) -> Span {
    let row = line(source, start);
    let found = source.text.get(row.clone()).and_then(|r| r.find(text)).filter(|_| !text.is_empty());
    found.map_or(row.clone(), |at| row.start + at..row.start + at + text.len())
}

fn unit(
    columns: &[String],
    row: &StringRecord,
    source: &SourceText,
    start: usize,
) -> Result<(String, UnitUnderTest), Box<Problem>> {
    if row.len() != columns.len() {
        let note = note!("unit_data.fields", found = row.len(), expected = columns.len());
        return Err(Box::new(source.error(&line(source, start), note)));
    }
    let mut unit = UnitUnderTest::default();
    for (name, text) in columns.iter().zip(row).filter(|(_, text)| !text.is_empty()) {
        let wrong = |key: &'static str, help: &'static str| {
            let note = Note::new(key).with("text", text);
            Box::new(source.error(&field(source, start, text), note).help(help))
        };
        match Known::of(name) {
            Some(Known::Serial) => unit.serial = Some(text.to_owned()),
            Some(Known::Model) => unit.model = Some(text.to_owned()),
            Some(Known::Lot) => unit.lot = Some(text.to_owned()),
            Some(Known::BuildDate) => {
                let date: NaiveDate =
                    text.parse().map_err(|_| wrong("unit_data.no_date", "unit_data.help.date"))?;
                unit.build_date = Some(date.to_string());
            }
            Some(Known::Reference) => {
                unit.reference = match text.to_lowercase().as_str() {
                    "true" | "yes" | "1" => true,
                    "false" | "no" | "0" => false,
                    _ => return Err(wrong("unit_data.no_flag", "unit_data.help.flag")),
                };
            }
            None => {
                unit.attributes.insert(name.clone(), text.to_owned());
            }
        }
    }
    match &unit.serial {
        Some(serial) => Ok((plain(serial), unit)),
        None => Err(Box::new(source.error(&line(source, start), "unit_data.no_serial"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_by_their_serial_numbers_however_written() {
        let table =
            "serial,model,lot,build_date,reference,coil\nSN-0043, A-1,L7,2026-03-01,,K12\nREF-1,A-1,,,yes,\n";
        let data = parse("units.csv", table.as_bytes()).unwrap();
        let unit = data.of("43").unwrap();
        assert_eq!((unit.model.as_deref(), unit.lot.as_deref()), (Some("A-1"), Some("L7")));
        assert_eq!(unit.build_date.as_deref(), Some("2026-03-01"));
        assert_eq!(unit.attributes.get("coil").map(String::as_str), Some("K12"));
        assert!(data.of("ref-1").unwrap().reference && !unit.reference);
        assert!(data.of("44").is_none());
        let other = parse("units.csv", "lot;serial\r\nL7;43\r\n".as_bytes()).unwrap();
        assert_eq!(other.of("43").unwrap().lot.as_deref(), Some("L7"));
    }

    #[test]
    fn every_mistake_has_its_place() {
        let said = |table: &str| parse("units.csv", table.as_bytes()).unwrap_err().to_string();
        for (table, place, what) in [
            ("number,lot\n1,2\n", "units.csv:1:1", "`serial`"),
            ("serial,lot\n1\n", "units.csv:2:1", "fields: 1"),
            ("serial,lot\n,L7\n", "units.csv:2:1", "serial number"),
            ("serial,lot\n1,a\n\nSN-1,b\n", "units.csv:4:1", "second row"),
            ("serial,build_date\n1,1.3.2026\n", "units.csv:2:3", "date"),
            ("serial,reference\n1,maybe\n", "units.csv:2:3", "maybe"),
        ] {
            let said = said(table);
            assert!(said.contains(place) && said.contains(what), "{table}: {said}");
        }
    }
}
