//! How a text file is written: separator, decimal sign, header. Found from its first lines.

use super::error::{IngestError, IngestErrorKind};
use super::number::{self, Field};
use crate::text::{Arg, Note};
use std::path::Path;

/// The way a text file is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dialect {
    /// Separator of fields.
    pub delimiter: u8,
    /// Decimal sign.
    pub decimal: u8,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Position of the first byte of the first data line.
    pub data_offset: usize,
    /// Line the data start on, counted from 1.
    pub data_line: u64,
    /// What was decided and why.
    pub notes: Vec<Note>,
    /// Mean length of the data lines looked at, bytes.
    pub mean_line: f64,
}

/// Most lines that are looked at.
const LINES: usize = 200;

/// Finds the dialect from the start of a file; `all`: the head is the whole file.
pub(super) fn sniff(path: &Path, head: &[u8], all: bool) -> Result<Dialect, IngestError> {
    let bom = if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut lines: Vec<(usize, u64, &[u8])> = Vec::new();
    let (mut at, mut number) = (bom, 0);
    while at < head.len() && lines.len() < LINES {
        let rest = head.get(at..).unwrap_or_default();
        let end = memchr::memchr(b'\n', rest);
        number += 1;
        // The last line of a part of a file may be cut.
        if end.is_none() && !all {
            break;
        }
        let line = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let before_data = lines.is_empty() && is_comment(line);
        if !before_data && !line.trim_ascii().is_empty() {
            lines.push((at, number, line));
        }
        at += end.map_or(rest.len(), |e| e + 1);
    }
    let Some(&(first_at, first_number, first)) = lines.first() else {
        let error = if all {
            IngestError::new(IngestErrorKind::Empty, path, "ingest.only_comments")
        } else {
            IngestError::new(IngestErrorKind::UnknownFormat, path, "ingest.endless_line")
        };
        return Err(error.hint("ingest.hint.line_per_sample"));
    };
    let body: Vec<&[u8]> = lines.iter().map(|l| l.2).collect();
    let delimiter = delimiter(&body);
    let probe = body.get(1..).filter(|b| !b.is_empty()).unwrap_or(&body);
    refuse_spaces(path, delimiter, probe, &lines)?;
    let decimal = if delimiter != b',' && comma_decimals(probe, delimiter) { b',' } else { b'.' };
    let cells = split(first, delimiter);
    let kinds: Vec<Field> = cells.iter().map(|c| number::field(c, decimal)).collect();
    let has_header =
        kinds.contains(&Field::Unparsable) || !kinds.iter().any(|k| matches!(k, Field::Value(_)));
    let mut notes = vec![
        Note::new("ingest.note.dialect")
            .with(
                "separator",
                match delimiter {
                    b'\t' => Arg::Key("ingest.tab".to_owned()),
                    d => Arg::Text(format!("`{}`", d as char)),
                },
            )
            .with("decimal", (decimal as char).to_string()),
    ];
    if has_header && lines.len() < 2 && all {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.header_only")
            .at(first_number, None)
            .hint("ingest.hint.check_written"));
    }
    let names = if has_header {
        cells.iter().enumerate().map(|(i, c)| name(c, i)).collect()
    } else {
        notes.push(Note::new("ingest.note.no_header"));
        (1..=cells.len()).map(|i| format!("column_{i}")).collect()
    };
    let (data_offset, data_line) = match lines.get(1) {
        _ if !has_header => (first_at, first_number),
        Some(&(at, number, _)) => (at, number),
        None => (head.len(), number + 1),
    };
    let total: usize = probe.iter().map(|l| l.len() + 1).sum();
    Ok(Dialect {
        delimiter,
        decimal,
        names,
        data_offset,
        data_line,
        notes,
        mean_line: total as f64 / probe.len().max(1) as f64,
    })
}

fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start(), [b'#' | b'%', ..])
}

fn name(cell: &[u8], index: usize) -> String {
    let text = String::from_utf8_lossy(cell);
    let text = text.trim().trim_matches('"').trim();
    if text.is_empty() { format!("column_{}", index + 1) } else { text.to_owned() }
}

/// Splits a line; a delimiter between quotes does not count.
pub(super) fn split(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
    let mut cells = Vec::new();
    let (mut start, mut quoted) = (0, false);
    for (i, &c) in line.iter().enumerate() {
        if c == b'"' {
            quoted = !quoted;
        } else if c == delimiter && !quoted {
            cells.push(line.get(start..i).unwrap_or_default());
            start = i + 1;
        }
    }
    cells.push(line.get(start..).unwrap_or_default());
    // A separator at the end of the line opens no further column.
    if cells.len() > 1 && cells.last().is_some_and(|c| c.trim_ascii().is_empty()) && start == line.len() {
        let numbers = cells.iter().rev().skip(1).all(|c| number::field(c, b'.') != Field::Empty);
        if numbers {
            cells.pop();
        }
    }
    cells
}

/// The separator that cuts the most lines into the same number of fields; a tab or a semicolon before a comma, since
/// a comma may be a decimal sign.
fn delimiter(lines: &[&[u8]]) -> u8 {
    for candidate in *b"\t;" {
        let with = lines.iter().filter(|l| l.contains(&candidate)).count();
        if with * 2 > lines.len() {
            return candidate;
        }
    }
    b','
}

/// True when the numbers have commas where their decimal sign should be.
fn comma_decimals(lines: &[&[u8]], delimiter: u8) -> bool {
    let (mut commas, mut points) = (0, 0);
    for cell in lines.iter().flat_map(|l| split(l, delimiter)) {
        if cell.contains(&b',') && matches!(number::field(cell, b','), Field::Value(_)) {
            commas += 1;
        } else if cell.contains(&b'.') && matches!(number::field(cell, b'.'), Field::Value(_)) {
            points += 1;
        }
    }
    commas > points
}

/// Refuses columns that only spaces separate, and commas that separate and mark decimals at once.
fn refuse_spaces(
    path: &Path,
    delimiter: u8,
    data: &[&[u8]],
    lines: &[(usize, u64, &[u8])],
) -> Result<(), IngestError> {
    if delimiter != b',' {
        return Ok(());
    }
    let spaced = |l: &&[u8]| {
        let words: Vec<&[u8]> = l.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()).collect();
        !l.contains(&b',') && words.len() > 1 && words.iter().all(|w| is_number(w))
    };
    if !data.is_empty() && data.iter().all(spaced) {
        let (line, text) = lines.get(1).or(lines.first()).map_or((1, &b""[..]), |l| (l.1, l.2));
        return Err(IngestError::new(IngestErrorKind::UnknownFormat, path, "ingest.spaces")
            .at(line, None)
            .found(&String::from_utf8_lossy(text))
            .hint("ingest.hint.separate"));
    }
    Ok(())
}

fn is_number(word: &[u8]) -> bool {
    !matches!(number::field(word, b'.'), Field::Unparsable | Field::Empty)
}
