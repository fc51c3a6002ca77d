//! Which results count for what.

use crate::estimate::Verdict;
use crate::record::{HistoryLimit, HistoryPoint, HistoryQuantity};
use crate::store::{Attempt, EntryMeasurand, ReasonKind};
use std::collections::{BTreeMap, BTreeSet};

/// A result with what it counts for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tested<'a> {
    pub attempt: &'a Attempt,
    /// False where the test was not done as required: aborted, or with a condition that was not met.
    pub is_done: bool,
}

impl Tested<'_> {
    fn of(attempt: &Attempt) -> Tested<'_> {
        let entry = &attempt.entry;
        let unmet = entry.reasons.iter().any(|r| matches!(r.kind, ReasonKind::Condition | ReasonKind::Error));
        Tested { attempt, is_done: entry.verdict != Verdict::Error && !unmet }
    }

    /// True where the result itself counts.
    pub fn counts(&self) -> bool {
        self.is_done && self.attempt.superseded.is_none()
    }

    pub fn is_reference(&self) -> bool {
        self.attempt.entry.unit.reference
    }

    pub fn passes(&self) -> bool {
        self.attempt.entry.verdict == Verdict::Pass
    }

    /// What tells tests of one unit by one procedure from others.
    pub fn test(&self) -> (String, String) {
        (self.attempt.entry.unit.key(), self.attempt.entry.test.procedure.clone())
    }
}

/// Results in the order of time.
pub(super) struct Selection<'a>(Vec<Tested<'a>>);

impl<'a> Selection<'a> {
    pub fn of(attempts: &'a [Attempt]) -> Selection<'a> {
        Selection(attempts.iter().map(Tested::of).collect())
    }

    pub fn all(&self) -> impl Iterator<Item = Tested<'a>> {
        self.0.iter().copied()
    }

    /// Results that count, of units that are products.
    pub fn products(&self) -> impl Iterator<Item = Tested<'a>> {
        self.all().filter(|t| t.counts() && !t.is_reference() && !t.attempt.entry.unit.serial.is_empty())
    }

    /// Results that count, of reference units.
    pub fn references(&self) -> impl Iterator<Item = Tested<'a>> {
        self.all().filter(|t| t.counts() && t.is_reference())
    }

    /// Tests of which the store lacks attempts that later ones name: which of them was the first, or failed, cannot be told.
    pub fn incomplete(&self) -> BTreeSet<(String, String)> {
        self.all().filter(|t| !t.attempt.missing.is_empty()).map(|t| t.test()).collect()
    }

    /// The first result that counts, of each product by each procedure, in the order of time.
    pub fn first_of_each(&self) -> Vec<Tested<'a>> {
        let mut seen = BTreeSet::new();
        self.products().filter(|t| seen.insert(t.test())).collect()
    }

    /// The last result that counts, of each product by each procedure.
    pub fn last_of_each(&self) -> Vec<Tested<'a>> {
        let last: BTreeMap<_, _> = self.products().map(|t| (t.test(), t)).collect();
        last.into_values().collect()
    }

    /// The quantities of results that count: the one that is asked for, or those with a limit, or else all.
    pub fn quantities(&self, asked: Option<&str>) -> Vec<HistoryQuantity> {
        let of = |keep: &dyn Fn(&EntryMeasurand) -> bool| -> Vec<HistoryQuantity> {
            let mut found: Vec<HistoryQuantity> = vec![];
            for t in self.all().filter(Tested::counts) {
                for m in t.attempt.entry.measurands.iter().filter(|m| m.value.is_some() && keep(m)) {
                    let quantity = quantity(t.attempt, m);
                    if !found.contains(&quantity) {
                        found.push(quantity);
                    }
                }
            }
            found
        };
        match asked {
            Some(id) => of(&|m| m.id == id),
            None => {
                let limited = of(&|m| m.min.is_some() || m.max.is_some());
                if limited.is_empty() { of(&|_| true) } else { limited }
            }
        }
    }
}

/// The quantity of a row.
fn quantity(attempt: &Attempt, m: &EntryMeasurand) -> HistoryQuantity {
    HistoryQuantity {
        procedure: attempt.entry.test.procedure.clone(),
        measurand: m.id.clone(),
        channel: m.channel.clone(),
        phase: m.phase.clone(),
        unit: m.unit.clone(),
    }
}

/// The row of a quantity in a result; `None` where it has no value.
fn row<'a>(attempt: &'a Attempt, of: &HistoryQuantity) -> Option<(&'a EntryMeasurand, f64)> {
    if attempt.entry.test.procedure != of.procedure {
        return None;
    }
    let is_it = |m: &&EntryMeasurand| {
        m.id == of.measurand && m.channel == of.channel && m.phase == of.phase && m.unit == of.unit
    };
    let row = attempt.entry.measurands.iter().find(is_it)?;
    Some((row, row.value?))
}

/// The values of a quantity in some results, in their order.
pub(super) fn points<'a>(
    results: impl Iterator<Item = Tested<'a>>,
    of: &HistoryQuantity,
) -> Vec<HistoryPoint> {
    let point = |t: Tested<'_>| {
        let (row, value) = row(t.attempt, of)?;
        Some(HistoryPoint {
            result: t.attempt.address.clone(),
            serial: t.attempt.entry.unit.serial.clone(),
            station: t.attempt.entry.test.station.clone(),
            evaluated_at: t.attempt.entry.test.evaluated_at.clone(),
            value,
            interval: row.interval,
        })
    };
    results.filter_map(point).collect()
}

/// The limits of a quantity in some results. `Err` where they differ, `Ok(None)` where there are none.
pub(super) fn limit<'a>(
    results: impl Iterator<Item = Tested<'a>>,
    of: &HistoryQuantity,
) -> Result<Option<HistoryLimit>, ()> {
    let mut found: Option<HistoryLimit> = None;
    for t in results {
        let Some((row, _)) = row(t.attempt, of) else { continue };
        let limit = HistoryLimit { min: row.min, max: row.max };
        match found {
            Some(other) if other != limit => return Err(()),
            _ => found = Some(limit),
        }
    }
    Ok(found.filter(|l| l.min.is_some() || l.max.is_some()))
}
