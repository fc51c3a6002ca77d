//! Values in HTML.

use super::markup::Markup;
use super::table::{Layout, Table};
use super::value::{Joined, State};
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

    fn formula(&self, text: &str) -> String {
        format!("<span class=\"formula\">{}</span>", prose::html_formula(text))
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

    fn strong(&self, printed: &str) -> String {
        format!("<b>{printed}</b>")
    }

    fn detailed(&self, value: String, details: &[(Joined, String)]) -> String {
        let detail = |(joined, detail): &(Joined, String)| match joined {
            Joined::Unit => format!(", <span class=\"unit\">{detail}</span>"),
            Joined::Interval | Joined::Remark | Joined::Further => format!("<small>{detail}</small>"),
        };
        std::iter::once(value).chain(details.iter().map(detail)).collect()
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
