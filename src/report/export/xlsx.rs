//! A lot for spreadsheets: Office Open XML (ECMA-376), numbers to the last digit.

use super::xml::{Xml, empty, leaf, node, printable, xml_document};
use super::{ExportedFile, Exporter};
use crate::estimate::Verdict;
use crate::i18n::visible;
use crate::output::archive;
use crate::record::{LotRecord, LotUnit, MeasurandRecord};
use crate::report::lot::Matrix;
use crate::report::translator::Translator;
use crate::report::{Document, Renderer, ReportError};
use quick_xml::events::BytesText;
use std::collections::BTreeMap;
use std::io;

/// A lot as `index.xlsx`: its units against its quantities, each in the colour of its verdict; of other results nothing.
pub struct Xlsx;

impl Exporter for Xlsx {
    fn id(&self) -> &'static str {
        "xlsx"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let Some(lot) = document.lot() else { return Ok(vec![]) };
        let bytes = workbook(lot, Translator { lang: document.lang })?;
        Ok(vec![ExportedFile::new(document.page("xlsx"), bytes)])
    }
}

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const RELATIONS: &str = "http://schemas.openxmlformats.org/package/2006/relationships";
const TYPES: &str = "http://schemas.openxmlformats.org/package/2006/content-types";
const SHEET: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml";

/// Styles of cells, by their place in the list of the workbook: without one, of heads, and of verdicts.
const PLAIN: usize = 0;
const HEAD: usize = 1;

/// Colours of verdicts, in the order of their styles behind that of heads.
const FILLS: [&str; 3] = ["FFD8F0DC", "FFF8D7D4", "FFFFF0C8"];

fn style(verdict: Verdict) -> usize {
    match verdict {
        Verdict::Pass => HEAD + 1,
        Verdict::Fail | Verdict::Error => HEAD + 2,
        Verdict::Indeterminate => HEAD + 3,
        Verdict::None => PLAIN,
    }
}

/// What stands in a cell.
enum Cell {
    Text(String),
    Number(f64),
}

type Rows = Vec<Vec<(Cell, usize)>>;

fn workbook(lot: &LotRecord, words: Translator) -> Result<Vec<u8>, ReportError> {
    let rows = rows(lot, words);
    let mut parts: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    let mut put = |name: &str, bytes: Vec<u8>| parts.insert(name.to_owned(), bytes);
    put("[Content_Types].xml", xml_document(content_types)?);
    put("_rels/.rels", xml_document(|xml| relations(xml, &[("officeDocument", "xl/workbook.xml")]))?);
    let below = [("worksheet", "worksheets/sheet1.xml"), ("styles", "styles.xml")];
    put("xl/_rels/workbook.xml.rels", xml_document(|xml| relations(xml, &below))?);
    put("xl/styles.xml", xml_document(styles)?);
    put("xl/workbook.xml", xml_document(|xml| book(xml, &words.t("lot.units")))?);
    put("xl/worksheets/sheet1.xml", xml_document(|xml| sheet(xml, &rows))?);
    archive(&parts).map_err(|e| ReportError::Xml(e.to_string()))
}

/// A row for each unit, in the order of the record: serial number, verdict, then every quantity.
fn rows(lot: &LotRecord, words: Translator) -> Rows {
    let units: Vec<_> = lot.units.iter().collect();
    let matrix = Matrix::new(&units);
    let own = [words.t("report.serial"), words.t("report.verdict")];
    let heads = own.into_iter().chain(matrix.heads(words)).map(|head| (Cell::Text(head), HEAD));
    let row = |(unit, values): &(&LotUnit, Vec<Option<&MeasurandRecord>>)| {
        let serial = (Cell::Text(unit.serial().to_owned()), PLAIN);
        let verdict = (Cell::Text(words.verdict(unit.verdict)), style(unit.verdict));
        let value = |row: &Option<&MeasurandRecord>| match row {
            None => (Cell::Text(String::new()), PLAIN),
            Some(row) => match row.value.filter(|v| v.is_finite()) {
                Some(value) => (Cell::Number(value), style(row.verdict)),
                None => (Cell::Text(words.verdict(row.verdict)), style(row.verdict)),
            },
        };
        [serial, verdict].into_iter().chain(values.iter().map(value)).collect()
    };
    std::iter::once(heads.collect()).chain(matrix.rows.iter().map(row)).collect()
}

fn content_types(xml: &mut Xml) -> io::Result<()> {
    let part = |xml: &mut Xml, name: &str, kind: &str| {
        empty(xml, "Override", &[("PartName", name), ("ContentType", &format!("{SHEET}.{kind}+xml"))])
    };
    node(xml, "Types", &[("xmlns", TYPES)], |xml| {
        let relations = "application/vnd.openxmlformats-package.relationships+xml";
        empty(xml, "Default", &[("Extension", "rels"), ("ContentType", relations)])?;
        empty(xml, "Default", &[("Extension", "xml"), ("ContentType", "application/xml")])?;
        part(xml, "/xl/workbook.xml", "sheet.main")?;
        part(xml, "/xl/worksheets/sheet1.xml", "worksheet")?;
        part(xml, "/xl/styles.xml", "styles")
    })
}

/// Relations with the name of their kind as their id.
fn relations(xml: &mut Xml, all: &[(&str, &str)]) -> io::Result<()> {
    node(xml, "Relationships", &[("xmlns", RELATIONS)], |xml| {
        all.iter().try_for_each(|(kind, target)| {
            let of = format!("{OFFICE}/{kind}");
            empty(xml, "Relationship", &[("Id", kind), ("Type", &of), ("Target", target)])
        })
    })
}

fn book(xml: &mut Xml, name: &str) -> io::Result<()> {
    node(xml, "workbook", &[("xmlns", MAIN), ("xmlns:r", OFFICE)], |xml| {
        node(xml, "sheets", &[], |xml| {
            empty(xml, "sheet", &[("name", name), ("sheetId", "1"), ("r:id", "worksheet")])
        })
    })
}

fn styles(xml: &mut Xml) -> io::Result<()> {
    let count = |n: usize| n.to_string();
    // The first two fills are those that every workbook has.
    let format = |xml: &mut Xml, font: usize, fill: usize| {
        let (font, fill) = (count(font), count(fill));
        let of = [
            ("numFmtId", "0"),
            ("fontId", font.as_str()),
            ("fillId", &fill),
            ("borderId", "0"),
            ("xfId", "0"),
        ];
        empty(xml, "xf", &of)
    };
    node(xml, "styleSheet", &[("xmlns", MAIN)], |xml| {
        node(xml, "fonts", &[("count", "2")], |xml| {
            let size = |xml: &mut Xml| {
                empty(xml, "sz", &[("val", "11")])?;
                empty(xml, "name", &[("val", "Calibri")])
            };
            node(xml, "font", &[], size)?;
            node(xml, "font", &[], |xml| {
                empty(xml, "b", &[])?;
                size(xml)
            })
        })?;
        node(xml, "fills", &[("count", &count(2 + FILLS.len()))], |xml| {
            for pattern in ["none", "gray125"] {
                node(xml, "fill", &[], |xml| empty(xml, "patternFill", &[("patternType", pattern)]))?;
            }
            FILLS.iter().try_for_each(|colour| {
                node(xml, "fill", &[], |xml| {
                    node(xml, "patternFill", &[("patternType", "solid")], |xml| {
                        empty(xml, "fgColor", &[("rgb", colour)])
                    })
                })
            })
        })?;
        node(xml, "borders", &[("count", "1")], |xml| {
            node(xml, "border", &[], |xml| {
                ["left", "right", "top", "bottom", "diagonal"].iter().try_for_each(|at| empty(xml, at, &[]))
            })
        })?;
        node(xml, "cellStyleXfs", &[("count", "1")], |xml| {
            empty(xml, "xf", &[("numFmtId", "0"), ("fontId", "0"), ("fillId", "0"), ("borderId", "0")])
        })?;
        node(xml, "cellXfs", &[("count", &count(2 + FILLS.len()))], |xml| {
            format(xml, 0, 0)?;
            format(xml, 1, 0)?;
            (0..FILLS.len()).try_for_each(|at| format(xml, 0, 2 + at))
        })?;
        node(xml, "cellStyles", &[("count", "1")], |xml| {
            empty(xml, "cellStyle", &[("name", "Normal"), ("xfId", "0"), ("builtinId", "0")])
        })
    })
}

fn sheet(xml: &mut Xml, rows: &Rows) -> io::Result<()> {
    node(xml, "worksheet", &[("xmlns", MAIN)], |xml| {
        node(xml, "sheetViews", &[], |xml| {
            node(xml, "sheetView", &[("workbookViewId", "0")], |xml| {
                let pane = [("xSplit", "1"), ("ySplit", "1"), ("topLeftCell", "B2"), ("state", "frozen")];
                empty(xml, "pane", &pane)
            })
        })?;
        let columns = rows.first().map_or(1, Vec::len).to_string();
        node(xml, "cols", &[], |xml| {
            empty(xml, "col", &[("min", "1"), ("max", &columns), ("width", "18"), ("customWidth", "1")])
        })?;
        node(xml, "sheetData", &[], |xml| {
            rows.iter().zip(1..).try_for_each(|(row, number): (_, usize)| {
                node(xml, "row", &[("r", &number.to_string())], |xml| {
                    row.iter().enumerate().try_for_each(|(at, (value, style))| {
                        cell(xml, &format!("{}{number}", column(at)), value, *style)
                    })
                })
            })
        })
    })
}

fn cell(xml: &mut Xml, at: &str, cell: &Cell, style: usize) -> io::Result<()> {
    let style = style.to_string();
    match cell {
        Cell::Number(value) => {
            node(xml, "c", &[("r", at), ("s", &style)], |xml| leaf(xml, "v", &[], &format!("{value:e}")))
        }
        Cell::Text(text) if text.is_empty() => empty(xml, "c", &[("r", at), ("s", &style)]),
        Cell::Text(text) => node(xml, "c", &[("r", at), ("s", &style), ("t", "inlineStr")], |xml| {
            node(xml, "is", &[], |xml| {
                let text = visible(text);
                let element = xml.create_element("t").with_attribute(("xml:space", "preserve"));
                element.write_text_content(BytesText::new(&printable(&text))).map(|_| ())
            })
        }),
    }
}

/// Letters of a column, counted from 0.
fn column(mut at: usize) -> String {
    let mut letters = vec![];
    loop {
        letters.push(char::from(b'A' + u8::try_from(at % 26).unwrap_or_default()));
        if at < 26 {
            return letters.into_iter().rev().collect();
        }
        at = at / 26 - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_lettered_as_spreadsheets_do() {
        let found: Vec<String> = [0, 25, 26, 51, 52, 701, 702].into_iter().map(column).collect();
        assert_eq!(found, ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }
}
