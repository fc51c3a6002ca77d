//! What separates the fields and what marks the decimals: whatever gives the most numbers in fields of one count.

use super::fields::{Separator, bare};
use super::number::{self, Field};
use super::stamps::{self, Shape};

/// What a field looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Looks {
    /// Empty.
    Empty,
    /// A number, or what stands for a missing one.
    Number,
    /// A stamp.
    Stamp(Shape),
    /// Anything else.
    Text,
}

impl Looks {
    /// True for a number or a stamp.
    pub(super) fn is_value(self) -> bool {
        matches!(self, Looks::Number | Looks::Stamp(_))
    }
}

/// What a field looks like, with a decimal sign.
pub(super) fn looks(cell: &[u8], decimal: u8) -> Looks {
    match number::field(cell, decimal) {
        Field::Value(_) | Field::NonFinite => Looks::Number,
        Field::Empty => Looks::Empty,
        Field::Unparsable => stamps::detect(bare(cell)).map_or(Looks::Text, Looks::Stamp),
    }
}

/// A way to cut the lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// Separator.
    pub separator: Separator,
    /// Decimal sign.
    pub decimal: u8,
    /// Fields of most lines that hold numbers.
    pub fields: usize,
    /// Lines with that many fields.
    pub lines: usize,
    /// Share of the fields that hold numbers or stamps, times the share of the lines of that count.
    merit: f64,
}

/// Advantage that a later candidate must have: the order settles what is nearly even.
const MARGIN: f64 = 0.02;

/// Finds the way to cut the lines; what a user stated stands. Candidates in order: a tab or a semicolon goes before a
/// comma, since a comma may be a decimal sign.
pub(super) fn find(lines: &[&[u8]], delimiter: Option<u8>, decimal: Option<u8>) -> Cut {
    let separators: Vec<Separator> = match delimiter {
        Some(byte) => vec![Separator::of(byte)],
        None => {
            [b'\t', b';', b'|', b','].map(Separator::Byte).into_iter().chain([Separator::Blanks]).collect()
        }
    };
    let mut best: Option<Cut> = None;
    for separator in separators {
        let common = |l: &&&[u8]| match separator {
            Separator::Byte(b) => l.contains(&b),
            Separator::Blanks => l.trim_ascii().iter().any(|c| matches!(c, b' ' | b'\t')),
        };
        let with = lines.iter().filter(common).count();
        if delimiter.is_none() && 2 * with <= lines.len() {
            continue;
        }
        let quoted = lines.iter().any(|l| l.contains(&b'"'));
        for sign in [b'.', b','] {
            // A comma is both only where quotes keep the two apart.
            let twice = sign == b',' && separator == Separator::Byte(b',') && !quoted;
            if decimal.is_some_and(|d| d != sign) || (twice && delimiter.is_none()) {
                continue;
            }
            let cut = measure(lines, separator, sign);
            let cuts = cut.fields > 1 || delimiter.is_some();
            if cuts && cut.merit > 0.0 && best.is_none_or(|b| cut.merit > b.merit + MARGIN) {
                best = Some(cut);
            }
        }
    }
    best.unwrap_or_else(|| {
        // One column: a comma in it that marks decimals separates nothing.
        let idle = if decimal == Some(b',') { b';' } else { b',' };
        let separator = delimiter.map_or(Separator::Byte(idle), Separator::of);
        let of_sign = |sign| measure(lines, separator, sign);
        match decimal {
            Some(sign) => of_sign(sign),
            None => of_sign(b'.'),
        }
    })
}

/// Counts of the lines with one number of fields.
#[derive(Default)]
struct Count {
    /// Fields that hold values.
    values: usize,
    /// Last such line.
    last: usize,
    /// Lines that hold values.
    lines: usize,
    /// Fields that are not empty, in such lines.
    filled: usize,
    /// True when the last field of any line, a header too, is filled.
    ends_filled: bool,
}

fn measure(lines: &[&[u8]], separator: Separator, decimal: u8) -> Cut {
    let mut counts: std::collections::BTreeMap<usize, Count> = std::collections::BTreeMap::new();
    let mut valued_lines = 0;
    for (i, line) in lines.iter().enumerate() {
        let cells = separator.cells(line);
        let of: Vec<Looks> = cells.iter().map(|c| looks(c, decimal)).collect();
        let values = of.iter().filter(|l| l.is_value()).count();
        let count = counts.entry(cells.len()).or_default();
        count.ends_filled |= of.last().is_some_and(|l| *l != Looks::Empty);
        if values > 0 {
            valued_lines += 1;
            count.values += values;
            count.last = i;
            count.lines += 1;
            count.filled += of.iter().filter(|l| **l != Looks::Empty).count();
        }
    }
    let nothing = Count { ends_filled: true, ..Count::default() };
    let most = counts.iter().max_by_key(|(_, c)| (c.values, c.last));
    let (cells, count) = most.map_or((1, &nothing), |(n, c)| (*n, c));
    // A separator at the end of every line opens no further field.
    let fields = if count.ends_filled || cells == 1 { cells } else { cells - 1 };
    let share = |part: usize, whole: usize| if whole == 0 { 0.0 } else { part as f64 / whole as f64 };
    let merit = share(count.values, count.filled) * share(count.lines, valued_lines);
    Cut { separator, decimal, fields, lines: count.lines, merit }
}

/// A column whose numbers may have signs between thousands, by the fields of it, of which some may be empty. Returns
/// the first such field. `stated`: the decimal sign was stated, so that a comma is not in doubt.
pub(super) fn thousands<'a>(
    cells: &[&'a [u8]],
    separator: Separator,
    decimal: u8,
    stated: bool,
) -> Option<&'a [u8]> {
    let filled = || cells.iter().copied().filter(|c| !bare(c).is_empty());
    let numbers = filled().filter(|c| looks(c, decimal) == Looks::Number).count();
    if 2 * numbers <= filled().count() {
        // Most fields are no numbers: because of blanks or apostrophes between groups of three digits?
        let spaced = |c: &&[u8]| {
            let text = String::from_utf8_lossy(bare(c)).into_owned();
            let body = text.trim_start_matches(['-', '+']);
            let whole = body.split(['.', ',']).next().unwrap_or_default();
            [' ', '\u{a0}', '\u{202f}', '\'', '\u{2019}', '.', ',']
                .into_iter()
                .any(|sign| grouped(if matches!(sign, '.' | ',') { body } else { whole }, sign))
        };
        let with = filled().filter(spaced).count();
        return (2 * with > filled().count()).then(|| filled().find(spaced)).flatten();
    }
    if decimal != b',' || stated {
        return None;
    }
    // A comma before every last three digits, and other numbers below a thousand without one: 1,234 may be either.
    let plain = |c: &[u8]| String::from_utf8_lossy(bare(c)).trim_start_matches(['-', '+']).to_owned();
    let with: Vec<&[u8]> = filled().filter(|c| c.contains(&b',')).collect();
    let whole = filled().any(|c| !c.contains(&b',') && looks(c, decimal) == Looks::Number);
    // Quotes around numbers with a comma are needed where commas separate, whatever the comma means.
    let quoted = separator == Separator::Byte(b',');
    let groups = !with.is_empty() && with.iter().all(|c| grouped(&plain(c), ','));
    if groups && (whole || quoted) { with.first().copied() } else { None }
}

/// True for a number whose only comma does not stand before three digits.
pub(super) fn marks_decimals(cell: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bare(cell)).into_owned();
    let body = text.trim_start_matches(['-', '+']);
    let digits = |g: &str| g.bytes().all(|c| c.is_ascii_digit());
    body.split_once(',').is_some_and(|(whole, rest)| {
        digits(whole) && digits(rest) && !whole.is_empty() && !rest.is_empty() && rest.len() != 3
    })
}

/// True for one to three digits, not all zero, and then groups of three, each behind the sign.
fn grouped(text: &str, sign: char) -> bool {
    let mut groups = text.split(sign);
    let digits = |g: &str| g.bytes().all(|c| c.is_ascii_digit());
    let first = groups.next().unwrap_or_default();
    let rest: Vec<&str> = groups.collect();
    let leads = (1..=3).contains(&first.len()) && digits(first) && !first.starts_with('0');
    let last = rest.len().saturating_sub(1);
    let fits = |(i, g): (usize, &&str)| {
        let whole = if i == last { g.split(['.', ',']).next().unwrap_or_default() } else { g };
        whole.len() == 3 && digits(whole)
    };
    leads && !rest.is_empty() && rest.iter().enumerate().all(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_thousands_are_known() {
        for (text, sign) in [("1,234", ','), ("12 345 678", ' '), ("1.234.567", '.'), ("999'000", '\'')] {
            assert!(grouped(text, sign), "{text}");
        }
        for (text, sign) in [("0,123", ','), ("1234", ','), ("1,23", ','), ("1234,567", ','), ("1,2345", ',')]
        {
            assert!(!grouped(text, sign), "{text}");
        }
    }
}
