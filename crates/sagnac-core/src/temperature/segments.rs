//! The segments of a schedule: from the temperature record, from a command channel, or as the procedure states them.

use super::test::{SegmentKind, TemperatureTest};

/// A segment with what was measured in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its kind.
    pub kind: SegmentKind,
    /// Start, s from the start of the recording.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Mean temperature at its beginning, degC.
    pub begins_deg_c: f64,
    /// Mean temperature at its end, degC.
    pub ends_deg_c: f64,
    /// Rate over the middle eight tenths of its way, degC/h; of a dwell, its drift over the second half.
    pub rate_deg_c_h: f64,
    /// Standard uncertainty of that rate, degC/h: the sensor at both ends of the way, and the scatter.
    pub rate_uncertainty_deg_c_h: f64,
}

impl Segment {
    /// Length, s.
    pub fn length_s(&self) -> f64 {
        self.to_s - self.from_s
    }
}

/// Share of the slowest ramp allowed from which a course counts as a ramp.
const RAMPS_FROM: f64 = 0.5;
/// Share of the span that a ramp covers at least.
const LEAST_WAY: f64 = 0.04;

/// A temperature as means over steps: time of the first step's start, length of a step, values.
#[derive(Debug, Clone, Copy)]
pub struct Steps<'a> {
    /// Start of the first step, s from the start of the recording.
    pub first_s: f64,
    /// Length of a step, s.
    pub step_s: f64,
    /// Means, degC; none missing.
    pub values: &'a [f64],
}

/// Length of the straight line from which the slope at a place is read, s.
fn window_s(steps: &Steps<'_>) -> f64 {
    (steps.values.len() as f64 * steps.step_s / 200.0).clamp(30.0, 600.0).max(3.0 * steps.step_s)
}

/// Segments of a temperature. `by` gives the boundaries, `measured` the temperatures in them.
pub fn find(by: &Steps<'_>, measured: &Steps<'_>, test: &TemperatureTest) -> Vec<Segment> {
    let spans = if test.segments.is_empty() {
        boundaries(by, RAMPS_FROM * test.slowest_deg_c_h)
    } else {
        test.segments.iter().map(|s| (s.kind, s.from_s, s.to_s)).collect()
    };
    let measure = |(kind, from_s, to_s)| measure(kind, from_s, to_s, measured, test.sensor_uncertainty_deg_c);
    spans.into_iter().filter_map(measure).collect()
}

fn boundaries(steps: &Steps<'_>, threshold_deg_c_h: f64) -> Vec<(SegmentKind, f64, f64)> {
    let n = steps.values.len();
    if n < 8 {
        return vec![];
    }
    let reach = ((0.5 * window_s(steps) / steps.step_s).round() as usize).clamp(1, n / 4);
    let per_hour = super::course::rate_per_minute(steps.values, steps.step_s, reach);
    let sign = |v: f64| {
        if v.abs() * 60.0 < threshold_deg_c_h { 0i8 } else { v.signum() as i8 }
    };
    let mut runs: Vec<(i8, usize, usize)> = vec![];
    for (i, v) in per_hour.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if run.0 == sign(*v) => run.2 = i + 1,
            _ => runs.push((sign(*v), i, i + 1)),
        }
    }
    let (low, high) = steps.values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let way = |run: &(i8, usize, usize)| (steps.values[run.2 - 1] - steps.values[run.1]).abs();
    // A stretch that is too short or covers too little is no segment of its own.
    loop {
        let least = |run: &(i8, usize, usize)| {
            let short = run.2 - run.1 < 2 * reach;
            if run.0 == 0 { short } else { short || way(run) < LEAST_WAY * (high - low) }
        };
        let doomed = runs
            .iter()
            .enumerate()
            .filter(|(_, r)| runs.len() > 1 && least(r))
            .min_by_key(|(_, r)| r.2 - r.1)
            .map(|(i, _)| i);
        let Some(at) = doomed else { break };
        // A short stop in a ramp belongs to it; a short movement beside a dwell belongs to the dwell.
        let sides = (at.checked_sub(1).map(|i| runs[i].0), runs.get(at + 1).map(|r| r.0));
        let into = match sides {
            (Some(a), Some(b)) if a == b => a,
            (Some(0), _) | (_, Some(0)) => 0,
            (Some(a), _) => a,
            (None, Some(b)) => b,
            (None, None) => break,
        };
        runs[at].0 = into;
        let mut joined: Vec<(i8, usize, usize)> = vec![];
        for run in &runs {
            match joined.last_mut() {
                Some(last) if last.0 == run.0 => last.2 = run.2,
                _ => joined.push(*run),
            }
        }
        if joined.len() == runs.len() {
            break;
        }
        runs = joined;
    }
    let time = |i: usize| steps.first_s + i as f64 * steps.step_s;
    let mut ramped = false;
    runs.into_iter()
        .map(|(sign, from, to)| {
            let kind = match sign {
                0 if ramped => SegmentKind::Dwell,
                0 => SegmentKind::Soak,
                s if s > 0 => SegmentKind::Heating,
                _ => SegmentKind::Cooling,
            };
            ramped |= kind.is_ramp();
            (kind, time(from), time(to))
        })
        .collect()
}

fn measure(
    kind: SegmentKind,
    from_s: f64,
    to_s: f64,
    steps: &Steps<'_>,
    sensor_uncertainty: f64,
) -> Option<Segment> {
    let at =
        |t: f64| (((t - steps.first_s) / steps.step_s).round().max(0.0) as usize).min(steps.values.len());
    let values = steps.values.get(at(from_s)..at(to_s))?;
    let (first, last) = (*values.first()?, *values.last()?);
    let inner: Vec<(f64, f64)> = {
        let (low, high) = (first.min(last), first.max(last));
        let margin = 0.1 * (high - low);
        let time = |i: usize| i as f64 * steps.step_s / 3600.0;
        let half = values.len() / 2;
        let inside = |(i, v): &(usize, f64)| {
            if kind.is_ramp() { (low + margin..=high - margin).contains(v) } else { *i >= half }
        };
        values.iter().copied().enumerate().filter(inside).map(|(i, v)| (time(i), v)).collect()
    };
    let (rate, scatter) = line(&inner)?;
    let hours = inner.last()?.0 - inner.first()?.0;
    let sensor = if hours > 0.0 { 2f64.sqrt() * sensor_uncertainty / hours } else { f64::INFINITY };
    // The error of a sensor is the same at one temperature: of a dwell it changes nothing.
    let sensor = if kind.is_ramp() { sensor } else { 0.0 };
    Some(Segment {
        kind,
        from_s,
        to_s,
        begins_deg_c: first,
        ends_deg_c: last,
        rate_deg_c_h: rate,
        rate_uncertainty_deg_c_h: sensor.hypot(scatter),
    })
}

/// Theil-Sen slope, and its standard uncertainty from the scatter about the line.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    const MAX_SEGMENTS: usize = 300;
    let stride = points.len().div_ceil(MAX_SEGMENTS).max(1);
    let few: Vec<(f64, f64)> = points.iter().step_by(stride).copied().collect();
    if few.len() < 3 {
        return None;
    }
    let mut slopes = vec![];
    for (i, a) in few.iter().enumerate() {
        for b in &few[i + 1..] {
            slopes.push((b.1 - a.1) / (b.0 - a.0));
        }
    }
    let middle = slopes.len() / 2;
    let slope = *slopes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let n = few.len() as f64;
    let (tm, ym) = (few.iter().map(|p| p.0).sum::<f64>() / n, few.iter().map(|p| p.1).sum::<f64>() / n);
    let rest: f64 = few.iter().map(|p| (p.1 - ym - slope * (p.0 - tm)).powi(2)).sum::<f64>() / (n - 2.0);
    let spread: f64 = few.iter().map(|p| (p.0 - tm).powi(2)).sum();
    (spread > 0.0).then(|| (slope, (rest / spread).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn asked() -> TemperatureTest {
        TemperatureTest {
            channel: "temp".into(),
            command: None,
            low_deg_c: -40.0,
            high_deg_c: 60.0,
            end_tolerance_deg_c: 2.0,
            overshoot_deg_c: Some(3.0),
            ramp_rate_deg_c_h: None,
            ramp_rate_tolerance: 0.1,
            slowest_deg_c_h: 4.0,
            fastest_deg_c_h: 60.0,
            dwell_s: None,
            dwell_drift_deg_c_h: 1.0,
            ramps_each_way: 1,
            sensor_uncertainty_deg_c: 0.1,
            coverage_factor: 2.0,
            zones_deg_c: vec![],
            residual_average_s: 100.0,
            highest_order: 6,
            segments: vec![],
        }
    }

    /// Soak 2 h at −40, up at `rate`, dwell 2 h, down, dwell 1 h; steps of 60 s.
    fn cycle(rate: f64, noise: f64) -> Vec<f64> {
        let mut t = vec![-40.0; 120];
        let step = rate / 60.0;
        let n = (100.0 / step).round() as usize;
        t.extend((0..n).map(|i| -40.0 + step * i as f64));
        t.extend(vec![60.0; 120]);
        t.extend((0..n).map(|i| 60.0 - step * i as f64));
        t.extend(vec![-40.0; 60]);
        let mut state = 1u64;
        for v in &mut t {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            *v += noise * ((state >> 33) as f64 / (1u64 << 31) as f64 - 0.5);
        }
        t
    }

    #[test]
    fn a_cycle_is_found_with_its_rates() {
        for rate in [4.0, 20.0, 60.0] {
            let values = cycle(rate, 0.1);
            let steps = Steps { first_s: 0.0, step_s: 60.0, values: &values };
            let found = find(&steps, &steps, &asked());
            let kinds: Vec<_> = found.iter().map(|s| s.kind).collect();
            use SegmentKind::{Cooling, Dwell, Heating, Soak};
            assert_eq!(kinds, [Soak, Heating, Dwell, Cooling, Dwell], "{rate}");
            assert!((found[1].rate_deg_c_h / rate - 1.0).abs() < 0.01, "{found:?}");
            assert!((found[3].rate_deg_c_h / rate + 1.0).abs() < 0.01);
            assert!((found[1].from_s - 7200.0).abs() < 900.0 && (found[1].ends_deg_c - 60.0).abs() < 1.5);
        }
    }

    #[test]
    fn a_command_and_a_procedure_say_where_segments_are() {
        let values = cycle(20.0, 0.0);
        let command = Steps { first_s: 0.0, step_s: 60.0, values: &values };
        // The unit follows twenty minutes behind.
        let late: Vec<f64> = (0..values.len()).map(|i| values[i.saturating_sub(20)]).collect();
        let measured = Steps { values: &late, ..command };
        let (by_command, by_itself) =
            (find(&command, &measured, &asked()), find(&measured, &measured, &asked()));
        assert_eq!((by_command.len(), by_itself.len()), (5, 5));
        let behind = by_itself[1].from_s - by_command[1].from_s;
        assert!((behind - 1200.0).abs() <= 120.0, "{behind}");
        let stated = |kind, from_s, to_s| crate::temperature::StatedSegment { kind, from_s, to_s };
        let test = TemperatureTest {
            segments: vec![
                stated(SegmentKind::Soak, 0.0, 7000.0),
                stated(SegmentKind::Heating, 7200.0, 25_200.0),
            ],
            ..asked()
        };
        let found = find(&command, &command, &test);
        assert_eq!((found.len(), found[1].from_s), (2, 7200.0));
        assert!((found[1].rate_deg_c_h - 20.0).abs() < 0.01);
    }

    #[test]
    fn a_ramp_that_pauses_is_one_ramp_and_a_still_record_has_none() {
        let mut values: Vec<f64> = (0..400).map(|i| 0.1 * f64::from(i)).collect();
        for i in 200..206 {
            values[i] = values[200];
        }
        let steps = Steps { first_s: 0.0, step_s: 60.0, values: &values };
        let kinds: Vec<_> = find(&steps, &steps, &asked()).iter().map(|s| s.kind).collect();
        assert_eq!(kinds, [SegmentKind::Heating]);
        let still = vec![21.0; 400];
        let steps = Steps { values: &still, ..steps };
        assert!(find(&steps, &steps, &asked()).iter().all(|s| !s.kind.is_ramp()));
    }
}
