//! Evidence of each condition: the recording, an inference from the output, or a declaration.

use crate::record::{ConditionRecord, Evidence};

/// Judged by what the output does.
const INFERRED_CONDITIONS: &[&str] = &[
    "earth_rate",
    "known_earth",
    "noise_level",
    "output",
    "steadiness",
    "table_earth_rate",
    "table_response",
    "table_scale",
    "influence_line",
    "influence_rates",
];

/// Stated by the procedure or by who ran the test.
const DECLARED_CONDITIONS: &[&str] = &["calibration", "known_stretches", "warm_up"];

/// Taken from the stamps of the recording, and without stamps from the declared rate.
const BY_STAMPS: &[&str] = &[
    "clock",
    "duration",
    "gaps",
    "longest_gap",
    "missing_samples",
    "sample_rate",
    "time_base",
    "timestamp_jitter",
    "table_settling",
];

/// Read from a channel or from the fields of the recording.
const RECORDED_CONDITIONS: &[&str] = &[
    "backward_timestamps",
    "cut_off",
    "duplicate_timestamps",
    "dwell",
    "implausible",
    "inner_axis_still",
    "non_finite",
    "outliers",
    "ramp_rate",
    "repeated",
    "saturated",
    "stuck",
    "supply",
    "table_agreement",
    "table_reached",
    "table_stamps",
    "table_steps",
    "temperature",
    "temperature_course",
    "temperature_overshoot",
    "unit_named",
    "units",
    "unparsable",
];

/// Gives every condition that does not state it the evidence of its kind.
pub fn complete(conditions: &mut [ConditionRecord], has_stamps: bool) {
    for c in conditions.iter_mut().filter(|c| c.evidence.is_none()) {
        c.evidence = usual(c.id.split('.').next().unwrap_or(&c.id), has_stamps);
    }
}

fn usual(kind: &str, has_stamps: bool) -> Option<Evidence> {
    let among = |list: &[&str]| list.contains(&kind);
    if among(INFERRED_CONDITIONS) {
        Some(Evidence::Inferred)
    } else if among(DECLARED_CONDITIONS) || among(BY_STAMPS) && !has_stamps {
        Some(Evidence::Declared)
    } else if among(RECORDED_CONDITIONS) || among(BY_STAMPS) {
        Some(Evidence::Recorded)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_recorded_by_stamps_and_else_declared() {
        assert_eq!(usual("duration", true), Some(Evidence::Recorded));
        assert_eq!(usual("duration", false), Some(Evidence::Declared));
        assert_eq!(usual("calibration", true), Some(Evidence::Declared));
        assert_eq!(usual("noise_level", true), Some(Evidence::Inferred));
    }
}
