//! A certificate of conformity: the statement of ISO/IEC 17025, 7.8.6, on one unit, by the decision rule of its limits.

use super::part::{Part, Phase};
use super::rows::Row;
use super::{evidence, limits, page};
use crate::estimate::Verdict;
use crate::i18n::{Arg, Note, note};
use crate::record::{RunKind, RunRecord};
use crate::report::number::{count, date_time, percent};
use crate::report::page::{Block, Head, Page, State};
use crate::report::translator::Translator;

/// Why no certificate of conformity can be made of a record; `None` for a test that is passed.
pub fn refusal(record: &RunRecord) -> Option<Note> {
    if record.kind != RunKind::Run || record.procedure.as_ref().is_none_or(|p| p.limits.is_none()) {
        return Some("certificate.no_test".into());
    }
    if record.verdict != Verdict::Pass {
        return Some(note!("certificate.not_passed", verdict = Arg::key("verdict", record.verdict.id())));
    }
    let is_named = record.unit_under_test.serial.as_deref().is_some_and(|s| !s.trim().is_empty());
    (!is_named).then(|| "certificate.no_serial".into())
}

/// The page of a test that is passed; of a test of several phases with the rows of each.
pub fn certificate(whole: &Part<'_>, phases: &[Phase<'_>]) -> Page {
    let (record, words) = (whole.record, whole.words);
    let parts: Vec<&Part<'_>> = match phases {
        [] => vec![whole],
        some => some.iter().filter_map(|p| p.part.as_ref()).collect(),
    };
    let mut blocks = vec![Block::Head(head(whole)), Block::Paragraph(statement(record, words))];
    blocks.push(page::identity_section(whole));
    for (number, part) in parts.iter().enumerate() {
        let phase = phases.iter().filter(|p| p.part.is_some()).nth(number);
        blocks.extend(phase.map(|p| Block::heading(p.title(words))));
        blocks.extend(limits::limits(part, &[]));
    }
    let rows: Vec<&Row<'_>> = parts.iter().flat_map(|p| &p.judged).collect();
    blocks.push(Block::section("identity", words.t("certificate.rule"), rule(&rows, words)));
    blocks.extend(Block::remarks(whole.attempt()));
    blocks.extend(evidence::waivers(whole));
    blocks.extend(page::file_table(record, words));
    blocks.push(Block::Hint(words.t("certificate.only_item")));
    blocks.push(Block::SignOff);
    let serial = record.unit_under_test.serial.clone().unwrap_or_default();
    Page {
        title: [words.t("certificate.kind"), serial].join(" · "),
        generator: format!("{} {}", record.program.name, record.program.version),
        footer: page::footer(record, words),
        blocks,
    }
}

fn head(whole: &Part<'_>) -> Head {
    let words = whole.words;
    Head {
        kind: page::kind(whole.record, &whole.title(), words),
        title: words.t("certificate.kind"),
        is_signed: true,
        label: words.t("certificate.label"),
        verdict: State { id: Verdict::Pass.id().to_owned(), word: words.t("certificate.conforms") },
        ..Head::default()
    }
}

/// What is stated of which unit, by which requirements.
fn statement(record: &RunRecord, words: Translator) -> String {
    let procedure = record.procedure.as_ref();
    let limits = procedure.and_then(|p| p.limits.as_ref());
    let named =
        |id: &str, revision: &str| words.with("report.id_revision", &[("id", id), ("revision", revision)]);
    let tested = record.recording.first().and_then(|f| f.start.as_deref());
    let args = [
        ("serial", record.unit_under_test.serial.clone().unwrap_or_default()),
        (
            "limits",
            limits
                .map(|l| format!("{} ({})", words.local(&l.title), named(&l.id, &l.revision)))
                .unwrap_or_default(),
        ),
        ("procedure", procedure.map(|p| named(&p.id, &p.revision)).unwrap_or_default()),
        ("date", date_time(tested.unwrap_or(&record.session.evaluated_at))),
    ];
    let key = if tested.is_some() { "certificate.statement" } else { "certificate.statement_evaluated" };
    words.with(key, &args.each_ref().map(|(name, text)| (*name, text.as_str())))
}

/// The rule by which the rows were decided, what it was applied to, and its risk.
fn rule(rows: &[&Row<'_>], words: Translator) -> Vec<Block> {
    let mut rules: Vec<String> = vec![];
    for rule in rows.iter().map(|row| row.rule(words)) {
        if !rules.contains(&rule) {
            rules.push(rule);
        }
    }
    let risks: Option<Vec<f64>> = rows.iter().map(|row| risk(row)).collect();
    let largest = risks.into_iter().flatten().reduce(f64::max);
    let facts = [
        (
            "certificate.applied_to",
            words.with("certificate.rows", &[("n", &count(rows.len() as u64, words.lang))]),
        ),
        ("certificate.decided_by", rules.join("; ")),
        ("certificate.largest_risk", largest.map(|risk| percent(risk, words.lang)).unwrap_or_default()),
    ];
    vec![Block::identity(facts.map(|(key, value)| (words.t(key), value)))]
}

/// The risk that an accepted row is beyond its limit; that of a bound is what the bound leaves.
fn risk(row: &Row<'_>) -> Option<f64> {
    row.of.specific_risk.or_else(|| row.of.upper_limit.map(|bound| 1.0 - bound.coverage))
}
