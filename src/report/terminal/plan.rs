//! A plan: the outcome, the schedule, what it tells apart and why.

use super::screen::Terminal;
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::plan::{CauseView, PlanView};
use crate::report::translator::Translator;

/// The outcome in sentences, the schedule step by step, the explanations of each cause with what decides between them.
pub fn plan(view: &PlanView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let verdict = terminal.verdict(&view.outcome_word.to_uppercase(), view.outcome_class);
    let mut out = terminal.headed(&verdict, &view.outcome_word, &visible(&view.title));
    out += &terminal.indented(&view.summary);
    out += &terminal.indented(&view.remarks);
    if !view.steps.is_empty() {
        out += &format!("\n{}\n", terminal.heading(&words.t("plan.heading.schedule")));
        out += &terminal.indented(view.steps.iter().map(|s| format!("{}. {}", s.number, s.what)));
    }
    for cause in &view.causes {
        out += &format!("\n{}\n", terminal.heading(&words.t("plan.heading.alternatives")));
        out += &alternatives(cause, words, terminal);
        let why: Vec<&String> = cause.pairs.iter().map(|p| &p.why).collect();
        out += &terminal.indented(why);
    }
    out
}

fn alternatives(cause: &CauseView, words: Translator, terminal: Terminal) -> String {
    let column = |key: &str, align| Column { head: words.t(key), align, optional: false };
    let columns = [
        column("plan.column.alternative", Align::Left),
        column("plan.column.shows_as", Align::Left),
        column("plan.column.alone", Align::Right),
    ];
    let row = |a: &crate::report::plan::AlternativeRow| -> Vec<Cell> {
        vec![a.title.clone().into(), a.shows_as.clone().into(), a.alone.clone().into()]
    };
    let rows: Vec<Vec<Cell>> = cause.alternatives.iter().map(row).collect();
    table(&columns, &rows, terminal)
}
