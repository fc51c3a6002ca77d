//! Blocks as paragraphs, tables and pictures.

use super::super::xml::{Xml, empty, node};
use super::line::{Line, bold, formula, lines, paragraph, plain, sentence, state};
use super::{picture, sign_off, table};
use crate::figure::Figure;
use crate::record::RunRecord;
use crate::report::page::{Block, Figure as FigureView, Head, Heading, Method, Reasons, Steps, Value};
use crate::report::signatures::{SignatureView, WaivedView};
use crate::report::svg::Drawing;
use crate::report::translator::Translator;
use std::io;

/// What blocks are shown with.
pub(super) struct Shown<'a> {
    /// The language.
    pub words: Translator,
    /// The run that the page is of, where it is one.
    pub run: Option<&'a RunRecord>,
    /// The signatures that there are.
    pub signatures: Vec<SignatureView>,
    /// The rows that they let pass.
    pub waived: Vec<WaivedView>,
    /// The figures with their drawings, in the order of the document.
    pub figures: Vec<(&'a Figure, Drawing)>,
}

impl Shown<'_> {
    /// Writes blocks in their order.
    pub(super) fn blocks(&self, xml: &mut Xml, blocks: &[Block]) -> io::Result<()> {
        blocks.iter().try_for_each(|b| self.block(xml, b))
    }

    fn block(&self, xml: &mut Xml, block: &Block) -> io::Result<()> {
        match block {
            Block::Head(of) => self.head(xml, of),
            Block::Reasons(of) => reasons(xml, of),
            Block::Lead(lead) => lead.sentences.iter().try_for_each(|s| paragraph(xml, "Lead", &sentence(s))),
            Block::Heading(of) => heading(xml, of),
            Block::Paragraph(text) => paragraph(xml, "Text", &sentence(text)),
            Block::Hint(text) => paragraph(xml, "Hint", &sentence(text)),
            Block::Facts(facts) => table::facts(xml, facts),
            Block::Steps(of) => steps(xml, of),
            Block::List(list) => list.items.iter().try_for_each(|(text, _)| item(xml, text)),
            Block::Footnotes(of) => of.notes.iter().try_for_each(|(number, text)| {
                paragraph(xml, "Hint", &[plain(&format!("{number}. ")), sentence(text)].concat())
            }),
            Block::Link(link) if link.words.is_empty() => Ok(()),
            Block::Link(link) => paragraph(xml, "Hint", &plain(&link.words)),
            Block::Method(of) => method(xml, of),
            Block::SignOff => self.blocks(xml, &sign_off::sign_off(self.run, &self.signatures, self.words)),
            Block::Table(of) => table::table(xml, of),
            Block::Figure(of) => self.figure(xml, of),
            Block::Section(_, below) => self.blocks(xml, below),
            Block::Fold(of, below) => {
                heading(xml, of)?;
                self.blocks(xml, below)
            }
            Block::PageEnd => page_end(xml),
            Block::SummaryEnd => Ok(()),
        }
    }

    fn head(&self, xml: &mut Xml, head: &Head) -> io::Result<()> {
        let size = if head.size.is_empty() { String::new() } else { format!(" · {}", head.size) };
        paragraph(xml, "Kind", &plain(&format!("{}{size}", head.kind)))?;
        paragraph(xml, "Title", &plain(&head.title))?;
        if head.has_verdict() {
            let label = plain(&format!("{}: ", head.label));
            paragraph(xml, "Verdict", &[label, state(&head.verdict)].concat())?;
        }
        if head.is_signed && !self.waived.is_empty() {
            let rows: Vec<&str> = self.waived.iter().map(|w| w.row.as_str()).collect();
            let said = self.words.with("signer.waived_rows", &[("rows", &rows.join("; "))]);
            paragraph(xml, "Text", &plain(&said))?;
            for w in &self.waived {
                let args = [("name", w.by.as_str()), ("row", &w.row), ("reason", &w.reason)];
                item(xml, &self.words.with("signer.waives", &args))?;
            }
        }
        if head.counts.is_empty() {
            return Ok(());
        }
        let mut line: Line = vec![];
        for (of, n) in &head.counts {
            let between = if line.is_empty() { "" } else { " · " };
            line.extend([plain(between), state(of), plain(&format!(": {n}"))].concat());
        }
        paragraph(xml, "Text", &line)
    }

    fn figure(&self, xml: &mut Xml, view: &FigureView) -> io::Result<()> {
        if let Some((number, (_, drawing))) = (1..).zip(&self.figures).find(|(_, (f, _))| f.id == view.id) {
            picture::picture(xml, number, &view.title, drawing.size_mm)?;
        }
        let caption = match (view.is_titled, view.caption.is_empty()) {
            (true, false) => format!("{}. {}", view.title, view.caption),
            (true, true) => view.title.clone(),
            (false, _) => view.caption.clone(),
        };
        paragraph(xml, "Caption", &plain(&caption))
    }
}

fn heading(xml: &mut Xml, heading: &Heading) -> io::Result<()> {
    let mut line = lines(&heading.text, true).concat();
    if let Some(verdict) = &heading.verdict {
        line.extend([plain(": "), state(verdict)].concat());
    }
    paragraph(xml, if heading.level <= 2 { "Heading1" } else { "Heading2" }, &line)
}

fn reasons(xml: &mut Xml, of: &Reasons) -> io::Result<()> {
    paragraph(xml, "Heading1", &plain(&of.heading))?;
    of.sentences.iter().try_for_each(|s| item(xml, s))
}

fn item(xml: &mut Xml, text: &str) -> io::Result<()> {
    paragraph(xml, "Item", &[plain("• "), sentence(text)].concat())
}

fn steps(xml: &mut Xml, of: &Steps) -> io::Result<()> {
    for (step, number) in of.items.iter().zip(1..) {
        paragraph(xml, "Item", &plain(&format!("{number}. {}", step.text)))?;
        for (name, hash) in &step.hashes {
            let of_file = [Value::Code(name.clone()), Value::Digest(hash.clone())];
            let line = Value::Several { values: of_file.into(), between: " " };
            paragraph(xml, "Item", &lines(&line, true).concat())?;
        }
    }
    Ok(())
}

fn method(xml: &mut Xml, of: &Method) -> io::Result<()> {
    if !of.title.is_empty() {
        paragraph(xml, "Heading2", &bold(&of.title))?;
    }
    of.formulas.iter().try_for_each(|f| paragraph(xml, "Formula", &formula(f)))?;
    let source = if of.source.is_empty() { vec![] } else { plain(&format!(" [{}]", of.source)) };
    paragraph(xml, "Text", &[formula(&of.text), source].concat())
}

fn page_end(xml: &mut Xml) -> io::Result<()> {
    node(xml, "w:p", &[], |xml| node(xml, "w:r", &[], |xml| empty(xml, "w:br", &[("w:type", "page")])))
}
