//! Channels that must stay between bounds over the evaluated window.

use super::facts::{Condition, Facts, record};
use super::stability_track::StabilityKey;
use crate::config::procedure::model::Bounds;
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Range;

impl Condition for Range {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let ranges = facts.procedure.conditions.ranges.iter().enumerate();
        ranges
            .filter_map(|(position, c)| {
                let bounds = c.bounds(&facts.procedure.channel(&c.channel)?.channel).ok()?;
                let guard = c.coverage_factor * bounds.standard_uncertainty;
                Some(judge(StabilityKey::range(position), &c.channel, &bounds, guard, facts))
            })
            .collect()
    }
}

/// Shown when every smoothed value lies between the bounds narrowed by the guard band; broken when one lies outside the
/// bounds widened by it; between, it is not shown, and that is not enough.
fn judge(
    key: StabilityKey,
    channel: &str,
    bounds: &Bounds,
    guard: f64,
    facts: &Facts<'_>,
) -> ConditionRecord {
    let id = format!("range.{channel}");
    let required = required(bounds);
    let Some(track) = facts.stability.get(&key) else {
        let note = note!("note.condition.no_data", channel = channel);
        return record(id, ConditionStatus::Invalid, &[], Some(required), note);
    };
    let (low, high) = (track.smooth_min, track.smooth_max);
    // How far each end lies outside its bound: the worse one decides.
    let (below, above) = (bounds.low - low.value, high.value - bounds.high);
    let (outside, worst) = if below > above { (below, low) } else { (above, high) };
    let (status, key) = if outside <= -guard {
        (ConditionStatus::Ok, "note.condition.range_held")
    } else if outside > guard {
        (ConditionStatus::Invalid, "note.condition.range_left")
    } else {
        (ConditionStatus::Invalid, "note.condition.range_not_shown")
    };
    let note = Note::new(key)
        .with("channel", channel)
        .with("value", worst.value)
        .with("low", low.value)
        .with("high", high.value)
        .with("time_h", worst.time_s / 3600.0)
        .with("guard", guard)
        .with("smoothing_s", track.smoothing_s)
        .with("share", 100.0 * track.share_outside)
        .with("unit", Arg::key("unit", &bounds.unit));
    let observed = [
        ("min", low.value),
        ("max", high.value),
        ("mean", track.mean),
        ("worst", worst.value),
        ("worst_at_s", worst.time_s),
        ("share_outside", track.share_outside),
        ("guard", guard),
    ];
    record(id, status, &observed, Some(required), note)
}

fn required(bounds: &Bounds) -> Note {
    let unit = Arg::key("unit", &bounds.unit);
    let (low, high) = (Arg::Stated(bounds.low), Arg::Stated(bounds.high));
    match (bounds.low.is_finite(), bounds.high.is_finite()) {
        (true, true) => note!("note.required.range", low, high, unit),
        (true, false) => note!("note.required.range_above", low, unit),
        _ => note!("note.required.range_below", high, unit),
    }
}
