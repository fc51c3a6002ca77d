//! Checks that were not made, with the reason, and those that were.

use crate::record::{CheckRecord, CheckStatus, RunRecord};
use crate::report::translator::Translator;
use serde::Serialize;

/// A check that was not made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unmade {
    /// Name, with its channels.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// Checks not made, those for one reason on several channels together.
pub fn unmade(record: &RunRecord, words: Translator) -> Vec<Unmade> {
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
        Unmade { name, reason: check.reason.as_ref().map_or_else(String::new, |r| words.say(r)) }
    };
    list.into_iter().map(of).collect()
}

/// Names of the checks that were made on at least one channel.
pub fn made(record: &RunRecord, words: Translator) -> String {
    let mut names: Vec<String> = Vec::new();
    for check in record.checks.iter().filter(|c| c.status == CheckStatus::Made) {
        let name = words.name("check_name", &check.id);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join("; ")
}
