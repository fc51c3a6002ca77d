//! `index.csv`: one row a unit, plain numbers, empty where there is none; the same in every language.

use super::reasons::reasons;
use crate::estimate::Verdict;
use crate::i18n::Lang;
use crate::output::csv_line;
use crate::record::{ConditionStatus, LotRecord, LotUnit, MeasurandRecord};
use crate::report::translator::Translator;
use std::collections::{BTreeMap, BTreeSet};

/// Columns of every lot; five for each quantity with a limit follow.
const COLUMNS: [&str; 12] = [
    "serial",
    "serial_from",
    "verdict",
    "recording",
    "sha256",
    "folder",
    "limits",
    "limits_met",
    "limits_failed",
    "limits_undecided",
    "conditions_not_met",
    "reasons",
];

/// The table of a lot.
pub fn csv(lot: &LotRecord) -> String {
    let mut quantities: Vec<Quantity<'_>> = vec![];
    let mut seen = BTreeSet::new();
    for m in lot.units.iter().flat_map(|u| &u.measurands) {
        let quantity = Quantity::of(m);
        if seen.insert(quantity) {
            quantities.push(quantity);
        }
    }
    let several = quantities.iter().any(|q| Some(q.channel) != quantities.first().map(|f| f.channel));
    let mut head: Vec<String> = COLUMNS.iter().map(|c| (*c).to_owned()).collect();
    head.extend(quantities.iter().flat_map(|q| q.columns(several)));
    let mut out = csv_line(&head);
    for unit in &lot.units {
        let mut fields = facts(unit);
        // The first row of a quantity is the one that counts.
        let own: BTreeMap<Quantity<'_>, &MeasurandRecord> =
            unit.measurands.iter().rev().map(|m| (Quantity::of(m), m)).collect();
        for q in &quantities {
            fields.extend(values(own.get(q).copied()));
        }
        out.push_str(&csv_line(&fields));
    }
    out
}

/// A quantity that has columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Quantity<'a> {
    id: &'a str,
    channel: &'a str,
    phase: Option<&'a str>,
    unit: &'a str,
}

impl Quantity<'_> {
    fn of(m: &MeasurandRecord) -> Quantity<'_> {
        Quantity { id: &m.id, channel: &m.channel, phase: m.phase.as_deref(), unit: &m.unit }
    }

    fn columns(&self, several_channels: bool) -> Vec<String> {
        let parts = [self.phase, several_channels.then_some(self.channel), Some(self.id), Some(self.unit)];
        let name =
            parts.into_iter().flatten().map(slug).filter(|p| !p.is_empty()).collect::<Vec<_>>().join("_");
        let further = ["low", "high", "upper_limit", "verdict"].map(|ending| format!("{name}_{ending}"));
        std::iter::once(name).chain(further).collect()
    }
}

/// A text as a part of the name of a column.
fn slug(text: &str) -> String {
    let parts = text.split(|c: char| !c.is_alphanumeric()).filter(|p| !p.is_empty());
    parts.collect::<Vec<_>>().join("_")
}

/// What every unit has.
fn facts(unit: &LotUnit) -> Vec<String> {
    let count =
        |verdict: Verdict| unit.measurands.iter().filter(|m| m.verdict == verdict).count().to_string();
    let invalid = unit.conditions.iter().filter(|c| c.status == ConditionStatus::Invalid);
    let hashes: Vec<&str> = unit.files.iter().map(|f| f.sha256.as_str()).collect();
    let recording = unit.recording.clone();
    vec![
        unit.serial().to_owned(),
        unit.serial_from.id().to_owned(),
        unit.verdict.id().to_owned(),
        recording,
        hashes.join(" "),
        unit.folder.clone(),
        unit.measurands.len().to_string(),
        count(Verdict::Pass),
        count(Verdict::Fail),
        count(Verdict::Indeterminate),
        invalid.count().to_string(),
        reasons(unit, Translator { lang: Lang::En }).join(" "),
    ]
}

/// Value, ends of the interval, bound and verdict of a quantity.
fn values(m: Option<&MeasurandRecord>) -> Vec<String> {
    let number = |v: Option<f64>| v.filter(|v| v.is_finite()).map(|v| format!("{v:e}")).unwrap_or_default();
    vec![
        number(m.and_then(|m| m.value)),
        number(m.and_then(|m| Some(m.interval?.low))),
        number(m.and_then(|m| Some(m.interval?.high))),
        number(m.and_then(|m| Some(m.upper_limit?.value))),
        m.map_or_else(String::new, |m| m.verdict.id().to_owned()),
    ]
}
