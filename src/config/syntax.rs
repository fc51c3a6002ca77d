//! Syntax errors: what the TOML parser says, in words of the tables, and what to do about the common ones.

use super::diagnostics::{Problem, SourceText, Span};
use super::line_repair::{Fault, repaired};
use crate::i18n::{Arg, Note, note};

/// What the parser says, and the key of the locale tables for it.
const PARSER_FAULTS: &[(&str, &str)] = &[
    ("duplicate key", "keyed.syntax.duplicate_key"),
    ("string values must be quoted", "keyed.syntax.unquoted"),
    ("key with no value", "keyed.syntax.no_value"),
    ("missing value", "keyed.syntax.missing_value"),
    ("missing key", "keyed.syntax.missing_key"),
    ("missing comma between array elements", "keyed.syntax.comma"),
    ("missing comma between key-value pairs", "keyed.syntax.comma"),
    ("missing assignment between key-value pairs", "keyed.syntax.assignment"),
    ("missing opening quote", "keyed.syntax.quote"),
    ("unclosed array", "keyed.syntax.unclosed_list"),
    ("unclosed table", "keyed.syntax.unclosed_header"),
    ("unclosed array table", "keyed.syntax.unclosed_header"),
    ("unclosed inline table", "keyed.syntax.unclosed_table"),
    ("unexpected key or value", "keyed.syntax.rest"),
    ("unexpected content", "keyed.syntax.rest"),
    ("unexpected leading zero", "keyed.syntax.leading_zero"),
    ("unexpected sign", "keyed.syntax.sign"),
    ("invalid key", "keyed.syntax.key"),
    ("invalid unquoted key", "keyed.syntax.key"),
    ("invalid table", "keyed.syntax.header"),
    ("invalid value", "keyed.syntax.value"),
    ("invalid string", "keyed.syntax.string"),
    ("invalid basic string", "keyed.syntax.string"),
    ("invalid literal string", "keyed.syntax.string"),
    ("invalid multi-line basic string", "keyed.syntax.string"),
    ("invalid multi-line literal string", "keyed.syntax.string"),
    ("invalid date-time", "keyed.syntax.date"),
    ("invalid date", "keyed.syntax.date"),
    ("invalid time", "keyed.syntax.time"),
    ("invalid offset", "keyed.syntax.time"),
    ("invalid float", "keyed.syntax.number"),
    ("invalid integer number", "keyed.syntax.number"),
    ("invalid mantissa", "keyed.syntax.number"),
    ("invalid fraction", "keyed.syntax.number"),
    ("invalid exponent", "keyed.syntax.number"),
    ("invalid boolean", "keyed.syntax.flag"),
    ("invalid comment character", "keyed.syntax.control"),
    ("carriage return must be followed by newline", "keyed.syntax.carriage_return"),
    ("extra `=`", "keyed.syntax.extra_sign"),
    ("extra comma in array", "keyed.syntax.extra_comma"),
    ("extra comma in inline table", "keyed.syntax.extra_comma"),
    ("cannot recurse further; max recursion depth met", "keyed.syntax.depth"),
];

/// A syntax error with its place, and what to do where it is one that people make often.
pub(super) fn problem(source: &SourceText, span: &Span, said: &str) -> Problem {
    // The part that speaks of the parser's grammar helps nobody.
    let said = said.strip_suffix(", expected literal string").unwrap_or(said);
    if let Some((line, repair)) = repaired(source, span) {
        let key = match repair.fault {
            Fault::Unquoted => "keyed.unquoted",
            Fault::Quotes => "keyed.odd_quotes",
            Fault::Flag => "keyed.flag_case",
            Fault::Date => "keyed.date_order",
            Fault::Colon => "keyed.colon",
        };
        return source.error(&line, key).help(note!("keyed.help.write", text = repair.line));
    }
    let problem = source.error(span, note!("keyed.not_toml", reason = reason(said)));
    let help = if said.contains("duplicate key") {
        "keyed.help.once"
    } else if said.contains("date") || said.contains("time") {
        "keyed.help.dates"
    } else if problem.token.starts_with(|c: char| c.is_ascii_alphanumeric()) || said.contains("string") {
        "keyed.help.quotes"
    } else {
        return problem;
    };
    problem.help(help)
}

/// What the parser said as a note: its own words in English, those of the tables in another language.
fn reason(said: &str) -> Arg {
    let what = said.split(", expected ").next().unwrap_or(said);
    let known = PARSER_FAULTS.iter().find(|(text, _)| *text == what);
    Note::new(known.map_or("keyed.syntax.other", |(_, key)| key)).with("said", said).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;
    use crate::i18n::Localize;

    #[test]
    fn english_keeps_what_the_parser_says() {
        for (said, _) in PARSER_FAULTS {
            for text in [(*said).to_owned(), format!("{said}, expected newline, `#`")] {
                let note = reason(&text);
                assert_eq!(note.say(Lang::En), text);
                assert!(!note.say(Lang::Ru).contains("expected"), "{said}");
            }
        }
        assert_eq!(reason("something new").say(Lang::En), "something new");
    }
}
