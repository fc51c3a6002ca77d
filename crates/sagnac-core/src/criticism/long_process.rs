//! Whether a long Markov process describes a record about as well as the flicker that was claimed.

use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, note};

/// Finds the process. Were it there in place of flicker, flicker would be less: an upper bound still holds.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let found = &gyro.identification;
    let Some(process) = found.long_process.filter(|_| found.bias_instability.value.is_some()) else {
        return vec![];
    };
    vec![Finding {
        measurands: vec!["bias_instability"],
        holds: Holds::UpperBound,
        found: note!(
            "criticism_found.long_process",
            sigma = process.rms_deg_h,
            time_s = Arg::rounded(process.decay_time_s, 2)
        ),
        advice: note!(
            "criticism_advice.long_process",
            hours = Arg::rounded(100.0 * process.decay_time_s / 3600.0, 2)
        ),
    }]
}
