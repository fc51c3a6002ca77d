//! Warm-up: how far the bias is off at switching on, and how long until it stays within its band.

use super::descriptor::Measurand;
use crate::estimate::{Estimate, LowerLimit, UpperLimit};
use crate::message::{Arg, Note, note};
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
    note!("thermal.transient", constants = Arg::Several(constants, "; ".into()))
}

/// A row with what is known of the moment of switching on. Only the time is at least what is seen from the first sample on.
fn started(m: &Measurand, row: Estimate, found: &WarmUpFindings, is_time: bool) -> Estimate {
    match found.start {
        Start::Shown(_) => row,
        Start::Declared => row.note(note!("thermal_start.declared")),
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
        Missing::NotAsked => note!("thermal_start.not_asked"),
        Missing::NoValues => note!("thermal_start.no_values"),
        Missing::OnAtFirst => note!("thermal_start.on_at_first"),
        Missing::NoRise => note!("thermal_start.no_rise"),
        Missing::WarmAtFirst(first, cold) => {
            note!("thermal_start.warm_at_first", first = Arg::figures(first, 4), cold = Arg::Stated(cold))
        }
        Missing::Late(late_s) => note!("thermal_start.late", late = Arg::figures(late_s, 4)),
    })
}

fn time(m: &Measurand, found: &WarmUpFindings, channel: &str) -> Estimate {
    let r = &found.time;
    // The objection says why.
    if found.is_contradicted() {
        return m.not_identifiable(channel, None, METHOD);
    }
    if found.too_short || found.drifts_on() {
        let hours = Arg::figures(found.length_s / 3600.0, 3);
        let note = if found.drifts_on() {
            note!("thermal.not_settled", hours, band = Arg::Stated(found.test.band_deg_h))
        } else {
            note!("thermal.warm_up_too_short", hours)
        };
        let least = found.settled.at_least_s;
        let limit = (least > 0.0).then_some(LowerLimit { value: least, coverage: STATEMENT_PROBABILITY });
        return m.not_identifiable(channel, None, METHOD).at_least(limit).note(note);
    }
    if r.value <= 0.0 {
        let limit = r.spread.bound(r.value, 0.95).map(|value| UpperLimit { value, coverage: 0.95 });
        return m.not_identifiable(channel, limit, METHOD).note(note!("thermal.warm_at_once"));
    }
    m.measured(channel, r.value, r.spread.clone(), METHOD).note(described(found))
}

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{gyro, near, notes, number, shows, told, withholds};
    use super::*;
    use crate::estimate::Spread;
    use crate::temperature::read::Reading;
    use crate::temperature::stays::Departure;
    use crate::temperature::warm_up::Settled;
    use crate::temperature::{StartAsked, WarmUpTest};

    /// Normal with a standard deviation of 10 s; its 95 % bounds lie 16.45 s to either side.
    fn reading(value: f64) -> Reading {
        let points = vec![(-2.0, value - 20.0), (0.0, value), (2.0, value + 20.0)];
        Reading { value, spread: Spread::Curve(points) }
    }

    const BOUND: f64 = 16.448_536_269_514_72;

    fn found(start: Start, time_s: f64) -> WarmUpFindings {
        WarmUpFindings {
            test: WarmUpTest { band_deg_h: 0.05, final_share: 0.2, start: StartAsked::Nothing },
            start,
            time: reading(time_s),
            always_inside: false,
            transient: Reading {
                value: -3.0,
                spread: Spread::Curve(vec![(-2.0, -3.4), (0.0, -3.0), (2.0, -2.6)]),
            },
            time_constants_s: vec![90.0, 600.0],
            length_s: 5400.0,
            blocks: vec![],
            modelled: vec![],
            final_deg_h: 0.0,
            too_short: false,
            settled: Settled { remaining: reading(0.0), at_most_deg_h: 0.05, at_least_s: 700.0 },
            departure: None,
            smoothed_s: None,
        }
    }

    fn row(m: &Measurand, found: &WarmUpFindings) -> Estimate {
        let mut rows = m.evaluate_warm_up("g", found);
        assert_eq!(rows.len(), 1);
        rows.remove(0)
    }

    #[track_caller]
    fn at_least(row: &Estimate, expected: Option<f64>) {
        assert_eq!((row.value, row.lower_limit.is_some()), (None, expected.is_some()), "{row:?}");
        if let (Some(limit), Some(expected)) = (row.lower_limit, expected) {
            near(limit.value, expected);
            assert_eq!(limit.coverage, 0.95);
        }
    }

    #[test]
    fn from_a_start_that_is_shown_time_and_transient_are_stated() {
        let found = found(Start::Shown(0.0), 300.0);
        let time = row(&WARM_UP_TIME, &found);
        shows(&time, 300.0, "decays_gls");
        let transient = row(&TURN_ON_TRANSIENT, &found);
        shows(&transient, -3.0, "decays_gls");
        for row in [&time, &transient] {
            assert_eq!(notes(row), ["thermal.transient"]);
            // In minutes.
            let constants = Arg::Several(vec![Arg::figures(1.5, 3), Arg::figures(10.0, 3)], "; ".into());
            assert_eq!(told(row, "thermal.transient", "constants"), &constants);
        }
        // A gyro at rest has the row where its warm-up was asked for.
        let (mut gyro, options) = (gyro(), Options { remove_earth_rate: false });
        assert!(WARM_UP_TIME.evaluate_gyro(&gyro, &options).is_empty());
        gyro.warm_up = Some(found.clone());
        assert_eq!(WARM_UP_TIME.evaluate_gyro(&gyro, &options), [time]);
        let declared = WarmUpFindings { start: Start::Declared, ..found };
        assert_eq!(notes(&row(&WARM_UP_TIME, &declared)), ["thermal.transient", "thermal_start.declared"]);
    }

    #[test]
    fn from_an_unknown_start_the_time_is_at_least_what_is_seen() {
        for (why, note) in [
            (Missing::NotAsked, "thermal_start.not_asked"),
            (Missing::NoValues, "thermal_start.no_values"),
            (Missing::OnAtFirst, "thermal_start.on_at_first"),
            (Missing::NoRise, "thermal_start.no_rise"),
            (Missing::WarmAtFirst(31.0, 20.0), "thermal_start.warm_at_first"),
            (Missing::Late(45.0), "thermal_start.late"),
        ] {
            let found = found(Start::NotShown(why), 300.0);
            let time = row(&WARM_UP_TIME, &found);
            at_least(&time, Some(300.0 - BOUND));
            assert_eq!(notes(&time), ["thermal.transient", note]);
            at_least(&row(&TURN_ON_TRANSIENT, &found), None);
            match why {
                Missing::WarmAtFirst(first, cold) => {
                    assert_eq!(number(&time, note, "first"), first);
                    assert_eq!(number(&time, note, "cold"), cold);
                }
                Missing::Late(late_s) => assert_eq!(number(&time, note, "late"), late_s),
                _ => {}
            }
        }
        // A bound of nothing is none.
        let start = Start::NotShown(Missing::NotAsked);
        at_least(&row(&WARM_UP_TIME, &found(start, 10.0)), None);
        let mut flat = found(start, 10.0);
        flat.time.spread = Spread::Curve(vec![(-2.0, 0.0), (0.0, 0.0), (2.0, 20.0)]);
        at_least(&row(&WARM_UP_TIME, &flat), None);
        // What the record shows of its end counts in the same way.
        let short = WarmUpFindings { too_short: true, ..found(start, 300.0) };
        at_least(&row(&WARM_UP_TIME, &short), Some(700.0));
    }

    #[test]
    fn a_record_that_ends_too_early_gives_a_lower_limit() {
        let start = Start::Shown(0.0);
        let mut short = WarmUpFindings { too_short: true, ..found(start, 300.0) };
        let time = row(&WARM_UP_TIME, &short);
        at_least(&time, Some(700.0));
        assert_eq!(notes(&time), ["thermal.warm_up_too_short"]);
        near(number(&time, "thermal.warm_up_too_short", "hours"), 1.5);
        short.settled.at_least_s = 0.0;
        at_least(&row(&WARM_UP_TIME, &short), None);
        let mut drifting = found(start, 300.0);
        drifting.settled.at_most_deg_h = 0.051;
        let time = row(&WARM_UP_TIME, &drifting);
        at_least(&time, Some(700.0));
        near(number(&time, "thermal.not_settled", "hours"), 1.5);
        near(number(&time, "thermal.not_settled", "band"), 0.05);
    }

    #[test]
    fn what_contradicts_the_decays_leaves_the_time_open() {
        let mut again = found(Start::Shown(0.0), 480.0);
        again.departure = Some(Departure { from_s: 6000.0, to_s: 6600.0, deg_h: 0.12 });
        let time = row(&WARM_UP_TIME, &again);
        withholds(&time, None, "decays_gls");
        (again.departure, again.smoothed_s) = (None, Some(60.0));
        withholds(&row(&WARM_UP_TIME, &again), None, "decays_gls");
        // Where the start is only declared, a unit without a transient may have been warm before.
        let mut warm = found(Start::Declared, 20.0);
        warm.transient = reading(5.0);
        let time = row(&WARM_UP_TIME, &warm);
        withholds(&time, None, "decays_gls");
    }

    #[test]
    fn a_unit_that_is_warm_at_once_has_an_upper_limit() {
        for value in [0.0, -5.0] {
            let time = row(&WARM_UP_TIME, &found(Start::Shown(0.0), value));
            withholds(&time, Some(value + BOUND), "decays_gls");
            assert_eq!(notes(&time), ["thermal.warm_at_once"]);
        }
    }
}
