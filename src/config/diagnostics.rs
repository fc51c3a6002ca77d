//! Problems of a file: place, reason and advice, all of a file together.
//!
//! A [`Problem`] carries the line it is about, so that it can be shown without the file. The rendering is plain text:
//! no colours, columns counted in characters, so that it lines up for text in any alphabet.

use crate::i18n::{Lang, Localize, Note, note, steers, visible};
use std::fmt;
use std::ops::Range;

/// Byte range in a file.
pub type Span = Range<usize>;

/// Longest piece of a line that is shown, in characters.
const MAX_SHOWN_CHARACTERS: usize = 120;

/// Most problems that are written out; more are counted.
const MAX_SHOWN: usize = 100;

/// How serious a problem is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; the file can be used.
    Warning,
    /// The file cannot be used.
    Error,
}

/// One problem of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// How serious it is.
    pub severity: Severity,
    /// File, as the user named it.
    pub file: String,
    /// Byte range of the offending text.
    pub span: Span,
    /// Line, counted from 1; 0 when the problem is of the file as a whole.
    pub line: usize,
    /// Column in characters, counted from 1; 0 when the problem is of the file as a whole.
    pub column: usize,
    /// The problem.
    pub message: Note,
    /// What to do.
    pub help: Option<Note>,
    /// The offending text, up to the end of its first line.
    pub token: String,
    excerpt: Excerpt,
}

/// The part of a line that is shown, and where in it the offending text stands.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Excerpt {
    text: String,
    start: usize,
    width: usize,
}

impl Problem {
    /// A problem of a file that is not about one place in it (it cannot be opened, for example).
    pub fn of_file(file: &str, message: impl Into<Note>, help: Option<Note>) -> Problem {
        Problem {
            severity: Severity::Error,
            file: file.to_owned(),
            span: 0..0,
            line: 0,
            column: 0,
            message: message.into(),
            help,
            token: String::new(),
            excerpt: Excerpt::default(),
        }
    }

    /// Something worth knowing of a file as a whole.
    pub fn remark_on_file(file: &str, message: impl Into<Note>) -> Problem {
        Problem { severity: Severity::Warning, ..Problem::of_file(file, message, None) }
    }

    /// The same problem with what to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<Note>) -> Problem {
        self.help = Some(help.into());
        self
    }

    /// In a language: `severity: message`, the place, the line as it stands in the file with the text underlined, and
    /// what to do.
    pub fn say(&self, lang: Lang) -> String {
        let key = match self.severity {
            Severity::Error => "diagnostic.error",
            Severity::Warning => "diagnostic.warning",
        };
        let mut out = format!("{}: {}\n", Note::new(key).say(lang), visible(&self.message.say(lang)));
        if self.line == 0 {
            out.push_str(&format!(" --> {}\n", visible(&self.file)));
        } else {
            let number = self.line.to_string();
            let margin = " ".repeat(number.len());
            let (indent, carets) = (" ".repeat(self.excerpt.start), "^".repeat(self.excerpt.width));
            out.push_str(&format!("{margin}--> {}:{}:{}\n", visible(&self.file), self.line, self.column));
            out.push_str(&format!("{margin} |\n{number} | {}\n", self.excerpt.text.trim_end()));
            out.push_str(&format!("{margin} | {indent}{carets}\n"));
        }
        if let Some(help) = &self.help {
            let help = help.say(lang);
            out.push_str(&format!("  {}: {}\n", note!("diagnostic.help").say(lang), visible(&help)));
        }
        out
    }
}

impl fmt::Display for Problem {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.say(Lang::En))
    }
}

/// All problems of one or more files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Problems {
    /// The problems, in the order of the text.
    pub list: Vec<Problem>,
}

impl Problems {
    /// True when one of them forbids the use of the file.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|p| p.severity == Severity::Error)
    }

    /// All of them in a language, an empty line between two.
    pub fn say(&self, lang: Lang) -> String {
        let shown: Vec<String> = self.list.iter().take(MAX_SHOWN).map(|p| p.say(lang)).collect();
        let mut out = shown.join("\n");
        if let Some(rest) = self.list.len().checked_sub(MAX_SHOWN).filter(|n| *n > 0) {
            out.push_str(&format!("\n{}\n", note!("diagnostic.more", n = rest).say(lang)));
        }
        out
    }

    /// Puts the problems in the order of the text and drops repeated ones.
    pub(crate) fn sort(&mut self) {
        self.list.sort_by_key(|p| (p.span.start, p.span.end));
        self.list.dedup();
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Problems { list: vec![problem] }
    }
}

impl fmt::Display for Problems {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.say(Lang::En))
    }
}

impl std::error::Error for Problems {}

/// A text file with its name, able to say where a byte stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceText {
    /// Name as the user gave it.
    pub name: String,
    /// The text.
    pub text: String,
    line_starts: Vec<usize>,
}

impl SourceText {
    /// Takes a text and notes where its lines begin.
    pub fn new(name: &str, text: String) -> SourceText {
        let line_starts = std::iter::once(0)
            .chain(text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1));
        let line_starts = line_starts.collect();
        SourceText { name: name.to_owned(), text, line_starts }
    }

    /// An error at a byte range.
    pub fn error(&self, span: &Span, message: impl Into<Note>) -> Problem {
        self.problem(Severity::Error, span, message.into())
    }

    /// A warning at a byte range.
    pub fn warning(&self, span: &Span, message: impl Into<Note>) -> Problem {
        self.problem(Severity::Warning, span, message.into())
    }

    /// The place of a text between its quotes; the place as given where there are none, or three.
    pub(crate) fn inside_quotes(&self, span: &Span) -> Span {
        let raw = self.text.get(span.clone()).unwrap_or("");
        let within = |quote: char| raw.len() >= 2 && raw.starts_with(quote) && raw.ends_with(quote);
        let quoted = within('"') && !raw.starts_with("\"\"\"") || within('\'');
        if quoted { span.start + 1..span.end - 1 } else { span.clone() }
    }

    fn problem(&self, severity: Severity, span: &Span, message: Note) -> Problem {
        let start = self.floor(span.start);
        let end = self.floor(span.end.max(start));
        let line = self.line_starts.partition_point(|s| *s <= start).max(1);
        let line_start = self.line_starts.get(line - 1).copied().unwrap_or(0);
        let line_end = self.line_starts.get(line).map_or(self.text.len(), |next| next - 1);
        let before = self.text.get(line_start..start).unwrap_or("").chars().count();
        let token = self.text.get(start..end.min(line_end.max(start))).unwrap_or("").trim_end();
        let shown = self.text.get(line_start..line_end).unwrap_or("");
        Problem {
            severity,
            file: self.name.clone(),
            span: start..end,
            line,
            column: before + 1,
            message,
            help: None,
            token: token.to_owned(),
            excerpt: excerpt(shown, before, token.chars().count()),
        }
    }

    /// The nearest character boundary at or before a byte.
    fn floor(&self, at: usize) -> usize {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}

/// Cuts a long line around the offending text. Control characters are shown as `·`, so that a file cannot steer a
/// terminal and one character stays one column.
fn excerpt(line: &str, start: usize, width: usize) -> Excerpt {
    let from = if start > MAX_SHOWN_CHARACTERS / 2 && line.chars().count() > MAX_SHOWN_CHARACTERS {
        start - MAX_SHOWN_CHARACTERS / 2
    } else {
        0
    };
    let visible = |c: char| match c {
        '\t' => ' ',
        '\r' => ' ',
        c if steers(c) => '·',
        c => c,
    };
    let text: String = line.chars().skip(from).take(MAX_SHOWN_CHARACTERS).map(visible).collect();
    let start = start - from;
    Excerpt { text, start, width: width.clamp(1, MAX_SHOWN_CHARACTERS.saturating_sub(start).max(1)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caret_stands_under_the_text_in_any_alphabet() {
        let source = SourceText::new("a.toml", "x = 1\ntitle = \"Дрейф\" # Ω\nlast".to_owned());
        let at = source.text.find("# Ω").unwrap();
        let p = source.error(&(at..at + 4), "bad").help("do better");
        assert_eq!((p.line, p.column, p.token.as_str()), (2, 17, "# Ω"));
        let shown = p.to_string();
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(lines[0], "error: bad");
        assert_eq!(lines[1], " --> a.toml:2:17");
        assert_eq!(lines[3], "2 | title = \"Дрейф\" # Ω");
        assert_eq!(lines[4], "  |                 ^^^");
        assert_eq!(lines[5], "  help: do better");
    }

    #[test]
    fn long_and_hostile_lines_are_shown_safely() {
        let text = format!("{}\u{1b}[31mX{}", "ж".repeat(500), "y".repeat(500));
        let source = SourceText::new("a", text);
        let at = source.text.find('X').unwrap();
        let p = source.error(&(at..at + 1), "m");
        let shown = p.to_string();
        assert!(!shown.contains('\u{1b}'));
        let line = shown.lines().nth(3).unwrap();
        let caret = shown.lines().nth(4).unwrap().chars().position(|c| c == '^').unwrap();
        assert_eq!(line.chars().nth(caret), Some('X'));
        assert!(line.chars().count() < 140);
    }

    #[test]
    fn places_outside_the_text_do_no_harm() {
        let source = SourceText::new("a", "é".to_owned());
        for (start, end) in [(0, 0), (1, 1), (1, 9), (7, 9), (5, 2)] {
            let p = source.error(&Span { start, end }, "m");
            assert_eq!(p.line, 1);
            assert!(!p.to_string().is_empty());
        }
        assert_eq!(SourceText::new("a", String::new()).error(&(0..0), "m").column, 1);
    }
}
