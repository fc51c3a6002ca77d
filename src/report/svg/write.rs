//! The small writer of SVG text: escaping, coordinates, the estimated width of words.

use crate::i18n::steers;
use std::fmt::Write;

/// Size of ordinary words in a figure, px of the view box.
pub const FONT: f64 = 12.0;

/// Text with the five characters of XML escaped and control characters, which XML forbids, left out.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(' '),
            c if steers(c) && !c.is_control() => out.push('·'),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}

/// A coordinate with one decimal, held inside what every viewer can draw.
pub fn px(v: f64) -> String {
    let v = if v.is_finite() { v.clamp(-20_000.0, 20_000.0) } else { 0.0 };
    let tenths = (v * 10.0).round() as i64;
    if tenths % 10 == 0 {
        (tenths / 10).to_string()
    } else {
        let sign = if tenths < 0 { "-" } else { "" };
        format!("{sign}{}.{}", tenths.abs() / 10, tenths.abs() % 10)
    }
}

/// Width of a text, px: on the wide side of common sans-serif fonts, so that what is laid out never overlaps.
pub fn width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '\u{202f}' => 0.34,
            'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' | '°' => 0.42,
            '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' | '₀'..='₉' => 0.44,
            'm' | 'w' | 'M' | 'W' | 'ш' | 'щ' | 'ж' | 'ю' | 'Ш' | 'Щ' | 'Ж' | 'Ю' => 0.95,
            c if c.is_uppercase() => 0.72,
            _ => 0.65,
        })
        .sum();
    em * size
}

/// The text cut so that it fits, with an ellipsis where it was cut.
pub fn cut(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut out = String::new();
    for c in text.chars() {
        out.push(c);
        if width(&out, size) + size > room {
            break;
        }
    }
    out.push('…');
    out
}

/// Where a text stands about its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// It is centred there.
    Middle,
    /// It ends there.
    End,
}

/// Writes one text element.
pub fn text(out: &mut String, (x, y): (f64, f64), anchor: Anchor, size: f64, extra: &str, words: &str) {
    let anchor = match anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{anchor}{extra}>{}</text>",
        px(x),
        px(y),
        px(size),
        escape(words)
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_breaks_out_of_the_markup() {
        assert_eq!(escape("a<b>&\"c'\u{1}\u{0}"), "a&lt;b&gt;&amp;&quot;c&#39;");
    }

    #[test]
    fn coordinates_are_short_and_finite() {
        assert_eq!(px(1.0), "1");
        assert_eq!(px(-0.04), "0");
        assert_eq!(px(-0.26), "-0.3");
        assert_eq!(px(f64::NAN), "0");
        assert_eq!(px(1e300), "20000");
    }

    #[test]
    fn long_words_are_cut_to_the_room() {
        let long = "a".repeat(200);
        assert!(width(&cut(&long, 12.0, 300.0), 12.0) <= 312.0);
        assert_eq!(cut("short", 12.0, 300.0), "short");
    }
}
