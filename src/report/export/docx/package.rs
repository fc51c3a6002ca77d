//! The parts of a document, in one archive.

use super::super::xml::{Xml, empty, leaf, node, xml_document};
use super::blocks::Shown;
use super::line::{paragraph, plain, text};
use super::picture::{drawing, relation};
use super::table::WIDTH;
use crate::output::archive;
use crate::report::page::{Block, Page};
use crate::report::signatures::waived;
use crate::report::translator::Translator;
use crate::report::{Document, Renderer, ReportError};
use chrono::{DateTime, SecondsFormat};
use std::collections::{BTreeMap, BTreeSet};
use std::io;

/// How paragraphs, tables and code look.
const STYLES: &str = include_str!("styles.xml");

/// Namespaces of the parts.
const TYPES: &str = "http://schemas.openxmlformats.org/package/2006/content-types";
const RELATIONS: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
const PROPERTIES: &str = "http://schemas.openxmlformats.org/package/2006/metadata/core-properties";
const MAIN: &str = "http://schemas.openxmlformats.org/wordprocessingml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const DRAWING: &str = "http://schemas.openxmlformats.org/drawingml/2006/wordprocessingDrawing";
/// Type of a part of a word processor, before its name.
const WORD: &str = "application/vnd.openxmlformats-officedocument.wordprocessingml";
/// Type of the properties, in the package and as a relation.
const PROPERTIES_TYPE: &str = "application/vnd.openxmlformats-package.core-properties+xml";
const PROPERTIES_RELATION: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/metadata/core-properties";

/// Paper and margins, twentieths of a point: A4 upright with 18 mm on every side.
const PAPER: (&str, &str) = ("11906", "16838");
const MARGIN: &str = "1020";

/// The bytes of a document.
///
/// # Errors
/// What XML or the archive has no form for.
pub(super) fn package(document: &Document<'_>, renderer: &Renderer) -> Result<Vec<u8>, ReportError> {
    let words = Translator { lang: document.lang };
    let signatures = renderer.signatures();
    let page = document.shown();
    let used = ids(&page.blocks);
    let figures = document.figures.iter().filter(|f| used.contains(f.id.as_str()));
    let shown = Shown {
        words,
        run: document.run(),
        signatures: signatures.iter().map(|s| s.view(words.lang)).collect(),
        waived: waived(signatures, words.lang),
        figures: figures.map(|f| (f, drawing(f, words.lang))).collect(),
    };
    let mut parts: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut put = |name: &str, bytes: Vec<u8>| parts.insert(name.to_owned(), bytes);
    put("[Content_Types].xml", xml_document(content_types)?);
    put("_rels/.rels", xml_document(package_relations)?);
    put("docProps/core.xml", xml_document(|xml| properties(xml, page, document.made_at()))?);
    put("word/styles.xml", STYLES.as_bytes().to_vec());
    put("word/document.xml", xml_document(|xml| body(xml, &shown, page))?);
    put("word/header1.xml", xml_document(|xml| edge(xml, "w:hdr", |xml| header(xml, page)))?);
    put("word/footer1.xml", xml_document(|xml| edge(xml, "w:ftr", |xml| footer(xml, page, words)))?);
    let relations = xml_document(|xml| document_relations(xml, shown.figures.len()))?;
    put("word/_rels/document.xml.rels", relations);
    for (number, (_, drawing)) in (1..).zip(&shown.figures) {
        put(&format!("word/media/{}.svg", relation(number)), drawing.svg.as_bytes().to_vec());
    }
    archive(&parts).map_err(|e| ReportError::Xml(e.to_string()))
}

/// Ids of the figures that blocks show.
fn ids(blocks: &[Block]) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    for block in blocks {
        match block {
            Block::Figure(figure) => {
                found.insert(figure.id.as_str());
            }
            Block::Section(_, below) | Block::Fold(_, below) => found.extend(ids(below)),
            _ => {}
        }
    }
    found
}

fn content_types(xml: &mut Xml) -> io::Result<()> {
    let default = |xml: &mut Xml, ending: &str, kind: &str| {
        empty(xml, "Default", &[("Extension", ending), ("ContentType", kind)])
    };
    let part = |xml: &mut Xml, name: &str, kind: &str| {
        empty(xml, "Override", &[("PartName", name), ("ContentType", kind)])
    };
    node(xml, "Types", &[("xmlns", TYPES)], |xml| {
        default(xml, "rels", "application/vnd.openxmlformats-package.relationships+xml")?;
        default(xml, "xml", "application/xml")?;
        default(xml, "svg", "image/svg+xml")?;
        part(xml, "/docProps/core.xml", PROPERTIES_TYPE)?;
        part(xml, "/word/document.xml", &format!("{WORD}.document.main+xml"))?;
        part(xml, "/word/styles.xml", &format!("{WORD}.styles+xml"))?;
        part(xml, "/word/header1.xml", &format!("{WORD}.header+xml"))?;
        part(xml, "/word/footer1.xml", &format!("{WORD}.footer+xml"))
    })
}

fn related(xml: &mut Xml, id: &str, kind: &str, target: &str) -> io::Result<()> {
    empty(xml, "Relationship", &[("Id", id), ("Type", kind), ("Target", target)])
}

fn package_relations(xml: &mut Xml) -> io::Result<()> {
    node(xml, "Relationships", &[("xmlns", RELATIONS)], |xml| {
        related(xml, "document", &format!("{OFFICE}/officeDocument"), "word/document.xml")?;
        related(xml, "properties", PROPERTIES_RELATION, "docProps/core.xml")
    })
}

fn document_relations(xml: &mut Xml, figures: usize) -> io::Result<()> {
    node(xml, "Relationships", &[("xmlns", RELATIONS)], |xml| {
        for (id, file) in [("styles", "styles.xml"), ("header", "header1.xml"), ("footer", "footer1.xml")] {
            related(xml, id, &format!("{OFFICE}/{id}"), file)?;
        }
        (1..=figures).try_for_each(|number| {
            let id = relation(number);
            related(xml, &id, &format!("{OFFICE}/image"), &format!("media/{id}.svg"))
        })
    })
}

/// Title, program and moment of the record.
fn properties(xml: &mut Xml, page: &Page, made_at: &str) -> io::Result<()> {
    let namespaces = [
        ("xmlns:cp", PROPERTIES),
        ("xmlns:dc", "http://purl.org/dc/elements/1.1/"),
        ("xmlns:dcterms", "http://purl.org/dc/terms/"),
        ("xmlns:xsi", super::super::xml::SCHEMA_INSTANCE),
    ];
    node(xml, "cp:coreProperties", &namespaces, |xml| {
        leaf(xml, "dc:title", &[], &page.title)?;
        leaf(xml, "dc:creator", &[], &page.generator)?;
        match DateTime::parse_from_rfc3339(made_at) {
            Ok(at) => {
                let at = at.to_utc().to_rfc3339_opts(SecondsFormat::Secs, true);
                leaf(xml, "dcterms:created", &[("xsi:type", "dcterms:W3CDTF")], &at)
            }
            Err(_) => Ok(()),
        }
    })
}

fn body(xml: &mut Xml, shown: &Shown<'_>, page: &Page) -> io::Result<()> {
    let namespaces = [("xmlns:w", MAIN), ("xmlns:r", OFFICE), ("xmlns:wp", DRAWING)];
    node(xml, "w:document", &namespaces, |xml| {
        node(xml, "w:body", &[], |xml| {
            shown.blocks(xml, &page.blocks)?;
            node(xml, "w:sectPr", &[], |xml| {
                empty(xml, "w:headerReference", &[("w:type", "default"), ("r:id", "header")])?;
                empty(xml, "w:footerReference", &[("w:type", "default"), ("r:id", "footer")])?;
                empty(xml, "w:pgSz", &[("w:w", PAPER.0), ("w:h", PAPER.1)])?;
                let margins = ["w:top", "w:right", "w:bottom", "w:left", "w:header", "w:footer"];
                let at = |name| (name, if matches!(name, "w:header" | "w:footer") { "510" } else { MARGIN });
                let margins: Vec<(&str, &str)> =
                    margins.into_iter().map(at).chain([("w:gutter", "0")]).collect();
                empty(xml, "w:pgMar", &margins)
            })
        })
    })
}

/// What stands at the upper or lower edge of every page.
fn edge(xml: &mut Xml, name: &str, inner: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    node(xml, name, &[("xmlns:w", MAIN), ("xmlns:r", OFFICE)], inner)
}

/// The kind of the document, with the organisation and the number of the protocol where they are stated.
fn header(xml: &mut Xml, page: &Page) -> io::Result<()> {
    paragraph(xml, "Header", &plain(&kind(&page.blocks).unwrap_or_default()))
}

fn kind(blocks: &[Block]) -> Option<String> {
    blocks.iter().find_map(|block| match block {
        Block::Head(head) => Some(head.kind.clone()),
        Block::Section(_, below) => kind(below),
        _ => None,
    })
}

/// The line of the page, and the number of the page at its right end.
fn footer(xml: &mut Xml, page: &Page, words: Translator) -> io::Result<()> {
    let field = |xml: &mut Xml, instruction: &str| {
        node(xml, "w:fldSimple", &[("w:instr", instruction)], |xml| {
            node(xml, "w:r", &[], |xml| text(xml, "1"))
        })
    };
    let said = |xml: &mut Xml, said: &str| node(xml, "w:r", &[], |xml| text(xml, said));
    let number = words.t("pdf.page");
    let (before, rest) = number.split_once("{n}").unwrap_or((&number, ""));
    let (between, after) = rest.split_once("{m}").unwrap_or((rest, ""));
    node(xml, "w:p", &[], |xml| {
        node(xml, "w:pPr", &[], |xml| {
            empty(xml, "w:pStyle", &[("w:val", "Footer")])?;
            node(xml, "w:tabs", &[], |xml| {
                empty(xml, "w:tab", &[("w:val", "right"), ("w:pos", &WIDTH.to_string())])
            })
        })?;
        said(xml, &page.footer)?;
        node(xml, "w:r", &[], |xml| empty(xml, "w:tab", &[]))?;
        said(xml, before)?;
        field(xml, "PAGE")?;
        said(xml, between)?;
        field(xml, "NUMPAGES")?;
        said(xml, after)
    })
}
