//! A lot: a line for a unit when it is done, and the table of all units at the end.

use super::screen::{Terminal, verdict_style};
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::lot::{LotUnitView, LotView};
use crate::report::translator::Translator;

/// The line of a unit that is done, and below it the first reason where it does not pass.
pub fn lot_unit(unit: &LotUnitView, terminal: Terminal) -> String {
    let word = unit.verdict_word.to_uppercase();
    let verdict = terminal.verdict(&word, unit.verdict);
    let of = format!("{} · {}", visible(&unit.serial), visible(&unit.recording));
    terminal.headed(&verdict, &word, &of) + &terminal.indented(unit.reasons.first())
}

/// The outcome: the worst verdict and how many units have which, a table of the units, and below it the reasons of those
/// that do not pass.
pub fn lot(view: &LotView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let verdict = terminal.verdict(&view.verdict_word.to_uppercase(), view.verdict);
    let counts = view.counts.iter().map(|c| format!("{} {}", c.verdict_word, c.n));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let of = format!("{} · {} ({counts})", visible(&view.title), view.size);
    let mut out = format!("\n{}", terminal.headed(&verdict, &view.verdict_word, &of));
    let column =
        |id: &str, optional| Column { head: words.name("terminal_column", id), align: Align::Left, optional };
    let columns =
        [column("unit", false), column("recording", true), column("met", false), column("verdict", false)];
    let rows: Vec<Vec<Cell>> = view
        .units
        .iter()
        .map(|u| {
            let verdict = Cell { text: u.verdict_word.clone(), style: verdict_style(u.verdict) };
            vec![u.serial.clone().into(), u.recording.clone().into(), u.met.clone().into(), verdict]
        })
        .collect();
    out += &format!("\n{}", table(&columns, &rows, terminal));
    for unit in view.units.iter().filter(|u| !u.reasons.is_empty()) {
        out += &format!("\n{}\n", terminal.heading(&visible(&unit.serial)));
        out += &terminal.indented(&unit.reasons);
    }
    out.push('\n');
    out += &terminal.indented([&view.serials]);
    out
}
