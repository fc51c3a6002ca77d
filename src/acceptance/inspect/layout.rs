//! Plain text in aligned columns, at most 80 characters wide where words allow it.

use crate::i18n::{Arg, Lang, Localize, Note, visible};

/// Width of a line, characters.
const LINE_WIDTH: usize = 80;
/// Width of the column of labels, characters, the space behind it included.
const LABEL_WIDTH: usize = 19;

/// A label that is left blank: the row belongs to the one above.
pub(super) const NO_LABEL: &str = "";

/// The words of a key.
pub(super) fn word(key: &'static str) -> Arg {
    Note::new(key).into()
}

/// A text in one language that grows section by section.
#[derive(Debug)]
pub(super) struct Page {
    out: String,
    lang: Lang,
}

impl Page {
    /// An empty text.
    pub fn new(lang: Lang) -> Page {
        Page { out: String::new(), lang }
    }

    /// The language of the text.
    pub fn lang(&self) -> Lang {
        self.lang
    }

    /// The title of the text.
    pub fn title(&mut self, text: &str) {
        self.out.push_str(&visible(text));
        self.out.push('\n');
    }

    /// The heading of a section.
    pub fn heading(&mut self, words: impl Into<Arg>) {
        self.out.push('\n');
        let words = words.into().say(self.lang);
        self.title(&words);
    }

    /// A label and what belongs to it, wrapped beside it.
    pub fn row(&mut self, label: impl Into<Arg>, text: impl Into<Arg>) {
        let (label, text) = (label.into().say(self.lang), text.into().say(self.lang));
        let mut line = format!("  {label}");
        pad(&mut line, LABEL_WIDTH);
        // A label that fills its column still stands apart from the text.
        if !line.ends_with(' ') {
            line.push(' ');
        }
        let mut empty = true;
        for piece in text.split_whitespace() {
            let length = line.chars().count();
            if !empty && length + 1 + piece.chars().count() > LINE_WIDTH {
                self.out.push_str(line.trim_end());
                self.out.push('\n');
                line.clear();
                pad(&mut line, LABEL_WIDTH);
                empty = true;
            }
            if !empty {
                line.push(' ');
            }
            line.push_str(piece);
            empty = false;
        }
        self.out.push_str(line.trim_end());
        self.out.push('\n');
    }

    /// A table; the first `left` columns are set to the left, the others to the right.
    pub fn table(&mut self, rows: &[Vec<String>], left: usize) {
        let rows: Vec<Vec<String>> =
            rows.iter().map(|r| r.iter().map(|c| visible(c).into_owned()).collect()).collect();
        let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns)
            .map(|c| rows.iter().filter_map(|r| r.get(c)).map(|t| t.chars().count()).max().unwrap_or(0))
            .collect();
        for row in &rows {
            let mut line = String::new();
            for (c, (text, width)) in row.iter().zip(&widths).enumerate() {
                line.push_str("  ");
                let room = width.saturating_sub(text.chars().count());
                if c >= left {
                    line.extend(std::iter::repeat_n(' ', room));
                }
                line.push_str(text);
                if c < left {
                    line.extend(std::iter::repeat_n(' ', room));
                }
            }
            self.out.push_str(line.trim_end());
            self.out.push('\n');
        }
    }

    /// The text.
    pub fn finish(self) -> String {
        self.out
    }
}

fn pad(line: &mut String, width: usize) {
    let length = line.chars().count();
    line.extend(std::iter::repeat_n(' ', width.saturating_sub(length)));
}
