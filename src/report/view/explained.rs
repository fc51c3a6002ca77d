//! The recording against the model of its family.

use super::part::Part;
use crate::report::explain::explained_summary;
use crate::report::page::{Block, Link};

/// What came of it, in sentences, and the way to the whole explanation where there is one.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let Some(explained) = &part.record.explained else { return vec![] };
    let to = explained.explanation.as_ref().map_or("", |_| "explain/report");
    let link = Block::Link(Link {
        words: format!("{}: {}", words.t("explained.model"), explained.model),
        text: words.t("explained.page"),
        to: to.to_owned(),
    });
    let summary = explained_summary(explained, words.lang).into_iter().map(Block::Paragraph);
    vec![Block::section("", words.t("explained.title"), summary.chain([link]).collect())]
}
