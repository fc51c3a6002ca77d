//! Temperature held over the evaluated window (static test: 20 ± 0.4 °C).

use super::{Condition, Facts, held};
use crate::record::ConditionRecord;

pub(super) struct Temperature;

impl Condition for Temperature {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let conditions = facts.procedure.conditions.temperatures.iter().enumerate();
        conditions
            .map(|(position, c)| {
                let held = held::Held {
                    id: "temperature",
                    channel: &c.channel,
                    position,
                    nominal: c.nominal_deg_c,
                    tolerance: c.tolerance_deg_c,
                    standard_uncertainty: c.sensor_uncertainty_deg_c,
                    coverage_factor: c.coverage_factor,
                    unit: "degC",
                };
                held::judge(&held, facts)
            })
            .collect()
    }
}
