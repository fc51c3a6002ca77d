//! The schedule of a test over temperature: ramps, ends, overshoot, dwells. What is not as asked names the likely
//! mistake.

use super::facts::{Condition, Facts, record};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};
use crate::temperature::findings::{MIN_SPAN_DEG_C, Schedule as Run};
use crate::temperature::segments::Segment;
use crate::temperature::{SegmentKind, TemperatureTest};

pub(super) struct Schedule;

/// Share of blocks without a temperature that is still borne.
const MAX_MISSING_SHARE: f64 = 0.02;
/// Time from the end of the last ramp to the end of the recording within which a ramp counts as cut, s.
const CUT_WITHIN_S: f64 = 120.0;

impl Condition for Schedule {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let Some(test) = &facts.procedure.temperature_test else { return vec![] };
        let channel = Arg::Text(test.channel.clone());
        let invalid = |id: &str, key: &'static str| {
            let required = note!(
                "schedule.required.course",
                low = Arg::Stated(test.low_deg_c),
                high = Arg::Stated(test.high_deg_c)
            );
            vec![record(
                id,
                ConditionStatus::Invalid,
                &[],
                Some(required),
                Note::new(key).with("channel", channel.clone()),
            )]
        };
        let Some(run) = facts.schedule else { return invalid("temperature_course", "schedule.missing") };
        if run.missing > MAX_MISSING_SHARE {
            let percent = Arg::figures(100.0 * run.missing, 3);
            let note = note!("schedule.holes", channel, percent);
            return vec![record("temperature_course", ConditionStatus::Invalid, &[], None, note)];
        }
        let width = run.reached.high - run.reached.low;
        if width < MIN_SPAN_DEG_C {
            let note = note!(
                "schedule.flat",
                channel,
                value = Arg::figures(0.5 * (run.reached.low + run.reached.high), 4),
                width = Arg::figures(width, 2)
            );
            return vec![record("temperature_course", ConditionStatus::Invalid, &[], None, note)];
        }
        let mut out = vec![ends(run, test, facts)];
        out.extend(test.overshoot_deg_c.map(|allowed| overshoot(run, test, allowed)));
        out.push(rates(run, test));
        out.extend(test.dwell_s.map(|least| dwells(run, test, least)));
        out
    }
}

fn c(value: f64) -> Arg {
    Arg::figures(value, 3)
}

/// Both ends reached and both directions run; a ramp that broke off says so.
fn ends(run: &Run, test: &TemperatureTest, facts: &Facts<'_>) -> ConditionRecord {
    let guard = test.coverage_factor * test.sensor_uncertainty_deg_c;
    let (low, high) = (run.reached.low, run.reached.high);
    let missed_low = low - test.low_deg_c > test.end_tolerance_deg_c - guard;
    let missed_high = test.high_deg_c - high > test.end_tolerance_deg_c - guard;
    let required = note!(
        "schedule.required.ends",
        low = Arg::Stated(test.low_deg_c),
        high = Arg::Stated(test.high_deg_c),
        tolerance = Arg::Stated(test.end_tolerance_deg_c),
        ramps = test.ramps_each_way
    );
    let last = run.segments.last();
    let cut = last.filter(|s| {
        s.kind.is_ramp() && facts.duration_s - s.to_s < CUT_WITHIN_S.max(0.005 * facts.duration_s)
    });
    let aborted = cut.filter(|s| left(s, test) > test.end_tolerance_deg_c);
    let turned: Vec<&Segment> = turned_back(run, test).collect();
    // A ramp that broke off or turned back is none of those asked for.
    let count = |kind| {
        let of_kind = run.segments.iter().filter(|s| s.kind == kind).count();
        let broken = turned.iter().copied().chain(aborted).filter(|s| s.kind == kind).count();
        of_kind.saturating_sub(broken)
    };
    let (up, down) = (count(SegmentKind::Heating), count(SegmentKind::Cooling));
    let observed =
        [("min_deg_c", low), ("max_deg_c", high), ("heating", up as f64), ("cooling", down as f64)];
    let too_few = up < test.ramps_each_way || down < test.ramps_each_way;
    let complete = !missed_low && !missed_high && !too_few;
    let (status, note) = if let Some(key) = other_scale((low, high), test).or_else(|| reversed(run, test)) {
        (ConditionStatus::Invalid, Note::new(key).with("low", c(low)).with("high", c(high)))
    } else if complete {
        (ConditionStatus::Ok, note!("schedule.ends", low = c(low), high = c(high)))
    } else if let Some(s) = aborted {
        let end = if s.kind == SegmentKind::Heating { test.high_deg_c } else { test.low_deg_c };
        let note = note!(
            "schedule.aborted",
            at = c(s.ends_deg_c),
            end = Arg::Stated(end),
            time_h = Arg::figures(s.to_s / 3600.0, 4)
        );
        (ConditionStatus::Invalid, note)
    } else if let Some(s) = turned.first() {
        let note = note!("schedule.turned", at = c(s.ends_deg_c), time_h = Arg::figures(s.to_s / 3600.0, 4));
        (ConditionStatus::Invalid, note)
    } else if missed_low || missed_high {
        let shown = low - test.low_deg_c <= test.end_tolerance_deg_c + guard
            && test.high_deg_c - high <= test.end_tolerance_deg_c + guard;
        let key = if shown { "schedule.ends_not_shown" } else { "schedule.ends_missed" };
        let note = Note::new(key).with("low", c(low)).with("high", c(high)).with("guard", c(guard));
        (ConditionStatus::Invalid, note)
    } else {
        let note = note!("schedule.too_few", up, down);
        (ConditionStatus::Invalid, note)
    };
    record("temperature_course", status, &observed, Some(required), note)
}

/// What a ramp had still to go to the end of its direction, degC.
fn left(ramp: &Segment, test: &TemperatureTest) -> f64 {
    if ramp.kind == SegmentKind::Heating {
        test.high_deg_c - ramp.ends_deg_c
    } else {
        ramp.ends_deg_c - test.low_deg_c
    }
}

/// Ramps far from their end that one in the other direction follows, a rest between them or not.
fn turned_back<'a>(run: &'a Run, test: &'a TemperatureTest) -> impl Iterator<Item = &'a Segment> {
    let ramps = || run.segments.iter().filter(|s| s.kind.is_ramp());
    ramps()
        .zip(ramps().skip(1))
        .filter(|(s, next)| next.kind != s.kind && left(s, test) > 3.0 * test.end_tolerance_deg_c)
        .map(|(s, _)| s)
}

/// A course whose ends are those asked for on another scale, and not in degrees Celsius.
fn other_scale((low, high): (f64, f64), test: &TemperatureTest) -> Option<&'static str> {
    let slack = 3.0 * test.end_tolerance_deg_c;
    let fits = |celsius: &dyn Fn(f64) -> f64| {
        (celsius(low) - test.low_deg_c).abs() <= slack && (celsius(high) - test.high_deg_c).abs() <= slack
    };
    if fits(&|t| t) {
        None
    } else if fits(&|t| t - 273.15) {
        Some("schedule.kelvin")
    } else if fits(&|t| (t - 32.0) / 1.8) {
        Some("schedule.fahrenheit")
    } else if (-high - test.low_deg_c).abs() <= slack && (-low - test.high_deg_c).abs() <= slack {
        Some("schedule.reversed")
    } else {
        None
    }
}

/// Correlation of the temperature with its command from which it runs the other way.
const REVERSED_CORRELATION: f64 = -0.5;

/// A course that runs against the shape of the schedule: every stated ramp the other way, or the temperature against its
/// command. Where both ends have the same size, nothing but the shape tells the sign.
fn reversed(run: &Run, test: &TemperatureTest) -> Option<&'static str> {
    let against = |s: &Segment| match s.kind {
        SegmentKind::Heating => s.rate_deg_c_h < -s.rate_uncertainty_deg_c_h,
        SegmentKind::Cooling => s.rate_deg_c_h > s.rate_uncertainty_deg_c_h,
        SegmentKind::Soak | SegmentKind::Dwell => false,
    };
    let mut ramps = run.segments.iter().filter(|s| s.kind.is_ramp()).peekable();
    let stated = !test.segments.is_empty() && ramps.peek().is_some() && ramps.all(against);
    let commanded = || {
        let command = run.command.as_ref()?;
        let pairs: Vec<(f64, f64)> = run.temperature.iter().zip(command).map(|(t, c)| (t.1, c.1)).collect();
        Some(correlation(&pairs) < REVERSED_CORRELATION)
    };
    (stated || commanded() == Some(true)).then_some("schedule.reversed_course")
}

/// Correlation of pairs; no number where one side is constant.
fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), p| (a + p.0 / n, b + p.1 / n));
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let product = sum(&|p| (p.0 - a) * (p.1 - b));
    product / (sum(&|p| (p.0 - a).powi(2)) * sum(&|p| (p.1 - b).powi(2))).sqrt()
}

fn overshoot(run: &Run, test: &TemperatureTest, allowed: f64) -> ConditionRecord {
    let beyond = (run.reached.high - test.high_deg_c).max(test.low_deg_c - run.reached.low).max(0.0);
    let ok = beyond <= allowed;
    let required = note!("schedule.required.overshoot", allowed = Arg::Stated(allowed));
    let note =
        Note::new(if ok { "schedule.overshoot" } else { "schedule.overshot" }).with("beyond", c(beyond));
    let status = if ok { ConditionStatus::Ok } else { ConditionStatus::Remark };
    record("temperature_overshoot", status, &[("overshoot_deg_c", beyond)], Some(required), note)
}

/// Every ramp within the allowed rates and, where a rate is nominal, within its tolerance, the uncertainty counted.
fn rates(run: &Run, test: &TemperatureTest) -> ConditionRecord {
    let (mut low, mut high) = (test.slowest_deg_c_h, test.fastest_deg_c_h);
    if let Some(nominal) = test.ramp_rate_deg_c_h {
        low = low.max(nominal * (1.0 - test.ramp_rate_tolerance));
        high = high.min(nominal * (1.0 + test.ramp_rate_tolerance));
    }
    let required = note!("schedule.required.rate", low = c(low), high = c(high));
    let ramps: Vec<_> = run.segments.iter().filter(|s| s.kind.is_ramp()).collect();
    // How far the ramp is inside, less its guard: the worst decides.
    let inside = |rate: f64| (rate - low).min(high - rate);
    let guard = |u: f64| test.coverage_factor * u;
    let worst = ramps.iter().min_by(|a, b| {
        let margin = |s: &Segment| inside(s.rate_deg_c_h.abs()) - guard(s.rate_uncertainty_deg_c_h);
        margin(a).total_cmp(&margin(b))
    });
    let Some(worst) = worst else {
        let note = note!("schedule.no_ramp");
        return record("ramp_rate", ConditionStatus::Invalid, &[], Some(required), note);
    };
    let (rate, u) = (worst.rate_deg_c_h.abs(), guard(worst.rate_uncertainty_deg_c_h));
    let margin = inside(rate);
    let (status, key) = if margin >= u {
        (ConditionStatus::Ok, "schedule.rate")
    } else if margin >= -u {
        (ConditionStatus::Invalid, "schedule.rate_not_shown")
    } else if (rate / 60.0 >= low && rate / 60.0 <= high) && rate > 10.0 * high {
        (ConditionStatus::Invalid, "schedule.rate_hours")
    } else {
        (ConditionStatus::Invalid, "schedule.rate_outside")
    };
    let note = Note::new(key)
        .with("rate", c(rate))
        .with("u", Arg::figures(u, 2))
        .with("from_h", Arg::figures(worst.from_s / 3600.0, 4))
        .with("n", ramps.len());
    record("ramp_rate", status, &[("rate_deg_c_h", rate), ("guard_deg_c_h", u)], Some(required), note)
}

/// Share of its length that a dwell must show: where a ramp ends is known to some minutes only.
const LEAST_DWELL_SHARE: f64 = 0.9;

/// Every dwell between ramps long and quiet enough.
fn dwells(run: &Run, test: &TemperatureTest, least_s: f64) -> ConditionRecord {
    let required = note!(
        "schedule.required.dwell",
        minutes = Arg::Stated(least_s / 60.0),
        tolerance = Arg::Stated(100.0 * (1.0 - LEAST_DWELL_SHARE)),
        drift = Arg::Stated(test.dwell_drift_deg_c_h)
    );
    // Between two ramps there must be one; after the last ramp it need not be there.
    let mut shortest: Option<(f64, f64, f64)> = None;
    for (i, ramp) in run.segments.iter().enumerate().filter(|(_, s)| s.kind.is_ramp()) {
        let Some(next) = run.segments.get(i + 1) else { continue };
        let (length, drift) =
            if next.kind.is_ramp() { (0.0, 0.0) } else { (next.length_s(), next.rate_deg_c_h) };
        // A ramp that turned back is said to have done so.
        if turned_back(run, test).any(|t| t == ramp) {
            continue;
        }
        let last = !next.kind.is_ramp() && i + 2 >= run.segments.len();
        if !last && shortest.is_none_or(|s| length < s.0) {
            shortest = Some((length, drift, ramp.to_s));
        }
    }
    let none = run.segments.iter().all(|s| s.kind != SegmentKind::Dwell);
    if none && shortest.is_some() {
        let note = note!("schedule_dwell.none");
        return record("dwell", ConditionStatus::Invalid, &[("shortest_s", 0.0)], Some(required), note);
    }
    let Some((length, _, at)) = shortest else {
        let note = note!("schedule.no_dwell");
        return record("dwell", ConditionStatus::Remark, &[], Some(required), note);
    };
    let restless = run
        .segments
        .iter()
        .filter(|s| s.kind == SegmentKind::Dwell)
        .map(|s| s.rate_deg_c_h.abs())
        .fold(0.0, f64::max);
    let long_enough = length >= LEAST_DWELL_SHARE * least_s;
    let quiet = restless <= test.dwell_drift_deg_c_h;
    let (status, key) = match (long_enough, quiet) {
        (true, true) => (ConditionStatus::Ok, "schedule.dwell"),
        (false, _) => (ConditionStatus::Invalid, "schedule.dwell_short"),
        (true, false) => (ConditionStatus::Invalid, "schedule.dwell_restless"),
    };
    let note = Note::new(key)
        .with("minutes", Arg::figures(length / 60.0, 3))
        .with("time_h", Arg::figures(at / 3600.0, 4))
        .with("drift", Arg::figures(restless, 2));
    record("dwell", status, &[("shortest_s", length), ("drift_deg_c_h", restless)], Some(required), note)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temperature::course::Span;

    /// Ramps of an hour from temperature to temperature, with a dwell behind those that are marked.
    fn run(ways: &[(f64, f64, bool)]) -> Run {
        let mut segments = vec![];
        let mut time = 0.0;
        for (from, to, rests) in ways {
            let kind = if to > from { SegmentKind::Heating } else { SegmentKind::Cooling };
            let segment = |kind, from_s: f64, begins: f64| Segment {
                kind,
                from_s,
                to_s: from_s + 3600.0,
                begins_deg_c: begins,
                ends_deg_c: *to,
                rate_deg_c_h: if kind == SegmentKind::Dwell { 0.0 } else { to - from },
                rate_uncertainty_deg_c_h: 0.01,
            };
            segments.push(segment(kind, time, *from));
            time += 3600.0;
            if *rests {
                segments.push(segment(SegmentKind::Dwell, time, *to));
                time += 3600.0;
            }
        }
        let reached = Span { low: -40.0, high: 60.0 };
        Run { segments, reached, last_deg_c: 0.0, temperature: vec![], command: None, missing: 0.0 }
    }

    fn asked() -> TemperatureTest {
        TemperatureTest {
            channel: "temp".into(),
            command: None,
            low_deg_c: -40.0,
            high_deg_c: 60.0,
            end_tolerance_deg_c: 2.0,
            overshoot_deg_c: None,
            ramp_rate_deg_c_h: None,
            ramp_rate_tolerance: 0.1,
            slowest_deg_c_h: 4.0,
            fastest_deg_c_h: 110.0,
            dwell_s: Some(2700.0),
            dwell_drift_deg_c_h: 1.0,
            ramps_each_way: 2,
            sensor_uncertainty_deg_c: 0.1,
            coverage_factor: 2.0,
            zones_deg_c: vec![],
            residual_average_s: 100.0,
            highest_order: 6,
            segments: vec![],
        }
    }

    #[test]
    fn a_ramp_that_turned_before_its_end_is_told_and_its_dwell_is_not_missed() {
        let turned =
            run(&[(-40.0, 60.0, true), (60.0, -40.0, true), (-40.0, 20.0, false), (20.0, -40.0, true)]);
        let found: Vec<f64> = turned_back(&turned, &asked()).map(|s| s.ends_deg_c).collect();
        assert_eq!(found, [20.0]);
        assert_eq!(dwells(&turned, &asked(), 2700.0).status, ConditionStatus::Ok);
        let rested = run(&[(-40.0, 60.0, true), (60.0, 0.0, true), (0.0, 60.0, true)]);
        assert_eq!(turned_back(&rested, &asked()).count(), 1);
        // Steps on one way are no turn.
        let steps = run(&[(-40.0, 0.0, true), (0.0, 60.0, true), (60.0, -40.0, true)]);
        assert_eq!(turned_back(&steps, &asked()).count(), 0);
    }

    #[test]
    fn a_temperature_with_the_wrong_sign_runs_against_the_schedule() {
        use crate::temperature::StatedSegment;
        let ways = [(-50.0, 50.0, true), (50.0, -50.0, true)];
        let up_and_down = run(&ways);
        let mut down_and_up = run(&ways.map(|(from, to, rests)| (-from, -to, rests)));
        let symmetric = TemperatureTest { low_deg_c: -50.0, high_deg_c: 50.0, ..asked() };
        // Without a shape nothing tells the sign.
        assert_eq!(reversed(&down_and_up, &symmetric), None);
        let segments = up_and_down.segments.iter();
        let stated =
            segments.map(|s| StatedSegment { kind: s.kind, from_s: s.from_s, to_s: s.to_s }).collect();
        let stated = TemperatureTest { segments: stated, ..symmetric.clone() };
        // Segments are of the stated kind, with the rates that were recorded.
        for (found, asked) in down_and_up.segments.iter_mut().zip(&stated.segments) {
            found.kind = asked.kind;
        }
        assert_eq!(reversed(&down_and_up, &stated), Some("schedule.reversed_course"));
        assert_eq!(reversed(&up_and_down, &stated), None);
        let course: Vec<(f64, f64)> = (0..100).map(|i| (f64::from(i), (0.1 * f64::from(i)).sin())).collect();
        let behind: Vec<(f64, f64)> =
            (0..100).map(|i| (f64::from(i), (0.1 * f64::from(i) - 0.5).sin())).collect();
        let commanded = |sign: f64| Run {
            temperature: behind.iter().map(|p| (p.0, sign * p.1)).collect(),
            command: Some(course.clone()),
            ..run(&ways)
        };
        assert_eq!(reversed(&commanded(1.0), &symmetric), None);
        assert_eq!(reversed(&commanded(-1.0), &symmetric), Some("schedule.reversed_course"));
        // Ends that differ in size tell it by themselves.
        assert_eq!(other_scale((-60.0, 40.0), &asked()), Some("schedule.reversed"));
        assert_eq!(other_scale((-40.0, 60.0), &asked()), None);
        assert_eq!(other_scale((-50.0, 50.0), &symmetric), None);
    }

    #[test]
    fn a_ramp_beyond_its_end_has_nothing_left_to_go() {
        let beyond = run(&[(-40.0, 64.0, false), (64.0, -44.0, false)]);
        assert!(beyond.segments.iter().all(|s| left(s, &asked()) < 0.0));
        let none = dwells(&beyond, &asked(), 2700.0);
        assert_eq!(none.message.as_ref().map(|m| m.id.as_ref()), Some("schedule_dwell.none"));
    }
}
