//! A data sheet: a table of the quantities, and what must be known of the whole.

use super::screen::Terminal;
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::datasheet::SheetView;
use crate::report::translator::Translator;

/// The quantities with their medians and bounds, and the notes below.
pub fn datasheet(view: &SheetView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let mut out = format!("\n{}\n", terminal.heading(&format!("{} · {}", visible(&view.title), view.size)));
    let column =
        |id: &str, align, optional| Column { head: words.name("datasheet.column", id), align, optional };
    let columns = [
        column("quantity", Align::Left, false),
        column("units", Align::Right, true),
        column("typical", Align::Right, false),
        column("bound_true", Align::Right, false),
        column("bound_measured", Align::Right, true),
        column("largest", Align::Right, true),
    ];
    let rows: Vec<Vec<Cell>> = view
        .quantities
        .iter()
        .map(|q| {
            let with_unit = |text: &str| match text {
                "" => "–".to_owned(),
                text => words.joined(text, &q.unit),
            };
            vec![
                q.name.clone().into(),
                q.units.clone().into(),
                with_unit(&q.typical).into(),
                with_unit(&q.bound_true).into(),
                with_unit(&q.bound_measured).into(),
                with_unit(&q.largest).into(),
            ]
        })
        .collect();
    out += &table(&columns, &rows, terminal);
    if !view.promise.is_empty() {
        out += &format!("\n{}", terminal.indented([&view.promise]));
    }
    out + &terminal.indented(&view.notes)
}
