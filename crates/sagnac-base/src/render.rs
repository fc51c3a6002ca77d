//! Notes as sentences, by a table of patterns that the caller brings.

use crate::message::{Arg, Note};
use crate::visible::visible;

/// A table of patterns: key to text with `{argument}` places. `number.decimal` is the decimal mark, `language.code` the
/// code of the language.
pub type Patterns<'a> = &'a dyn Fn(&str) -> Option<&'static str>;

impl Arg {
    /// The argument in words, with the decimal mark of the table.
    pub fn render(&self, patterns: Patterns<'_>) -> String {
        match self {
            Arg::Number(v) => decimal(&trimmed(significant(*v, 4)), patterns),
            Arg::Stated(v) => decimal(&trimmed(significant(*v, 12)), patterns),
            Arg::Figures { value, digits, zeros: true } => decimal(&significant(*value, *digits), patterns),
            Arg::Figures { value, digits, zeros: false } => {
                decimal(&trimmed(significant(*value, *digits)), patterns)
            }
            Arg::Decimals { value, digits, zeros: true } => {
                decimal(&with_decimals(*value, *digits), patterns)
            }
            Arg::Decimals { value, digits, zeros: false } => {
                decimal(&trimmed(with_decimals(*value, *digits)), patterns)
            }
            Arg::Count(v) => v.to_string(),
            Arg::Text(t) => visible(t).into_owned(),
            Arg::Local(t) => {
                visible(t.in_language(patterns("language.code").unwrap_or_default())).into_owned()
            }
            Arg::Key(k) => words(k, patterns),
            Arg::Note(n) => n.render(patterns),
            Arg::Several(list, between) => {
                list.iter().map(|a| a.render(patterns)).collect::<Vec<_>>().join(between)
            }
        }
    }
}

impl Note {
    /// The sentence. A key that the table lacks shows as itself, so that it is noticed.
    pub fn render(&self, patterns: Patterns<'_>) -> String {
        fill(patterns(&self.id).unwrap_or(&self.id), |name| {
            self.args.get(name).map(|arg| arg.render(patterns))
        })
    }
}

/// The words of a key: what the table says, or else the last part of the key.
pub fn words(key: &str, patterns: Patterns<'_>) -> String {
    patterns(key).map_or_else(|| key.rsplit('.').next().unwrap_or(key).replace('_', " "), str::to_owned)
}

/// An ASCII number with the decimal mark of a table. What was rounded to zero has no sign.
pub fn decimal(ascii: &str, patterns: Patterns<'_>) -> String {
    let zero = |rest: &&str| rest.bytes().all(|b| matches!(b, b'0' | b'.'));
    let ascii = ascii.strip_prefix('-').filter(zero).unwrap_or(ascii);
    ascii.replace('.', patterns("number.decimal").unwrap_or("."))
}

/// Replaces every `{name}` in a pattern.
pub fn fill(pattern: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(pattern.len() + 16);
    let mut rest = pattern;
    while let Some(open) = rest.find('{') {
        let Some(close) = rest[open..].find('}').map(|i| open + i) else { break };
        out.push_str(&rest[..open]);
        let name = &rest[open + 1..close];
        match value(name) {
            Some(text) => out.push_str(&text),
            None => out.push_str(&rest[open..=close]),
        }
        rest = &rest[close + 1..];
    }
    out.push_str(rest);
    out
}

/// Without zeros behind the decimal mark that say nothing.
fn trimmed(text: String) -> String {
    let (mantissa, exponent) = match text.split_once('e') {
        Some((m, e)) => (m, Some(e)),
        None => (text.as_str(), None),
    };
    if !mantissa.contains('.') {
        return text;
    }
    let short = mantissa.trim_end_matches('0').trim_end_matches('.');
    exponent.map_or_else(|| short.to_owned(), |e| format!("{short}e{e}"))
}

/// Significant digits that tell one double from any other.
const MAX_DIGITS: usize = 17;

/// Decimals of the least double with so many digits.
const MAX_DECIMALS: usize = 324 + MAX_DIGITS;

/// A number with the given count of decimals, as far as a double has so many: a record may ask for any count.
pub fn with_decimals(value: f64, digits: usize) -> String {
    let decimals = digits.min(MAX_DECIMALS);
    format!("{value:.decimals$}")
}

/// A number with the given count of significant digits, plain where that reads well and with an exponent elsewhere.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "–".to_owned();
    }
    let digits = digits.clamp(1, MAX_DIGITS);
    // Rounding may carry into the next decade (9.9996 → 10.00), so the exponent is read after rounding.
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-5..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        let plain = format!("{value:.decimals$}");
        if plain.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { "0".into() } else { plain }
    } else {
        format!("{mantissa}e{exponent}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_shown_whatever_count_of_digits_is_asked_for() {
        for digits in [0, 1, 17, 65_535, 65_536, usize::MAX] {
            let figures = |zeros| Arg::Figures { value: 0.1, digits, zeros };
            let decimals = |zeros| Arg::Decimals { value: 0.25, digits, zeros };
            for arg in [figures(true), figures(false), decimals(true), decimals(false)] {
                assert!(arg.render(&|_| None).len() <= 2 + MAX_DECIMALS, "{digits}");
            }
            assert!(significant(f64::MIN_POSITIVE, digits).len() < 30, "{digits}");
        }
        assert_eq!(with_decimals(5e-324, usize::MAX).len(), 2 + MAX_DECIMALS);
    }
}
