//! Worst errors by estimator and record.

use std::collections::BTreeMap;

/// Part of the range of a record below which a figure is measured against the range and not against itself: an
/// Allan deviation that is zero by cancellation can only be known to the rounding of what cancelled.
pub const FLOOR: f64 = 1e-3;

/// Largest error of a figure that is let pass.
pub const ALLOWED: f64 = 1e-9;

/// Worst errors seen.
#[derive(Default)]
pub struct Worst {
    table: BTreeMap<(&'static str, &'static str), f64>,
    wrong: Vec<String>,
}

impl Worst {
    /// Compares a figure with its reference. `scale` is the size below which it cannot be known.
    pub fn compare(
        &mut self,
        estimator: &'static str,
        record: &'static str,
        what: &str,
        got: f64,
        reference: f64,
        scale: f64,
    ) {
        let size = reference.abs().max(FLOOR * scale);
        let error = if got == reference { 0.0 } else { (got - reference).abs() / size };
        let worst = self.table.entry((estimator, record)).or_default();
        *worst = if error.is_nan() { f64::INFINITY } else { worst.max(error) };
        if error.is_nan() || error > ALLOWED {
            self.wrong.push(format!("{estimator}, {record}, {what}: {got:e}, reference {reference:e}"));
        }
    }

    /// The table, one line an estimator: worst record and its error.
    pub fn print(&self) {
        let mut by_estimator: BTreeMap<&str, Vec<(&str, f64)>> = BTreeMap::new();
        for ((estimator, record), error) in &self.table {
            by_estimator.entry(estimator).or_default().push((record, *error));
        }
        for (estimator, mut records) in by_estimator {
            records.sort_by(|a, b| b.1.total_cmp(&a.1));
            let shown: Vec<String> = records.iter().take(3).map(|(r, e)| format!("{e:.1e} {r}")).collect();
            println!("| {estimator} | {} records | {} |", records.len(), shown.join("; "));
        }
    }

    /// Fails with everything that was wrong.
    pub fn assert_none_wrong(&self) {
        let shown: Vec<&String> = self.wrong.iter().take(60).collect();
        assert!(self.wrong.is_empty(), "{} figures wrong:\n{shown:#?}", self.wrong.len());
    }
}
