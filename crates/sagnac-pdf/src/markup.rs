//! Markdown as markup of the typesetter.

use crate::fonts::shown;
use crate::{Mark, Pages, Paper};
use pulldown_cmark::{Alignment, CowStr, Event, Options, Parser, Tag, TagEnd};

/// A text in markup: every sign stands for itself.
pub fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 16);
    for c in shown(text).chars() {
        if c.is_ascii_punctuation() {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// A text as a string of the typesetter's language.
pub fn string(text: &str) -> String {
    format!("\"{}\"", shown(text).replace('\\', "\\\\").replace('"', "\\\""))
}

/// The title of a text: its first heading, else its first words.
pub fn title(markdown: &str) -> String {
    let mut words = String::new();
    for event in Parser::new_ext(markdown, Options::ENABLE_TABLES) {
        match event {
            Event::Text(text) | Event::Code(text) => words.push_str(&text),
            Event::End(TagEnd::Heading(_) | TagEnd::Paragraph) if !words.trim().is_empty() => break,
            _ => {}
        }
    }
    // An archive takes no document without a title.
    if words.trim().is_empty() { "Sagnac".to_owned() } else { words.trim().to_owned() }
}

/// The text of a paper in markup.
pub fn body(paper: &Paper<'_>) -> String {
    let mut body = Body { paper, out: String::new(), nested: vec![] };
    for event in Parser::new_ext(paper.markdown, Options::ENABLE_TABLES) {
        let ends_summary =
            matches!(&event, Event::Html(text) if text.trim() == PAGE_MARK || text.trim() == SUMMARY_MARK);
        if ends_summary && paper.pages == Pages::Summary {
            break;
        }
        body.take(event);
    }
    body.out
}

/// A new page begins here, and the summary ends.
const PAGE_MARK: &str = "<!-- page -->";
/// The summary ends here.
const SUMMARY_MARK: &str = "<!-- summary -->";

/// Signs of a word that has no place to break, above which places are made.
const LONGEST_WORD: usize = 40;

/// Signs on a line of a table, and of a cell that is kept on one line.
const PAGE_WIDTH: usize = 100;
const SHORT_COLUMN_CHARS: usize = 20;

/// Text collected before it can be written.
enum Nested {
    /// Text in bold.
    Strong(String),
    /// A picture: its name, and the words for those who do not see it.
    Picture(String, String),
    /// A table.
    Table(Table),
}

#[derive(Default)]
struct Table {
    alignments: Vec<Alignment>,
    head: Vec<String>,
    cells: Vec<String>,
    in_head: bool,
    /// The text of every cell, those of the head first.
    texts: Vec<String>,
    /// Markup of the cell at hand, and its text.
    cell: String,
    text: String,
}

struct Body<'a> {
    paper: &'a Paper<'a>,
    out: String,
    nested: Vec<Nested>,
}

impl Body<'_> {
    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Start(tag) => self.start(tag),
            Event::End(tag) => self.end(tag),
            Event::Text(text) | Event::Code(text) => self.text(&text),
            Event::SoftBreak => self.put(" "),
            Event::HardBreak => self.put("#linebreak()"),
            Event::Html(text) if text.trim() == PAGE_MARK => self.put("\n#pagebreak(weak: true)\n"),
            // The pages have none; what a template of the user's has of it is no text.
            _ => {}
        }
    }

    fn start(&mut self, tag: Tag<'_>) {
        match tag {
            Tag::Heading { level, .. } => self.put(&format!("\n#heading(level: {})[", level as usize)),
            Tag::List(None) => self.put("\n#list("),
            Tag::List(Some(first)) => self.put(&format!("\n#enum(start: {first}, ")),
            Tag::Item => self.put("["),
            Tag::Emphasis => self.put("#emph["),
            Tag::Strong => self.nested.push(Nested::Strong(String::new())),
            Tag::Link { dest_url, .. } => self.put(&link(&dest_url)),
            Tag::Image { dest_url, .. } => {
                self.nested.push(Nested::Picture(dest_url.into_string(), String::new()));
            }
            Tag::Table(alignments) => {
                self.nested.push(Nested::Table(Table { alignments, ..Table::default() }));
            }
            Tag::TableHead => self.in_table(|t| t.in_head = true),
            Tag::TableCell => self.in_table(|t| {
                t.cell.clear();
                t.text.clear();
            }),
            Tag::Paragraph => self.put("\n"),
            _ => {}
        }
    }

    fn end(&mut self, tag: TagEnd) {
        match tag {
            TagEnd::Heading(_) => self.put("]\n"),
            TagEnd::List(_) => self.put(")\n"),
            TagEnd::Item => self.put("],"),
            TagEnd::Emphasis | TagEnd::Link => self.put("]"),
            TagEnd::Strong => {
                if let Some(Nested::Strong(text)) = self.nested.pop() {
                    let marked = self.marked(&text).unwrap_or_else(|| format!("#strong[{}]", plain(&text)));
                    self.put(&marked);
                    self.in_table(|t| t.text.push_str(&text));
                }
            }
            TagEnd::Image => {
                if let Some(Nested::Picture(name, alternative)) = self.nested.pop() {
                    self.picture(&name, &alternative);
                }
            }
            TagEnd::Table => {
                if let Some(Nested::Table(table)) = self.nested.pop() {
                    self.put(&table.markup());
                }
            }
            TagEnd::TableHead => self.in_table(|t| t.in_head = false),
            TagEnd::TableCell => {
                let marked = match self.nested.last() {
                    Some(Nested::Table(t)) => self.marked(&t.text),
                    _ => None,
                };
                self.in_table(|t| {
                    t.texts.push(std::mem::take(&mut t.text));
                    let cell = marked.unwrap_or_else(|| std::mem::take(&mut t.cell));
                    if t.in_head { &mut t.head } else { &mut t.cells }.push(cell);
                });
            }
            TagEnd::Paragraph => self.put("\n\n"),
            _ => {}
        }
    }

    fn text(&mut self, text: &CowStr<'_>) {
        match self.nested.last_mut() {
            Some(Nested::Strong(held) | Nested::Picture(_, held)) => held.push_str(text),
            Some(Nested::Table(table)) => {
                table.text.push_str(text);
                table.cell.push_str(&breakable(text));
            }
            None => self.out.push_str(&breakable(text)),
        }
    }

    fn put(&mut self, markup: &str) {
        match self.nested.last_mut() {
            Some(Nested::Table(table)) => table.cell.push_str(markup),
            Some(_) => {}
            None => self.out.push_str(markup),
        }
    }

    fn in_table(&mut self, change: impl FnOnce(&mut Table)) {
        if let Some(Nested::Table(table)) = self.nested.last_mut() {
            change(table);
        }
    }

    /// A word that is coloured, as markup.
    fn marked(&self, text: &str) -> Option<String> {
        // The text before a colon says of what the word is.
        let (before, word) = match text.trim().rsplit_once(": ") {
            Some((before, word)) => (format!("#strong[{}] ", plain(&format!("{before}:"))), word),
            None => (String::new(), text.trim()),
        };
        let (_, mark) = self.paper.marks.iter().find(|(marked, _)| marked == word)?;
        let colour = match mark {
            Mark::Good => "good",
            Mark::Bad => "bad",
            Mark::Open => "open",
        };
        Some(format!("{before}#{colour}[{}]", plain(word)))
    }

    fn picture(&mut self, name: &str, alternative: &str) {
        let markup = if self.paper.drawings.contains_key(name) {
            format!("\n#drawing({}, {})\n", string(name), string(alternative))
        } else {
            format!("#emph[{}]", plain(alternative))
        };
        self.put(&markup);
    }
}

/// The beginning of a link; one to a file beside the page is its words.
fn link(address: &str) -> String {
    if address.starts_with("https://") || address.starts_with("http://") {
        format!("#link({})[", string(address))
    } else {
        "#[".to_owned()
    }
}

/// A text in which long words, such as paths and hashes, can be broken.
fn breakable(text: &str) -> String {
    let words: Vec<String> = text
        .split(' ')
        .map(|word| {
            if word.chars().count() <= LONGEST_WORD {
                return plain(word);
            }
            let signs: Vec<char> = word.chars().collect();
            let parts: Vec<String> =
                signs.chunks(16).map(|part| plain(&part.iter().collect::<String>())).collect();
            parts.join("#sym.zws;")
        })
        .collect();
    words.join(" ")
}

impl Table {
    fn markup(self) -> String {
        let aligned: Vec<&str> = self
            .alignments
            .iter()
            .map(|a| match a {
                Alignment::Right => "right",
                Alignment::Center => "center",
                _ => "left",
            })
            .collect();
        let cells = |cells: &[String]| cells.iter().map(|c| format!("[{}], ", c.trim())).collect::<String>();
        // A head without words is none.
        let head = if self.head.iter().all(|h| h.trim().is_empty()) {
            String::new()
        } else {
            format!("table.header({}), ", cells(&self.head))
        };
        let widths: Vec<String> = self.widths();
        let (widths, aligned) = (widths.join(", "), aligned.join(", "));
        format!("\n#grid-of(({widths},), ({aligned},), {head}{})\n", cells(&self.cells))
    }

    /// The widths of the columns: as wide as they need to be where there is room for that, else shares of the page.
    fn widths(&self) -> Vec<String> {
        let columns = self.alignments.len();
        let of = |i: usize| self.texts.iter().skip(i).step_by(columns).map(|t| t.chars().count());
        let longest: Vec<usize> = (0..columns).map(|i| of(i).max().unwrap_or(0)).collect();
        if longest.iter().sum::<usize>() <= PAGE_WIDTH {
            let width = |i: usize| if self.is_to_be_filled(i) { "1fr" } else { "auto" };
            return (0..columns).map(|i| width(i).to_owned()).collect();
        }
        // Short columns keep their width; the others share what is left by what a usual cell needs, and no word is too wide.
        let share = |(i, longest): (usize, &usize)| {
            if *longest <= SHORT_COLUMN_CHARS {
                return "auto".to_owned();
            }
            let words = self.texts.iter().skip(i).step_by(columns).flat_map(|t| t.split(' '));
            let word = words.map(|w| w.chars().count().min(LONGEST_WORD / 2)).max().unwrap_or(1);
            let mean = of(i).sum::<usize>() as f64 / of(i).count().max(1) as f64;
            format!("{:.1}fr", (mean * *longest as f64).sqrt().max(word as f64) + 2.0)
        };
        longest.iter().enumerate().map(share).collect()
    }

    /// True for a column that has a head and nothing else: somebody will write in it.
    fn is_to_be_filled(&self, column: usize) -> bool {
        let headed = self.head.get(column).is_some_and(|h| !h.trim().is_empty());
        headed && self.cells.iter().skip(column).step_by(self.alignments.len()).all(|c| c.trim().is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Moment;
    use std::collections::BTreeMap;

    fn of(markdown: &str, pages: Pages) -> String {
        let paper = Paper {
            language: "en",
            subject: "",
            foot: "",
            page_number: "{n}",
            made_at: Moment { year: 2026, month: 1, day: 1, time: [0; 3] },
            markdown,
            drawings: &BTreeMap::new(),
            attachments: &[],
            marks: &[("PASS".to_owned(), Mark::Good)],
            pages,
        };
        body(&paper)
    }

    #[test]
    fn the_title_is_the_first_heading() {
        assert_eq!(title("# A *b* \\_c `d`\n\ntext\n"), "A b _c d");
        assert_eq!(title("text\n\n# later\n"), "text");
        assert_eq!(title(""), "Sagnac");
    }

    #[test]
    fn every_sign_of_a_text_stands_for_itself() {
        assert_eq!(plain("a_b #x $5 \\u{1}"), r"a\_b \#x \$5 \\u\{1\}");
        assert_eq!(string("a\"b\\"), r#""a\"b\\""#);
    }

    #[test]
    fn a_table_keeps_its_head_its_alignment_and_its_marks() {
        let made = of("| a | b |\n|---|--:|\n| 1 | PASS |\n", Pages::All);
        assert!(
            made.contains(
                "#grid-of((auto, auto,), (left, right,), table.header([a], [b], ), [1], [#good[PASS]], )"
            ),
            "{made}"
        );
        let made = of("| | |\n|---|---|\n| 1 | 2 |\n", Pages::All);
        assert!(!made.contains("header"), "{made}");
    }

    #[test]
    fn the_summary_ends_where_the_text_says_so() {
        let text = "# One\n\n**It: PASS**\n\n<!-- page -->\n\n- two\n";
        let made = of(text, Pages::All);
        assert!(
            made.contains("#good[PASS]") && made.contains("#pagebreak") && made.contains("#list([two],)"),
            "{made}"
        );
        let made = of(text, Pages::Summary);
        assert!(made.contains("One") && !made.contains("two") && !made.contains("pagebreak"), "{made}");
    }

    #[test]
    fn a_picture_that_is_not_there_is_its_words() {
        assert!(of("![σ(τ)](figures/a.svg)", Pages::All).contains(r"#emph[σ\(τ\)]"));
    }
}
