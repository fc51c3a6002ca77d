//! Values in HTML.

use super::markup::Markup;
use super::table::{Layout, Table};
use super::value::{Detail, Detailed, Joined, State};
use crate::report::prose;
use crate::report::svg::escape;

/// HTML.
pub struct Html;

impl Markup for Html {
    fn text(&self, text: &str) -> String {
        escape(text)
    }

    fn sentence(&self, text: &str) -> String {
        prose::html_sentence(text)
    }

    fn code(&self, name: &str) -> String {
        format!("<code>{}</code>", escape(name))
    }

    fn digest(&self, digest: &str) -> String {
        format!("<span class=\"hash\">{}</span>", escape(digest))
    }

    fn named(&self, text: &str, id: &str) -> String {
        format!("{} {}", escape(text), self.code(id))
    }

    fn link(&self, text: &str, to: &str) -> String {
        format!("<a href=\"{}\">{}</a>", escape(to), escape(text))
    }

    fn state(&self, state: &State) -> String {
        format!("<span class=\"mark {}\">{}</span>", escape(&state.id), escape(&state.word))
    }

    fn detailed(&self, value: String, detailed: &Detailed) -> String {
        let value = if detailed.is_strong { format!("<b>{value}</b>") } else { value };
        let detail = |detail: &Detail| match detail.joined {
            Joined::Unit => format!(", <span class=\"unit\">{}</span>", escape(&detail.text)),
            Joined::Interval | Joined::Remark | Joined::Further => {
                format!("<small>{}</small>", escape(&detail.text))
            }
        };
        std::iter::once(value).chain(detailed.details.iter().map(detail)).collect()
    }

    fn strong(&self, sentence: &str) -> String {
        format!("<strong>{}</strong>", self.sentence(sentence))
    }

    fn stacked(&self, value: String, below: &[String]) -> String {
        below.iter().fold(value, |out, b| format!("{out}<small>{b}</small>"))
    }

    fn footnote(&self, anchor: &str, number: usize, is_last: bool) -> String {
        let comma = if is_last { "" } else { "<sup>,</sup>" };
        format!("<sup><a href=\"#note-{}{number}\">{number}</a></sup>{comma}", escape(anchor))
    }

    fn list(&self, items: &[String], ordered: bool) -> String {
        let tag = if ordered { "ol" } else { "ul" };
        let items: String = items.iter().map(|i| format!("<li>{}</li>", self.sentence(i))).collect();
        if items.is_empty() { items } else { format!("<{tag}>{items}</{tag}>") }
    }

    fn layout(&self, table: &Table) -> Layout {
        table.in_html
    }
}
