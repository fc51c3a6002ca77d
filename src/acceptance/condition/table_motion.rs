//! Whether a table moved as its stamps and the settling time say.

use super::table::TableFacts;
use super::{mistakes, record};
use crate::i18n::{Arg, Note};
use crate::record::{ConditionRecord, ConditionStatus};

/// Share of the tolerance of the rate by which steps may be off on average where the settling is a little short.
const OFF: f64 = 0.1;
/// Relative difference within which a time is that of another unit.
const OF_UNIT: f64 = 0.05;

/// Steps that are evaluated from a time on at which the table still changed its rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settling {
    /// How many.
    pub steps: usize,
    /// Settling that the procedure states, s.
    pub stated_s: f64,
    /// Longest that one needed, s.
    pub needed_s: f64,
    /// Largest relative deviation of the mean rate from that at the end of the step.
    pub off: f64,
}

/// Whether steps are evaluated before the table is at its rate; `None` where none is.
pub(super) fn settling(facts: &TableFacts) -> Option<ConditionRecord> {
    let s = &facts.settling;
    if s.steps == 0 {
        return None;
    }
    let status =
        if s.off > OFF * facts.tolerance { ConditionStatus::Invalid } else { ConditionStatus::Remark };
    let note = Note::new("table_motion.settling_short")
        .with("steps", s.steps)
        .with("of", facts.steps)
        .with("stated", Arg::Stated(s.stated_s))
        .with("needed", Arg::figures(s.needed_s, 2));
    let observed = [("needed_s", s.needed_s), ("stated_s", s.stated_s)];
    Some(record("table_settling", status, &observed, Some(Note::new("table_motion.required.settled")), note))
}

/// Stamps of a unit that the angle and the rate of the table contradict; `None` where they do not.
pub(super) fn stamps(facts: &TableFacts) -> Option<ConditionRecord> {
    let factor = facts.time_factor.filter(|f| *f > 0.0)?;
    let mistake = mistakes::time_factors().into_iter().find(|m| (factor / m.factor - 1.0).abs() < OF_UNIT)?;
    let note = Note::new("table_motion.stamps").with("mistake", Arg::from(mistake.note));
    let required = Note::new("table_motion.required.stamps");
    Some(record("table_stamps", ConditionStatus::Invalid, &[("factor", factor)], Some(required), note))
}
