//! The look of a page, and the whole document in the typesetter's language.

use crate::fonts::FONT_FAMILIES;
use crate::markup::{body, string, title};
use crate::{Paper, Relation};

/// Name of the document among its files.
pub const MAIN_FILE: &str = "main.typ";

const LOOK_SOURCE: &str = include_str!("look.typ");

/// The document.
pub fn document(paper: &Paper<'_>) -> String {
    let families: Vec<String> = FONT_FAMILIES.iter().map(|f| string(f)).collect();
    let title = title(paper.markdown);
    let (before, between, after) = numbering(paper.page_number);
    let date = paper.made_at;
    let mut out = LOOK_SOURCE.to_owned();
    out.push_str(&format!(
        "#show: page-of.with(title: {}, lang: {}, families: ({}), left: {}, right: {}, foot: {}, number: ({}, {}, {}), \
         date: datetime(year: {}, month: {}, day: {}, hour: {}, minute: {}, second: {}))\n",
        string(&title),
        string(paper.language),
        families.join(", "),
        string(&title),
        string(paper.subject),
        string(paper.foot),
        string(before),
        string(between),
        string(after),
        date.year,
        date.month,
        date.day,
        date.time[0],
        date.time[1],
        date.time[2],
    ));
    for attached in paper.attachments {
        let relation = match attached.relation {
            Relation::Source => "source",
            Relation::Data => "data",
        };
        out.push_str(&format!(
            "#pdf.attach({}, relationship: \"{relation}\", mime-type: {}, description: {})\n",
            string(attached.name),
            string(attached.media_type),
            string(attached.description),
        ));
    }
    out.push_str(&body(paper));
    out
}

/// The texts before, between and after the numbers of `page {n} of {m}`.
fn numbering(pattern: &str) -> (&str, &str, &str) {
    let (before, rest) = pattern.split_once("{n}").unwrap_or((pattern, ""));
    let (between, after) = rest.split_once("{m}").unwrap_or((rest, ""));
    (before, between, after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_of_a_page_stand_where_the_words_have_them() {
        assert_eq!(numbering("с. {n} из {m}."), ("с. ", " из ", "."));
    }
}
