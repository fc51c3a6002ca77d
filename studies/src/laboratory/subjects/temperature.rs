//! Effects of temperature on a unit whose thermometer sits on the housing and is recorded.

use crate::laboratory::bench::Bench;
use crate::laboratory::effect::{Effect, Facts, Shape, range_of};
use crate::laboratory::unit::body::Pace;
use crate::laboratory::unit::curve::{Curve, without_line};
use crate::laboratory::unit::hysteresis::{Hysteresis, loop_width};

/// A unit in a chamber whose coil follows quickly.
pub fn quick(bench: &mut Bench) {
    bench.warm(true, Pace::Quick);
    decoys(bench);
}

/// A unit in a chamber whose coil follows slowly.
pub fn slow(bench: &mut Bench) {
    bench.warm(true, Pace::Slow);
    decoys(bench);
}

fn decoys(bench: &mut Bench) {
    let count = bench.dice.count(0, 3);
    bench.record_others(count);
}

/// The coil at the slow grid, °C; flat where the unit has no thermometer.
fn coil(bench: &Bench) -> Vec<f64> {
    bench.warmth.as_ref().map_or_else(|| vec![20.0; bench.span.length], |w| w.coil())
}

/// Recorded temperatures between which an effect is seen.
fn seen(bench: &Bench, facts: Facts) -> Facts {
    let [low, high] = bench.columns.get("temp_degC").map_or([0.0, 0.0], |t| range_of(t));
    facts.at("temperature", low, high)
}

/// Recorded temperature and its rate, as places.
fn seen_with_rate(bench: &Bench, facts: Facts) -> Facts {
    let rate = bench.warmth.as_ref().map_or([0.0, 0.0], |w| range_of(&bench.span.per_minute(&w.coil())));
    let facts = facts.at("temperature_rate", rate[0], rate[1]).at("time", 0.0, bench.duration_s());
    seen(bench, facts)
}

/// Another coefficient than claimed.
pub fn linear(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let course = bench.at_rows(&coil(bench)).iter().map(|t| sign * (t - 20.0)).collect();
    let mut effect = Effect::new("temp_linear", Shape::Course(course), move |bench, size| {
        let right = bench.right.temperature.map_or(0.0, |[c, ..]| c);
        seen(bench, Facts::default()).with("coefficient_deg_h_per_degC", right + sign * size)
    });
    effect.column = Some("temp_degC".to_owned());
    effect.beside(&["thermal_lag", "temp_rate", "temp_polynomial"])
}

/// A static curve that is no polynomial.
pub fn polynomial(bench: &mut Bench) -> Effect {
    let coil = coil(bench);
    let [low, high] = range_of(&coil);
    let curve = Curve::draw(&mut bench.dice, low, high);
    let bent: Vec<f64> = coil.iter().map(|t| curve.at(*t)).collect();
    let course = bench.at_rows(&without_line(&bent, &coil));
    let mut effect =
        Effect::new("temp_polynomial", Shape::Course(course), |bench, _| seen(bench, Facts::default()));
    effect.column = Some("temp_degC".to_owned());
    effect.beside(&["thermal_lag", "temp_rate", "temp_linear"])
}

/// The effect of changing temperature on a wound coil.
pub fn rate(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let sign = dice.sign();
    let course = bench.warmth.as_ref().map_or_else(Vec::new, |w| w.shupe(&mut dice, &bench.span));
    let course = bench.at_rows(&course).iter().map(|c| sign * c).collect();
    let mut effect = Effect::new("temp_rate", Shape::Course(course), move |bench, size| {
        seen_with_rate(bench, Facts::default()).with("coefficient_deg_h_per_degC_per_min", sign * size)
    });
    effect.column = Some("temp_degC".to_owned());
    effect.beside(&["thermal_lag"])
}

/// The claimed coefficient acts through the coil, which is late.
pub fn lag(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let recorded = bench.columns.get("temp_degC").cloned().unwrap_or_default();
    let course = bench.at_rows(&coil(bench)).iter().zip(&recorded).map(|(c, r)| sign * (c - r)).collect();
    let mut effect = Effect::new("thermal_lag", Shape::Course(course), |bench, _| {
        let lag_s = bench.warmth.as_ref().map_or(0.0, |w| w.lag_s);
        seen_with_rate(bench, Facts::default().at("lag", 0.5 * lag_s, 1.5 * lag_s))
            .with("time_constant_s", lag_s)
    });
    effect.column = Some("temp_degC".to_owned());
    effect.claimed = sign;
    effect.beside(&["temp_rate"])
}

/// Loops.
pub fn hysteresis(bench: &mut Bench) -> Effect {
    let coil = coil(bench);
    let [low, high] = range_of(&coil);
    let mut dice = bench.dice.fork();
    let typical = dice.uniform(0.05, 0.2) * (high - low);
    let sign = dice.sign();
    let loops = Hysteresis::draw(&mut dice, typical).run(&mut dice, &coil);
    let course: Vec<f64> = without_line(&loops, &coil).iter().map(|c| sign * c).collect();
    let width = loop_width(&coil, &course);
    let course = bench.at_rows(&course);
    let mut effect = Effect::new("temp_hysteresis", Shape::Course(course), move |bench, size| {
        seen_with_rate(bench, Facts::default()).with("loop_width_deg_h", size * width)
    });
    effect.column = Some("temp_degC".to_owned());
    effect.beside(&["temp_linear"])
}
