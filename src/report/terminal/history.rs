//! A history: the latest results, yields, reasons, what is out of control, capability, drift.

use super::screen::{Terminal, verdict_style};
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::history::HistoryView;
use crate::report::translator::Translator;

/// Results that are listed.
const LISTED: usize = 20;

/// The words of a history.
pub fn history(view: &HistoryView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let mut out = format!("{}\n", terminal.heading(&format!("{} · {}", visible(&view.title), view.size)));
    out += &results(view, words, terminal);
    out += &yields(view, words, terminal);
    out += &reasons(view, words, terminal);
    out += &charts(view, words, terminal);
    out += &drifts(view, words, terminal);
    out += &stations(view, words, terminal);
    if !view.notes.is_empty() {
        out += &format!("\n{}", terminal.indented(&view.notes));
    }
    out
}

fn column(id: &str, align: Align, optional: bool, words: Translator) -> Column {
    Column { head: words.name("history.column", id), align, optional }
}

fn section(
    key: &str,
    columns: &[Column],
    rows: &[Vec<Cell>],
    words: Translator,
    terminal: Terminal,
) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!("\n{}\n{}", terminal.heading(&words.t(key)), table(columns, rows, terminal))
}

fn cells(texts: &[&String]) -> Vec<Cell> {
    texts.iter().map(|t| Cell::from((*t).clone())).collect()
}

fn results(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("evaluated_at", Align::Left, false, words),
        column("serial", Align::Left, false, words),
        column("lot", Align::Left, true, words),
        column("station", Align::Left, true, words),
        column("attempt", Align::Right, false, words),
        column("address", Align::Left, false, words),
        column("reasons", Align::Left, true, words),
        column("verdict", Align::Left, false, words),
    ];
    let rows: Vec<Vec<Cell>> = view
        .results
        .iter()
        .take(LISTED)
        .map(|r| {
            let mut row =
                cells(&[&r.evaluated_at, &r.serial, &r.lot, &r.station, &r.attempt, &r.address, &r.reasons]);
            row.push(Cell { text: r.verdict_word.clone(), style: verdict_style(r.verdict) });
            row
        })
        .collect();
    section("history.results", &columns, &rows, words, terminal)
}

fn yields(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("procedure", Align::Left, false, words),
        column("units", Align::Right, false, words),
        column("first_pass", Align::Right, false, words),
        column("last_pass", Align::Right, false, words),
    ];
    let rows: Vec<Vec<Cell>> =
        view.yields.iter().map(|y| cells(&[&y.procedure, &y.units, &y.first_pass, &y.last_pass])).collect();
    section("history.yields", &columns, &rows, words, terminal)
}

fn reasons(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("reason", Align::Left, false, words),
        column("kind", Align::Left, true, words),
        column("results", Align::Right, false, words),
        column("cumulative", Align::Right, false, words),
    ];
    let rows: Vec<Vec<Cell>> =
        view.reasons.iter().map(|r| cells(&[&r.name, &r.kind, &r.results, &r.cumulative])).collect();
    section("history.reasons", &columns, &rows, words, terminal)
}

fn charts(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("quantity", Align::Left, false, words),
        column("values", Align::Right, true, words),
        column("center", Align::Left, false, words),
        column("cp", Align::Right, true, words),
        column("cpk", Align::Right, true, words),
        column("control", Align::Left, false, words),
    ];
    let rows: Vec<Vec<Cell>> = view
        .charts
        .iter()
        .map(|c| {
            let mut row = cells(&[&c.name, &c.values, &c.center, &c.cp, &c.cpk]);
            row.push(Cell { text: c.status_word.clone(), style: verdict_style(c.status) });
            row
        })
        .collect();
    let mut out = section("history.charts", &columns, &rows, words, terminal);
    for c in view.charts.iter().filter(|c| c.status == "remark") {
        out += &format!("\n{}\n", terminal.heading(&visible(&c.name)));
        out += &terminal.indented(&c.sentences);
    }
    out
}

fn drifts(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("quantity", Align::Left, false, words),
        column("span", Align::Left, true, words),
        column("change", Align::Right, false, words),
        column("per_year", Align::Right, true, words),
    ];
    let rows: Vec<Vec<Cell>> =
        view.drifts.iter().map(|d| cells(&[&d.name, &d.span, &d.change, &d.per_year])).collect();
    section("history.drifts", &columns, &rows, words, terminal)
}

fn stations(view: &HistoryView, words: Translator, terminal: Terminal) -> String {
    let columns = [
        column("quantity", Align::Left, false, words),
        column("station", Align::Left, false, words),
        column("units", Align::Right, true, words),
        column("mean", Align::Right, false, words),
        column("difference", Align::Right, false, words),
    ];
    let rows: Vec<Vec<Cell>> = view
        .stations
        .iter()
        .map(|s| {
            let mut row = cells(&[&s.name, &s.station, &s.units, &s.mean]);
            row.push(Cell { text: s.difference.clone(), style: verdict_style(s.status) });
            row
        })
        .collect();
    section("history.stations", &columns, &rows, words, terminal)
}
