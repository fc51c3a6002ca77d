//! A number with its unit in one text: `"20 degC"`, `"0.0030 deg/sqrt(h)"`, `"0.1 %"`.

use crate::i18n::{Note, note};
use crate::units::Unit;
use std::ops::Range;

/// Why a text is no quantity of the dimension needed.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityError {
    /// The part of the text that is wrong, in bytes.
    pub span: Range<usize>,
    /// The problem.
    pub message: Note,
    /// What to do, where that follows from the text alone.
    pub help: Option<Note>,
}

/// Splits a text into its number and the unit behind it.
///
/// # Errors
/// When the text does not begin with a finite decimal number.
pub fn split(text: &str) -> Result<(f64, &str), QuantityError> {
    let start = text.len() - text.trim_start().len();
    let body = &text[start..];
    let end = number_length(body);
    let number = &body[..end];
    let rest = &body[end..];
    let whole = || start..text.trim_end().len().max(start);
    if number.is_empty() {
        let message = if body.trim().is_empty() {
            note!("keyed.quantity.missing")
        } else {
            note!("keyed.quantity.no_number", text = body.trim())
        };
        return Err(QuantityError { span: whole(), message, help: None });
    }
    if rest.starts_with(',') && rest[1..].starts_with(|c: char| c.is_ascii_digit()) {
        return Err(QuantityError {
            span: whole(),
            message: note!("keyed.quantity.decimal_comma", text = body.trim()),
            help: Some(note!("keyed.help.write", text = body.trim().replacen(',', ".", 1))),
        });
    }
    match number.replacen('−', "-", 1).parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((value, rest.trim())),
        _ => Err(QuantityError {
            span: start..start + end,
            message: note!("keyed.quantity.not_finite", text = number),
            help: None,
        }),
    }
}

/// Length of the decimal number a text begins with; 0 when there is none.
fn number_length(text: &str) -> usize {
    let sign = match text.chars().next() {
        Some(c @ ('+' | '-' | '−')) => c.len_utf8(),
        _ => 0,
    };
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + signed);
        if exponent > 0 {
            end += 1 + signed + exponent;
        }
    }
    end
}

/// Reads a quantity that may have one of several units, each of a dimension of its own: the number in the one that its unit
/// fits, and that unit. A number alone is a pure one.
///
/// # Errors
/// As [`parse`].
pub fn parse_as_recorded(
    text: &str,
    units: &'static [&'static str],
) -> Result<(f64, &'static str), QuantityError> {
    let (_, unit_text) = split(text)?;
    let whole = || 0..text.len();
    let pure = units.iter().find(|u| **u == "1");
    if let Some(pure) = pure.filter(|_| unit_text.is_empty()) {
        return parse(text, "1", false, true).map(|value| (value, *pure));
    }
    let given =
        Unit::parse(unit_text).map_err(|e| QuantityError { span: whole(), message: e.note(), help: None })?;
    // What is per percent is a plain quantity by its dimension alone, and would be meant otherwise.
    let per_cent = |text: &str| text.contains('%');
    let fits = |unit: &&&str| {
        let alike = per_cent(unit) == per_cent(unit_text);
        alike && Unit::parse(unit).is_ok_and(|u| u.same_dimension(&given))
    };
    match units.iter().find(fits) {
        Some(unit) => parse(text, unit, true, true).map(|value| (value, *unit)),
        None => {
            let key = if pure.is_some() {
                "keyed_more.no_output_per_input"
            } else {
                "keyed_more.no_unit_per_level"
            };
            let message = Note::new(key).with("unit", unit_text);
            Err(QuantityError { span: whole(), message, help: None })
        }
    }
}

/// Reads a quantity and converts it to `unit`.
///
/// A `difference` is scaled only; otherwise the offset of a temperature scale counts too. For a pure number
/// (`unit` is `1`) the unit may be left out when `bare` allows it.
///
/// # Errors
/// A missing or unknown unit, a wrong dimension, a number that is not finite; with the part of the text concerned.
pub fn parse(text: &str, unit: &str, difference: bool, bare: bool) -> Result<f64, QuantityError> {
    let (value, unit_text) = split(text)?;
    let trimmed = text.trim();
    let whole = {
        let start = text.len() - text.trim_start().len();
        start..start + trimmed.len()
    };
    if unit_text.is_empty() {
        if bare && unit == "1" {
            return Ok(value);
        }
        let message = note!("keyed.no_unit", name = trimmed);
        return Err(QuantityError { span: whole, message, help: None });
    }
    let unit_start = whole.end - unit_text.len();
    let wrong_unit = |message: Note| QuantityError { span: unit_start..whole.end, message, help: None };
    let given = Unit::parse(unit_text).map_err(|e| wrong_unit(e.note()))?;
    let target = Unit::parse(unit).map_err(|e| wrong_unit(e.note()))?;
    let converted = if difference {
        given.factor_to(&target).map(|factor| value * factor)
    } else {
        given.convert(value, &target)
    };
    let converted = converted.map_err(|e| wrong_unit(e.note()))?;
    if converted.is_finite() {
        Ok(converted)
    } else {
        let message = note!("keyed.quantity.too_large", text = trimmed);
        Err(QuantityError { span: whole, message, help: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};

    #[test]
    fn numbers_and_units_are_told_apart() {
        assert_eq!(split("20 degC"), Ok((20.0, "degC")));
        assert_eq!(split(" -1.5e-3deg/h "), Ok((-0.0015, "deg/h")));
        assert_eq!(split("−4 degC"), Ok((-4.0, "degC")));
        assert_eq!(split("10h"), Ok((10.0, "h")));
        assert_eq!(split("1e3"), Ok((1000.0, "")));
        assert_eq!(split(".5 %"), Ok((0.5, "%")));
        for bad in ["", "  ", "degC", "nan s", "inf", "1e999 s", "0,4 degC", ".", "-", "e5"] {
            assert!(split(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn values_arrive_in_the_unit_asked_for() {
        assert_eq!(parse("10 h", "s", false, false), Ok(36_000.0));
        assert!((parse("0.1 %", "1", false, false).unwrap() - 0.001).abs() < 1e-18);
        assert!((parse("68 degF", "degC", false, false).unwrap() - 20.0).abs() < 1e-12);
        assert!((parse("0.9 degF", "degC", true, false).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(parse("2.5", "1", false, true), Ok(2.5));
    }

    #[test]
    fn the_wrong_part_is_pointed_at() {
        let e = parse("20 bananas", "degC", false, false).unwrap_err();
        assert_eq!(e.span, 3..10);
        assert!(e.message.say(Lang::En).contains("`bananas`"), "{:?}", e.message);
        let e = parse("3 deg/sqrt(h)", "deg/h", false, false).unwrap_err();
        assert_eq!((e.span, e.message.say(Lang::En).contains("an angle random walk")), (2..13, true));
        assert!(parse("20", "degC", false, false).unwrap_err().message.say(Lang::En).contains("no unit"));
        assert!(
            parse("0,4 degC", "degC", false, false)
                .unwrap_err()
                .help
                .unwrap()
                .say(Lang::En)
                .contains("0.4 degC")
        );
    }
}
