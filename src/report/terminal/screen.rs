//! What the text is written to: width and styles.

use super::wrap::wrapped;
use crate::i18n::visible;
use anstyle::{AnsiColor, Style};
use unicode_width::UnicodeWidthStr;

/// What the text is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// Columns.
    pub width: usize,
    /// Whether control sequences for colour and weight are written.
    pub colour: bool,
}

impl Terminal {
    /// Text in a style. The text must be [`visible`].
    pub(in crate::report) fn styled(self, text: &str, style: Style) -> String {
        if self.colour && !text.is_empty() { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }

    /// A heading.
    pub(in crate::report) fn heading(self, text: &str) -> String {
        self.styled(text, Style::new().bold())
    }

    /// A word in the colour of a verdict.
    pub(in crate::report) fn verdict(self, text: &str, id: &str) -> String {
        self.styled(text, verdict_style(id))
    }

    /// A styled word with what it is of, on its line or, where that is too long, below it.
    pub(in crate::report) fn headed(self, styled: &str, word: &str, of: &str) -> String {
        if word.width() + 2 + of.width() > self.width {
            format!("{styled}\n{}", self.indented([of]))
        } else {
            format!("{styled}  {of}\n")
        }
    }

    /// A sentence behind a word in the colour of its state, wrapped as by [`Terminal::indented`].
    pub(super) fn marked(self, word: &str, id: &str, sentence: &str) -> String {
        let plain = self.indented([format!("{word}: {sentence}")]);
        // The first line may be too narrow for a word that has a space.
        match plain.strip_prefix("  ").and_then(|text| text.strip_prefix(word)) {
            Some(rest) => format!("  {}{rest}", self.verdict(word, id)),
            None => plain,
        }
    }

    /// Sentences, each wrapped to the width behind an indent of two columns.
    pub(in crate::report) fn indented(self, sentences: impl IntoIterator<Item = impl AsRef<str>>) -> String {
        let mut out = String::new();
        for sentence in sentences {
            let text = visible(sentence.as_ref()).into_owned();
            for (i, line) in wrapped(&text, self.width.saturating_sub(4)).iter().enumerate() {
                out.push_str(if i == 0 { "  " } else { "    " });
                out.push_str(line);
                out.push('\n');
            }
        }
        out
    }
}

/// The style of a verdict or a state.
pub(in crate::report) fn verdict_style(id: &str) -> Style {
    let colour = match id {
        "pass" | "ok" | "consistent" => AnsiColor::Green,
        "fail" | "error" | "invalid" => AnsiColor::Red,
        "indeterminate" | "remark" | "mismatch" => AnsiColor::Yellow,
        _ => return Style::new(),
    };
    Style::new().bold().fg_color(Some(colour.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_stands_before_its_sentence_on_one_line() {
        let plain = Terminal { width: 40, colour: false };
        let sentence = "Warm-up excluded: the fitted tail would need 0.62 h.";
        let shown = plain.marked("remark", "remark", sentence);
        assert_eq!(shown, "  remark: Warm-up excluded: the fitted\n    tail would need 0.62 h.\n");
        let coloured = Terminal { width: 40, colour: true }.marked("remark", "remark", sentence);
        assert!(coloured.starts_with("  \u{1b}["), "{coloured:?}");
        assert_eq!(anstream::adapter::strip_str(&coloured).to_string(), shown);
    }
}
