//! An explanation: where the mismatch is, what causes it and how large that is, what was gained.

use super::screen::Terminal;
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::explain::{ExplainView, NoticeableRow, ParameterRow};
use crate::report::translator::Translator;

/// The outcome: verdict in sentences, each effect with its parameters, the fit before and after.
pub fn explanation(view: &ExplainView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let verdict = terminal.verdict(&view.verdict_word.to_uppercase(), view.verdict_class);
    let mut out = terminal.headed(&verdict, &view.verdict_word, &visible(&view.title));
    out += &terminal.indented(&view.summary);
    for effect in &view.effects {
        out += &format!("\n{}\n", terminal.heading(&visible(&effect.title)));
        out += &parameters(&effect.parameters, words, terminal);
    }
    if !view.unchanged && !view.fit_summary.is_empty() {
        out += &format!("\n{}\n", terminal.heading(&words.t("terminal.gained")));
        out += &terminal.indented([&view.fit_summary]);
    }
    if !view.noticeable.is_empty() {
        out += &format!("\n{}\n", terminal.heading(&words.t("explain.noticeable.terminal")));
        out += &noticeable(&view.noticeable, words, terminal);
    }
    out
}

/// Rows that a terminal shows of the sizes that would have been noticed.
const NOTICEABLE: usize = 8;

fn noticeable(all: &[NoticeableRow], words: Translator, terminal: Terminal) -> String {
    let column = |id: &str, align| Column { head: words.name("terminal_column", id), align, left_out: None };
    let place = Column { left_out: Some(0), ..column("place", Align::Left) };
    let columns = [column("effect", Align::Left), column("noticed_from", Align::Right), place];
    let shown = all.iter().take(NOTICEABLE);
    let rows: Vec<Vec<Cell>> =
        shown.map(|n| vec![n.title.clone().into(), n.size.clone().into(), n.at.clone().into()]).collect();
    let mut out = table(&columns, &rows, terminal);
    if all.len() > NOTICEABLE {
        let left = (all.len() - NOTICEABLE).to_string();
        out += &terminal.indented([words.with("explain.noticeable.further", &[("n", &left)])]);
    }
    out
}

/// Parameters with their values and intervals; nothing where there are none.
fn parameters(parameters: &[ParameterRow], words: Translator, terminal: Terminal) -> String {
    let column = |id: &str, align| Column { head: words.name("terminal_column", id), align, left_out: None };
    let columns =
        [column("parameter", Align::Left), column("value", Align::Right), column("interval", Align::Right)];
    let rows: Vec<Vec<Cell>> = parameters
        .iter()
        .map(|p| {
            vec![p.name.clone().into(), words.joined(&p.value, &p.unit).into(), p.interval.clone().into()]
        })
        .collect();
    if rows.is_empty() { String::new() } else { table(&columns, &rows, terminal) }
}
