//! Lines of delimited text into columns of numbers.

use super::fields::{Comments, Separator, bare};
use super::number::{self, Field};
use super::stamps::{self, Shape};
use crate::{Block, FieldFault, FieldFaultKind};

/// What a field of every line holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FieldKind {
    /// A number, or text that nobody wants.
    Number,
    /// A stamp, given in seconds after `base_s` from 1970 (clock times: after midnight).
    Stamp {
        /// How it is written.
        shape: Shape,
        /// Seconds from 1970 to the zero of the values.
        base_s: i64,
    },
    /// A word: 1 where its fingerprint is this, 0 elsewhere.
    Word(u64),
}

/// A number that two words hardly ever share (FNV-1a).
pub(super) fn fingerprint(word: &[u8]) -> u64 {
    word.iter().fold(0xcbf2_9ce4_8422_2325, |hash, c| (hash ^ u64::from(*c)).wrapping_mul(0x0100_0000_01b3))
}

/// 1 where a field holds the word of a fingerprint, 0 elsewhere.
fn is_word(cell: &[u8], of: u64) -> f64 {
    f64::from(u8::from(fingerprint(bare(cell)) == of))
}

/// A column that two fields make together: `(first - offset) * scale + second / divisor`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    /// Position of the field that tells the day or the week.
    pub first: usize,
    /// Position of the field that tells the time in it.
    pub second: usize,
    /// Value of the first field at the zero of the values.
    pub offset: f64,
    /// Seconds in one of the first field.
    pub scale: f64,
    /// Parts of a second that the second field counts.
    pub divisor: f64,
}

/// How the lines are written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lines {
    /// What separates the fields.
    pub separator: Separator,
    /// Decimal sign.
    pub decimal: u8,
    /// What each field holds.
    pub kinds: Vec<FieldKind>,
    /// Columns of two fields; they stand behind the columns of one.
    pub pairs: Vec<Pair>,
    /// Which lines are comments.
    pub comments: Comments,
    /// A line that is no row, such as erased memory at the end repeats it.
    pub void: Option<Vec<u8>>,
    /// Rows may have a remark behind their last field.
    pub remarks: bool,
}

/// Reads whole lines. Fields between wanted ones are skipped, not checked; the number of fields of a line is.
///
/// A line break inside quotes is not supported: recordings have none.
#[derive(Debug, Clone)]
pub(super) struct LineParser<'a> {
    of: &'a Lines,
    delimiter: u8,
    fields: usize,
    /// Columns asked for; those behind them are read for the pairs only.
    wanted: usize,
    slots: usize,
    /// Fields to skip before each wanted one, and where its value goes; in the order of the file.
    steps: Vec<Step>,
    /// Slot of each wanted pair and of its two parts.
    pairs: Vec<(usize, [usize; 2], Pair)>,
    /// Fields after the last wanted one.
    rest: usize,
    /// True when the first field of a line is not looked at, so that a comment must be recognised before.
    watched: bool,
}

#[derive(Debug, Clone, Copy)]
struct Step {
    skip: usize,
    slot: usize,
    kind: FieldKind,
}

/// Where a field ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Field,
    Line,
}

impl<'a> LineParser<'a> {
    /// A parser of lines, of which the columns at the `wanted` positions (each at most once) are read.
    pub(super) fn new(of: &'a Lines, wanted: &[usize]) -> LineParser<'a> {
        let fields = of.kinds.len();
        let mut order: Vec<(usize, usize)> =
            wanted.iter().enumerate().filter(|(_, w)| **w < fields).map(|(slot, &w)| (w, slot)).collect();
        let mut slots = wanted.len();
        let mut pairs = Vec::new();
        for (slot, &w) in wanted.iter().enumerate() {
            let Some(pair) = w.checked_sub(fields).and_then(|i| of.pairs.get(i)) else { continue };
            let parts = [pair.first, pair.second].map(|position| {
                let read = order.iter().find(|(p, _)| *p == position).map(|(_, slot)| *slot);
                read.unwrap_or_else(|| {
                    order.push((position, slots));
                    slots += 1;
                    slots - 1
                })
            });
            pairs.push((slot, parts, *pair));
        }
        order.sort_unstable();
        let mut steps = Vec::new();
        let mut next = 0;
        for (position, slot) in order {
            let kind = of.kinds.get(position).copied().unwrap_or(FieldKind::Number);
            steps.push(Step { skip: position.saturating_sub(next), slot, kind });
            next = position + 1;
        }
        LineParser {
            of,
            delimiter: of.separator.byte(),
            fields,
            wanted: wanted.len(),
            slots,
            watched: steps.first().is_none_or(|s| s.skip > 0),
            rest: fields.saturating_sub(next),
            steps,
            pairs,
        }
    }

    /// Reads lines, the last of which ends with a line feed; rows and lines count from the start of the text.
    pub(super) fn parse(&self, text: &[u8], block: &mut Block) {
        block.reset(self.wanted);
        block.columns.resize_with(self.slots, Vec::new);
        // A row has a byte a field at least; room for more would be asked for once a column.
        let rows = text.len() / self.fields.max(8);
        block.columns.iter_mut().for_each(|c| c.reserve(rows.min(1 << 16)));
        let mut columns = std::mem::take(&mut block.columns);
        let blanks = self.of.separator == Separator::Blanks;
        let stamped = self.steps.iter().any(|s| s.kind != FieldKind::Number);
        // The ways that are common are compiled each for itself.
        match (self.of.decimal, blanks, stamped) {
            (b',', false, false) => self.lines::<b',', false, false>(text, &mut columns, block),
            (b',', false, true) => self.lines::<b',', false, true>(text, &mut columns, block),
            (b',', true, false) => self.lines::<b',', true, false>(text, &mut columns, block),
            (b',', true, true) => self.lines::<b',', true, true>(text, &mut columns, block),
            (_, false, false) => self.lines::<b'.', false, false>(text, &mut columns, block),
            (_, false, true) => self.lines::<b'.', false, true>(text, &mut columns, block),
            (_, true, false) => self.lines::<b'.', true, false>(text, &mut columns, block),
            (_, true, true) => self.lines::<b'.', true, true>(text, &mut columns, block),
        }
        self.join(&mut columns);
        columns.truncate(self.wanted);
        block.columns = columns;
    }

    /// Puts the parts of pairs together.
    fn join(&self, columns: &mut [Vec<f64>]) {
        for (slot, [first, second], pair) in &self.pairs {
            let mut joined = columns.get_mut(*slot).map(std::mem::take).unwrap_or_default();
            joined.clear();
            if let (Some(first), Some(second)) = (columns.get(*first), columns.get(*second)) {
                joined.extend(
                    first.iter().zip(second).map(|(a, b)| (a - pair.offset) * pair.scale + b / pair.divisor),
                );
            }
            if let Some(column) = columns.get_mut(*slot) {
                *column = joined;
            }
        }
    }

    fn lines<const DECIMAL: u8, const BLANKS: bool, const STAMPS: bool>(
        &self,
        text: &[u8],
        columns: &mut [Vec<f64>],
        block: &mut Block,
    ) {
        let (mut at, mut row, mut line) = (0, 0u64, 0u64);
        while at < text.len() {
            let comment = self.watched && text.get(at).is_some_and(|c| self.of.comments.may_begin(*c));
            let comment = comment
                || self.of.void.as_ref().is_some_and(|v| text.get(at..).is_some_and(|t| t.starts_with(v)));
            let plain =
                if comment { None } else { self.plain_line::<DECIMAL, BLANKS, STAMPS>(text, at, columns) };
            if let Some(next) = plain {
                at = next;
                row += 1;
            } else {
                let length = memchr::memchr(b'\n', text.get(at..).unwrap_or_default());
                let end = length.map_or(text.len(), |l| at + l);
                let content = text.get(at..end).unwrap_or_default();
                // What the fast path had stored of this line before it gave up.
                let kept = usize::try_from(row).unwrap_or(usize::MAX);
                columns.iter_mut().for_each(|c| c.truncate(kept));
                if !content.trim_ascii().is_empty()
                    && !self.of.comments.holds(content)
                    && !self.is_void(content)
                {
                    self.any_line(content, columns, block, (row, line));
                    row += 1;
                }
                at = end + 1;
            }
            line += 1;
        }
        block.lines = line;
    }

    /// True for a line that is no row.
    fn is_void(&self, line: &[u8]) -> bool {
        self.of.void.as_ref().is_some_and(|v| line.trim_ascii_end() == v.trim_ascii_end())
    }

    /// Reads a line of plain decimals and stamps with the right number of fields; returns where the next line starts.
    #[inline(always)]
    fn plain_line<const DECIMAL: u8, const BLANKS: bool, const STAMPS: bool>(
        &self,
        text: &[u8],
        start: usize,
        columns: &mut [Vec<f64>],
    ) -> Option<usize> {
        let mut at = if BLANKS { blanks(text, start) } else { start };
        let mut end = End::Field;
        for step in &self.steps {
            for _ in 0..step.skip {
                (at, end) = self.skip::<BLANKS>(text, at)?;
                if end == End::Line {
                    return None;
                }
            }
            let (value, stop) = match step.kind {
                FieldKind::Stamp { shape, base_s } if STAMPS => {
                    let stop = at + text.get(at..)?.iter().position(|c| self.ends::<BLANKS>(*c))?;
                    (stamps::parse(text.get(at..stop)?, shape)?.after(base_s), stop)
                }
                FieldKind::Word(of) if STAMPS => {
                    let stop = at + text.get(at..)?.iter().position(|c| self.ends::<BLANKS>(*c))?;
                    let cell = text.get(at..stop).filter(|c| !c.contains(&b'"'))?;
                    (is_word(cell, of), stop)
                }
                _ => number::plain_decimal::<DECIMAL, BLANKS>(text, at, self.delimiter)?,
            };
            columns.get_mut(step.slot)?.push(value);
            (at, end) = self.terminate::<BLANKS>(text, stop)?;
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
            (at, end) = self.skip::<BLANKS>(text, at)?;
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

    /// True for a character that ends a stamp.
    #[inline(always)]
    fn ends<const BLANKS: bool>(&self, c: u8) -> bool {
        c == self.delimiter || c == b'\n' || c == b'\r' || (BLANKS && c == b'\t')
    }

    /// Passes a field without quotes.
    #[inline(always)]
    fn skip<const BLANKS: bool>(&self, text: &[u8], start: usize) -> Option<(usize, End)> {
        for (at, &c) in (start..).zip(text.get(start..)?) {
            if c == self.delimiter || (BLANKS && c == b'\t') {
                return if BLANKS { self.terminate::<BLANKS>(text, at) } else { Some((at + 1, End::Field)) };
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

    /// Where the field or the line ends, after a number that stops at `at`.
    #[inline(always)]
    fn terminate<const BLANKS: bool>(&self, text: &[u8], at: usize) -> Option<(usize, End)> {
        let at = if BLANKS { blanks(text, at) } else { at };
        match *text.get(at)? {
            b'\n' => Some((at + 1, End::Line)),
            b'\r' if text.get(at + 1) == Some(&b'\n') => Some((at + 2, End::Line)),
            _ if BLANKS => Some((at, End::Field)),
            c if c == self.delimiter => Some((at + 1, End::Field)),
            _ => None,
        }
    }

    /// Reads a line of any content and counts what is wrong with it.
    #[cold]
    fn any_line(&self, line: &[u8], columns: &mut [Vec<f64>], block: &mut Block, place: (u64, u64)) {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let cells = self.of.separator.cells(line);
        let surplus_is_empty = |extra: &[&[u8]]| matches!(extra, [one] if one.trim_ascii().is_empty());
        let right = cells.len() == self.fields
            || cells
                .get(self.fields..)
                .is_some_and(|e| !e.is_empty() && (surplus_is_empty(e) || (self.of.remarks && e.len() == 1)));
        let mut faults: Vec<(usize, Option<&[u8]>, FieldFaultKind)> = Vec::new();
        let mut position = 0;
        for step in &self.steps {
            position += step.skip;
            let cell = cells.get(position).copied();
            position += 1;
            let read = match cell {
                Some(cell) if right => self.field(cell, step.kind),
                _ => Err(FieldFaultKind::Unparsable),
            };
            if let Some(column) = columns.get_mut(step.slot) {
                column.push(read.unwrap_or(f64::NAN));
            }
            faults.extend(read.err().map(|kind| (step.slot, cell, kind)));
        }
        for (slot, parts, _) in &self.pairs {
            // One fault a pair; what is no stamp at all goes before what is empty.
            let of_parts = || faults.iter().filter(|(s, ..)| parts.contains(s));
            let worst = of_parts().find(|f| f.2 == FieldFaultKind::Unparsable).or_else(|| of_parts().next());
            if let Some(&(_, cell, kind)) = worst {
                faults.push((*slot, cell, kind));
            }
        }
        for (slot, cell, kind) in faults.into_iter().filter(|(slot, ..)| *slot < self.wanted) {
            let describe = || FieldFault {
                slot,
                row: place.0,
                line: place.1,
                character: cell.map_or(1, |c| character(line, c)),
                kind,
                text: if right {
                    crate::error::shorten(&String::from_utf8_lossy(cell.unwrap_or_default()))
                } else {
                    crate::error::shorten(&format!(
                        "{} of {} fields: {}",
                        cells.len(),
                        self.fields,
                        String::from_utf8_lossy(line)
                    ))
                },
            };
            block.fault(describe, slot, kind);
        }
    }

    /// The value of a field, or why there is none.
    fn field(&self, cell: &[u8], kind: FieldKind) -> Result<f64, FieldFaultKind> {
        if let FieldKind::Stamp { shape, base_s } = kind {
            let text = bare(cell);
            return match stamps::parse(text, shape) {
                Some(stamp) => Ok(stamp.after(base_s)),
                None if text.is_empty() => Err(FieldFaultKind::NonFinite),
                None => Err(FieldFaultKind::Unparsable),
            };
        }
        if let FieldKind::Word(of) = kind {
            return Ok(is_word(cell, of));
        }
        match number::field(cell, self.of.decimal) {
            Field::Value(v) => Ok(v),
            Field::Empty | Field::NonFinite => Err(FieldFaultKind::NonFinite),
            Field::Unparsable => Err(FieldFaultKind::Unparsable),
        }
    }
}

/// The position of the first character that is no blank.
#[inline(always)]
fn blanks(text: &[u8], mut at: usize) -> usize {
    while matches!(text.get(at), Some(b' ' | b'\t')) {
        at += 1;
    }
    at
}

/// Position of a cell in its line in characters, counted from 1.
fn character(line: &[u8], cell: &[u8]) -> u64 {
    let offset = (cell.as_ptr() as usize).saturating_sub(line.as_ptr() as usize).min(line.len());
    let before = line.get(..offset).unwrap_or_default();
    before.iter().filter(|&&b| b & 0xc0 != 0x80).count() as u64 + 1
}

#[cfg(test)]
#[path = "rows_tests.rs"]
mod tests;
