//! Whether the rate is stationary: a step of the mean, a change of the noise. Remarks only: a unit may do so, and then its
//! limits judge it; but so does a record that was put together from two.

use super::facts::{Condition, Facts, record};
use crate::i18n::note;
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Stationarity;

impl Condition for Stationarity {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let mut found = Vec::new();
        for gyro in facts.gyros {
            let id = format!("steadiness.{}", gyro.channel);
            let required = || Some(note!("steadiness.required"));
            if let Some(step) = gyro.bias_step {
                let note = note!(
                    "steadiness.step",
                    channel = gyro.channel.clone(),
                    size = step.size_deg_h,
                    time_h = step.time_s / 3600.0,
                    significance = step.significance
                );
                let observed = [("step_deg_h", step.size_deg_h), ("step_at_s", step.time_s)];
                found.push(record(id.clone(), ConditionStatus::Remark, &observed, required(), note));
            }
            if let Some(change) = gyro.noise_change {
                let note = note!(
                    "steadiness.noise",
                    channel = gyro.channel.clone(),
                    ratio = change.ratio,
                    loudest_h = change.loudest_s / 3600.0,
                    quietest_h = change.quietest_s / 3600.0
                );
                let observed = [("noise_ratio", change.ratio)];
                found.push(record(id, ConditionStatus::Remark, &observed, required(), note));
            }
        }
        found
    }
}
