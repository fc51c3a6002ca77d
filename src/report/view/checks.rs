//! Checks that were not made, with the reason, and those that were.

use super::part::Part;
use crate::record::{CheckRecord, CheckStatus, RunRecord};
use crate::report::page::{Block, Table, Value};
use crate::report::translator::Translator;

/// The checks that were made, in a sentence, and those that were not, with the reasons.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let (made, unmade) = (made(part.record, words), unmade(part.record, words));
    let made = (!made.is_empty()).then(|| format!("{}: {made}.", words.t("report.checks_made")));
    let table = (!unmade.is_empty()).then(|| {
        let (names, reasons): (Vec<String>, Vec<Value>) =
            unmade.into_iter().map(|(name, reason)| (name, Value::Sentence(reason))).unzip();
        let table = Table::new("", names.len())
            .column(words.column("report.checks_not_made"), names)
            .column(words.column("report.reason"), reasons);
        Block::Table(table)
    });
    let below: Vec<Block> = made.map(Block::Hint).into_iter().chain(table).collect();
    if below.is_empty() { vec![] } else { vec![Block::section("", words.t("report.checks"), below)] }
}

/// Checks not made, those for one reason on several channels together: name with its channels, and the reason.
fn unmade(record: &RunRecord, words: Translator) -> Vec<(String, String)> {
    let mut list: Vec<(&CheckRecord, Vec<&str>)> = Vec::new();
    for check in record.checks.iter().filter(|c| c.status == CheckStatus::NotMade) {
        let same = |(c, _): &&mut (&CheckRecord, Vec<&str>)| {
            c.id == check.id && c.reason == check.reason && c.phase == check.phase
        };
        match list.iter_mut().find(same) {
            Some((_, channels)) => channels.extend(check.channel.as_deref()),
            None => list.push((check, check.channel.as_deref().into_iter().collect())),
        }
    }
    // A channel is named where another one differs.
    let differs = |check: &CheckRecord| {
        record.checks.iter().any(|c| c.id == check.id && c.phase == check.phase && c.reason != check.reason)
    };
    let of = |(check, channels): (&CheckRecord, Vec<&str>)| {
        let mut name = words.name("check_name", &check.id);
        if differs(check) && !channels.is_empty() {
            name = format!("{name} · {}", channels.join(", "));
        }
        if let Some(phase) = &check.phase {
            name = format!("{phase}: {name}");
        }
        (name, check.reason.as_ref().map_or_else(String::new, |r| words.say(r)))
    };
    list.into_iter().map(of).collect()
}

/// Names of the checks that were made on at least one channel.
fn made(record: &RunRecord, words: Translator) -> String {
    let mut names: Vec<String> = Vec::new();
    for check in record.checks.iter().filter(|c| c.status == CheckStatus::Made) {
        let name = words.name("check_name", &check.id);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join("; ")
}
