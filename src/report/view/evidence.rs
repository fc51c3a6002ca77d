//! What the verdict rests on beside measured values and conditions: the evaluated span, the power of the test, waivers,
//! clauses.

use super::common::row_name;
use super::part::Part;
use crate::record::{ClauseRecord, ExcludedSpan, ExclusionRecord, PowerRecord, WaiverRecord};
use crate::report::number::{NOTHING, duration, limit, limit_digits, percent};
use crate::report::page::{Block, Facts, Table, Value};
use crate::report::translator::Translator;

/// The evaluated span, and what was left out. A run that read nothing evaluated nothing.
pub fn window(part: &Part<'_>) -> Vec<Block> {
    let (record, words) = (part.record, part.words);
    let w = &record.window;
    let is_evaluated = w.to_s > w.from_s;
    if !is_evaluated && w.excluded.is_empty() {
        return vec![];
    }
    let seconds = |s: f64| duration(s, words.lang);
    let span = [
        ("report.window_from", w.from_s),
        ("report.window_to", w.to_s),
        ("report.window_usable", w.usable_s),
    ];
    let rows = span.into_iter().filter(|_| is_evaluated);
    let rows = rows.map(|(key, s)| (words.t(key).into(), seconds(s).into())).collect();
    let left_out = if w.excluded.is_empty() {
        Block::Paragraph(words.t("report.nothing_left_out"))
    } else {
        let all = &w.excluded;
        let table = Table::new("", all.len())
            .column(
                words.column("report.left_out"),
                all.iter().map(|e| why_excluded(e, &record.exclusions, words)),
            )
            .column(words.number_column("report.from"), all.iter().map(|e| seconds(e.from_s)))
            .column(words.number_column("report.to"), all.iter().map(|e| seconds(e.to_s)))
            .column(words.number_column("report.length"), all.iter().map(|e| seconds(e.to_s - e.from_s)));
        Block::Table(table)
    };
    let facts = Block::Facts(Facts { class: "counts", rows });
    vec![Block::section("", words.t("report.window"), vec![facts, left_out])]
}

/// Reason why a span is left out; of a declared one with the reasons that the procedure gives.
fn why_excluded(e: &ExcludedSpan, declared: &[ExclusionRecord], words: Translator) -> String {
    let of = |d: &&ExclusionRecord| e.reason == "declared" && d.from_s < e.to_s && d.to_s > e.from_s;
    let reasons: Vec<String> = declared.iter().filter(of).map(|d| words.local(&d.reason)).collect();
    let word = words.name("excluded", &e.reason);
    if reasons.is_empty() {
        word
    } else {
        words.with("report.excluded_because", &[("kind", &word), ("reasons", &reasons.join("; "))])
    }
}

/// What this test can decide.
pub fn power(part: &Part<'_>) -> Vec<Block> {
    let (all, words) = (&part.record.power, part.words);
    if all.is_empty() {
        return vec![];
    }
    let several = part.several_channels;
    let about = |p: &PowerRecord| {
        let said = words.say(&p.message);
        Value::Sentence(if several { format!("{} · {said}", p.channel) } else { said })
    };
    let needed = |p: &PowerRecord| {
        let hours = |h| words.quantity(&limit_digits(h, 3, words.lang), "h");
        p.needed_h.map_or_else(|| NOTHING.to_owned(), hours)
    };
    let bound = |p: &PowerRecord| words.quantity(&limit(p.limit, words.lang), &p.unit);
    let table = Table::new("dense cards", all.len())
        .column(
            words.column("report.quantity"),
            all.iter().map(|p| Value::Text(words.name("measurand", &p.id)).over([about(p)])),
        )
        .column(words.number_column("report.limit"), all.iter().map(bound))
        .column(words.number_column("report.power_fail"), all.iter().map(|p| percent(p.power, words.lang)))
        .column(
            words.number_column("report.power_pass"),
            all.iter().map(|p| percent(p.pass_probability, words.lang)),
        )
        .column(words.number_column("report.needed"), all.iter().map(needed));
    vec![Block::section("", words.t("report.power"), vec![Block::Table(table)])]
}

/// Rows that are let pass by decision.
pub fn waivers(part: &Part<'_>) -> Vec<Block> {
    let (all, words) = (&part.record.waivers, part.words);
    if all.is_empty() {
        return vec![];
    }
    let each = |of: &dyn Fn(&WaiverRecord) -> String| all.iter().map(of).collect::<Vec<_>>();
    let table = Table::new("", all.len())
        .column(words.column("report.row"), each(&|w| row_name(&w.row, words)))
        .column(words.column("report.waived_by"), each(&|w| words.local(&w.by)))
        .column(words.column("report.date"), each(&|w| w.date.clone()))
        .column(words.column("report.reason"), each(&|w| words.local(&w.reason)));
    let hint = Block::Hint(words.t("report.waivers_hint"));
    vec![Block::section("", words.t("report.waivers"), vec![hint, Block::Table(table)])]
}

/// Clauses of the standard, and what covers each.
pub fn clauses(part: &Part<'_>) -> Vec<Block> {
    let (all, words) = (&part.record.clauses, part.words);
    if all.is_empty() {
        return vec![];
    }
    let each = |of: &dyn Fn(&ClauseRecord) -> String| all.iter().map(of).collect::<Vec<_>>();
    let notes = all.iter().map(|c| Value::Sentence(words.local(&c.note)));
    let rows = |c: &ClauseRecord| {
        let names: Vec<String> = c.rows.iter().map(|id| row_name(id, words)).collect();
        Value::Sentence(names.join("; "))
    };
    let mut table = Table::new("dense clauses cards", all.len())
        .column(words.column("report.clause"), each(&|c| words.local(&c.clause)))
        .column(words.column("report.clause_title"), each(&|c| words.local(&c.title)))
        .column(words.column("report.clause_state"), each(&|c| words.name("clause", &c.status)))
        .column(words.column("report.remark"), notes);
    // Of a test of one phase they are all of its rows.
    if all.iter().any(|c| !c.rows.is_empty()) {
        table = table.column(words.column("report.clause_rows"), all.iter().map(rows));
    }
    vec![Block::section("", words.t("report.clauses"), vec![Block::Table(table)])]
}
