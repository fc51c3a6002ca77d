//! What a series of switching off and on, and a comparison without and with an influence, must have been.

use super::record;
use crate::influence::repeatability::factors;
use crate::record::{ConditionRecord, ConditionStatus};
use crate::text::{Arg, Note};

/// What was found of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFacts {
    /// Runs that were evaluated.
    pub found: usize,
    /// Runs that there must be.
    pub fewest: usize,
    /// Runs that were too short.
    pub too_short: usize,
    /// Least length, s.
    pub minimum_run_s: f64,
}

/// Judges whether there were runs enough.
pub fn judge_runs(facts: &RunFacts) -> ConditionRecord {
    let enough = facts.found >= facts.fewest;
    let key = match (enough, facts.found) {
        (true, _) => "runs.enough",
        (false, 0) => "runs.none",
        (false, 1) => "runs.one",
        (false, _) => "runs.too_few",
    };
    let (low, high) = factors(facts.found);
    let note = Note::new(key)
        .with("n", facts.found)
        .with("short", facts.too_short)
        .with("least", Arg::figures(facts.minimum_run_s, 3))
        .with("low", Arg::figures(low, 2))
        .with("high", Arg::figures(high, 3));
    let status = match (enough, facts.too_short) {
        (true, 0) => ConditionStatus::Ok,
        (true, _) => ConditionStatus::Remark,
        _ => ConditionStatus::Invalid,
    };
    let required = Note::new("runs.required").with("n", facts.fewest);
    record("runs", status, &[("runs", facts.found as f64)], Some(required), note)
}

/// What was found of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedFacts {
    /// Intervals that were evaluated.
    pub found: usize,
    /// Those with the influence.
    pub with: usize,
    /// Intervals with the influence that stand between two without.
    pub alternations: usize,
    /// How many of these there must be.
    pub asked: usize,
    /// Stretches that were too short.
    pub too_short: usize,
    /// Stated intervals that the recording does not hold.
    pub missing: usize,
    /// Least length, s.
    pub minimum_interval_s: f64,
    /// True when the intervals were found from channels.
    pub recorded: bool,
    /// How much warmer it was with the influence, degC; `None` without a thermometer.
    pub temperature: Option<f64>,
    /// How much is allowed, degC.
    pub allowed_deg_c: f64,
    /// Probability of levels so far off the line.
    pub line: Option<f64>,
    /// True when the line is one over the square of the level.
    pub squared: bool,
}

/// Probability below which levels are said to be off the line.
const OFF_THE_LINE: f64 = 0.01;

/// Judges a comparison.
pub fn judge_compared(facts: &ComparedFacts) -> Vec<ConditionRecord> {
    let mut all = vec![intervals(facts), temperature(facts)];
    if let Some(p) = facts.line {
        let (status, key) = match (p < OFF_THE_LINE, facts.squared) {
            (false, _) => (ConditionStatus::Ok, "compared.on_line"),
            (true, false) => (ConditionStatus::Remark, "compared.off_line"),
            (true, true) => (ConditionStatus::Remark, "compared.off_square"),
        };
        let note = Note::new(key).with("probability", Arg::figures(100.0 * p, 2));
        all.push(record("influence_line", status, &[("probability", p)], None, note));
    }
    all
}

fn intervals(facts: &ComparedFacts) -> ConditionRecord {
    let without = facts.found - facts.with;
    let (status, key) = if facts.missing > 0 {
        (ConditionStatus::Invalid, "compared.missing")
    } else if facts.found == 0 {
        (ConditionStatus::Invalid, "compared.none")
    } else if facts.with == 0 {
        let key = if facts.recorded { "compared.never_on" } else { "compared.never_stated" };
        (ConditionStatus::Invalid, key)
    } else if without == 0 {
        (ConditionStatus::Invalid, "compared.never_off")
    } else if facts.alternations == 0 {
        (ConditionStatus::Invalid, "compared.no_return")
    } else if facts.alternations < facts.asked {
        (ConditionStatus::Invalid, "compared.too_few")
    } else {
        (ConditionStatus::Ok, "compared.enough")
    };
    let note = Note::new(key)
        .with("n", facts.alternations)
        .with("with", facts.with)
        .with("without", without)
        .with("short", facts.too_short)
        .with("missing", facts.missing)
        .with("least", Arg::figures(facts.minimum_interval_s, 3));
    let observed = [("alternations", facts.alternations as f64), ("intervals", facts.found as f64)];
    let required = Note::new("compared.required").with("n", facts.asked);
    record("influence_intervals", status, &observed, Some(required), note)
}

fn temperature(facts: &ComparedFacts) -> ConditionRecord {
    let id = "influence_temperature";
    let required = Some(
        Note::new("compared.required_temperature").with("allowed", Arg::figures(facts.allowed_deg_c, 2)),
    );
    let Some(difference) = facts.temperature else {
        return record(id, ConditionStatus::Remark, &[], required, Note::new("compared.no_temperature"));
    };
    let (status, key) = if difference.abs() > facts.allowed_deg_c {
        (ConditionStatus::Invalid, "compared.with_temperature")
    } else {
        (ConditionStatus::Ok, "compared.temperature")
    };
    let note = Note::new(key).with("difference", Arg::decimals(difference, 2));
    record(id, status, &[("difference", difference)], required, note)
}
