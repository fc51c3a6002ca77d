//! A proof: the outcome, what was said, the rules.

use super::screen::Terminal;
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::proof::{ProofView, RuleRow};
use crate::report::translator::Translator;

/// The outcome, what the engine said each time, and each rule with what was found.
pub fn proof(view: &ProofView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let outcome = terminal.verdict(&view.outcome_word.to_uppercase(), view.outcome_class);
    let mut out = terminal.headed(&outcome, &view.outcome_word, &visible(&view.title));
    out += &terminal.indented([&view.summary]);
    for said in &view.said {
        out += &format!("\n{}\n", terminal.heading(&said.title));
        out += &terminal.indented(&said.summary);
    }
    let column = |key: &str| Column { head: words.t(key), align: Align::Left, optional: false };
    let columns = ["prove.column.must", "prove.column.found", "prove.column.holds"].map(column);
    let row = |r: &RuleRow| -> Vec<Cell> {
        vec![format!("{} ({})", r.must, r.when).into(), r.found.clone().into(), r.word.clone().into()]
    };
    let rows: Vec<Vec<Cell>> = view.rules.iter().map(row).collect();
    out += &format!("\n{}\n", terminal.heading(&words.t("prove.heading.rules")));
    out + &table(&columns, &rows, terminal)
}
