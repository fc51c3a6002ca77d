//! How a text file is written, found from its first lines or as its user says.

use super::column_kinds::{self, Kinds};
use super::encoding::{self, FoundEncoding};
use super::fields::{Comments, Separator, words};
use super::header::{self, Header};
use super::metadata::add_line;
use super::number::{Field, field};
use super::rows::Lines;
use super::separator::{self, Cut, Looks, looks};
use crate::error::{IngestError, IngestErrorKind};
use crate::metadata::Metadata;
use crate::options::Encoding;
use crate::{Candidate, Column, Labels};
use sagnac_core::message::{Arg, Note, note};
use std::path::Path;

/// The way a text file is written.
#[derive(Debug, Clone)]
pub(super) struct Dialect {
    /// Characters.
    pub encoding: Encoding,
    /// Lines.
    pub lines: Lines,
    /// Columns.
    pub columns: Vec<Column>,
    /// Position of the first byte of the first data line in the text as UTF-8.
    pub data_offset: usize,
    /// Line the data start on, counted from 1.
    pub data_line: u64,
    /// Decisions and their reasons.
    pub notes: Vec<Note>,
    /// What the file says of itself.
    pub metadata: Vec<(String, String)>,
    /// Words in the first rows of columns that hold few of them.
    pub labels: Vec<Labels>,
    /// True where all lines looked at differ as they do where a time or a counter runs.
    pub all_differ: bool,
    /// Mean length of the data lines looked at, bytes of the file.
    pub mean_line: f64,
}

/// Most lines that are looked at, comments above the data left out.
const LINES: usize = 200;

/// A line of the head: position of its first byte, number counted from 1, text without its end.
pub(super) struct Line<'a> {
    at: usize,
    pub number: u64,
    pub text: &'a [u8],
}

/// Finds the dialect from the start of a file.
pub(super) fn sniff(file: &Candidate) -> Result<Dialect, IngestError> {
    let (path, options) = (file.path.as_path(), &file.options.text);
    let found = match options.encoding {
        Some(e) => encoding::stated(path, &file.head, file.head_is_all, e)?,
        None => encoding::find(&file.head, file.head_is_all).ok_or_else(|| {
            IngestError::new(IngestErrorKind::UnknownFormat, path, "ingest.formats.unknown")
                .hint("ingest.hint.give_recording")
        })?,
    };
    let head = encoding::decode(found.encoding, &file.head, file.head_is_all);
    let far = options.header_line.unwrap_or(0).max(options.first_line.unwrap_or(0));
    let far = usize::try_from(far).unwrap_or(usize::MAX).saturating_add(LINES);
    let unsplit = Comments::new(options.comment.as_deref(), options.delimiter.map(Separator::of));
    let certain = |l: &[u8]| unsplit.prefix_of(l).is_some_and(|p| options.comment.is_some() || p != b";");
    let lines = lines(&head, file.head_is_all, far, &certain);
    let body: Vec<&Line<'_>> = lines.iter().filter(|l| !certain(l.text)).collect();
    if body.is_empty() {
        return Err(if file.head_is_all {
            IngestError::new(IngestErrorKind::Empty, path, "ingest.only_comments")
        } else {
            IngestError::new(IngestErrorKind::UnknownFormat, path, "ingest.endless_line")
        }
        .hint("ingest.hint.line_per_sample"));
    }
    let after: Vec<&[u8]> = body
        .iter()
        .filter(|l| options.first_line.is_none_or(|f| l.number >= f))
        .filter(|l| options.header_line.is_none_or(|h| l.number >= h))
        .map(|l| l.text)
        .collect();
    let cut = separator::find(&after, options.delimiter, options.decimal);
    let sniffed =
        Sniffed { path, file, cut, comments: Comments::new(options.comment.as_deref(), Some(cut.separator)) };
    let first = sniffed.first_data_line(&lines)?;
    sniffed.check_stated(&after)?;
    let (above, data) = lines.split_at(first);
    let data: Vec<&Line<'_>> = data.iter().filter(|l| !sniffed.comments.holds(l.text)).collect();
    let header = sniffed.header(above, &data)?;
    let kinds = sniffed.kinds(&header, above, &data)?;
    let (data_offset, data_line) = match data.first() {
        Some(line) => (line.at, line.number),
        None => (head.len(), lines.last().map_or(0, |l| l.number) + 1),
    };
    let total: usize = data.iter().map(|l| l.text.len() + 1).sum();
    let widening = head.len() as f64 / file.head.len().max(1) as f64;
    let metadata = sniffed.metadata(above, &header);
    let mut notes = sniffed.notes(&found, &header, above, &head);
    notes.extend(kinds.notes);
    Ok(Dialect {
        encoding: found.encoding,
        lines: Lines {
            separator: cut.separator,
            decimal: cut.decimal,
            kinds: kinds.kinds,
            pairs: kinds.pairs,
            comments: sniffed.comments,
            void: None,
            remarks: header.remarks,
        },
        columns: kinds.columns,
        data_offset,
        data_line,
        notes,
        metadata,
        labels: kinds.labels,
        all_differ: data.len() > 8
            && (cut.fields > 2 || first_field_grows(&data, &cut))
            && data.windows(2).all(|w| matches!(w, [a, b] if a.text != b.text)),
        mean_line: total as f64 / data.len().max(1) as f64 / widening,
    })
}

/// True where the first field grows from line to line, as a time does. Two noisy fields tell no end of the data by lines
/// that are equal: a sensor may be stuck.
fn first_field_grows(data: &[&Line<'_>], cut: &Cut) -> bool {
    let first = |line: &Line<'_>| {
        let cells = cut.separator.cells(line.text);
        match cells.first().map(|cell| field(cell, cut.decimal)) {
            Some(Field::Value(value)) => value,
            _ => f64::NAN,
        }
    };
    cut.fields == 2 && data.windows(2).all(|w| matches!(w, [a, b] if first(a) < first(b)))
}

/// The first lines that are not blank, at most `most` without certain comments. The last line of a part of a file may
/// be cut and is left out.
fn lines<'a>(head: &'a [u8], all: bool, most: usize, comment: &dyn Fn(&[u8]) -> bool) -> Vec<Line<'a>> {
    let mut lines = Vec::new();
    let (mut at, mut number, mut counted) = (if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 }, 0, 0);
    while at < head.len() && counted < most {
        let rest = head.get(at..).unwrap_or_default();
        let end = memchr::memchr(b'\n', rest);
        number += 1;
        if end.is_none() && !all {
            break;
        }
        let text = rest.get(..end.unwrap_or(rest.len())).unwrap_or_default();
        let text = text.strip_suffix(b"\r").unwrap_or(text);
        if !text.trim_ascii().is_empty() {
            counted += usize::from(!comment(text));
            lines.push(Line { at, number, text });
        }
        at += end.map_or(rest.len(), |e| e + 1);
    }
    lines
}

/// Facts that are known once the lines can be cut.
pub(super) struct Sniffed<'a> {
    pub path: &'a Path,
    pub file: &'a Candidate,
    pub cut: Cut,
    pub comments: Comments,
}

impl Sniffed<'_> {
    pub(super) fn error(&self, message: Note) -> IngestError {
        IngestError::new(IngestErrorKind::UnknownFormat, self.path, message)
    }

    /// Position of the first data line among the lines.
    fn first_data_line(&self, lines: &[Line<'_>]) -> Result<usize, IngestError> {
        let options = &self.file.options.text;
        let empty = |line: u64| {
            IngestError::new(IngestErrorKind::Empty, self.path, "ingest.header_only")
                .at(line, None)
                .hint("ingest.hint.check_written")
        };
        let last = lines.last().map_or(0, |l| l.number);
        for (key, stated) in
            [("header_line", options.header_line.filter(|h| *h > 0)), ("first_line", options.first_line)]
        {
            let holds =
                |number: u64| lines.iter().any(|l| l.number == number && !self.comments.holds(l.text));
            if let Some(number) = stated
                && !holds(number)
                && !(key == "header_line" && lines.iter().any(|l| l.number == number))
            {
                let message = note!("ingest.delimited.no_such_line", key, line = number);
                return Err(self.error(message).hint("ingest.delimited.hint_line"));
            }
        }
        let begins = |at: usize, i: usize, line: &Line<'_>| {
            let below = lines.get(i + 1..).unwrap_or_default();
            match (options.first_line, options.header_line) {
                (Some(first), _) => line.number == first,
                (None, Some(header)) => {
                    line.number > header && self.is_data(line, at + usize::from(header > 0), below)
                }
                (None, None) => self.is_data(line, at, below),
            }
        };
        let mut at = 0;
        for (i, line) in lines.iter().enumerate() {
            if self.comments.holds(line.text) {
                continue;
            }
            if begins(at, i, line) {
                // Names that stand twice: the second time they are a row of words, as in files put together.
                let mut before =
                    lines.iter().enumerate().take(i).rev().filter(|(_, l)| !self.comments.holds(l.text));
                return Ok(match (before.next(), before.next()) {
                    (Some((again, a)), Some((_, b))) if a.text == b.text && self.is_names(a) => again,
                    _ => i,
                });
            }
            at += 1;
        }
        // No line is like data: the first is the header, whatever follows are rows of text.
        let mut plain = lines.iter().enumerate().filter(|(_, l)| !self.comments.holds(l.text));
        let headed = options.header_line != Some(0);
        let (head, next) = if headed { (plain.next(), plain.next()) } else { (None, plain.next()) };
        match (head, next) {
            (_, Some((i, _))) => Ok(i),
            (head, None) if self.file.head_is_all => Err(empty(head.map_or(last, |(_, l)| l.number))),
            (_, None) => Ok(lines.len()),
        }
    }

    /// True when a line has the usual number of fields and holds values; `at`: how many plain lines stand before it,
    /// `below`: the lines after it.
    fn is_data(&self, line: &Line<'_>, at: usize, below: &[Line<'_>]) -> bool {
        let cells = self.cut.separator.usual_cells(line.text, self.cut.fields);
        if cells.len() != self.cut.fields {
            return false;
        }
        let of: Vec<Looks> = cells.iter().map(|c| looks(c, self.cut.decimal)).collect();
        let values = of.iter().filter(|l| l.is_value()).count();
        let texts = of.iter().filter(|l| **l == Looks::Text).count();
        if texts == 0 || (at > 0 && values > texts) {
            return values > 0;
        }
        if at > 0 {
            // Half of it is text, such as `Rate;100`: a line above the data when names follow.
            return values > 0 && !below.iter().any(|l| self.is_names(l));
        }
        // The first line may be a header of names such as `time,1,2,3`: whole numbers tell nothing there.
        let fractions = |c: &&&[u8]| c.contains(&b'.') || c.contains(&b',') || c.contains(&b':');
        let clear =
            cells.iter().zip(&of).filter(|(_, l)| l.is_value()).map(|(c, _)| c).filter(|c| fractions(c));
        values > texts && clear.count() > 0
    }

    /// True for a line of the usual number of fields, all of them text.
    fn is_names(&self, line: &Line<'_>) -> bool {
        let cells = self.cut.separator.usual_cells(line.text, self.cut.fields);
        cells.len() == self.cut.fields && cells.iter().all(|c| looks(c, self.cut.decimal) == Looks::Text)
    }

    /// Refuses what a user stated where the lines say otherwise.
    fn check_stated(&self, lines: &[&[u8]]) -> Result<(), IngestError> {
        let options = &self.file.options.text;
        let place = |sign: u8| {
            lines.iter().find(|l| l.contains(&sign)).map(|l| String::from_utf8_lossy(l).into_owned())
        };
        if let Some(delimiter) = options.delimiter {
            let other = separator::find(lines, None, options.decimal);
            if self.cut.fields == 1 && other.fields > 1 {
                let message = note!(
                    "ingest.delimited.not_this_separator",
                    stated = sign(Separator::of(delimiter)),
                    found = sign(other.separator)
                );
                let text = place(other.separator.byte()).unwrap_or_default();
                return Err(self.error(message).found(&text).hint("ingest.delimited.hint_separator"));
            }
        }
        if let Some(stated) = options.decimal {
            let other = if stated == b'.' { b',' } else { b'.' };
            let count = |decimal: u8| {
                let cells = lines.iter().flat_map(|l| self.cut.separator.cells(l));
                cells.filter(|c| c.contains(&decimal) && looks(c, decimal) == Looks::Number).count()
            };
            if count(stated) == 0 && count(other) > 0 {
                let message = note!(
                    "ingest.delimited.not_this_decimal",
                    stated = (stated as char).to_string(),
                    found = (other as char).to_string()
                );
                let text = place(other).unwrap_or_default();
                return Err(self.error(message).found(&text).hint("ingest.delimited.hint_decimal"));
            }
        }
        Ok(())
    }

    /// What the columns hold; refuses numbers with signs between thousands.
    fn kinds(&self, header: &Header, above: &[Line<'_>], data: &[&Line<'_>]) -> Result<Kinds, IngestError> {
        let fields = self.cut.fields;
        let mut cells: Vec<Vec<&[u8]>> = vec![Vec::new(); fields];
        let mut numbers: Vec<u64> = Vec::new();
        for line in data {
            let of = self.cut.separator.usual_cells(line.text, self.cut.fields);
            if of.len() == fields {
                cells.iter_mut().zip(of).for_each(|(column, cell)| column.push(cell));
                numbers.push(line.number);
            }
        }
        // One file has one decimal sign: a column in which a comma cannot stand before thousands settles all others.
        let settled = |c: &&[u8]| separator::marks_decimals(c);
        let stated = self.file.options.text.decimal.is_some() || cells.iter().flatten().any(settled);
        for column in &cells {
            if let Some(cell) = separator::thousands(column, self.cut.separator, self.cut.decimal, stated) {
                let at = column.iter().position(|c| std::ptr::eq(*c, cell));
                let line = at.and_then(|i| numbers.get(i)).copied().unwrap_or(0);
                return Err(self
                    .error(note!("ingest.delimited.thousands"))
                    .at(line, None)
                    .found(&words(cell))
                    .hint("ingest.delimited.hint_thousands"));
            }
        }
        let blank = |i: usize| format!("column_{}", i + 1);
        let names: Vec<String> = match &header.names {
            Some((_, names)) => names
                .iter()
                .enumerate()
                .map(|(i, n)| if n.is_empty() { blank(i) } else { n.clone() })
                .collect(),
            None => (0..fields).map(blank).collect(),
        };
        let below =
            |i: usize| header.units.as_ref().and_then(|(_, u)| u.get(i)).filter(|u| !u.is_empty()).cloned();
        let texts: Vec<&[u8]> = above.iter().map(|l| l.text).collect();
        let of_labview = header::labview_units(&texts, self.cut.separator, &names);
        let units: Vec<Option<String>> = names
            .iter()
            .zip(of_labview)
            .enumerate()
            .map(|(i, (n, labview))| below(i).or_else(|| header::unit_in_name(n)).or(labview))
            .collect();
        let options = &self.file.options;
        let (stamps, only) = (&options.text.stamps, options.only.as_ref());
        column_kinds::find(&names, &units, &cells, self.cut.decimal, stamps, only).map_err(|c| {
            let message = note!("ingest.delimited.not_these_stamps", column = c.column);
            self.error(message)
                .at(numbers.get(c.row).copied().unwrap_or(0), None)
                .found(&c.text)
                .hint("ingest.delimited.hint_stamps")
        })
    }

    fn metadata(&self, above: &[Line<'_>], header: &Header) -> Vec<(String, String)> {
        let mut metadata = Metadata::default();
        for line in above.iter().filter(|l| !header.uses(l.number)) {
            match self.comments.prefix_of(line.text) {
                Some(prefix) => {
                    let text = line.text.trim_ascii_start().get(prefix.len()..).unwrap_or_default();
                    let sign = prefix.first().copied().unwrap_or(0);
                    let start = text.iter().position(|c| *c != sign).unwrap_or(text.len());
                    add_line(&mut metadata, text.get(start..).unwrap_or_default(), None);
                }
                None => add_line(&mut metadata, line.text, Some(self.cut.separator)),
            }
        }
        metadata.entries()
    }

    fn notes(&self, found: &FoundEncoding, header: &Header, above: &[Line<'_>], head: &[u8]) -> Vec<Note> {
        let mut notes = vec![note!(
            "ingest.delimited.encoding",
            encoding = encoding::name(found.encoding),
            why = found.reason.clone()
        )];
        if let Some(at) = found.damaged_at {
            let line = head.iter().take(at).filter(|c| **c == b'\n').count() + 1;
            notes.push(note!("ingest.delimited.damaged", line, byte = at + 1));
        }
        notes.push(note!(
            "ingest.note.dialect",
            separator = sign(self.cut.separator),
            decimal = (self.cut.decimal as char).to_string()
        ));
        notes.push(note!("ingest.delimited.fields", fields = self.cut.fields, lines = self.cut.lines));
        match (&header.names, &header.units) {
            (None, _) => notes.push(note!("ingest.note.no_header")),
            (Some((line, _)), None) => notes.push(note!("ingest.delimited.names", line = *line)),
            (Some((line, _)), Some((units, _))) => {
                notes.push(note!("ingest.delimited.names_and_units", line = *line, units = *units))
            }
        }
        let comments = above.iter().filter(|l| self.comments.holds(l.text) && !header.uses(l.number)).count();
        if comments > 0 {
            notes.push(note!("ingest.delimited.comments", count = comments));
        }
        notes
    }
}

/// A separator as it is reported.
fn sign(separator: Separator) -> Arg {
    match separator {
        Separator::Byte(b'\t') => Arg::Key("ingest.tab".to_owned()),
        Separator::Byte(b) => Arg::Text(format!("`{}`", b as char)),
        Separator::Blanks => Arg::Key("ingest.delimited.blanks".to_owned()),
    }
}
