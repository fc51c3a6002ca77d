//! Which results count for what.

use crate::estimate::{Limits, Verdict};
use crate::record::{HistoryPoint, HistoryQuantity, MeasurandRecord};
use crate::store::{Attempt, ReasonKind};
use std::collections::{BTreeMap, BTreeSet};

/// A result with what it counts for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tested<'a> {
    /// Place among the results, from 0.
    place: usize,
    pub attempt: &'a Attempt,
    /// False where the test was not done as required: aborted, or with a condition that was not met.
    pub is_done: bool,
}

impl Tested<'_> {
    fn of(place: usize, attempt: &Attempt) -> Tested<'_> {
        let entry = &attempt.entry;
        let unmet = entry.reasons.iter().any(|r| matches!(r.kind, ReasonKind::Condition | ReasonKind::Error));
        Tested { place, attempt, is_done: entry.verdict != Verdict::Error && !unmet }
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

/// The row of a quantity in a result.
#[derive(Debug, Clone, Copy)]
struct Row<'a> {
    of: Tested<'a>,
    measurand: &'a MeasurandRecord,
}

/// Results in the order of time, and the rows of each quantity in them: a result may have many.
pub(super) struct Selection<'a> {
    tests: Vec<Tested<'a>>,
    rows: BTreeMap<HistoryQuantity, Vec<Row<'a>>>,
}

/// Results of a selection, by their places in it.
pub(super) struct Group(BTreeSet<usize>);

impl Group {
    pub fn of<'a>(tests: impl IntoIterator<Item = Tested<'a>>) -> Group {
        Group(tests.into_iter().map(|t| t.place).collect())
    }
}

impl<'a> Selection<'a> {
    pub fn of(attempts: &'a [Attempt]) -> Selection<'a> {
        let tests: Vec<Tested<'a>> = attempts.iter().enumerate().map(|(i, a)| Tested::of(i, a)).collect();
        let mut rows: BTreeMap<HistoryQuantity, Vec<Row<'a>>> = BTreeMap::new();
        for of in &tests {
            for measurand in &of.attempt.entry.measurands {
                let rows = rows.entry(quantity(of.attempt, measurand)).or_default();
                // The first row of a quantity is the one that counts.
                if rows.last().is_none_or(|row| row.of.place != of.place) {
                    rows.push(Row { of: *of, measurand });
                }
            }
        }
        Selection { tests, rows }
    }

    pub fn all(&self) -> impl Iterator<Item = Tested<'a>> {
        self.tests.iter().copied()
    }

    /// The rows of a quantity with a value, in some results, in their order.
    fn rows(&self, of: &HistoryQuantity, group: &Group) -> impl Iterator<Item = (Row<'a>, f64)> {
        let rows = self.rows.get(of).into_iter().flatten().copied();
        let in_group = rows.filter(|row| group.0.contains(&row.of.place));
        in_group.filter_map(|row| Some((row, row.measurand.value?)))
    }

    /// The values of a quantity in some results, in their order.
    pub fn points(&self, of: &HistoryQuantity, group: &Group) -> Vec<HistoryPoint> {
        let point = |(row, value): (Row<'a>, f64)| {
            let attempt = row.of.attempt;
            HistoryPoint {
                result: attempt.address.clone(),
                serial: attempt.entry.unit.serial.clone(),
                station: attempt.entry.test.station.clone(),
                evaluated_at: attempt.entry.test.evaluated_at.clone(),
                value,
                interval: row.measurand.interval,
            }
        };
        self.rows(of, group).map(point).collect()
    }

    /// The limits of a quantity in some results. `Err` where they differ, `Ok(None)` where there are none.
    pub fn limit(&self, of: &HistoryQuantity, group: &Group) -> Result<Option<Limits>, ()> {
        let mut found: Option<Limits> = None;
        for (row, _) in self.rows(of, group) {
            let limit = row.measurand.limits();
            match found {
                Some(other) if other != limit => return Err(()),
                _ => found = Some(limit),
            }
        }
        Ok(found.filter(|l| !l.is_empty()))
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
        let of = |keep: &dyn Fn(&MeasurandRecord) -> bool| -> Vec<HistoryQuantity> {
            let (mut found, mut seen) = (vec![], BTreeSet::new());
            for t in self.all().filter(Tested::counts) {
                for m in t.attempt.entry.measurands.iter().filter(|m| m.value.is_some() && keep(m)) {
                    let quantity = quantity(t.attempt, m);
                    if seen.insert(quantity.clone()) {
                        found.push(quantity);
                    }
                }
            }
            found
        };
        match asked {
            Some(id) => of(&|m| m.id == id),
            None => {
                let limited = of(&|m| m.limit.is_some());
                if limited.is_empty() { of(&|_| true) } else { limited }
            }
        }
    }
}

/// The quantity of a row.
fn quantity(attempt: &Attempt, m: &MeasurandRecord) -> HistoryQuantity {
    HistoryQuantity {
        procedure: attempt.entry.test.procedure.clone(),
        measurand: m.id.clone(),
        channel: m.channel.clone(),
        phase: m.phase.clone(),
        unit: m.unit.clone(),
    }
}
