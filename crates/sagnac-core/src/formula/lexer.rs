//! The symbols of a formula with their places.

use super::expression::FormulaError;
use crate::message::{Note, note};
use crate::units::Unit;
use std::ops::Range;

/// Longest formula, bytes.
const MAX_BYTES: usize = 1000;

/// One symbol.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Symbol {
    /// A number with its unit.
    Number(f64, Unit),
    /// A name.
    Name(String),
    /// The channel behind a name.
    Channel(String),
    /// An operator, a parenthesis or a comma.
    Mark(char),
}

/// A symbol and its place.
pub(super) type Placed = (Symbol, Range<usize>);

fn error(span: Range<usize>, message: Note) -> FormulaError {
    FormulaError { span, message }
}

/// Length of what a text begins with, as long as `is` holds.
fn length(text: &str, is: impl Fn(char) -> bool) -> usize {
    text.find(|c| !is(c)).unwrap_or(text.len())
}

/// Length of a decimal number without a sign.
fn number_length(text: &str) -> usize {
    let mut end = length(text, |c| c.is_ascii_digit() || c == '.');
    let rest = text.get(end..).unwrap_or_default();
    if let Some(exponent) = rest.strip_prefix(['e', 'E']) {
        let sign = usize::from(exponent.starts_with(['+', '-']));
        let digits = length(exponent.get(sign..).unwrap_or_default(), |c| c.is_ascii_digit());
        if digits > 0 {
            end += 1 + sign + digits;
        }
    }
    end
}

/// The symbols of a formula.
pub(super) fn symbols(text: &str) -> Result<Vec<Placed>, FormulaError> {
    if text.len() > MAX_BYTES {
        return Err(error(0..text.len(), note!("formula.too_long", most = MAX_BYTES)));
    }
    let mut found = vec![];
    let mut at = 0;
    while let Some(c) = text.get(at..).and_then(|rest| rest.chars().next()) {
        let rest = text.get(at..).unwrap_or_default();
        let begin = at;
        if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        }
        let symbol = if c.is_ascii_digit() || c == '.' {
            at += number_length(rest);
            let value = text.get(begin..at).and_then(|t| t.parse::<f64>().ok()).filter(|v| v.is_finite());
            let value = value.ok_or_else(|| error(begin..at, note!("formula.number")))?;
            let unit = unit_behind(text, &mut at)?;
            Symbol::Number(value, unit)
        } else if c.is_alphabetic() || c == '_' {
            at += length(rest, |c| c.is_alphanumeric() || c == '_');
            Symbol::Name(text.get(begin..at).unwrap_or_default().to_owned())
        } else if c == '@' {
            Symbol::Channel(channel(text, &mut at)?)
        } else if let Some(mark) = mark(c) {
            at += c.len_utf8();
            Symbol::Mark(mark)
        } else {
            return Err(error(at..at + c.len_utf8(), note!("formula.character", found = c.to_string())));
        };
        found.push((symbol, begin..at));
    }
    Ok(found)
}

/// The ASCII mark of a character.
fn mark(c: char) -> Option<char> {
    match c {
        '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => Some(c),
        '×' | '·' => Some('*'),
        '÷' => Some('/'),
        '−' => Some('-'),
        _ => None,
    }
}

/// The unit behind a number: a symbol such as `mT`, or any unit in brackets such as `[deg/h]`.
fn unit_behind(text: &str, at: &mut usize) -> Result<Unit, FormulaError> {
    let rest = text.get(*at..).unwrap_or_default();
    let begin = *at + length(rest, char::is_whitespace);
    let rest = text.get(begin..).unwrap_or_default();
    let (inside, end) = if rest.starts_with('[') {
        let close = rest.find(']').ok_or_else(|| error(begin..text.len(), note!("formula.bracket")))?;
        (begin + 1..begin + close, begin + close + 1)
    } else {
        let end = begin + length(rest, |c| c.is_alphabetic() || matches!(c, '°' | '%' | 'µ' | '″'));
        (begin..end, end)
    };
    if inside.is_empty() && end == begin {
        return Ok(Unit::pure());
    }
    *at = end;
    let unit = Unit::parse(text.get(inside.clone()).unwrap_or_default());
    unit.map_err(|e| error(inside, e.note()))
}

/// The channel behind `@`: a word, or any text in quotation marks.
fn channel(text: &str, at: &mut usize) -> Result<String, FormulaError> {
    let begin = *at;
    let rest = text.get(begin + 1..).unwrap_or_default();
    let (name, end) = if let Some(quoted) = rest.strip_prefix('\'') {
        let close = quoted.find('\'').ok_or_else(|| error(begin..text.len(), note!("formula.quote")))?;
        (quoted.get(..close).unwrap_or_default(), begin + 1 + close + 2)
    } else {
        let end = length(rest, |c| c.is_alphanumeric() || c == '_');
        (rest.get(..end).unwrap_or_default(), begin + 1 + end)
    };
    *at = end;
    if name.is_empty() {
        return Err(error(begin..end.max(begin + 1), note!("formula.no_channel")));
    }
    Ok(name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(text: &str) -> Vec<Symbol> {
        symbols(text).unwrap().into_iter().map(|(s, _)| s).collect()
    }

    #[test]
    fn numbers_take_the_unit_behind_them() {
        let unit = |text: &str| Unit::parse(text).unwrap();
        assert_eq!(marks("0.05 mT"), [Symbol::Number(0.05, unit("mT"))]);
        assert_eq!(marks("1e-3[deg/sqrt(h)]"), [Symbol::Number(1e-3, unit("deg/sqrt(h)"))]);
        assert_eq!(
            marks("2*3"),
            [Symbol::Number(2.0, Unit::pure()), Symbol::Mark('*'), Symbol::Number(3.0, Unit::pure())]
        );
        assert_eq!(marks("5 %"), [Symbol::Number(5.0, unit("%"))]);
    }

    #[test]
    fn names_have_channels_and_places() {
        let found = symbols("N − k@'rate@-40'").unwrap();
        let is = |s: &str| Symbol::Name(s.to_owned());
        assert_eq!(found[0], (is("N"), 0..1));
        assert_eq!(found[1], (Symbol::Mark('-'), 2..5));
        assert_eq!(found[2], (is("k"), 6..7));
        assert_eq!(found[3], (Symbol::Channel("rate@-40".to_owned()), 7..18));
    }

    #[test]
    fn what_is_no_symbol_is_pointed_at() {
        for (text, span) in [
            ("a ? b", 2..3),
            ("1.2.3", 0..5),
            ("3 [deg", 2..6),
            ("3 [bananas]", 3..10),
            ("a@", 1..2),
            ("a@'x", 1..4),
        ] {
            assert_eq!(symbols(text).unwrap_err().span, span, "{text}");
        }
        assert!(symbols(&"a+".repeat(600)).is_err());
    }
}
