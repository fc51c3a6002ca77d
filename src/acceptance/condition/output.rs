//! Processing of the output before it was recorded: coarse steps, smoothing. Remarks only.

use super::facts::{Condition, Facts, GyroFact, record};
use crate::i18n::{Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Output;

/// Step of the output in units of the noise of a sample from which it adds 2 % to the variance.
const COARSE_STEP: f64 = 0.5;
/// Scatter of neighbouring samples over that of white noise below which the output is smoothed.
const SMOOTHED_SCATTER: f64 = 0.5;

impl Condition for Output {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        facts.gyros.iter().flat_map(of_gyro).collect()
    }
}

fn of_gyro(gyro: &GyroFact) -> Vec<ConditionRecord> {
    let Some(&(_, sample)) = gyro.deviations.first().filter(|(tau, d)| *tau <= 1.5 * gyro.tau0_s && *d > 0.0)
    else {
        return vec![];
    };
    let mut found = Vec::new();
    let mut remark = |note: Note| {
        let required = note!("output.required");
        let id = format!("output.{}", gyro.channel);
        found.push(record(id, ConditionStatus::Remark, &[("sample_deg_h", sample)], Some(required), note));
    };
    if let Some(step) = gyro.quantization_step_deg_h.filter(|q| *q > COARSE_STEP * sample) {
        remark(note!("output.coarse", channel = gyro.channel.clone(), step, ratio = step / sample));
    }
    if let Some(n) = gyro.angle_random_walk {
        let white = 60.0 * n / gyro.tau0_s.sqrt();
        if sample < SMOOTHED_SCATTER * white {
            remark(note!("output.smoothed", channel = gyro.channel.clone(), sample, white));
        }
    }
    found
}
