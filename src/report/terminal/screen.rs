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
    pub(super) fn styled(self, text: &str, style: Style) -> String {
        if self.colour && !text.is_empty() { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }

    /// A heading.
    pub(super) fn heading(self, text: &str) -> String {
        self.styled(text, Style::new().bold())
    }

    /// A word in the colour of a verdict.
    pub(super) fn verdict(self, text: &str, id: &str) -> String {
        self.styled(text, verdict_style(id))
    }

    /// A styled word with what it is of, on its line or, where that is too long, below it.
    pub(super) fn headed(self, styled: &str, word: &str, of: &str) -> String {
        if word.width() + 2 + of.width() > self.width {
            format!("{styled}\n{}", self.indented([of]))
        } else {
            format!("{styled}  {of}\n")
        }
    }

    /// Sentences, each wrapped to the width behind an indent of two columns.
    pub(super) fn indented(self, sentences: impl IntoIterator<Item = impl AsRef<str>>) -> String {
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
pub(super) fn verdict_style(id: &str) -> Style {
    let colour = match id {
        "pass" | "ok" | "consistent" => AnsiColor::Green,
        "fail" | "error" | "invalid" => AnsiColor::Red,
        "indeterminate" | "remark" | "mismatch" => AnsiColor::Yellow,
        _ => return Style::new(),
    };
    Style::new().bold().fg_color(Some(colour.into()))
}
