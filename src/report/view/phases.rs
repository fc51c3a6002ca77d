//! Parts of a page that a test of several phases has: what came of each phase, and how its conditions were met.

use super::conditions;
use super::part::{Part, Phase};
use crate::record::PhaseRecord;
use crate::report::page::{Block, Link, Reasons, Table, Value};
use crate::report::translator::Translator;

/// The phases with their procedures, recordings and verdicts.
pub fn overview(phases: &[Phase<'_>], words: Translator) -> Vec<Block> {
    if phases.is_empty() {
        return vec![];
    }
    let verdict = |p: &Phase<'_>| Value::state(p.phase.verdict.id(), words.verdict(p.phase.verdict));
    let table = Table::new("cards", phases.len())
        .column(words.column("phases.phase"), phases.iter().map(|p| p.title(words)))
        .column(words.column("report.procedure"), phases.iter().map(|p| procedure(p.phase, words)))
        .column(words.column("report.recording"), phases.iter().map(|p| recordings(p.phase)))
        .column(words.column("report.verdict"), phases.iter().map(verdict));
    vec![Block::section("", words.t("phases.title"), vec![Block::Table(table)])]
}

/// How many conditions of each phase were met, and which ones were not.
pub fn conditions_met(phases: &[Phase<'_>], words: Translator) -> Vec<Block> {
    let (met, open): (Vec<String>, Vec<Value>) = phases
        .iter()
        .map(|p| p.part.as_ref().map_or_else(Default::default, |part| met_and_open(part, words)))
        .unzip();
    let table = Table::new("conditions cards", phases.len())
        .column(words.column("phases.phase"), phases.iter().map(|p| p.title(words)))
        .column(words.column("report.recording"), phases.iter().map(|p| recordings(p.phase)))
        .column(words.column("phases.conditions_met"), met)
        .column(words.column("phases.conditions_open"), open);
    vec![Block::section("", words.t("report.conditions"), vec![Block::Table(table)])]
}

fn met_and_open(part: &Part<'_>, words: Translator) -> (String, Value) {
    let all = conditions::all(part.record, words);
    let open: Vec<Value> = all
        .iter()
        .filter(|c| c.status != "ok")
        .map(|c| {
            let name = Value::state(c.status, c.name.as_str());
            let found = (!c.found.is_empty()).then(|| Value::Text(format!("({})", c.found)));
            Value::Several { values: std::iter::once(name).chain(found).collect(), between: " " }
        })
        .collect();
    let met = (all.len() - open.len()).to_string();
    let met = words.with("terminal.met", &[("met", &met), ("all", &all.len().to_string())]);
    (met, Value::Several { values: open, between: "; " })
}

/// The verdict on a phase with its reasons, and the way to its own report.
pub fn head(phase: &Phase<'_>, words: Translator) -> Vec<Block> {
    let verdict = phase.phase.verdict;
    let title = phase.title(words);
    let heading =
        format!("{} {}: {title} · {}", words.t("phases.phase"), phase.number, words.verdict(verdict));
    let reasons = Block::Reasons(Reasons {
        class: "phase reasons",
        id: verdict.id().to_owned(),
        mark: phase.mark(),
        heading,
        sentences: phase.summary(words),
    });
    let link = phase.phase.folder.as_ref().map(|folder| {
        let to = format!("{folder}/report");
        Block::Link(Link { words: String::new(), text: words.t("phases.own_report"), to })
    });
    std::iter::once(reasons).chain(link).collect()
}

/// Procedure and limits, with their revisions.
fn procedure(phase: &PhaseRecord, words: Translator) -> String {
    let revision =
        |id: &str, revision: &str| words.with("report.id_revision", &[("id", id), ("revision", revision)]);
    let Some(p) = &phase.procedure else { return String::new() };
    let limits = p.limits.as_ref().map(|l| revision(&l.id, &l.revision));
    std::iter::once(revision(&p.id, &p.revision)).chain(limits).collect::<Vec<_>>().join("; ")
}

fn recordings(phase: &PhaseRecord) -> String {
    phase.recording.iter().map(|f| f.path.as_str()).collect::<Vec<_>>().join(", ")
}
