//! Text from outside without what steers a terminal or hides in a line.
//!
//! A name in a recording may hold an escape sequence that clears the screen or paints one verdict over another, an
//! override that turns the order of letters round, or a letter that nobody sees. Each is shown as one visible sign.

use std::borrow::Cow;

/// Replacement of a character that is not shown.
const REPLACEMENT_SIGN: char = '·';

/// True for a character that steers in place of being shown: controls, marks of direction, what has no width, separators
/// of lines.
pub fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

fn shown(c: char) -> char {
    match c {
        '\t' | '\n' | '\r' => ' ',
        c if steers(c) => REPLACEMENT_SIGN,
        c => c,
    }
}

/// A text as one line.
pub fn visible(text: &str) -> Cow<'_, str> {
    if text.chars().any(steers) { text.chars().map(shown).collect::<String>().into() } else { text.into() }
}

/// A text of several lines.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    if text.chars().any(|c| c != '\n' && steers(c)) {
        text.chars().map(|c| if c == '\n' { c } else { shown(c) }).collect::<String>().into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_is_shown_as_a_sign() {
        assert_eq!(visible("a\u{1b}[2Jb\u{9b}c\u{7f}"), "a·[2Jb·c·");
        assert_eq!(visible("x\nPASS\r\ty"), "x PASS  y");
        assert_eq!(visible_lines("x\nPASS\r\u{202e}y\u{200b}\u{2028}"), "x\nPASS ·y··");
        assert_eq!(visible("Дрейф, °/ч — 5\u{202f}%"), "Дрейф, °/ч — 5\u{202f}%");
    }
}
