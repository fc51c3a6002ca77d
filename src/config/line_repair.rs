//! Lines that are no TOML for a usual reason, and how they are written: text without quotes, typographic quotes, `True`,
//! a date of the calendar on the wall, a colon in place of `=`.

use super::diagnostics::{SourceText, Span};
use toml::de::DeTable;

/// A mistake in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// Text without quotes.
    Unquoted,
    /// Quotes that TOML does not know, or only one of two.
    Quotes,
    /// `True` or `False`.
    Flag,
    /// A date such as `31.12.2030`.
    Date,
    /// A colon between key and value.
    Colon,
}

/// A mistake in a line, and the line as it is right.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Repair {
    /// The mistake.
    pub fault: Fault,
    /// The line without its comment.
    pub line: String,
}

/// Longest line that is repaired, bytes.
const MAX_REPAIRED_BYTES: usize = 300;

/// The repair of the line in which a span begins, with the place of its value. `None` where none makes it TOML.
pub(super) fn repaired(source: &SourceText, span: &Span) -> Option<(Span, Repair)> {
    let before = source.text.get(..span.start)?;
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    let line = source.text.get(start..)?.split('\n').next()?;
    let (value, repair) = of_line(line)?;
    Some((start + value.start..start + value.end, repair))
}

/// The place of the value in a line, and the repair.
fn of_line(line: &str) -> Option<(Span, Repair)> {
    if line.len() > MAX_REPAIRED_BYTES || is_toml(line) {
        return None;
    }
    let sign = line.find(['=', ':'])?;
    let (key, rest) = (line.get(..sign)?.trim(), line.get(sign + 1..)?);
    let bare = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    if key.is_empty() || !key.chars().all(bare) {
        return None;
    }
    let value = without_comment(rest).trim();
    if value.is_empty() {
        return None;
    }
    let from = sign + 1 + (rest.len() - rest.trim_start().len());
    let (fault, value_written) = written(value)?;
    let colon = line.get(sign..)?.starts_with(':');
    let (fault, at) = if colon { (Fault::Colon, sign..sign + 1) } else { (fault, from..from + value.len()) };
    let repair = Repair { fault, line: format!("{key} = {value_written}") };
    is_toml(&repair.line).then_some((at, repair))
}

/// A value as TOML has it, with what was wrong with it.
fn written(value: &str) -> Option<(Fault, String)> {
    if is_toml(&format!("a = {value}")) {
        return Some((Fault::Colon, value.to_owned()));
    }
    if let Some(items) = value.strip_prefix('[').and_then(|v| v.strip_suffix(']')) {
        let items: Option<Vec<(Fault, String)>> = items.split(',').map(|item| written(item.trim())).collect();
        let items = items?;
        let fault = items.iter().map(|(fault, _)| *fault).find(|fault| *fault != Fault::Colon)?;
        let items: Vec<String> = items.into_iter().map(|(_, text)| text).collect();
        return Some((fault, format!("[{}]", items.join(", "))));
    }
    match value {
        "True" | "TRUE" => return Some((Fault::Flag, "true".to_owned())),
        "False" | "FALSE" => return Some((Fault::Flag, "false".to_owned())),
        _ => {}
    }
    if let Some(date) = date(value) {
        return Some((Fault::Date, date));
    }
    let quote = |c: char| "\"'“”„«»‘’`".contains(c);
    let text = value.trim_matches(quote).trim();
    let has_words = text.chars().any(|c| c.is_alphabetic() || "%°".contains(c));
    let quoted = value.starts_with(quote) || value.ends_with(quote);
    if !has_words || quoted && text.contains(quote) || text.starts_with(['{', '[']) {
        return None;
    }
    let fault = if quoted { Fault::Quotes } else { Fault::Unquoted };
    Some((fault, toml::Value::String(text.to_owned()).to_string()))
}

/// `31.12.2030` as `2030-12-31`; `None` for anything that is no day, month and year.
fn date(value: &str) -> Option<String> {
    let parts: Vec<&str> = value.split('.').collect();
    let &[day, month, year] = parts.as_slice() else { return None };
    let number = |text: &str| text.parse::<u32>().ok().filter(|_| text.chars().all(|c| c.is_ascii_digit()));
    let (day, month, year) = (number(day)?, number(month)?, number(year).filter(|_| year.len() == 4)?);
    chrono::NaiveDate::from_ymd_opt(i32::try_from(year).ok()?, month, day).map(|d| d.to_string())
}

/// A value without the comment behind it. A `#` in quotes is none.
fn without_comment(rest: &str) -> &str {
    let mut quote = None;
    for (i, c) in rest.char_indices() {
        match (quote, c) {
            (None, '#') => return rest.get(..i).unwrap_or(rest),
            (None, '"' | '\'') => quote = Some(c),
            (Some(q), c) if c == q => quote = None,
            _ => {}
        }
    }
    rest
}

fn is_toml(line: &str) -> bool {
    DeTable::parse_recoverable(line).1.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_slips_are_written_right() {
        for (line, fault, right) in [
            ("id = temp", Fault::Unquoted, "id = \"temp\""),
            ("role = temperature # of the unit", Fault::Unquoted, "role = \"temperature\""),
            ("  title = My own test", Fault::Unquoted, "title = \"My own test\""),
            ("unit = deg/h", Fault::Unquoted, "unit = \"deg/h\""),
            ("nominal = 20 degC", Fault::Unquoted, "nominal = \"20 degC\""),
            ("column = Omega_z [deg/h]", Fault::Unquoted, "column = \"Omega_z [deg/h]\""),
            ("model = ..\\m.toml", Fault::Unquoted, "model = '..\\m.toml'"),
            ("figures = [rate, \"sigma_tau\"]", Fault::Unquoted, "figures = [\"rate\", \"sigma_tau\"]"),
            ("title = My \"own\" test", Fault::Unquoted, "title = 'My \"own\" test'"),
            ("title = “My test”", Fault::Quotes, "title = \"My test\""),
            ("title = «Испытание»", Fault::Quotes, "title = \"Испытание\""),
            ("title = 'My test", Fault::Quotes, "title = \"My test\""),
            ("title = My test\"", Fault::Quotes, "title = \"My test\""),
            ("required = True", Fault::Flag, "required = true"),
            ("calibration_due = 31.12.2030", Fault::Date, "calibration_due = 2030-12-31"),
            ("title: \"My test\"", Fault::Colon, "title = \"My test\""),
            ("warm_up: 30 min", Fault::Colon, "warm_up = \"30 min\""),
        ] {
            let (_, repair) = of_line(line).unwrap_or_else(|| panic!("{line}"));
            assert_eq!((repair.fault, repair.line.as_str()), (fault, right), "{line}");
        }
    }

    #[test]
    fn what_is_right_or_beyond_repair_is_left_alone() {
        for line in [
            "id = \"temp\"",
            "gaps = 10",
            "# title = My test",
            "[conditions",
            "x = { a = b }",
            "title = \"a\" and \"b\"",
            "time,rate",
            "id =",
            "= 5",
            "12:30:00,5.1",
            "due = 2030-02-30",
            "sizes = [1, 2",
            "",
        ] {
            assert_eq!(of_line(line), None, "{line}");
        }
    }
}
