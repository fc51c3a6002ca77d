//! Intervals of what a temperature test measures, at one and two rates, with and without dwells.

use super::evaluation::{found, over_temperature, unit};
use crate::bench::chamber::{Leg, Unit, programme, record};
use crate::bench::chance::Chance;
use crate::coverage::Coverage;
use crate::study::{Asked, Case, Row};
use rayon::prelude::*;
use sagnac::estimate::{Estimate, Spread};
use sagnac::i18n::Arg;
use sagnac::temperature::course::{Shape, Terms};
use sagnac::temperature::findings::Findings;
use sagnac::temperature::gls::Modes;
use std::collections::BTreeMap;

/// Measurands of a temperature test.
pub const IDS: [&str; 9] = [
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
    if let (Some(v), Spread::Curve(points)) = (e.value, &e.spread)
        && v < 0.0
    {
        out.value = Some(-v);
        let turned = points.iter().rev().map(|(z, x)| (-z, -x)).collect();
        out.spread = Spread::Curve(turned);
    }
    out
}

/// The truth of a measurand over the range that a test found.
pub fn truth(id: &str, u: &Unit, f: &Findings) -> f64 {
    let a = f.analysis.as_ref().expect("an analysis");
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

/// Standard deviations of a fit that knows noise, lag, play and order.
pub fn told(u: &Unit, f: &Findings) -> Option<BTreeMap<&'static str, f64>> {
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

/// What many tests gave.
#[derive(Debug, Default)]
pub struct Tests {
    /// Intervals by measurand.
    pub tallies: BTreeMap<&'static str, Coverage>,
    /// Tests in which the static curve is found to be of third order, as it is.
    pub right_order: usize,
}

/// Units at random in cycles at rates in °C/h with dwells in s, from a first seed on.
pub fn study(rates: &[f64], dwell_s: f64, runs: u64, first: u64) -> Tests {
    let legs: Vec<Leg> = programme(rates, dwell_s);
    let evaluated = |seed: u64| {
        let u = unit(&mut Chance::new(seed));
        let f = found(&record(&u, -40.0, &legs, 10.0, 0.01, 7919 * seed + 1));
        let told = told(&u, &f);
        (u, f, told)
    };
    let tests: Vec<_> = (first..first + runs).into_par_iter().map(evaluated).collect();
    let mut all = Tests::default();
    for (u, f, told) in tests {
        all.right_order += usize::from(f.analysis.as_ref().is_some_and(|a| a.order == 3));
        for id in IDS {
            let rows = over_temperature(id, &f);
            let tally = all.tallies.entry(id).or_default();
            if id == "bias_loop_width" {
                if let Some(expected) = loop_width(&u, &f, rows.first()) {
                    tally.take(rows.first(), expected, None);
                }
                continue;
            }
            let expected = truth(id, &u, &f);
            let told = told.as_ref().and_then(|t| t.get(id)).copied();
            let rows: Vec<Estimate> =
                if id.ends_with("_max") { rows.iter().map(upright).collect() } else { rows };
            for row in rows.iter().take(if id.starts_with("angle") { 5 } else { 1 }) {
                tally.take(Some(row), expected, told);
            }
        }
    }
    all
}

/// Width of the loop at the place that the row names: 2 (D r − b'(T) τ r + h), the coil being where the sensor is.
fn loop_width(u: &Unit, f: &Findings, row: Option<&Estimate>) -> Option<f64> {
    let at = match row?.notes.first()?.args.get("deg_c")? {
        Arg::Figures { value, .. } => *value,
        _ => return None,
    };
    let rate = f.analysis.as_ref()?.ramp_deg_c_min;
    Some(2.0 * (u.shupe * rate - u.slope(at) * u.lag_s / 60.0 * rate + u.hysteresis.0))
}

/// Two rates and one, with and without dwells.
pub(super) fn cases() -> Vec<Case> {
    let case = |name: &str, rates: &'static [f64], dwell_s: f64, first: u64| {
        Case::new(name, move |records, seed| {
            let all = study(rates, dwell_s, records, first + 100_000_000 * (seed - 1));
            let mut rows: Vec<Row> =
                all.tallies.iter().flat_map(|(id, of)| of.rows(id, Asked::AtMost(1.3))).collect();
            let claim = "the order of the static curve is found";
            rows.push(Row::share(
                "bias over temperature",
                claim,
                Asked::Nothing,
                all.right_order as u64,
                records,
            ));
            rows
        })
    };
    vec![
        case("60 and 20 °C/h with dwells", &[60.0, 20.0], 3600.0, 1),
        case("20 °C/h with dwells", &[20.0], 3600.0, 50_001),
        case("20 °C/h without dwells", &[20.0], 0.0, 90_001),
    ]
}
