//! Whether the output was smoothed over longer than the means that the noise in zones of temperature is read from.

use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, note};

/// Finds a smoothed output over temperature.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let zones = gyro.over_temperature.iter().flat_map(|found| &found.zones);
    let Some(zone) = zones.into_iter().find(|zone| zone.smoothed) else { return vec![] };
    vec![Finding {
        measurands: vec!["angle_random_walk_at_temperature"],
        holds: Holds::Nothing,
        found: note!("criticism_found.smoothed_output", average_s = Arg::figures(zone.average_s, 2)),
        advice: note!("criticism_advice.slow_part_removed"),
    }]
}
