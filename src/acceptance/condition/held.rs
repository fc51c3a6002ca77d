//! A quantity that must be held over the evaluated window, whatever it is.

use super::temperature_track::TemperatureFacts;
use super::{Facts, record};
use crate::i18n::{Arg, Note};
use crate::record::{ConditionRecord, ConditionStatus};

/// What must be held.
pub(super) struct Held<'a> {
    pub id: &'a str,
    pub channel: &'a str,
    /// Position among the conditions of its kind.
    pub position: usize,
    pub nominal: f64,
    pub tolerance: f64,
    pub standard_uncertainty: f64,
    pub coverage_factor: f64,
    pub unit: &'a str,
}

/// Shown when every smoothed value lies inside the tolerance less k·u; broken when one lies outside the tolerance
/// plus k·u; between, it is not shown, and that is not enough.
pub(super) fn judge(held: &Held<'_>, facts: &Facts<'_>) -> ConditionRecord {
    let unit = Arg::key("unit", held.unit);
    let required = Note::new("note.required.held")
        .with("nominal", Arg::Stated(held.nominal))
        .with("tolerance", Arg::Stated(held.tolerance))
        .with("unit", unit.clone());
    let id = if held.position == 0 { held.id.to_owned() } else { format!("{}.{}", held.id, held.channel) };
    let Some(track) = facts.held.get(&(held.id.to_owned(), held.position)) else {
        let note = Note::new("note.condition.no_data").with("channel", held.channel);
        return record(id, ConditionStatus::Invalid, &[], Some(required), note);
    };
    let worst = worst(track, held.nominal);
    let guard = held.coverage_factor * held.standard_uncertainty;
    let distance = (worst.value - held.nominal).abs();
    let (status, key) = if distance <= held.tolerance - guard {
        (ConditionStatus::Ok, "note.condition.held")
    } else if distance > held.tolerance + guard {
        (ConditionStatus::Invalid, "note.condition.left")
    } else {
        (ConditionStatus::Invalid, "note.condition.not_shown")
    };
    let note = Note::new(key)
        .with("channel", held.channel)
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
        ("raw_min", track.raw.0),
        ("raw_max", track.raw.1),
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
    record(id, status, &observed, Some(required), note)
}

fn worst(track: &TemperatureFacts, nominal: f64) -> super::temperature_track::Extreme {
    if (track.smooth_max.value - nominal).abs() >= (track.smooth_min.value - nominal).abs() {
        track.smooth_max
    } else {
        track.smooth_min
    }
}
