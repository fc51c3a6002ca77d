//! Supply voltage held over the evaluated window.

use super::{Condition, Facts, held};
use crate::record::ConditionRecord;

pub(super) struct Supply;

impl Condition for Supply {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let conditions = facts.procedure.conditions.supplies.iter().enumerate();
        conditions
            .map(|(position, c)| {
                let held = held::Held {
                    id: "supply",
                    channel: &c.channel,
                    position,
                    nominal: c.nominal_v,
                    tolerance: c.tolerance_v,
                    standard_uncertainty: c.sensor_uncertainty_v,
                    coverage_factor: c.coverage_factor,
                    unit: "V",
                };
                held::judge(&held, facts)
            })
            .collect()
    }
}
