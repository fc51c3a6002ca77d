//! Quantities that must stay within a band over the evaluated window: the temperature of the unit (static test: 20 ± 0.4 °C)
//! and its supply.

use super::facts::{Condition, Facts, record};
use super::stability_track::{Extreme, StabilityFacts, StabilityKey};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Temperature;

impl Condition for Temperature {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let conditions = facts.procedure.conditions.temperatures.iter().enumerate();
        conditions
            .map(|(position, c)| {
                let requirement = Requirement {
                    key: StabilityKey::temperature(position),
                    channel: &c.channel,
                    nominal: c.nominal_deg_c,
                    tolerance: c.tolerance_deg_c,
                    standard_uncertainty: c.sensor_uncertainty_deg_c,
                    coverage_factor: c.coverage_factor,
                    unit: "degC",
                };
                judge(&requirement, facts)
            })
            .collect()
    }
}

pub(super) struct Supply;

impl Condition for Supply {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let conditions = facts.procedure.conditions.supplies.iter().enumerate();
        conditions
            .map(|(position, c)| {
                let requirement = Requirement {
                    key: StabilityKey::supply(position),
                    channel: &c.channel,
                    nominal: c.nominal_v,
                    tolerance: c.tolerance_v,
                    standard_uncertainty: c.sensor_uncertainty_v,
                    coverage_factor: c.coverage_factor,
                    unit: "V",
                };
                judge(&requirement, facts)
            })
            .collect()
    }
}

/// The band that a channel must keep.
struct Requirement<'a> {
    key: StabilityKey,
    channel: &'a str,
    nominal: f64,
    tolerance: f64,
    standard_uncertainty: f64,
    coverage_factor: f64,
    unit: &'a str,
}

/// Shown when every smoothed value lies inside the tolerance less k·u; broken when one lies outside the tolerance
/// plus k·u; between, it is not shown, and that is not enough.
fn judge(required: &Requirement<'_>, facts: &Facts<'_>) -> ConditionRecord {
    let unit = Arg::key("unit", required.unit);
    let sentence = note!(
        "note.required.held",
        nominal = Arg::Stated(required.nominal),
        tolerance = Arg::Stated(required.tolerance),
        unit = unit.clone()
    );
    let id = if required.key.position == 0 {
        required.key.condition.to_owned()
    } else {
        format!("{}.{}", required.key.condition, required.channel)
    };
    let Some(track) = facts.stability.get(&required.key) else {
        let note = note!("note.condition.no_data", channel = required.channel);
        return record(id, ConditionStatus::Invalid, &[], Some(sentence), note);
    };
    let worst = worst(track, required.nominal);
    let guard = required.coverage_factor * required.standard_uncertainty;
    let distance = (worst.value - required.nominal).abs();
    let (status, key) = if distance <= required.tolerance - guard {
        (ConditionStatus::Ok, "note.condition.held")
    } else if distance > required.tolerance + guard {
        (ConditionStatus::Invalid, "note.condition.left")
    } else {
        (ConditionStatus::Invalid, "note.condition.not_shown")
    };
    let note = Note::new(key)
        .with("channel", required.channel)
        .with("value", worst.value)
        .with("time_h", worst.time_s / 3600.0)
        .with("guard", guard)
        .with("smoothing_s", track.smoothing_s)
        .with("share", 100.0 * track.share_outside)
        .with("unit", unit);
    let mut observed = vec![
        ("min", track.smooth_min.value),
        ("max", track.smooth_max.value),
        ("mean", track.mean),
        ("raw_min", track.raw_min),
        ("raw_max", track.raw_max),
        ("worst", worst.value),
        ("worst_at_s", worst.time_s),
        ("share_outside", track.share_outside),
        ("guard", guard),
    ];
    if let Some(slope) = track.steepest_deg_c_per_h {
        observed.push(("steepest_per_h", slope));
    }
    if track.unusable > 0 {
        observed.push(("unusable", track.unusable as f64));
    }
    record(id, status, &observed, Some(sentence), note)
}

fn worst(track: &StabilityFacts, nominal: f64) -> Extreme {
    if (track.smooth_max.value - nominal).abs() >= (track.smooth_min.value - nominal).abs() {
        track.smooth_max
    } else {
        track.smooth_min
    }
}
