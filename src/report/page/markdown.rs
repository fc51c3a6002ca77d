//! Values in Markdown.

use super::markup::Markup;
use super::table::{Layout, Table};
use super::value::{Detail, Detailed, Joined, State};
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

    fn detailed(&self, value: String, detailed: &Detailed) -> String {
        let detail = |detail: &Detail| {
            let text = self.text(&detail.text);
            match detail.joined {
                Joined::Interval => format!(" [{text}]"),
                Joined::Remark => format!(" ({text})"),
                Joined::Further => format!("; {text}"),
                Joined::Unit => format!(", {text}"),
            }
        };
        std::iter::once(value).chain(detailed.details.iter().map(detail)).collect()
    }

    fn strong(&self, sentence: &str) -> String {
        format!("**{}**", self.sentence(sentence))
    }

    fn stacked(&self, value: String, below: &[String]) -> String {
        let below = below.join("; ");
        if value.is_empty() { below } else { format!("{value} ({below})") }
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
