//! A quantity over all units of a lot.

use crate::estimate::Verdict;
use crate::record::{LotUnit, MeasurandRecord};
use crate::report::translator::Translator;
use crate::report::view::{limit_text, rounding};
use serde::Serialize;

/// A quantity that has a limit, over all units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityView {
    /// Name, with its phase and channel where there are several.
    pub name: String,
    /// Limit with its unit; empty where the units have different ones.
    pub limit: String,
    /// How many units meet it, in words.
    pub met: String,
    /// Smallest value with its unit; empty where no unit has a value.
    pub smallest: String,
    /// Largest value with its unit.
    pub largest: String,
    /// Serial numbers of the units that fail.
    pub failed: Vec<String>,
    /// Serial numbers of the units that are undecided.
    pub undecided: Vec<String>,
}

/// What tells one quantity from another.
type Key<'a> = (Option<&'a str>, &'a str, &'a str);

fn key(m: &MeasurandRecord) -> Key<'_> {
    (m.phase.as_deref(), m.channel.as_str(), m.id.as_str())
}

/// The quantities in the order in which they first appear.
pub(super) fn quantities(units: &[LotUnit], words: Translator) -> Vec<QuantityView> {
    let mut keys: Vec<Key<'_>> = vec![];
    for m in units.iter().flat_map(|u| &u.measurands) {
        if !keys.contains(&key(m)) {
            keys.push(key(m));
        }
    }
    let several = keys.iter().any(|k| Some(k.1) != keys.first().map(|f| f.1));
    keys.into_iter().map(|k| quantity(k, units, several, words)).collect()
}

fn quantity(of: Key<'_>, units: &[LotUnit], several_channels: bool, words: Translator) -> QuantityView {
    let rows: Vec<(&str, &MeasurandRecord)> = units
        .iter()
        .flat_map(|u| u.measurands.iter().filter(|m| key(m) == of).map(|m| (u.serial(), m)))
        .collect();
    let serials = |verdict: Verdict| -> Vec<String> {
        rows.iter().filter(|(_, m)| m.verdict == verdict).map(|(serial, _)| (*serial).to_owned()).collect()
    };
    let met = rows.iter().filter(|(_, m)| m.verdict == Verdict::Pass).count().to_string();
    let shown = |m: &MeasurandRecord| {
        words.quantity(&rounding(m).show(m.value.unwrap_or_default(), words.lang), &m.unit)
    };
    let valued = || rows.iter().map(|(_, m)| *m).filter(|m| m.value.is_some());
    let by_value = |a: &&MeasurandRecord, b: &&MeasurandRecord| {
        a.value.unwrap_or_default().total_cmp(&b.value.unwrap_or_default())
    };
    let limits: Vec<String> = rows.iter().map(|(_, m)| limit_text(m, words)).collect();
    let same = limits.iter().all(|l| Some(l) == limits.first());
    let (phase, channel, id) = of;
    let parts = [Some(words.name("measurand", id)), phase.map(str::to_owned)];
    let parts = parts.into_iter().flatten().chain(several_channels.then(|| words.channel(channel, id)));
    QuantityView {
        name: parts.collect::<Vec<_>>().join(" · "),
        limit: limits.first().filter(|_| same).cloned().unwrap_or_default(),
        met: words.with("terminal.met", &[("met", &met), ("all", &rows.len().to_string())]),
        smallest: valued().min_by(by_value).map_or_else(String::new, shown),
        largest: valued().max_by(by_value).map_or_else(String::new, shown),
        failed: serials(Verdict::Fail),
        undecided: serials(Verdict::Indeterminate),
    }
}
