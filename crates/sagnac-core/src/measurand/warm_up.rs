//! Warm-up: how far the bias is off at switching on, and how long until it stays within its band.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, LowerLimit, UpperLimit};
use crate::message::{Arg, Note};
use crate::temperature::start::{Missing, Start};
use crate::temperature::warm_up::STATEMENT_PROBABILITY;
use crate::temperature::warm_up::WarmUpFindings;

/// Bias at switching on, less its final value.
pub static TURN_ON_TRANSIENT: Measurand = Measurand::of_warm_up(
    "turn_on_transient",
    "deg/h",
    "bias at switching on, less its final value",
    |m, channel, found| {
        let r = &found.transient;
        let row = m.measured(channel, r.value, r.spread.clone(), METHOD).note(described(found));
        vec![started(m, row, found, false)]
    },
)
.signed();

/// Time until the bias stays within its band.
pub static WARM_UP_TIME: Measurand = Measurand::of_warm_up(
    "warm_up_time",
    "s",
    "time after switching on until the bias stays in its band",
    |m, channel, found| vec![started(m, time(m, found, channel), found, true)],
)
.also_called(&["turn_on_time", "start_up_time", "readiness_time"]);

const METHOD: &str = "decays_gls";

/// The decays that were fitted.
fn described(found: &WarmUpFindings) -> Note {
    let constants = found.time_constants_s.iter().map(|c| Arg::figures(c / 60.0, 3)).collect();
    Note::new("thermal.transient").with("constants", Arg::Several(constants, "; ".into()))
}

/// A row with what is known of the moment of switching on. Only the time is at least what is seen from the first sample on.
fn started(m: &Measurand, row: Estimate, found: &WarmUpFindings, is_time: bool) -> Estimate {
    match found.start {
        Start::Shown(_) => row,
        Start::Declared => row.note(Note::new("thermal_start.declared")),
        Start::NotShown(why) => unknown(m, row, why, is_time),
    }
}

/// A row whose time counts from an unknown moment: it is at least what is seen from the first sample on.
fn unknown(m: &Measurand, row: Estimate, why: Missing, is_time: bool) -> Estimate {
    let seen = row.value.and_then(|v| row.spread.bound(v, 1.0 - STATEMENT_PROBABILITY)).filter(|v| *v > 0.0);
    let least = row.lower_limit.or(seen.map(|value| LowerLimit { value, coverage: STATEMENT_PROBABILITY }));
    let least = least.filter(|_| is_time);
    let mut out = m.not_identifiable(&row.channel, None, METHOD).at_least(least);
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

fn time(m: &Measurand, found: &WarmUpFindings, channel: &str) -> Estimate {
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
        return m.not_identifiable(channel, None, METHOD).at_least(limit).note(note);
    }
    if r.value <= 0.0 {
        let limit = r.spread.bound(r.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return m.not_identifiable(channel, limit, METHOD).note(Note::new("thermal.warm_at_once"));
    }
    m.measured(channel, r.value, r.spread.clone(), METHOD).note(described(found))
}
