//! Results as text for a terminal: the verdict, a table of quantities, the reasons, and where the report is.
//!
//! Texts from files are made visible before they are styled, so that only this module writes control sequences.

mod explanation;
mod run;
mod table;

pub use explanation::explanation;
pub use run::run;

use crate::i18n::visible;
use anstyle::{AnsiColor, Style};

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
    fn styled(self, text: &str, style: Style) -> String {
        if self.colour && !text.is_empty() { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }

    /// A heading.
    fn heading(self, text: &str) -> String {
        self.styled(text, Style::new().bold())
    }

    /// A word in the colour of a verdict.
    fn verdict(self, text: &str, id: &str) -> String {
        self.styled(text, verdict_style(id))
    }

    /// Sentences, each wrapped to the width behind an indent of two columns.
    fn indented(self, sentences: impl IntoIterator<Item = impl AsRef<str>>) -> String {
        let mut out = String::new();
        for sentence in sentences {
            let text = visible(sentence.as_ref()).into_owned();
            for (i, line) in table::wrapped(&text, self.width.saturating_sub(4)).iter().enumerate() {
                out.push_str(if i == 0 { "  " } else { "    " });
                out.push_str(line);
                out.push('\n');
            }
        }
        out
    }
}

fn verdict_style(id: &str) -> Style {
    let colour = match id {
        "pass" | "ok" | "consistent" => AnsiColor::Green,
        "fail" | "error" | "invalid" => AnsiColor::Red,
        "indeterminate" | "remark" | "mismatch" => AnsiColor::Yellow,
        _ => return Style::new(),
    };
    Style::new().bold().fg_color(Some(colour.into()))
}
