//! Warm-up: how far the bias is off at switching on, and how long until it stays within its band.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, LowerLimit, UpperLimit};
use crate::message::{Arg, Note};
use crate::temperature::settled::STATEMENT_PROBABILITY;
use crate::temperature::start::{Missing, Start};
use crate::temperature::warm_up::WarmUpFindings;

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
    let described = Note::new("thermal.transient").with("constants", Arg::Several(constants, "; ".into()));
    let r = &found.transient;
    let spread = r.spread.clone();
    let transient = Estimate::measured("turn_on_transient", channel, r.value, "deg/h", spread, METHOD);
    let rows = [transient.note(described.clone()), time(found, channel, described)];
    match found.start {
        Start::Shown(_) => rows.into(),
        Start::Declared => rows.map(|row| row.note(Note::new("thermal_start.declared"))).into(),
        Start::NotShown(why) => rows.map(|row| unknown(row, why)).into(),
    }
}

/// A row whose time counts from an unknown moment: it is at least what is seen from the first sample on.
fn unknown(row: Estimate, why: Missing) -> Estimate {
    let seen = row.value.and_then(|v| row.spread.bound(v, 1.0 - STATEMENT_PROBABILITY)).filter(|v| *v > 0.0);
    let least = row.lower_limit.or(seen.map(|value| LowerLimit { value, coverage: STATEMENT_PROBABILITY }));
    let least = least.filter(|_| row.id == "warm_up_time");
    let mut out = Estimate::not_identifiable(row.id, &row.channel, None, row.unit, METHOD).at_least(least);
    out.notes = row.notes;
    out.note(match why {
        Missing::NotAsked => Note::new("thermal_start.not_asked"),
        Missing::NoValues => Note::new("thermal_start.no_values"),
        Missing::OnAtFirst => Note::new("thermal_start.on_at_first"),
        Missing::NoRise => Note::new("thermal_start.no_rise"),
        Missing::WarmAtFirst(first, cold) => Note::new("thermal_start.warm_at_first")
            .with("first", Arg::figures(first, 4))
            .with("cold", Arg::Stated(cold)),
        Missing::Late(late_s) => Note::new("thermal_start.late").with("late", Arg::figures(late_s, 4)),
    })
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
        let limit = (least > 0.0).then_some(LowerLimit { value: least, coverage: STATEMENT_PROBABILITY });
        return Estimate::not_identifiable(id, channel, None, "s", METHOD).at_least(limit).note(note);
    }
    if r.value <= 0.0 {
        let limit = r.spread.bound(r.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return Estimate::not_identifiable(id, channel, limit, "s", METHOD)
            .note(Note::new("thermal.warm_at_once"));
    }
    Estimate::measured(id, channel, r.value, "s", r.spread.clone(), METHOD).note(described)
}
