//! The plan of looks of a growing test, with the state of each row.

use super::part::Part;
use super::rows::Row;
use crate::i18n::Arg;
use crate::i18n::note;
use crate::record::{InterimRecord, InterimRow};
use crate::report::number::{NOTHING, decimals, duration, percent};
use crate::report::page::{Block, Table, Value};
use crate::report::translator::Translator;

/// Decimals of a normal score.
const SCORE_DECIMALS: usize = 2;

/// The plan, the share of the information and the deciding score of each row at each look.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let Some(interim) = part.record.interim.as_ref().filter(|i| !i.rows.is_empty()) else { return vec![] };
    let rows = &interim.rows;
    let each = |of: &dyn Fn(&InterimRow) -> String| rows.iter().map(of).collect::<Vec<_>>();
    let several = |list: &dyn Fn(&InterimRow) -> Vec<String>| {
        rows.iter().map(|r| list(r).join(" · ")).collect::<Vec<_>>()
    };
    let information = |r: &InterimRow| -> Vec<String> {
        if r.information.is_empty() {
            return vec![words.t("interim.full_only")];
        }
        r.information.iter().map(|t| percent(*t, words.lang)).collect()
    };
    let scores = |r: &InterimRow| -> Vec<String> {
        let score = |s: &Option<f64>| {
            s.map_or_else(|| NOTHING.to_owned(), |s| decimals(s, SCORE_DECIMALS, true, words.lang))
        };
        r.scores.iter().map(score).collect()
    };
    let table = Table::new("dense cards", rows.len())
        .column(words.column("report.quantity"), rows.iter().map(|r| Value::Text(name(part, r))))
        .column(words.column("interim.information"), several(&information))
        .column(words.column("interim.score"), several(&scores))
        .column(words.number_column("interim.spent"), each(&|r| percent(r.spent_risk, words.lang)))
        .column(words.column("interim.state_column"), each(&|r| words.name("interim.state", r.state.id())))
        .column(
            words.number_column("interim.decidable"),
            each(&|r| r.decidable_s.map_or_else(|| NOTHING.to_owned(), |s| span(s, words))),
        );
    let below = vec![Block::Hint(hint(interim, words)), Block::Table(table)];
    vec![Block::section("interim", words.t("interim.title"), below)]
}

fn name(part: &Part<'_>, row: &InterimRow) -> String {
    let judged = part.judged.iter().find(|r: &&Row<'_>| r.of.id == row.id && r.of.channel == row.channel);
    judged.map_or_else(
        || part.words.name("measurand", &row.id),
        |r| r.name_in(part.several_channels, part.words),
    )
}

fn span(seconds: f64, words: Translator) -> String {
    words.say(&note!("interim.span", length = Arg::span(seconds)))
}

fn hint(interim: &InterimRecord, words: Translator) -> String {
    let looks: Vec<String> = interim.looks_s.iter().map(|s| span(*s, words)).collect();
    words.with(
        "interim.hint",
        &[
            ("looks", &looks.join("; ")),
            ("look", &interim.look.to_string()),
            ("recorded", &duration(interim.recorded_s, words.lang)),
        ],
    )
}
