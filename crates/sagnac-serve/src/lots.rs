//! Units by quantities: the tests of a lot, a day or a procedure, with the share that passed at the first attempt.

use crate::harness::{Outcome, Quantity};
use crate::queue::Job;
use crate::texts::Lang;
use sagnac_base::estimate::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Most units on a page.
pub const MAX_UNITS: usize = 500;

/// What is selected.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default)]
pub struct Selection {
    /// Lot; empty for all.
    pub lot: String,
    /// Day of the end by UTC; empty for all.
    pub day: String,
    /// Procedure; empty for all.
    pub procedure: String,
    /// Verdict; empty for all.
    pub verdict: String,
}

impl Selection {
    fn has(&self, job: &Job, outcome: &Outcome) -> bool {
        let is = |wanted: &str, found: &str| wanted.is_empty() || wanted == found;
        let lot = job.order.test.lot.as_deref().or(outcome.lot.as_deref()).unwrap_or_default();
        is(&self.lot, lot) && is(&self.day, job.day()) && is(&self.procedure, &outcome.procedure)
    }
}

/// A unit by a procedure.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Serial number.
    pub serial: String,
    /// Procedure.
    pub procedure: String,
    /// Attempts in the selection.
    pub attempts: usize,
    /// Verdict of the last attempt.
    pub verdict: Verdict,
    /// Id of the last attempt.
    pub run: String,
    /// Cells in the order of the columns; `None` for a quantity that the procedure does not have.
    pub cells: Vec<Option<Cell>>,
}

/// A quantity of a unit.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    /// Value with its unit.
    pub value: String,
    /// Limit with its unit.
    pub limit: String,
    /// Verdict.
    pub verdict: Verdict,
}

/// Units by quantities.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Matrix {
    /// Names of the quantities.
    pub columns: Vec<String>,
    /// The units, in the order of their first attempt.
    pub rows: Vec<Row>,
    /// Units by procedures in the selection, whatever the verdict.
    pub units: usize,
    /// Of them, those that passed at the first attempt.
    pub passed_first: usize,
    /// Of them, those whose last attempt passed.
    pub passed: usize,
    /// Lots, days and procedures that can be selected.
    pub lots: BTreeSet<String>,
    /// Days.
    pub days: BTreeSet<String>,
    /// Procedures.
    pub procedures: BTreeSet<String>,
}

impl Matrix {
    /// The matrix of a selection, from the tests in their order.
    pub fn of<'j>(jobs: impl Iterator<Item = &'j Job>, selection: &Selection, lang: Lang) -> Matrix {
        let mut matrix = Matrix::default();
        let mut attempts: BTreeMap<(&str, &str), Vec<(&Job, &Outcome)>> = BTreeMap::new();
        let mut order = vec![];
        for job in jobs {
            let Some(outcome) = job.outcome() else { continue };
            let lot = job.order.test.lot.as_ref().or(outcome.lot.as_ref());
            matrix.lots.extend(lot.cloned());
            matrix.days.insert(job.day().to_owned());
            matrix.procedures.insert(outcome.procedure.clone());
            if selection.has(job, outcome) {
                let key = (job.order.test.serial.as_str(), outcome.procedure.as_str());
                let of_unit = attempts.entry(key).or_default();
                if of_unit.is_empty() {
                    order.push(key);
                }
                of_unit.push((job, outcome));
            }
        }
        let mut columns: Vec<(&str, &Quantity)> = vec![];
        let mut shown = vec![];
        for key in order {
            let Some(of_unit) = attempts.get(&key) else { continue };
            let (Some((_, first)), Some((last, outcome))) = (of_unit.first(), of_unit.last()) else {
                continue;
            };
            matrix.units += 1;
            matrix.passed_first += usize::from(first.verdict == Verdict::Pass);
            matrix.passed += usize::from(outcome.verdict == Verdict::Pass);
            let is_wanted = selection.verdict.is_empty() || selection.verdict == outcome.verdict.id();
            if !is_wanted || shown.len() == MAX_UNITS {
                continue;
            }
            for quantity in &outcome.quantities {
                if !columns.iter().any(|(id, _)| *id == quantity.id) {
                    columns.push((&quantity.id, quantity));
                }
            }
            shown.push((key, of_unit.len(), *last, *outcome));
        }
        matrix.rows = shown
            .into_iter()
            .map(|((serial, procedure), attempts, job, outcome)| Row {
                serial: serial.to_owned(),
                procedure: procedure.to_owned(),
                attempts,
                verdict: outcome.verdict,
                run: job.order.id.clone(),
                cells: columns.iter().map(|(id, _)| cell(outcome, id, lang)).collect(),
            })
            .collect();
        matrix.columns = columns.into_iter().map(|(_, quantity)| quantity.name.of(lang).to_owned()).collect();
        matrix
    }

    /// Share of units that passed at the first attempt, per cent; `None` without units.
    pub fn first_pass_yield(&self) -> Option<f64> {
        (self.units > 0).then(|| 100.0 * self.passed_first as f64 / self.units as f64)
    }
}

fn cell(outcome: &Outcome, id: &str, lang: Lang) -> Option<Cell> {
    let quantity = outcome.quantities.iter().find(|quantity| quantity.id == id)?;
    Some(Cell {
        value: quantity.value.of(lang).to_owned(),
        limit: quantity.limit.of(lang).to_owned(),
        verdict: quantity.verdict,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::{LocalText, Next};
    use crate::order::{End, Test};
    use crate::queue::Queue;
    use chrono::{DateTime, TimeDelta};

    fn outcome(verdict: Verdict, quantities: &[&str]) -> Outcome {
        let text = |text: &str| LocalText { en: text.to_owned(), ru: text.to_owned() };
        let quantity = |id: &&str| Quantity {
            id: (*id).to_owned(),
            name: text(id),
            value: text("1"),
            limit: text("2"),
            verdict,
        };
        Outcome {
            verdict,
            procedure: "static".to_owned(),
            lot: None,
            reasons: vec![],
            next: Next::HandOn,
            quantities: quantities.iter().map(quantity).collect(),
        }
    }

    #[test]
    fn a_unit_counts_once_and_its_first_attempt_decides_the_yield() {
        let folder = tempfile::tempdir().unwrap();
        let queue = Queue::open(&folder.path().join("q")).unwrap();
        let day = |days: i64| DateTime::UNIX_EPOCH + TimeDelta::days(days);
        let tests = [
            ("A", "L1", Verdict::Fail, 0, "n"),
            ("B", "L1", Verdict::Pass, 0, "n"),
            ("A", "L1", Verdict::Pass, 1, "n"),
            ("C", "L2", Verdict::Pass, 1, "b"),
        ];
        for (serial, lot, verdict, days, quantity) in tests {
            let test = Test { serial: serial.to_owned(), lot: Some(lot.to_owned()), ..Test::default() };
            let job = queue.order(test, day(days)).unwrap();
            queue.end(&job.order.id, End::Done(outcome(verdict, &[quantity])), day(days)).unwrap();
        }
        let of = |selection: &Selection| queue.read(|jobs| Matrix::of(jobs, selection, Lang::En));
        let all = of(&Selection::default());
        assert_eq!((all.units, all.passed_first, all.passed), (3, 2, 3));
        assert_eq!(all.columns, ["n", "b"]);
        let serials: Vec<&str> = all.rows.iter().map(|row| row.serial.as_str()).collect();
        assert_eq!((serials, all.rows[0].attempts), (vec!["A", "B", "C"], 2));
        assert!(all.rows[2].cells[0].is_none() && all.rows[2].cells[1].is_some());
        assert!((all.first_pass_yield().unwrap() - 200.0 / 3.0).abs() < 1e-9);
        let first_day = of(&Selection { day: "1970-01-01".to_owned(), ..Selection::default() });
        assert_eq!(
            (first_day.units, first_day.passed_first, first_day.rows[0].verdict),
            (2, 1, Verdict::Fail)
        );
        let lot = of(&Selection { lot: "L2".to_owned(), ..Selection::default() });
        assert_eq!((lot.units, lot.lots.len()), (1, 2));
        let failed = of(&Selection { verdict: "fail".to_owned(), ..Selection::default() });
        assert_eq!((failed.units, failed.rows.len()), (3, 0));
        assert_eq!(
            of(&Selection { lot: "none".to_owned(), ..Selection::default() }).first_pass_yield(),
            None
        );
    }
}
