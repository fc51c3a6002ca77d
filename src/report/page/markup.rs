//! Blocks as the templates of a markup language see them: every value printed and escaped, ready to be laid out.

use super::block::{Block, Figure, Head, Heading, Page};
use super::table::{Column, Layout, Listed, Table};
use super::value::{Joined, State, Value};
use minijinja::context;
use minijinja::value::{Serde, Value as Seen};

/// A markup language: how it writes values, so that nothing in them is markup.
pub trait Markup {
    /// A text in which nothing is markup.
    fn text(&self, text: &str) -> String;
    /// A sentence, in which names between backticks are code.
    fn sentence(&self, text: &str) -> String;
    /// A name as files have it.
    fn code(&self, name: &str) -> String;
    /// A formula, in which letters behind an underscore stand below the line.
    fn formula(&self, text: &str) -> String;
    /// A digest of a file.
    fn digest(&self, digest: &str) -> String;
    /// A text, and the id that files have for it.
    fn named(&self, text: &str, id: &str) -> String;
    /// A text that leads to another page.
    fn link(&self, text: &str, to: &str) -> String;
    /// A verdict or a state.
    fn state(&self, state: &State) -> String;
    /// A printed value that stands out.
    fn strong(&self, printed: &str) -> String;
    /// A printed value with its printed details.
    fn detailed(&self, value: String, details: &[(Joined, String)]) -> String;
    /// The number of a footnote behind the value that it is of.
    fn footnote(&self, anchor: &str, number: usize, is_last: bool) -> String;
    /// Sentences in a cell.
    fn list(&self, items: &[String], ordered: bool) -> String;
    /// How it lays a table out.
    fn layout(&self, table: &Table) -> Layout;

    /// A value; a quantity with its unit where the unit has no place of its own.
    fn value(&self, value: &Value, with_unit: bool) -> String {
        match value {
            Value::Empty => String::new(),
            Value::Text(text) => self.text(text),
            Value::Sentence(text) => self.sentence(text),
            Value::Code(name) => self.code(name),
            Value::Formula(text) => self.formula(text),
            Value::Digest(digest) => self.digest(digest),
            Value::Named { text, id } => self.named(text, id),
            Value::Link { text, to } => self.link(text, to),
            Value::State(state) => self.state(state),
            Value::Quantity(quantity) if with_unit => self.text(&quantity.whole()),
            Value::Quantity(quantity) => self.text(&quantity.printed),
            Value::Detailed(detailed) => {
                let value = self.value(&detailed.value, with_unit);
                let value = if detailed.is_strong && !value.is_empty() { self.strong(&value) } else { value };
                let details: Vec<(Joined, String)> =
                    detailed.details.iter().map(|d| (d.joined, self.value(&d.value, true))).collect();
                self.detailed(value, &details)
            }
            Value::Noted { value, anchor, notes } => {
                let number = |(i, n): (usize, &usize)| self.footnote(anchor, *n, i + 1 == notes.len());
                notes.iter().enumerate().map(number).fold(self.value(value, with_unit), |out, n| out + &n)
            }
            Value::Wide(value) => self.value(value, with_unit),
            Value::Several { values, between } => {
                let each: Vec<String> = values.iter().map(|v| self.value(v, with_unit)).collect();
                each.join(&self.text(between))
            }
            Value::List { items, ordered } => self.list(items, *ordered),
        }
    }
}

/// A page as its templates see it, as `v`.
pub fn page(page: &Page, markup: &dyn Markup) -> Seen {
    context! {
        title => &page.title,
        generator => &page.generator,
        footer => &page.footer,
        blocks => blocks(&page.blocks, markup),
    }
}

fn blocks(blocks: &[Block], markup: &dyn Markup) -> Vec<Seen> {
    blocks.iter().map(|b| block(b, markup)).collect()
}

/// A text that is escaped already.
fn escaped(text: String) -> Seen {
    Seen::from_safe_string(text)
}

fn sentences(all: &[String], markup: &dyn Markup) -> Vec<Seen> {
    all.iter().map(|s| escaped(markup.sentence(s))).collect()
}

fn block(block: &Block, markup: &dyn Markup) -> Seen {
    let value = |v: &Value| escaped(markup.value(v, true));
    match block {
        Block::Head(of) => head(of),
        Block::Reasons(of) => context! {
            kind => "reasons", class => of.class, id => &of.id, mark => &of.mark, heading => &of.heading,
            sentences => sentences(&of.sentences, markup),
        },
        Block::Lead(lead) => context! {
            kind => "lead", id => &lead.id, sentences => sentences(&lead.sentences, markup),
        },
        Block::Heading(of) => heading(of, markup),
        Block::Paragraph(text) => context! { kind => "paragraph", text => escaped(markup.sentence(text)) },
        Block::Hint(text) => context! { kind => "hint", text => escaped(markup.sentence(text)) },
        Block::Facts(facts) => {
            let row = |(label, v): &(Value, Value)| context! { label => value(label), value => value(v) };
            let rows: Vec<Seen> = facts.rows.iter().map(row).collect();
            context! { kind => "facts", class => facts.class, rows }
        }
        Block::Steps(steps) => {
            let item = |step: &super::block::Step| {
                let hash = |(name, hash): &(String, String)| {
                    context! { name => escaped(markup.code(name)), hash => escaped(markup.digest(hash)) }
                };
                let hashes: Vec<Seen> = step.hashes.iter().map(hash).collect();
                context! { text => escaped(markup.text(&step.text)), hashes }
            };
            let items: Vec<Seen> = steps.items.iter().map(item).collect();
            context! { kind => "steps", class => steps.class, items }
        }
        Block::List(list) => {
            let item = |(text, is_failure): &(String, bool)| {
                context! { text => escaped(markup.sentence(text)), is_failure => *is_failure }
            };
            let items: Vec<Seen> = list.items.iter().map(item).collect();
            context! { kind => "list", class => list.class, items }
        }
        Block::Footnotes(of) => {
            let note = |(number, sentence): &(usize, String)| {
                context! { number => *number, text => escaped(markup.sentence(sentence)) }
            };
            let notes: Vec<Seen> = of.notes.iter().map(note).collect();
            context! { kind => "footnotes", anchor => &of.anchor, notes }
        }
        Block::Link(link) => context! {
            kind => "link", words => &link.words, text => &link.text, to => &link.to,
        },
        Block::Method(of) => context! {
            kind => "method", title => &of.title, formulas => &of.formulas, text => &of.text, source => &of.source,
        },
        Block::SignOff => context! { kind => "signoff" },
        Block::Table(of) => table(of, markup),
        Block::Figure(of) => figure(of),
        Block::Section(class, below) => {
            context! { kind => "section", class => *class, blocks => blocks(below, markup) }
        }
        Block::Fold(of, below) => {
            context! { kind => "fold", heading => heading(of, markup), blocks => blocks(below, markup) }
        }
        Block::PageEnd => context! { kind => "page_end" },
        Block::SummaryEnd => context! { kind => "summary_end" },
    }
}

fn state(state: &State) -> Seen {
    context! { id => &state.id, word => &state.word }
}

fn heading(heading: &Heading, markup: &dyn Markup) -> Seen {
    context! {
        kind => "heading", level => heading.level, text => escaped(markup.value(&heading.text, true)),
        verdict => heading.verdict.as_ref().map(state),
    }
}

fn head(head: &Head) -> Seen {
    let count = |(of, n): &(State, usize)| context! { id => &of.id, word => &of.word, n => *n };
    let counts: Vec<Seen> = head.counts.iter().map(count).collect();
    context! {
        kind => "head", is_signed => head.is_signed, document => &head.kind, title => &head.title, size => &head.size,
        label => &head.label, verdict => head.has_verdict().then(|| state(&head.verdict)), counts,
    }
}

fn figure(figure: &Figure) -> Seen {
    context! { kind => "figure", figure => Seen::from(Serde(figure)) }
}

/// A table: heads and rows, each cell with what its column says of it.
fn table(table: &Table, markup: &dyn Markup) -> Seen {
    let is_list = markup.layout(table) == Layout::List;
    let shown = if is_list { table.with(|c| !c.is_unit) } else { table.clone() };
    let with_unit = !shown.units_in_names && !shown.columns.iter().any(|c| c.is_unit);
    let row = |row: &super::table::Row| {
        let cells = shown.columns.iter().zip(&row.cells);
        // A cell behind a wide one has no room.
        let covered = std::iter::once(false).chain(row.cells.iter().map(|v| matches!(v, Value::Wide(_))));
        let cell = |((column, value), is_covered): ((&Column, &Value), bool)| {
            context! {
                text => escaped(markup.value(value, with_unit)),
                is_empty => markup.value(value, with_unit).is_empty(),
                is_list => matches!(value, Value::List { .. }),
                is_state => matches!(value, Value::State(_)),
                is_wide => matches!(value, Value::Wide(_)),
                is_covered,
                listed => listed(&column.listed),
                words => match &column.listed { Listed::Below(words) => words.as_str(), _ => "" },
                ..column_seen(column)
            }
        };
        context! {
            chosen => row.chosen, is_heading => row.is_heading, id => &row.id, channel => &row.channel,
            cells => cells.zip(covered).map(cell).collect::<Vec<Seen>>(),
        }
    };
    context! {
        kind => "table", class => table.class, is_list,
        columns => shown.columns.iter().map(column_seen).collect::<Vec<Seen>>(),
        rows => shown.rows.iter().map(row).collect::<Vec<Seen>>(),
    }
}

fn listed(listed: &Listed) -> &'static str {
    match listed {
        Listed::Beside => "beside",
        Listed::Bracketed => "bracketed",
        Listed::Below(_) => "below",
    }
}

fn column_seen(column: &Column) -> Seen {
    let is_number = column.align == super::table::Align::Right;
    context! { head => &column.head, class => column.class, is_number }
}
