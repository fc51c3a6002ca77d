//! Sentences in the kind of file they stand in: names between backticks become code.

use super::svg;
use crate::i18n::{steers, visible};
use minijinja::value::Value;
use minijinja::{AutoEscape, State};

/// A sentence, escaped for the file. Backticks that do not pair, and pairs with nothing between them, stay as they are.
pub fn prose(state: &State, sentence: &str) -> Value {
    match state.auto_escape() {
        AutoEscape::Html => Value::from_safe_string(parted(sentence, whole_quantities, |name| {
            format!("<code>{}</code>", svg::escape(name))
        })),
        AutoEscape::Custom(kind) if kind == "md" => {
            // Within code nothing is markup but the bar that ends a cell.
            let name = |name: &str| format!("`{}`", visible(name).replace('|', "\\|"));
            Value::from_safe_string(parted(sentence, markdown, name))
        }
        _ => Value::from(sentence),
    }
}

/// Escapes what stands between pairs of backticks and around them.
fn parted(sentence: &str, escape: impl Fn(&str) -> String, code: impl Fn(&str) -> String) -> String {
    let parts: Vec<&str> = sentence.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return escape(sentence);
    }
    let each = parts.iter().enumerate();
    each.map(|(i, part)| match (i % 2 == 1, part.is_empty()) {
        (true, true) => escape("``"),
        (true, false) => code(part),
        _ => escape(part),
    })
    .collect()
}

/// Units written as a separate word after a number. Units with a symbol or a slash are recognised by it.
const UNIT_WORDS: &[&str] = &[
    "s",
    "ms",
    "min",
    "h",
    "Hz",
    "ppm",
    "mrad",
    "arcsec",
    "deg",
    "V",
    "g",
    "mT",
    "с",
    "мс",
    "мин",
    "ч",
    "Гц",
    "млн⁻¹",
    "мрад",
    "град",
    "угл.",
    "В",
    "мТл",
];

fn is_unit(word: &str) -> bool {
    let word = word.trim_end_matches(['.', ',', ';', ':', ')']);
    let is_sign = word.starts_with(['°', '%']);
    let is_ratio = word.split_once('/').is_some_and(|(unit, _)| UNIT_WORDS.contains(&unit));
    is_sign || is_ratio || UNIT_WORDS.contains(&word)
}

/// Text of a page with every number and its unit on one line: a browser would break the line at the space between them,
/// and behind the slash of a unit.
fn whole_quantities(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').collect();
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    while let Some(word) = words.get(at) {
        let next = words.get(at + 1).filter(|w| word.ends_with(|c: char| c.is_ascii_digit()) && is_unit(w));
        let joined = word.contains(['\u{202f}', '\u{a0}']) && word.contains('/');
        if at > 0 {
            out.push(' ');
        }
        match next {
            Some(unit) => {
                let (word, unit) = (svg::escape(word), svg::escape(unit));
                out.push_str(&format!("<span class=\"unit\">{word} {unit}</span>"));
                at += 1;
            }
            None if joined => out.push_str(&format!("<span class=\"unit\">{}</span>", svg::escape(word))),
            None => out.push_str(&svg::escape(word)),
        }
        at += 1;
    }
    out
}

/// Text of a Markdown file in which nothing is markup.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' => {
                out.push('\\');
                out.push(c);
            }
            '_' => out.push_str("\\_"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c if steers(c) => out.push('·'),
            c => out.push(c),
        }
    }
    // An address is no link unless the report makes one.
    out.replace("://", "&#58;//")
        .replace("www.", "www&#46;")
        .replace("WWW.", "WWW&#46;")
        .replace('@', "&#64;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_and_its_unit_stay_on_one_line() {
        let seen = whole_quantities("from 3 to 4.5 °/√h, a < b, 12 rates, 61\u{202f}°/h.");
        let kept = "<span class=\"unit\">4.5 °/√h,</span>";
        assert_eq!(
            seen,
            format!("from 3 to {kept} a &lt; b, 12 rates, <span class=\"unit\">61\u{202f}°/h.</span>")
        );
        assert_eq!(whole_quantities("5 s"), "<span class=\"unit\">5 s</span>");
        assert_eq!(whole_quantities("0,002 град/√ч"), "<span class=\"unit\">0,002 град/√ч</span>");
        assert_eq!(whole_quantities("file 6 limits/2 sold"), "file 6 limits/2 sold");
    }

    #[test]
    fn markdown_cells_stay_whole() {
        assert_eq!(markdown("a|b*c<d>\ne_f"), "a\\|b\\*c&lt;d&gt; e\\_f");
    }

    #[test]
    fn names_become_code_and_what_does_not_pair_stays() {
        let html = |s: &str| parted(s, svg::escape, |name| format!("<code>{}</code>", svg::escape(name)));
        assert_eq!(html("channel `a<b`, x < 1"), "channel <code>a&lt;b</code>, x &lt; 1");
        assert_eq!(html("`a` and `"), "`a` and `");
        assert_eq!(html("an empty field ``"), "an empty field ``");
        assert_eq!(html("column `a`: ``"), "column <code>a</code>: ``");
        let mut env = minijinja::Environment::new();
        env.set_auto_escape_callback(|_| AutoEscape::Custom("md".into()));
        env.add_filter("prose", prose);
        env.set_formatter(|out, _, value| Ok(out.write_str(&value.to_string())?));
        let said = env.render_str("{{ s | prose }}", minijinja::context! { s => "column_a: `rate_deg|h`" });
        assert_eq!(said.unwrap(), "column\\_a: `rate_deg\\|h`");
    }
}
