//! Lines of delimited text into columns of numbers.

use super::number::{self, Field};
use super::{Block, FieldFault, FieldFaultKind};

/// Reads whole lines. Fields between wanted ones are skipped, not checked; the number of fields of a line is.
///
/// A line break inside quotes is not supported: recordings have none.
#[derive(Debug, Clone)]
pub(super) struct LineParser {
    delimiter: u8,
    decimal: u8,
    fields: usize,
    /// Fields to skip before each wanted one, and where its value goes; in the order of the file.
    steps: Vec<Step>,
    /// Fields after the last wanted one.
    rest: usize,
}

#[derive(Debug, Clone, Copy)]
struct Step {
    skip: usize,
    slot: usize,
}

/// Where a field ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Field,
    Line,
}

impl LineParser {
    /// A parser of lines with `fields` fields, of which those at the `wanted` positions (each at most once) are read.
    pub(super) fn new(delimiter: u8, decimal: u8, fields: usize, wanted: &[usize]) -> LineParser {
        let mut order: Vec<(usize, usize)> = wanted.iter().enumerate().map(|(slot, &w)| (w, slot)).collect();
        order.sort_unstable();
        let mut steps = Vec::new();
        let mut next = 0;
        for (position, slot) in order {
            steps.push(Step { skip: position.saturating_sub(next), slot });
            next = position + 1;
        }
        LineParser { delimiter, decimal, fields, steps, rest: fields.saturating_sub(next) }
    }

    /// Reads lines, the last of which ends with a line feed; rows and lines count from the start of the text.
    pub(super) fn parse(&self, text: &[u8], block: &mut Block) {
        block.reset(self.steps.len());
        let rows = text.len() / 8;
        block.columns.iter_mut().for_each(|c| c.reserve(rows.min(1 << 16)));
        let mut columns = std::mem::take(&mut block.columns);
        if self.decimal == b',' {
            self.lines::<b','>(text, &mut columns, block);
        } else {
            self.lines::<b'.'>(text, &mut columns, block);
        }
        block.columns = columns;
    }

    fn lines<const DECIMAL: u8>(&self, text: &[u8], columns: &mut [Vec<f64>], block: &mut Block) {
        let (mut at, mut row, mut line) = (0, 0u64, 0u64);
        while at < text.len() {
            if let Some(next) = self.plain_line::<DECIMAL>(text, at, columns) {
                at = next;
                row += 1;
            } else {
                let length = memchr::memchr(b'\n', text.get(at..).unwrap_or_default());
                let end = length.map_or(text.len(), |l| at + l);
                let content = text.get(at..end).unwrap_or_default();
                // What the fast path had stored of this line before it gave up.
                let kept = usize::try_from(row).unwrap_or(usize::MAX);
                columns.iter_mut().for_each(|c| c.truncate(kept));
                if !content.trim_ascii().is_empty() {
                    self.any_line(content, columns, block, (row, line));
                    row += 1;
                }
                at = end + 1;
            }
            line += 1;
        }
        block.lines = line;
    }

    /// Reads a line of plain decimals with the right number of fields; returns where the next line starts.
    #[inline(always)]
    fn plain_line<const DECIMAL: u8>(
        &self,
        text: &[u8],
        start: usize,
        columns: &mut [Vec<f64>],
    ) -> Option<usize> {
        let mut at = start;
        let mut end = End::Field;
        for step in &self.steps {
            for _ in 0..step.skip {
                (at, end) = self.skip(text, at)?;
                if end == End::Line {
                    return None;
                }
            }
            let (value, stop) = number::plain_decimal::<DECIMAL>(text, at, self.delimiter)?;
            columns.get_mut(step.slot)?.push(value);
            (at, end) = terminate(text, stop, self.delimiter)?;
            if end == End::Line {
                break;
            }
        }
        if self.rest == 0 {
            return (end == End::Line && self.complete(columns)).then_some(at);
        }
        for left in (0..self.rest).rev() {
            if end == End::Line {
                return None;
            }
            (at, end) = self.skip(text, at)?;
            if (end == End::Line) != (left == 0) {
                return None;
            }
        }
        Some(at)
    }

    /// True when every wanted column got its value: a line that ended early leaves the last ones short.
    #[inline(always)]
    fn complete(&self, columns: &[Vec<f64>]) -> bool {
        match (self.steps.first(), self.steps.last()) {
            (Some(first), Some(last)) => {
                columns.get(first.slot).map(Vec::len) == columns.get(last.slot).map(Vec::len)
            }
            _ => true,
        }
    }

    /// Passes a field without quotes.
    #[inline(always)]
    fn skip(&self, text: &[u8], start: usize) -> Option<(usize, End)> {
        for (at, &c) in (start..).zip(text.get(start..)?) {
            if c == self.delimiter {
                return Some((at + 1, End::Field));
            }
            if c == b'\n' {
                return Some((at + 1, End::Line));
            }
            if c == b'"' {
                return None;
            }
        }
        None
    }

    /// Reads a line of any content and counts what is wrong with it.
    #[cold]
    fn any_line(&self, line: &[u8], columns: &mut [Vec<f64>], block: &mut Block, place: (u64, u64)) {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let cells = cells(line, self.delimiter);
        let surplus_is_empty = |extra: &[&[u8]]| matches!(extra, [one] if one.trim_ascii().is_empty());
        let right = cells.len() == self.fields
            || cells.get(self.fields..).is_some_and(|e| !e.is_empty() && surplus_is_empty(e));
        let mut position = 0;
        for step in &self.steps {
            position += step.skip;
            let cell = cells.get(position).copied();
            position += 1;
            let (value, fault) = match cell {
                Some(cell) if right => match number::field(cell, self.decimal) {
                    Field::Value(v) => (v, None),
                    Field::Empty | Field::NonFinite => (f64::NAN, Some(FieldFaultKind::NonFinite)),
                    Field::Unparsable => (f64::NAN, Some(FieldFaultKind::Unparsable)),
                },
                _ => (f64::NAN, Some(FieldFaultKind::Unparsable)),
            };
            if let Some(column) = columns.get_mut(step.slot) {
                column.push(value);
            }
            let Some(kind) = fault else { continue };
            let describe = || FieldFault {
                slot: step.slot,
                row: place.0,
                line: place.1,
                character: cell.map_or(1, |c| character(line, c)),
                kind,
                text: if right {
                    super::error::shorten(&String::from_utf8_lossy(cell.unwrap_or_default()))
                } else {
                    super::error::shorten(&format!(
                        "{} of {} fields: {}",
                        cells.len(),
                        self.fields,
                        String::from_utf8_lossy(line)
                    ))
                },
            };
            block.fault(describe, step.slot, kind);
        }
    }
}

/// Where the field or the line ends, after a number that stops at `at`.
#[inline(always)]
fn terminate(text: &[u8], at: usize, delimiter: u8) -> Option<(usize, End)> {
    match *text.get(at)? {
        b'\n' => Some((at + 1, End::Line)),
        b'\r' if text.get(at + 1) == Some(&b'\n') => Some((at + 2, End::Line)),
        c if c == delimiter => Some((at + 1, End::Field)),
        _ => None,
    }
}

/// The fields of a line; a delimiter between quotes does not count.
fn cells(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
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
    cells
}

/// Position of a cell in its line in characters, counted from 1.
fn character(line: &[u8], cell: &[u8]) -> u64 {
    let offset = (cell.as_ptr() as usize).saturating_sub(line.as_ptr() as usize).min(line.len());
    let before = line.get(..offset).unwrap_or_default();
    before.iter().filter(|&&b| b & 0xc0 != 0x80).count() as u64 + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, fields: usize, wanted: &[usize]) -> Block {
        let mut block = Block::default();
        LineParser::new(b',', b'.', fields, wanted).parse(text.as_bytes(), &mut block);
        block
    }

    #[test]
    fn wanted_columns_come_in_the_order_asked_for() {
        let block = parse("1,2,3\r\n4,5,6\n\n7,8,9\n", 3, &[2, 0]);
        assert_eq!(block.columns, vec![vec![3.0, 6.0, 9.0], vec![1.0, 4.0, 7.0]]);
        assert_eq!((block.lines, block.faults.len()), (4, 0));
    }

    #[test]
    fn bad_fields_are_located_and_the_rest_of_the_line_is_kept() {
        let block = parse("0,1,x\n1,abc,x\n2,,x\n3, \"4.5\" ,x\n4,1e3,x\n", 3, &[0, 1]);
        assert_eq!(block.columns[0], vec![0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(block.columns[1][0], 1.0);
        assert!(block.columns[1][1].is_nan() && block.columns[1][2].is_nan());
        assert_eq!(block.columns[1][3..], [4.5, 1000.0]);
        assert_eq!((block.unparsable.clone(), block.non_finite.clone()), (vec![0, 1], vec![0, 1]));
        let f = &block.faults[0];
        assert_eq!((f.slot, f.row, f.line, f.character, f.text.as_str()), (1, 1, 1, 3, "abc"));
    }

    #[test]
    fn a_line_with_the_wrong_number_of_fields_gives_no_value() {
        for text in ["1,2\n3\n4,5\n", "1,2\n3,4,5\n4,5\n"] {
            let block = parse(text, 2, &[0, 1]);
            assert_eq!(block.unparsable, vec![1, 1], "{text}");
            assert!(block.columns[0][1].is_nan() && block.columns[1][1].is_nan(), "{text}");
            assert_eq!(block.columns[1][2], 5.0);
        }
        let block = parse("1,2,9\n3,4\n5,6,9\n", 3, &[0]);
        assert_eq!(block.unparsable, vec![1]);
    }

    #[test]
    fn a_separator_at_the_end_of_a_line_is_no_field() {
        let block = parse("1,2,\n3,4,\n", 2, &[0, 1]);
        assert_eq!(block.columns, vec![vec![1.0, 3.0], vec![2.0, 4.0]]);
        assert_eq!(block.unparsable, vec![0, 0]);
    }

    #[test]
    fn separators_between_quotes_do_not_count() {
        let block = parse("1,\"a,b\",3\n", 3, &[2]);
        assert_eq!(block.columns, vec![vec![3.0]]);
    }
}
