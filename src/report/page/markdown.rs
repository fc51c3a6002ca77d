//! Values in Markdown.

use super::markup::Markup;
use super::table::{Layout, Table};
use super::value::{Joined, State};
use crate::i18n::visible;
use crate::report::prose;

/// Markdown.
pub struct Markdown;

impl Markup for Markdown {
    fn text(&self, text: &str) -> String {
        prose::markdown(text)
    }

    fn sentence(&self, text: &str) -> String {
        prose::markdown_sentence(text)
    }

    /// Within code nothing is markup but the bar that ends a cell, and a backtick, which a longer fence lets stand.
    fn code(&self, name: &str) -> String {
        let name = visible(name).replace('|', "\\|");
        let longest = name.split(|c| c != '`').map(str::len).max().unwrap_or_default();
        if longest == 0 {
            return format!("`{name}`");
        }
        let fence = "`".repeat(longest + 1);
        format!("{fence} {name} {fence}")
    }

    fn formula(&self, text: &str) -> String {
        self.text(text)
    }

    fn digest(&self, digest: &str) -> String {
        self.code(digest)
    }

    fn named(&self, text: &str, id: &str) -> String {
        format!("{} ({})", self.text(text), self.code(id))
    }

    fn link(&self, text: &str, _: &str) -> String {
        self.text(text)
    }

    fn state(&self, state: &State) -> String {
        self.text(&state.word)
    }

    fn strong(&self, printed: &str) -> String {
        format!("**{printed}**")
    }

    fn detailed(&self, value: String, details: &[(Joined, String)]) -> String {
        let mut out = value;
        for group in details.chunk_by(|(a, _), (b, _)| a == b) {
            let joined = group.first().map(|(joined, _)| *joined);
            let texts: Vec<&str> = group.iter().map(|(_, text)| text.as_str()).collect();
            let text = texts.join("; ");
            out += &match joined {
                _ if out.is_empty() => text,
                Some(Joined::Interval) => format!(" [{text}]"),
                Some(Joined::Remark) => format!(" ({text})"),
                Some(Joined::Unit) => format!(", {text}"),
                Some(Joined::Further) | None => format!("; {text}"),
            };
        }
        out
    }

    fn footnote(&self, _: &str, number: usize, _: bool) -> String {
        format!(" ({number})")
    }

    fn list(&self, items: &[String], ordered: bool) -> String {
        let items: Vec<String> = items.iter().map(|i| self.sentence(i)).collect();
        items.join(if ordered { "; " } else { " " })
    }

    fn layout(&self, table: &Table) -> Layout {
        table.in_markdown
    }
}
