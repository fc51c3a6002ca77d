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
/// out. Where the others do not fit, names are wrapped, then columns are left out by their ranks, then the widest text of
/// the rest is wrapped too. Where not even that fits, each row is a paragraph: its name, and below it the other cells with
/// their heads.
pub fn table(columns: &[Column], rows: &[Vec<Cell>], terminal: Terminal) -> String {
    let rows: Vec<Vec<Cell>> = rows
        .iter()
        .map(|row| row.iter().map(|c| Cell { text: visible(&c.text).into_owned(), style: c.style }).collect())
        .collect();
    let cell = |row: &[Cell], c: usize| row.get(c).cloned().unwrap_or_default();
    let filled = |c: &usize| rows.iter().any(|row| !cell(row, *c).text.is_empty());
    let mut shown: Vec<usize> = (0..columns.len()).filter(filled).collect();
    // Looked at once: a line of a table must not look through all of it.
    let mut widths: Vec<usize> = columns
        .iter()
        .enumerate()
        .map(|(c, column)| {
            let texts = rows.iter().filter_map(|row| row.get(c)).map(|cell| cell.text.width());
            texts.max().unwrap_or(0).max(column.head.width())
        })
        .collect();
    let left_over = |shown: &[usize], widths: &[usize]| {
        let others = shown.iter().filter(|c| **c != 0).filter_map(|c| widths.get(*c));
        terminal.width.checked_sub(others.map(|width| width + GAP).sum::<usize>() + GAP)
    };
    let longest_word = |c: usize| {
        let words = rows.iter().filter_map(|row| row.get(c)).flat_map(|cell| cell.text.split(' '));
        words.map(UnicodeWidthStr::width).max().unwrap_or(0)
    };
    let names = widths.first().map_or(0, |width| *width.min(&NAME_WIDTH));
    let least_names = names.min(LEAST_NAME_WIDTH);
    let rank = |c: usize| columns.get(c).and_then(|column| column.left_out);
    let name_width = loop {
        if let Some(width) = left_over(&shown, &widths).filter(|width| *width >= least_names) {
            break width;
        }
        if let Some((_, next)) = shown.iter().copied().filter_map(|c| Some((rank(c)?, c))).min() {
            shown.retain(|c| *c != next);
            continue;
        }
        let is_text = |c: &usize| *c != 0 && columns.get(*c).is_some_and(|of| of.align == Align::Left);
        let widest = shown.iter().copied().filter(is_text).max_by_key(|c| widths.get(*c));
        let least = LEAST_NAME_WIDTH.max(widest.map_or(0, longest_word));
        let Some(width) = widest.and_then(|c| widths.get_mut(c)).filter(|width| **width > least) else {
            return stacked(columns, &rows, terminal);
        };
        *width -= 1;
    };
    let name_width = names.min(name_width);
    let widest = |c: usize| if c == 0 { name_width } else { widths.get(c).copied().unwrap_or(0) };
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
        let texts: Vec<(usize, Style, Vec<String>)> = shown
            .iter()
            .map(|c| {
                let of = cell(row, *c);
                let fits = of.text.width() <= widest(*c);
                (*c, of.style, if fits { vec![of.text] } else { wrapped(&of.text, widest(*c)) })
            })
            .collect();
        for n in 0..texts.iter().map(|(_, _, lines)| lines.len()).max().unwrap_or(0) {
            let cells: Vec<(usize, Cell)> = texts
                .iter()
                .map(|(c, style, lines)| {
                    // The rest of a name is indented.
                    let indent = if *c == 0 && n > 0 { "  " } else { "" };
                    let text = lines.get(n).map(|text| format!("{indent}{text}"));
                    (*c, text.map(|text| Cell { text, style: *style }).unwrap_or_default())
                })
                .collect();
            out.push_str(&line(&cells));
        }
    }
    out
}

/// Each row as a paragraph: the first and the last cell, below them the others behind their heads.
fn stacked(columns: &[Column], rows: &[Vec<Cell>], terminal: Terminal) -> String {
    let mut out = String::new();
    for row in rows {
        let Some((name, rest)) = row.split_first() else { continue };
        let (last, between) = rest.split_last().unwrap_or((name, &[]));
        for (i, line) in wrapped(&name.text, terminal.width.saturating_sub(4)).iter().enumerate() {
            out.push_str(&format!("  {}{line}\n", if i > 0 { "  " } else { "" }));
        }
        let last_column = columns.last().filter(|_| !rest.is_empty()).map(|column| (column, last));
        let below = columns.iter().skip(1).zip(between).chain(last_column);
        for (column, cell) in below.filter(|(_, cell)| !cell.text.is_empty()) {
            let room = terminal.width.saturating_sub(column.head.width() + 6);
            let lines = wrapped(&cell.text, room);
            for (i, text) in lines.iter().enumerate() {
                let text = terminal.styled(text, cell.style);
                let head = if i == 0 { format!("{}: ", column.head) } else { "  ".to_owned() };
                out.push_str(&format!("    {head}{text}\n"));
            }
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
    fn texts_are_wrapped_before_a_row_becomes_a_paragraph() {
        let column = |head: &str| Column { head: head.into(), align: Align::Left, left_out: None };
        let columns = ["Unit", "Quantity", "Verdict"].map(column);
        let row = ["SN-1", "Angle random walk from 10-s averages", "pass"];
        let rows = [row.map(|text| Cell::from(text.to_owned())).to_vec()];
        let shown = table(&columns, &rows, Terminal { width: 46, colour: false });
        assert_eq!(
            shown,
            "  Unit  Quantity                       Verdict\n  SN-1  Angle random walk from 10-s    pass\n        \
             averages\n"
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
