//! The blocks that pages are made of.

use super::table::Table;
use super::value::{State, Value};
use serde::Serialize;

/// A page: its blocks in their order, and what its frame shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Title of its window.
    pub title: String,
    /// The program with its version.
    pub generator: String,
    /// Line at the foot of every printed page.
    pub footer: String,
    /// What it shows.
    pub blocks: Vec<Block>,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// What the page is of, and the verdict.
    Head(Head),
    /// Sentences that say why a verdict is what it is, in its colour.
    Reasons(Reasons),
    /// The verdict in sentences, in its colour.
    Lead(Lead),
    /// A heading.
    Heading(Heading),
    /// A sentence.
    Paragraph(String),
    /// A sentence that tells how to read what stands beside it.
    Hint(String),
    /// Labels and their values.
    Facts(Facts),
    /// Steps, in their order.
    Steps(Steps),
    /// Sentences without an order, an item each.
    List(List),
    /// Footnotes.
    Footnotes(Footnotes),
    /// A way to another page.
    Link(Link),
    /// A method with its formulas.
    Method(Method),
    /// Lines to be signed, and the signatures that there are.
    SignOff,
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Box<Figure>),
    /// Blocks that belong together, with a class in HTML.
    Section(&'static str, Vec<Block>),
    /// Blocks under a heading that a reader opens in HTML.
    Fold(Heading, Vec<Block>),
    /// The end of a page on paper.
    PageEnd,
    /// The end of the summary: what follows it is left out where only the summary is printed.
    SummaryEnd,
}

/// What a page is of, and the verdict.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Head {
    /// Kind of the document.
    pub kind: String,
    /// What it is of.
    pub title: String,
    /// Of how many; empty where it is of one.
    pub size: String,
    /// True where signatures may waive rows of the verdict: they are shown with it.
    pub is_signed: bool,
    /// What the verdict is, such as “Outcome”.
    pub label: String,
    /// The verdict; empty where the page has none.
    pub verdict: State,
    /// How many have which verdict.
    pub counts: Vec<(State, usize)>,
}

/// The verdict in sentences.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Lead {
    /// Id of the verdict, for its colour.
    pub id: String,
    /// The sentences.
    pub sentences: Vec<String>,
}

/// Sentences that say why a verdict is what it is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reasons {
    /// Classes in HTML.
    pub class: &'static str,
    /// Id of the verdict, for its colour.
    pub id: String,
    /// Mark that others refer to; empty without one.
    pub mark: String,
    /// Heading.
    pub heading: String,
    /// The sentences.
    pub sentences: Vec<String>,
}

/// A heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heading {
    /// 2 for a section, 3 for a part of one.
    pub level: u8,
    /// Text.
    pub text: Value,
    /// The verdict on what it is of.
    pub verdict: Option<State>,
}

/// Labels and their values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Facts {
    /// Class in HTML.
    pub class: &'static str,
    /// Label and value.
    pub rows: Vec<(Value, Value)>,
}

/// Steps, in their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Steps {
    /// Class in HTML.
    pub class: &'static str,
    /// The steps.
    pub items: Vec<Step>,
}

/// A step.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Step {
    /// What is done.
    pub text: String,
    /// Hashes of what it gave: name and SHA-256.
    pub hashes: Vec<(String, String)>,
}

/// Sentences without an order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct List {
    /// Class in HTML.
    pub class: &'static str,
    /// The sentences, and whether each is a failure.
    pub items: Vec<(String, bool)>,
}

/// Footnotes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Footnotes {
    /// Beginning of their marks: it differs between the parts of a page that count from 1 each.
    pub anchor: String,
    /// Number and sentence.
    pub notes: Vec<(usize, String)>,
}

/// A way to another page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Link {
    /// Words before it; empty without any.
    pub words: String,
    /// Text.
    pub text: String,
    /// Address relative to the page, without the ending of the file; empty where there is no page.
    pub to: String,
}

/// A method with its formulas.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Method {
    /// Title.
    pub title: String,
    /// Formulas, in which letters behind an underscore stand below the line.
    pub formulas: Vec<String>,
    /// Explanation.
    pub text: String,
    /// Source; empty without one.
    pub source: String,
}

/// A figure with its drawing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Id.
    pub id: String,
    /// Number, counted from 1.
    pub number: usize,
    /// Mark that others refer to; empty without one.
    pub mark: String,
    /// Title.
    pub title: String,
    /// What is to be seen, in a sentence; empty where nothing is said.
    pub caption: String,
    /// True where HTML has the title before the caption.
    pub is_titled: bool,
    /// The drawing.
    pub svg: String,
    /// What a pointer reads off it, as JSON for the script of the page; empty where nothing can be read off.
    pub readings: String,
    /// File, relative to the page, as a URL.
    pub href: String,
}

impl Block {
    /// The heading of a section.
    pub fn heading(text: impl Into<Value>) -> Block {
        Block::Heading(Heading { level: 2, text: text.into(), verdict: None })
    }

    /// The heading of a part of a section.
    pub fn subheading(text: impl Into<Value>) -> Block {
        Block::Heading(Heading { level: 3, text: text.into(), verdict: None })
    }

    /// A section: its heading, and what stands below it.
    pub fn section(class: &'static str, heading: impl Into<Value>, below: Vec<Block>) -> Block {
        Block::Section(class, std::iter::once(Block::heading(heading)).chain(below).collect())
    }

    /// Sentences as a list of remarks; `None` without any.
    pub fn remarks(sentences: impl IntoIterator<Item = String>) -> Option<Block> {
        let items: Vec<_> = sentences.into_iter().map(|s| (s, false)).collect();
        (!items.is_empty()).then_some(Block::List(List { class: "remarks", items }))
    }

    /// Facts in two columns; those without a value are left out.
    pub fn identity(rows: impl IntoIterator<Item = (String, String)>) -> Block {
        let rows = rows.into_iter().filter(|(_, value)| !value.trim().is_empty());
        Block::Facts(Facts { class: "", rows: rows.map(|(l, v)| (l.into(), v.into())).collect() })
    }

    /// The files of a folder: name, and what each is.
    pub fn files(rows: impl IntoIterator<Item = (String, String)>) -> Block {
        let rows = rows.into_iter().map(|(name, what)| (Value::Code(name), Value::Sentence(what))).collect();
        Block::Facts(Facts { class: "about", rows })
    }
}

impl Head {
    /// True where the page has a verdict.
    pub fn has_verdict(&self) -> bool {
        !self.verdict.word.is_empty()
    }
}
