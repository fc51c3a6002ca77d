//! A table in columns where they fit, and a paragraph for each row where they do not.

use super::screen::Terminal;
use super::wrap::wrapped;
use crate::i18n::visible;
pub use crate::report::page::Align;
use anstyle::Style;
use unicode_width::UnicodeWidthStr;

/// Columns between two cells.
const GAP: usize = 2;
/// Widest first column; longer names are wrapped.
const NAME_WIDTH: usize = 46;
/// Narrowest column that names are wrapped to before another column is left out.
const LEAST_NAME_WIDTH: usize = 26;

/// A column with its head.
pub struct Column {
    /// Head.
    pub head: String,
    /// Side.
    pub align: Align,
    /// Rank among the columns that may be left out, one by one, where not all fit: the least first, of equal ones the
    /// left one. `None` for a column that stays.
    pub left_out: Option<u8>,
}

/// A cell with the style of its text.
#[derive(Clone, Default)]
pub struct Cell {
    /// Text.
    pub text: String,
    /// Style.
    pub style: Style,
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell { text, style: Style::new() }
    }
}

/// The rows under their heads, two columns indented; the first column names the row. Columns without any text are left
/// out. Where the others do not fit, names are wrapped, then columns are left out by their ranks. Where not even the
/// rest fits, each row is a paragraph: its name, and below it the other cells with their heads.
pub fn table(columns: &[Column], rows: &[Vec<Cell>], terminal: Terminal) -> String {
    let rows: Vec<Vec<Cell>> = rows
        .iter()
        .map(|row| row.iter().map(|c| Cell { text: visible(&c.text).into_owned(), style: c.style }).collect())
        .collect();
    let cell = |row: &[Cell], c: usize| row.get(c).cloned().unwrap_or_default();
    let filled = |c: &usize| rows.iter().any(|row| !cell(row, *c).text.is_empty());
    let mut shown: Vec<usize> = (0..columns.len()).filter(filled).collect();
    // Looked at once: a line of a table must not look through all of it.
    let widths: Vec<usize> = columns
        .iter()
        .enumerate()
        .map(|(c, column)| {
            let texts = rows.iter().filter_map(|row| row.get(c)).map(|cell| cell.text.width());
            texts.max().unwrap_or(0).max(column.head.width())
        })
        .collect();
    let needed = |c: usize| widths.get(c).copied().unwrap_or(0);
    let room = |shown: &[usize]| {
        let others: usize = shown.iter().filter(|c| **c != 0).map(|c| needed(*c) + GAP).sum();
        terminal.width.checked_sub(others + GAP)
    };
    let names = needed(0).min(NAME_WIDTH);
    let rank = |c: usize| columns.get(c).and_then(|column| column.left_out);
    let name_width = loop {
        if let Some(width) = room(&shown).filter(|room| *room >= names.min(LEAST_NAME_WIDTH)) {
            break width;
        }
        let next = shown.iter().copied().filter_map(|c| Some((rank(c)?, c))).min();
        let Some((_, next)) = next else { return stacked(columns, &rows, terminal) };
        shown.retain(|c| *c != next);
    };
    let name_width = names.min(name_width);
    let widest = |c: usize| if c == 0 { name_width } else { needed(c) };
    let line = |texts: &[(usize, Cell)]| {
        let mut out = String::new();
        for (c, cell) in texts {
            let padding = " ".repeat(widest(*c).saturating_sub(cell.text.width()));
            let text = terminal.styled(&cell.text, cell.style);
            let right = columns.get(*c).is_some_and(|column| column.align == Align::Right);
            out.push_str("  ");
            out.push_str(&if right { padding + &text } else { text + &padding });
        }
        format!("{}\n", out.trim_end())
    };
    let heads: Vec<(usize, Cell)> = shown
        .iter()
        .filter_map(|c| {
            Some((*c, Cell { text: columns.get(*c)?.head.clone(), style: Style::new().dimmed() }))
        })
        .collect();
    let mut out = line(&heads);
    for row in &rows {
        let name = cell(row, 0);
        let mut names = wrapped(&name.text, name_width).into_iter();
        let first = Cell { text: names.next().unwrap_or_default(), style: name.style };
        let cells: Vec<(usize, Cell)> =
            shown.iter().map(|c| (*c, if *c == 0 { first.clone() } else { cell(row, *c) })).collect();
        out.push_str(&line(&cells));
        names.for_each(|rest| out.push_str(&format!("    {rest}\n")));
    }
    out
}

/// Each row as a paragraph: the first and the last cell, below them the others behind their heads.
fn stacked(columns: &[Column], rows: &[Vec<Cell>], terminal: Terminal) -> String {
    let mut out = String::new();
    for row in rows {
        let Some((name, rest)) = row.split_first() else { continue };
        let (last, between) = rest.split_last().unwrap_or((name, &[]));
        let last_text = terminal.styled(&last.text, last.style);
        for (i, line) in wrapped(&name.text, terminal.width.saturating_sub(4)).iter().enumerate() {
            out.push_str(&format!("  {}{line}\n", if i > 0 { "  " } else { "" }));
        }
        for (column, cell) in columns.iter().skip(1).zip(between).filter(|(_, c)| !c.text.is_empty()) {
            out.push_str(&format!("    {}: {}\n", column.head, terminal.styled(&cell.text, cell.style)));
        }
        if !last.text.is_empty() && !rest.is_empty() {
            let head = columns.last().map_or("", |column| column.head.as_str());
            out.push_str(&format!("    {head}: {last_text}\n"));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Vec<Column> {
        let column = |head: &str, align, left_out| Column { head: head.into(), align, left_out };
        vec![
            column("Quantity", Align::Left, None),
            column("Value", Align::Right, Some(1)),
            column("Margin", Align::Right, Some(0)),
            column("Verdict", Align::Left, None),
        ]
    }

    fn rows() -> Vec<Vec<Cell>> {
        let row = |texts: [&str; 4]| texts.iter().map(|t| Cell::from((*t).to_owned())).collect();
        vec![row(["Сдвиг нуля", "0.12 °/h", "0.38", "pass"]), row(["N", "12.25 °/√h", "-1", "fail"])]
    }

    #[test]
    fn columns_are_in_line_and_those_with_a_rank_go_one_by_one() {
        let wide = table(&columns(), &rows(), Terminal { width: 80, colour: false });
        assert_eq!(
            wide,
            "  Quantity         Value  Margin  Verdict\n  Сдвиг нуля    0.12 °/h    0.38  pass\n\
             \u{20}\u{20}N           12.25 °/√h      -1  fail\n"
        );
        let medium = table(&columns(), &rows(), Terminal { width: 36, colour: false });
        assert!(!medium.contains("Margin") && medium.starts_with("  Quantity         Value  "), "{medium}");
        let small = table(&columns(), &rows(), Terminal { width: 24, colour: false });
        assert_eq!(small, "  Quantity    Verdict\n  Сдвиг нуля  pass\n  N           fail\n");
        let narrow = table(&columns(), &rows(), Terminal { width: 20, colour: false });
        assert!(narrow.starts_with("  Сдвиг нуля\n    Value: 0.12 °/h\n    Margin: 0.38\n"), "{narrow}");
    }

    #[test]
    fn long_names_are_wrapped_before_a_column_goes() {
        let row = ["Drift of 100-s averages predicted by the noise model", "0.01278 °/h", "0.38", "pass"];
        let rows = [row.map(|text| Cell::from(text.to_owned())).to_vec()];
        let shown = table(&columns(), &rows, Terminal { width: 64, colour: false });
        assert_eq!(
            shown,
            "  Quantity                                Value  Margin  Verdict\n  \
             Drift of 100-s averages           0.01278 °/h    0.38  pass\n    \
             predicted by the noise model\n"
        );
    }

    #[test]
    fn what_steers_a_terminal_is_shown_and_colour_is_not_counted() {
        let evil = vec![vec![Cell::from("\u{1b}[2Ja".to_owned())]];
        assert!(!table(&columns()[..1], &evil, Terminal { width: 80, colour: true }).contains("\u{1b}[2J"));
        let plain = table(&columns(), &rows(), Terminal { width: 80, colour: false });
        let coloured = table(&columns(), &rows(), Terminal { width: 80, colour: true });
        assert_eq!(anstream::adapter::strip_str(&coloured).to_string(), plain);
    }
}
