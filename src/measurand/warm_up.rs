//! Warm-up: how far the bias is off at switching on, and how long until it stays within its band.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, LowerLimit, UpperLimit};
use crate::temperature::settled::SHOWN;
use crate::temperature::warm_up::WarmUpFindings;
use crate::text::{Arg, Note};

pub(super) struct WarmUp;

const METHOD: &str = "decays_gls";

impl Measurand for WarmUp {
    fn ids(&self) -> &'static [&'static str] {
        &["turn_on_transient", "warm_up_time"]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        warm_up(gyro.warm_up.as_ref()?, &gyro.channel).into_iter().find(|e| e.id == id)
    }
}

/// Every row about the warm-up of a channel.
pub fn warm_up(found: &WarmUpFindings, channel: &str) -> Vec<Estimate> {
    let constants = found.time_constants_s.iter().map(|c| Arg::figures(c / 60.0, 3)).collect();
    let described = Note::new("thermal.transient").with("constants", Arg::Several(constants, "; "));
    let r = &found.transient;
    let spread = r.spread.clone();
    let transient = Estimate::measured("turn_on_transient", channel, r.value, "deg/h", spread, METHOD);
    vec![transient.note(described.clone()), time(found, channel, described)]
}

fn time(found: &WarmUpFindings, channel: &str, described: Note) -> Estimate {
    let id = "warm_up_time";
    let r = &found.time;
    if found.too_short || found.drifts_on() {
        let hours = Arg::figures(found.length_s / 3600.0, 3);
        let note = if found.drifts_on() {
            Note::new("thermal.not_settled")
                .with("hours", hours)
                .with("band", Arg::Stated(found.test.band_deg_h))
        } else {
            Note::new("thermal.warm_up_too_short").with("hours", hours)
        };
        let least = found.settled.at_least_s;
        let limit = (least > 0.0).then_some(LowerLimit { value: least, coverage: SHOWN });
        return Estimate::not_identifiable(id, channel, None, "s", METHOD).at_least(limit).note(note);
    }
    if r.value <= 0.0 {
        let limit = r.spread.bound(r.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return Estimate::not_identifiable(id, channel, limit, "s", METHOD)
            .note(Note::new("thermal.warm_at_once"));
    }
    Estimate::measured(id, channel, r.value, "s", r.spread.clone(), METHOD).note(described)
}
