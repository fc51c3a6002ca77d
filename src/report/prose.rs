//! Sentences in the kind of file they stand in: names between backticks become code.

use super::svg;
use crate::i18n::{steers, visible};
use minijinja::value::Value;
use minijinja::{AutoEscape, State};

/// A sentence, escaped for the file. Backticks that do not pair, and pairs with nothing between them, stay as they are.
pub fn prose(state: &State, sentence: &str) -> Value {
    match state.auto_escape() {
        AutoEscape::Html => Value::from_safe_string(html_sentence(sentence)),
        AutoEscape::Custom(kind) if kind == "md" => Value::from_safe_string(markdown_sentence(sentence)),
        _ => Value::from(sentence),
    }
}

/// A sentence in HTML.
pub fn html_sentence(sentence: &str) -> String {
    parted(sentence, whole_quantities, |name| format!("<code>{}</code>", svg::escape(name)))
}

/// A sentence in Markdown. Within code nothing is markup but the bar that ends a cell.
pub fn markdown_sentence(sentence: &str) -> String {
    parted(sentence, markdown, |name| format!("`{}`", visible(name).replace('|', "\\|")))
}

/// A formula, escaped for the file. In HTML, letters and digits behind an underscore stand below the line.
pub fn formula(state: &State, text: &str) -> Value {
    match state.auto_escape() {
        AutoEscape::Html => Value::from_safe_string(html_formula(text)),
        _ => Value::from(text),
    }
}

/// A formula in HTML: letters and digits behind an underscore stand below the line.
pub fn html_formula(text: &str) -> String {
    let mut parts = text.split('_');
    let mut out = svg::escape(parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|c: char| !c.is_alphabetic() && !c.is_ascii_digit()).unwrap_or(part.len());
        let (below, rest) = part.split_at(end);
        out.push_str(&format!("<sub>{}</sub>{}", svg::escape(below), svg::escape(rest)));
    }
    out
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

/// True where no line may end between two words: a number and its unit, a sign and its number.
fn belong_together(word: &str, next: &str) -> bool {
    let is_number = word.ends_with(|c: char| c.is_ascii_digit());
    let is_sign = matches!(word.trim_start_matches('('), "<" | ">" | "≤" | "≥" | "±");
    is_number && (is_unit(next) || next == "±") || is_sign && next.starts_with(|c: char| c.is_ascii_digit())
}

/// Text of a page with every number on one line with its sign and its unit: a browser would break the line at the space
/// between them, and behind the slash of a unit.
fn whole_quantities(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').collect();
    let mut out = String::with_capacity(text.len());
    let mut rest = words.as_slice();
    while !rest.is_empty() {
        let more = rest.windows(2).take_while(|w| belong_together(w[0], w[1])).count();
        let (together, after) = rest.split_at(more + 1);
        let quantity = svg::escape(&together.join(" "));
        let is_unbroken = together.iter().any(|w| w.contains(['\u{202f}', '\u{a0}']) && w.contains('/'));
        if more > 0 || is_unbroken {
            out.push_str(&format!("<span class=\"unit\">{quantity}</span>"));
        } else {
            out.push_str(&quantity);
        }
        if !after.is_empty() {
            out.push(' ');
        }
        rest = after;
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
        assert_eq!(
            whole_quantities("from < 0.01\u{202f}% to 1 ± 5 s"),
            "from <span class=\"unit\">&lt; 0.01\u{202f}%</span> to <span class=\"unit\">1 ± 5 s</span>"
        );
    }

    #[test]
    fn letters_behind_an_underscore_stand_below_the_line() {
        assert_eq!(html_formula("θ_x² < Ω_max·V_1"), "θ<sub>x</sub>² &lt; Ω<sub>max</sub>·V<sub>1</sub>");
        assert_eq!(html_formula("y = x"), "y = x");
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
