//! Tables.

use super::super::xml::{Xml, empty, node};
use super::line::{Line, bold, lines, paragraph, plain};
use crate::report::page::{Align, Facts, Row, Table, Value};
use std::io;

/// Width between the margins, twentieths of a point: A4 with margins of 18 mm.
pub(super) const WIDTH: usize = 9866;

/// Fewest and most letters that the width of a column follows.
const LETTERS: (usize, usize) = (7, 34);

/// A cell: how many columns it covers, the style of its paragraphs, and those.
struct Cell {
    covers: usize,
    style: &'static str,
    lines: Vec<Line>,
}

/// A table with a head.
pub(super) fn table(xml: &mut Xml, table: &Table) -> io::Result<()> {
    let with_unit = !table.units_in_names && !table.columns.iter().any(|c| c.is_unit);
    let style = |align: Align| if align == Align::Right { "CellNumber" } else { "Cell" };
    let cells = |row: &Row| -> Vec<Cell> {
        let mut out: Vec<Cell> = vec![];
        let mut is_covered = false;
        for (column, value) in table.columns.iter().zip(&row.cells) {
            let is_wide = matches!(value, Value::Wide(_));
            if !is_covered {
                let covers = if is_wide { 2 } else { 1 };
                out.push(Cell { covers, style: style(column.align), lines: lines(value, with_unit) });
            }
            is_covered = is_wide;
        }
        // A heading has the room of the whole row.
        if row.is_heading {
            out.truncate(1);
            out.iter_mut().for_each(|cell| cell.covers = table.columns.len());
        }
        out
    };
    let heads: Vec<Cell> = table
        .columns
        .iter()
        .map(|c| Cell { covers: 1, style: style(c.align), lines: vec![bold(&c.head)] })
        .collect();
    let rows: Vec<Vec<Cell>> = table.rows.iter().map(cells).collect();
    let widths = widths(table.columns.len(), std::iter::once(&heads).chain(&rows));
    let has_head = table.columns.iter().any(|c| !c.head.is_empty());
    grid(xml, "Grid", &widths, |xml| {
        if has_head {
            row(xml, &widths, &heads, true)?;
        }
        rows.iter().try_for_each(|cells| row(xml, &widths, cells, false))
    })
}

/// Labels and their values in two columns.
pub(super) fn facts(xml: &mut Xml, facts: &Facts) -> io::Result<()> {
    if facts.rows.is_empty() {
        return Ok(());
    }
    let widths = [WIDTH * 3 / 10, WIDTH - WIDTH * 3 / 10];
    grid(xml, "Facts", &widths, |xml| {
        facts.rows.iter().try_for_each(|(label, value)| {
            let label = Cell { covers: 1, style: "Label", lines: lines(label, true) };
            let value = Cell { covers: 1, style: "Cell", lines: lines(value, true) };
            row(xml, &widths, &[label, value], false)
        })
    })
}

/// Widths of the columns by their longest texts, which fill the page together.
fn widths<'a>(columns: usize, rows: impl Iterator<Item = &'a Vec<Cell>>) -> Vec<usize> {
    let mut letters = vec![LETTERS.0; columns];
    for cells in rows.filter(|cells| cells.len() == columns) {
        for (most, cell) in letters.iter_mut().zip(cells) {
            let longest = cell.lines.iter().map(|line| line.iter().map(super::line::length).sum()).max();
            *most = longest.unwrap_or(0).min(LETTERS.1).max(*most);
        }
    }
    let all: usize = letters.iter().sum::<usize>().max(1);
    letters.iter().map(|n| n * WIDTH / all).collect()
}

fn grid(
    xml: &mut Xml,
    style: &str,
    widths: &[usize],
    rows: impl FnOnce(&mut Xml) -> io::Result<()>,
) -> io::Result<()> {
    if widths.is_empty() {
        return Ok(());
    }
    node(xml, "w:tbl", &[], |xml| {
        node(xml, "w:tblPr", &[], |xml| {
            empty(xml, "w:tblStyle", &[("w:val", style)])?;
            empty(xml, "w:tblW", &[("w:w", &WIDTH.to_string()), ("w:type", "dxa")])?;
            empty(xml, "w:tblLayout", &[("w:type", "fixed")])
        })?;
        node(xml, "w:tblGrid", &[], |xml| {
            widths.iter().try_for_each(|w| empty(xml, "w:gridCol", &[("w:w", &w.to_string())]))
        })?;
        rows(xml)
    })?;
    // Tables that follow one another would become one.
    paragraph(xml, "Between", &plain(""))
}

fn row(xml: &mut Xml, widths: &[usize], cells: &[Cell], is_head: bool) -> io::Result<()> {
    let mut rest = widths;
    node(xml, "w:tr", &[], |xml| {
        node(xml, "w:trPr", &[], |xml| {
            empty(xml, "w:cantSplit", &[])?;
            if is_head { empty(xml, "w:tblHeader", &[]) } else { Ok(()) }
        })?;
        for cell in cells {
            let (own, after) = rest.split_at(cell.covers.min(rest.len()));
            rest = after;
            node(xml, "w:tc", &[], |xml| {
                node(xml, "w:tcPr", &[], |xml| {
                    let width = own.iter().sum::<usize>().to_string();
                    empty(xml, "w:tcW", &[("w:w", &width), ("w:type", "dxa")])?;
                    if cell.covers > 1 {
                        empty(xml, "w:gridSpan", &[("w:val", &cell.covers.to_string())])?;
                    }
                    Ok(())
                })?;
                // A cell has a paragraph in any case.
                let blank = [vec![]];
                let lines = if cell.lines.is_empty() { &blank[..] } else { &cell.lines[..] };
                lines.iter().try_for_each(|line| paragraph(xml, cell.style, line))
            })?;
        }
        Ok(())
    })
}
