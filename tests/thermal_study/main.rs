//! Intervals over temperature against simulated truth, by a generator that knows nothing of the program.
//!
//! The short study runs with the tests; the long one:
//! `SAGNAC_RUNS=1000 cargo test --release --test thermal_study -- --ignored --nocapture`

mod ambiguity;
mod chamber;
mod mistaken;
mod samples;
mod settling;
mod tally;

use chamber::warm_up as switched_on;
use chamber::{Chance, Leg, Noise, Recorded, Unit, programme, record};
use rayon::prelude::*;
use sagnac::estimate::{Estimate, normal_probability};
use sagnac::measurand::{TURN_ON_TRANSIENT, WARM_UP_TIME, find};
use sagnac::temperature::course::{Shape, Terms};
use sagnac::temperature::findings::{Findings, findings, schedule};
use sagnac::temperature::gls::Modes;
use sagnac::temperature::read::of_distribution;
use sagnac::temperature::start::Start;
use sagnac::temperature::track::Track;
use sagnac::temperature::warm_up::WarmUpFindings;
use sagnac::temperature::{StartAsked, TemperatureTest, WarmUpTest, warm_up};
use std::collections::BTreeMap;
use tally::Tally;

/// The rows of a measurand over temperature.
fn over_temperature(id: &str, found: &Findings) -> Vec<Estimate> {
    find(id).map_or_else(Vec::new, |m| m.evaluate_temperature("rate", found))
}

/// The rows of a warm-up.
fn warm_up_rows(found: &WarmUpFindings) -> Vec<Estimate> {
    [&TURN_ON_TRANSIENT, &WARM_UP_TIME].into_iter().flat_map(|m| m.evaluate_warm_up("rate", found)).collect()
}

fn asked() -> TemperatureTest {
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
        fastest_deg_c_h: 62.0,
        dwell_s: None,
        dwell_drift_deg_c_h: 1.0,
        ramps_each_way: 1,
        sensor_uncertainty_deg_c: 0.05,
        coverage_factor: 2.0,
        zones_deg_c: vec![-40.0, -15.0, 10.0, 35.0, 60.0],
        residual_average_s: 100.0,
        highest_order: std::env::var("SAGNAC_ORDER").ok().and_then(|v| v.parse().ok()).unwrap_or(6),
        segments: vec![],
    }
}

fn found(r: &Recorded) -> Findings {
    let mut track = Track::new(2, r.dt);
    track.push(0, &r.rate, 0);
    track.push(1, &r.temperature, 0);
    let means = track.finish().unwrap();
    let test = asked();
    let s = schedule(&means, 1, None, &test);
    findings(&means, 0, 1, s, &test)
}

/// A unit at random: a navigation-grade coil, every effect plainly there.
fn unit(chance: &mut Chance) -> Unit {
    let sign = |c: &mut Chance| if c.uniform() < 0.5 { -1.0 } else { 1.0 };
    Unit {
        a: [
            sign(chance) * chance.between(2e-4, 2e-3),
            sign(chance) * chance.between(2e-6, 2e-5),
            sign(chance) * chance.between(0.0, 1.5e-7),
        ],
        shupe: sign(chance) * chance.between(0.01, 0.08),
        lag_s: chance.between(300.0, 1500.0),
        hysteresis: (sign(chance) * chance.between(0.003, 0.012), chance.between(1.0, 5.0)),
        noise: Noise {
            n: chance.between(0.001, 0.003),
            b: chance.between(0.0, 0.003),
            k: chance.between(0.0, 0.002),
        },
        level: 12.4,
    }
}

const IDS: [&str; 9] = [
    "bias_temperature_sensitivity",
    "bias_temperature_sensitivity_max",
    "bias_over_temperature_peak_to_peak",
    "bias_over_temperature_rms",
    "bias_temperature_rate_sensitivity",
    "thermal_lag",
    "thermal_hysteresis",
    "bias_loop_width",
    "angle_random_walk_at_temperature",
];

/// The magnitude of a row.
fn upright(e: &Estimate) -> Estimate {
    let mut out = e.clone();
    if let (Some(v), sagnac::estimate::Spread::Curve(points)) = (e.value, &e.spread)
        && v < 0.0
    {
        out.value = Some(-v);
        let turned = points.iter().rev().map(|(z, x)| (-z, -x)).collect();
        out.spread = sagnac::estimate::Spread::Curve(turned);
    }
    out
}

fn truth(id: &str, u: &Unit, f: &Findings) -> f64 {
    let a = f.analysis.as_ref().unwrap();
    let span = a.posterior.span;
    let (pp, rms, slope, steepest) = u.statistics(span.low, span.high);
    match id {
        "bias_temperature_sensitivity" => slope,
        // Its sign is that of the steepest place of the fit, which may be the other of two nearly as steep ones.
        "bias_temperature_sensitivity_max" => steepest.abs(),
        "bias_over_temperature_peak_to_peak" => pp,
        "bias_over_temperature_rms" => rms,
        "bias_temperature_rate_sensitivity" => u.shupe,
        "thermal_lag" => u.lag_s,
        "thermal_hysteresis" => 2.0 * u.hysteresis.0,
        _ => u.noise.n,
    }
}

/// Deviations of a fit that is told noise, lag, play and order.
fn told(u: &Unit, f: &Findings) -> Option<BTreeMap<&'static str, f64>> {
    let a = f.analysis.as_ref()?;
    let span = a.posterior.span;
    let terms = Terms { order: 3, rate: true, hysteresis: true };
    let shape = Shape { lag_s: u.lag_s, play_deg_c: u.hysteresis.1 };
    let modes = Modes::new(a.course.len(), a.course.block_s);
    let columns: Vec<_> = a.course.columns(&terms, &shape, &span).iter().map(|c| modes.of(c)).collect();
    let solved =
        modes.solve(&modes.of(&a.course.rate_deg_h), &columns, &[u.noise.n, u.noise.b, u.noise.k])?;
    let deviation = |i: usize| solved.covariance[(i, i)].sqrt();
    Some(BTreeMap::from([
        ("bias_temperature_sensitivity", deviation(0) * 2.0 / (span.high - span.low)),
        ("bias_temperature_rate_sensitivity", deviation(3)),
        ("thermal_hysteresis", 2.0 * deviation(4)),
    ]))
}

fn study(rates: &[f64], dwell_s: f64, runs: u64, first: u64) -> BTreeMap<&'static str, Tally> {
    let mut tallies: BTreeMap<&'static str, Tally> = BTreeMap::new();
    let legs: Vec<Leg> = programme(rates, dwell_s);
    let mut orders = [0; 8];
    let evaluated = |seed: u64| {
        let u = unit(&mut Chance::new(seed));
        let f = found(&record(&u, -40.0, &legs, 10.0, 0.01, 7919 * seed + 1));
        let told = told(&u, &f);
        (u, f, told)
    };
    let tests: Vec<_> = (first..first + runs).into_par_iter().map(evaluated).collect();
    for (u, f, told) in tests {
        if let Some(a) = &f.analysis {
            orders[a.order] += 1;
        }
        for id in IDS {
            let rows = over_temperature(id, &f);
            if id == "bias_loop_width" {
                let a = f.analysis.as_ref().unwrap();
                // At the place that the row names: 2 (D r − b'(T) τ r + h), the coil being where the sensor is.
                let at = rows.first().and_then(|e| match e.notes.first()?.args.get("deg_c")? {
                    sagnac::i18n::Arg::Figures { value, .. } => Some(*value),
                    _ => None,
                });
                let (rate, Some(t)) = (a.ramp_deg_c_min, at) else { continue };
                let expected = 2.0 * (u.shupe * rate - u.slope(t) * u.lag_s / 60.0 * rate + u.hysteresis.0);
                tallies.entry(id).or_default().add(rows.first(), expected, None);
                continue;
            }
            let expected = truth(id, &u, &f);
            let told = told.as_ref().and_then(|t| t.get(id)).copied();
            let rows: Vec<Estimate> =
                if id.ends_with("_max") { rows.iter().map(upright).collect() } else { rows };
            for row in rows.iter().take(if id.starts_with("angle") { 5 } else { 1 }) {
                tallies.entry(id).or_default().add(Some(row), expected, told);
            }
        }
    }
    eprintln!("orders shown, 0 to 6 (three is right): {:?}", &orders[..7]);
    tallies
}

/// A unit at random that warms up: its warm-up time in s, its transient in deg/h, and what is found.
fn warm_up_of(seed: u64) -> Option<(f64, f64, warm_up::WarmUpFindings)> {
    let mut chance = Chance::new(seed);
    let decays = [
        (chance.between(0.1, 0.5), chance.between(120.0, 600.0)),
        (chance.between(-0.2, 0.2), chance.between(900.0, 2500.0)),
    ];
    let model = Noise { n: chance.between(0.0005, 0.002), b: chance.between(0.0, 0.002), k: 0.0 };
    let (dt, count) = (5.0, 5760);
    let y = switched_on(&decays, 12.5, model, dt, count, seed);
    let mut track = Track::new(1, dt);
    track.push(0, &y, 0);
    let asked = WarmUpTest { band_deg_h: 0.02, final_share: 0.25, start: StartAsked::Declared };
    let f = warm_up::find(&track.finish().unwrap(), 0, &asked, Start::Declared)?;
    let at = |t: f64| decays.iter().map(|(a, c)| a * (-t / c).exp()).sum::<f64>();
    let length = dt * count as f64;
    let end: f64 =
        (0..1000).map(|i| at(length * (0.75 + 0.25 * (i as f64 + 0.5) / 1000.0))).sum::<f64>() / 1000.0;
    let truth = (0..length as usize).rev().find(|t| (at(*t as f64) - end).abs() > 0.02).unwrap_or(0) as f64;
    Some((truth, at(0.0) - end, f))
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn warm_up_times_cover() {
    let (mut time, mut transient) = (Tally::default(), Tally::default());
    let (mut below, mut bounded) = (0, 0);
    for seed in first(200_001)..first(200_001) + runs() {
        let Some((truth, transient_truth, f)) = warm_up_of(seed) else { continue };
        let rows = warm_up_rows(&f);
        time.add(rows.iter().find(|e| e.id == "warm_up_time"), truth, None);
        transient.add(rows.iter().find(|e| e.id == "turn_on_transient"), transient_truth, None);
        if let Some(limit) = rows.iter().find(|e| e.id == "warm_up_time").and_then(|e| e.upper_limit) {
            bounded += 1;
            below += usize::from(truth <= limit.value);
        }
    }
    time.say("warm_up_time");
    transient.say("turn_on_transient");
    eprintln!("bounds: {below} of {bounded} hold");
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|v| v.parse().ok())
}

fn runs() -> u64 {
    number("SAGNAC_RUNS").unwrap_or(200)
}

/// First seed of a long study.
fn first(otherwise: u64) -> u64 {
    number("SAGNAC_FIRST").unwrap_or(otherwise)
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn intervals_cover_at_two_rates_with_dwells() {
    for (id, mut t) in study(&[60.0, 20.0], 3600.0, runs(), first(1)) {
        t.say(id);
    }
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn intervals_cover_at_one_rate_with_dwells() {
    for (id, mut t) in study(&[20.0], 3600.0, runs(), first(50_001)) {
        t.say(id);
    }
}

#[test]
#[ignore = "minutes; see the head of the file"]
fn one_rate_without_dwells() {
    for (id, mut t) in study(&[20.0], 0.0, runs(), first(90_001)) {
        t.say(id);
    }
}

/// Width of the sensitivity's interval over that of a fit told everything, and whether it holds the truth, for a fit told
/// lag, play, order and N, and of B and K that they are evenly spread below `most` (`None`: what the program takes).
fn told_a_range(u: &Unit, f: &Findings, most: Option<f64>) -> Option<(f64, bool)> {
    const STEPS: usize = 12;
    let a = f.analysis.as_ref()?;
    let span = a.posterior.span;
    let terms = Terms { order: 3, rate: true, hysteresis: true };
    let shape = Shape { lag_s: u.lag_s, play_deg_c: u.hysteresis.1 };
    let modes = Modes::new(a.course.len(), a.course.block_s);
    let data = modes.of(&a.course.rate_deg_h);
    let columns: Vec<_> = a.course.columns(&terms, &shape, &span).iter().map(|c| modes.of(c)).collect();
    let visible = modes.visible(u.noise.n);
    let at = |i: usize, which: usize| {
        let share = (i as f64 + 0.5) / STEPS as f64;
        match most {
            Some(factor) => factor * [0.003, 0.002][which] * share,
            // Equal steps of ln(x + visible), up to a hundred times what the record shows.
            None => visible[which] * (share * 101f64.ln()).exp_m1(),
        }
    };
    let per_deg_c = 2.0 / (span.high - span.low);
    let mut parts = vec![];
    for i in 0..STEPS {
        for j in 0..STEPS {
            let s = modes.solve(&data, &columns, &[u.noise.n, at(i, 0), at(j, 1)])?;
            parts.push((
                s.log_likelihood,
                s.coefficients[0] * per_deg_c,
                s.covariance[(0, 0)].sqrt() * per_deg_c,
            ));
        }
    }
    let top = parts.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = parts.iter().map(|p| (p.0 - top).exp()).sum();
    let below = |x: f64| {
        parts.iter().map(|(l, m, s)| (l - top).exp() * normal_probability((x - m) / s)).sum::<f64>() / total
    };
    let ends = parts.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (_, m, s)| {
        (l.min(m - 6.0 * s), h.max(m + 6.0 * s))
    });
    let reading = of_distribution(below, ends);
    let i = reading.spread.interval(reading.value, 0.95)?;
    let exact = told(u, f)?["bias_temperature_sensitivity"];
    let truth = truth("bias_temperature_sensitivity", u, f);
    Some(((i.high - i.low) / 3.92 / exact, (i.low..=i.high).contains(&truth)))
}

/// What a fit can do that is told everything but the strengths of the slow noise: the program is to be held against it.
#[test]
#[ignore = "minutes; see the head of the file"]
fn sensitivity_at_one_rate_told_all_but_the_slow_noise() {
    let legs = programme(&[20.0], 3600.0);
    // Walks as the other studies draw them, and twice as strong ones.
    for stronger in [1.0, 2.0] {
        let mut rows = vec![(vec![], 0); 5];
        for seed in first(60_001)..first(60_001) + runs() {
            let mut chance = Chance::new(seed);
            let mut u = unit(&mut chance);
            u.noise.b *= stronger;
            u.noise.k *= stronger;
            let r = record(&u, -40.0, &legs, 10.0, 0.01, 7919 * seed + 1);
            let f = found(&r);
            let own = over_temperature("bias_temperature_sensitivity", &f);
            let own = own[0].interval95().and_then(|i| {
                let truth = truth("bias_temperature_sensitivity", &u, &f);
                let exact = told(&u, &f)?["bias_temperature_sensitivity"];
                Some(((i.high - i.low) / 3.92 / exact, (i.low..=i.high).contains(&truth)))
            });
            let ranges = [Some(1.0), Some(3.0), Some(10.0), None].map(|m| told_a_range(&u, &f, m));
            for (row, got) in rows.iter_mut().zip(ranges.into_iter().chain([own])) {
                let (width, inside) = got.expect("an interval");
                row.0.push(width);
                row.1 += usize::from(inside);
            }
        }
        let names = ["range once", "range times 3", "range times 10", "the program's density", "the program"];
        for ((mut widths, inside), name) in rows.into_iter().zip(names) {
            widths.sort_by(f64::total_cmp);
            let (n, median) = (widths.len(), widths[widths.len() / 2]);
            eprintln!(
                "B, K times {stronger}: {name:<22} width {median:.2} of told all, covered {:.3} of {n}",
                inside as f64 / n as f64
            );
        }
    }
}

#[test]
fn warm_up_intervals_hold_where_two_decays_are_nearly_one() {
    // Seeds of the study whose intervals missed while coefficients had a flat density.
    let (mut inside, seeds) = (0, [200_017, 200_031, 200_043, 200_051]);
    for seed in seeds {
        let (truth, _, found) = warm_up_of(seed).expect("a warm-up");
        let rows = warm_up_rows(&found);
        let time = rows.iter().find(|e| e.id == "warm_up_time").unwrap().interval95().unwrap();
        inside += usize::from((time.low..=time.high).contains(&truth));
    }
    assert!(inside >= 3, "{inside} of {}", seeds.len());
}

#[test]
fn a_few_intervals_hold() {
    let tallies = study(&[60.0, 20.0], 3600.0, 20, 700_001);
    let linear = ["bias_temperature_sensitivity", "bias_temperature_rate_sensitivity", "thermal_hysteresis"];
    let (inside, stated) =
        linear.iter().map(|id| &tallies[id]).fold((0, 0), |(i, s), t| (i + t.inside, s + t.stated));
    // Of 60 at 95 % fewer than 52 are inside once in 300 times.
    assert!(stated == 60 && inside >= 52, "{inside} of {stated}");
    let zones = &tallies["angle_random_walk_at_temperature"];
    // Of 100 fewer than 89 once in 200 times.
    assert!(zones.stated == 100 && zones.inside >= 89, "{} of {}", zones.inside, zones.stated);
}

/// The rows of one recording.
fn rows_of(legs: &[Leg], start: f64) -> BTreeMap<&'static str, Estimate> {
    let u = unit(&mut Chance::new(5));
    let f = found(&record(&u, start, legs, 10.0, 0.01, 77));
    let row = |id: &'static str| (id, over_temperature(id, &f).swap_remove(0));
    IDS.map(row).into_iter().collect()
}

#[test]
fn what_a_schedule_cannot_tell_apart_is_not_stated_singly() {
    let single = ["bias_temperature_rate_sensitivity", "thermal_lag", "thermal_hysteresis"];
    // Up and down at one rate without rest: the sum alone.
    let rows = rows_of(&programme(&[20.0], 0.0), -40.0);
    for id in single {
        assert!(rows[id].value.is_none(), "{id}");
        assert!(rows[id].notes.iter().any(|n| n.id == "thermal.inseparable"), "{:?}", rows[id].notes);
    }
    assert!(rows["bias_loop_width"].value.is_some());
    // One way: not even the branches.
    let rows = rows_of(&[Leg::Hold(3600.0), Leg::Ramp(60.0, 20.0), Leg::Hold(3600.0)], -40.0);
    for id in ["bias_temperature_rate_sensitivity", "thermal_hysteresis", "bias_loop_width"] {
        assert!(rows[id].notes.iter().any(|n| n.id == "thermal.one_way"), "{id} {:?}", rows[id].notes);
    }
    assert!(rows["bias_temperature_sensitivity"].value.is_some());
    // Two rates with rest: each.
    let rows = rows_of(&programme(&[60.0, 20.0], 3600.0), -40.0);
    for id in single {
        assert!(rows[id].value.is_some(), "{id} {:?}", rows[id].notes);
    }
}
