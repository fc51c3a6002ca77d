//! Several recordings explained together: what they share, and what each says alone and with the others.

use super::explanation::parameters;
use super::screen::Terminal;
use super::table::{Align, Cell, Column, table};
use crate::i18n::{Lang, visible};
use crate::report::joint::JointView;
use crate::report::translator::Translator;

/// The outcome: verdict in sentences, each shared effect with its parameters, and the recordings.
pub fn joint(view: &JointView, lang: Lang, terminal: Terminal) -> String {
    let words = Translator { lang };
    let verdict = terminal.verdict(&view.verdict_word.to_uppercase(), view.verdict_class);
    let mut out = terminal.headed(&verdict, &view.verdict_word, &visible(&view.title));
    out += &terminal.indented(&view.summary);
    for shared in &view.shared {
        out += &format!("\n{}\n", terminal.heading(&visible(&shared.title)));
        out += &parameters(&shared.parameters, words, terminal);
        out += &terminal.indented(&shared.sentences);
    }
    out += &format!("\n{}\n", terminal.heading(&words.t("joint.heading.recordings")));
    let column = |key: &str| Column { head: words.t(key), align: Align::Left, optional: false };
    let columns =
        [column("joint.column.recording"), column("joint.column.alone"), column("joint.column.together")];
    let row = |r: &crate::report::joint::RecordingRow| -> Vec<Cell> {
        vec![visible(&r.name).into_owned().into(), r.alone.clone().into(), r.together.clone().into()]
    };
    let rows: Vec<Vec<Cell>> = view.recordings.iter().map(row).collect();
    out + &table(&columns, &rows, terminal)
}
