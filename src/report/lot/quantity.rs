//! The quantities with a limit, each over all units of a lot.

use crate::estimate::Verdict;
use crate::record::{LotUnit, MeasurandRecord};
use crate::report::page::{Column, Quantity, Table, Value};
use crate::report::translator::Translator;
use crate::report::view::{limit_text, rounding};
use std::collections::{BTreeMap, BTreeSet};

/// What tells one quantity from another: phase, channel, id of the measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key<'a> {
    phase: Option<&'a str>,
    pub(super) channel: &'a str,
    id: &'a str,
}

impl Key<'_> {
    pub(super) fn of(m: &MeasurandRecord) -> Key<'_> {
        Key { phase: m.phase.as_deref(), channel: &m.channel, id: &m.id }
    }
}

/// The quantities in the order in which they first appear, and whether they are of several channels.
pub(super) fn distinct<K: Ord + Copy>(of: impl Iterator<Item = K>) -> Vec<K> {
    let mut seen = BTreeSet::new();
    of.filter(|k| seen.insert(*k)).collect()
}

pub(super) fn several<'a>(mut channels: impl Iterator<Item = &'a str>) -> bool {
    let first = channels.next();
    channels.any(|c| Some(c) != first)
}

/// The quantities, a row each: the limit, the smallest and the largest value, and the units that do not meet it.
pub(super) fn table(units: &[LotUnit], words: Translator) -> Table {
    let keys = distinct(units.iter().flat_map(|u| &u.measurands).map(Key::of));
    let several = several(keys.iter().map(|k| k.channel));
    let over: Vec<OverUnits<'_>> = keys.iter().map(|k| OverUnits::new(*k, units)).collect();
    Table::new("units small cards", keys.len())
        .column(words.column("report.quantity"), keys.iter().map(|k| name(*k, several, words)))
        .column(words.number_column("report.limit"), over.iter().map(|o| o.limit(words)))
        .column(words.number_column("lot.smallest"), over.iter().map(|o| o.smallest(words)))
        .column(words.number_column("lot.largest"), over.iter().map(|o| o.largest(words)))
        .column(words.number_column("lot.units"), over.iter().map(|o| o.met(words)))
        .column(words.column("lot.failed"), over.iter().map(|o| o.serials(Verdict::Fail)))
        .column(words.column("lot.undecided"), over.iter().map(|o| o.serials(Verdict::Indeterminate)))
}

pub(super) fn name(key: Key<'_>, several_channels: bool, words: Translator) -> String {
    let parts = [Some(words.name("measurand", key.id)), key.phase.map(str::to_owned)];
    let channel = several_channels.then(|| words.channel(key.channel, key.id));
    parts.into_iter().flatten().chain(channel).collect::<Vec<_>>().join(" · ")
}

/// A quantity of all units: serial number and row.
struct OverUnits<'a>(Vec<(&'a str, &'a MeasurandRecord)>);

impl<'a> OverUnits<'a> {
    fn new(key: Key<'_>, units: &'a [LotUnit]) -> OverUnits<'a> {
        let rows = |u: &'a LotUnit| {
            let own = u.measurands.iter().filter(move |m| Key::of(m) == key);
            own.map(|m| (u.serial(), m)).collect::<Vec<_>>()
        };
        OverUnits(units.iter().flat_map(rows).collect())
    }

    /// Limit with its unit; empty where the units have different ones.
    fn limit(&self, words: Translator) -> String {
        let limits: Vec<String> = self.0.iter().map(|(_, m)| limit_text(m, words)).collect();
        let is_same = limits.iter().all(|l| Some(l) == limits.first());
        limits.into_iter().next().filter(|_| is_same).unwrap_or_default()
    }

    fn smallest(&self, words: Translator) -> Value {
        self.valued().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(Value::Empty, |(m, v)| shown(m, v, words))
    }

    fn largest(&self, words: Translator) -> Value {
        self.valued().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(Value::Empty, |(m, v)| shown(m, v, words))
    }

    fn valued(&self) -> impl Iterator<Item = (&'a MeasurandRecord, f64)> {
        self.0.iter().filter_map(|(_, m)| Some((*m, m.value?)))
    }

    /// How many units meet the limit, in words.
    fn met(&self, words: Translator) -> String {
        let met = self.0.iter().filter(|(_, m)| m.verdict == Verdict::Pass).count().to_string();
        words.with("terminal.met", &[("met", &met), ("all", &self.0.len().to_string())])
    }

    /// Serial numbers of the units with a verdict.
    fn serials(&self, verdict: Verdict) -> String {
        let with = self.0.iter().filter(|(_, m)| m.verdict == verdict).map(|(serial, _)| *serial);
        with.collect::<Vec<_>>().join(", ")
    }
}

pub(super) fn shown(m: &MeasurandRecord, value: f64, words: Translator) -> Value {
    let printed = rounding(m).show(value, words.lang);
    Value::Quantity(Quantity { number: Some(value), printed, unit: words.unit(&m.unit) })
}

/// The table of the units with five columns for each quantity: value, ends of the interval, bound and verdict.
pub(super) fn with_values(table: Table, units: &[&LotUnit]) -> Table {
    let of = |m: &'_ MeasurandRecord| (m.phase.clone(), m.channel.clone(), m.id.clone(), m.unit.clone());
    let mut seen = BTreeSet::new();
    let rows = units.iter().flat_map(|u| &u.measurands);
    let quantities: Vec<&MeasurandRecord> = rows.filter(|m| seen.insert(of(m))).collect();
    let several = several(quantities.iter().map(|m| m.channel.as_str()));
    // The first row of a quantity is the one that counts.
    let own: Vec<BTreeMap<_, &MeasurandRecord>> =
        units.iter().map(|u| u.measurands.iter().rev().map(|m| (of(m), m)).collect()).collect();
    quantities.iter().fold(table, |table, quantity| {
        let key = of(quantity);
        let found: Vec<Option<&MeasurandRecord>> = own.iter().map(|u| u.get(&key).copied()).collect();
        let number = |of: fn(&MeasurandRecord) -> Option<f64>| {
            found.iter().map(move |m| m.and_then(of)).collect::<Vec<Option<f64>>>()
        };
        let name = column_name(quantity, several);
        let column = |ending: &str| Column::number(format!("{name}{ending}"), "");
        table
            .column(column(""), number(|m| m.value))
            .column(column("_low"), number(|m| Some(m.interval?.low)))
            .column(column("_high"), number(|m| Some(m.interval?.high)))
            .column(column("_upper_limit"), number(|m| Some(m.upper_limit?.value)))
            .column(column("_verdict"), found.iter().map(|m| m.map_or("", |m| m.verdict.id())))
    })
}

fn column_name(m: &MeasurandRecord, several_channels: bool) -> String {
    let parts =
        [m.phase.as_deref(), several_channels.then_some(m.channel.as_str()), Some(&m.id), Some(&m.unit)];
    parts.into_iter().flatten().map(slug).filter(|p| !p.is_empty()).collect::<Vec<_>>().join("_")
}

/// A text as a part of the name of a column.
fn slug(text: &str) -> String {
    let parts = text.split(|c: char| !c.is_alphanumeric()).filter(|p| !p.is_empty());
    parts.collect::<Vec<_>>().join("_")
}
