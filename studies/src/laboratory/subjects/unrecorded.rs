//! What follows a quantity that was not recorded, or time itself.

use crate::laboratory::bench::Bench;
use crate::laboratory::effect::{Effect, Facts, Shape, range_of, spread_of};
use crate::laboratory::environment::{chamber, room, supply, weather};
use crate::laboratory::unit::body::{Body, Pace};
use crate::laboratory::unit::curve::without_line;
use crate::laboratory::unit::response::Law;

/// A unit at rest with some decoys.
pub fn at_rest(bench: &mut Bench) {
    let count = bench.dice.count(0, 3);
    bench.record_others(count);
}

/// Records nothing besides; for drivers of which a column would tell.
pub fn nothing_recorded(_: &mut Bench) {}

/// A unit that was switched on cold; its board warms the rest.
pub fn warm_up(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let body = Body::draw(&mut dice, Pace::Slow);
    let air = vec![21.0; bench.span.length];
    let warmth = body.run(&bench.span, &air, true);
    let (board, coil) = (dice.uniform(0.0, 0.3), 1.0);
    let sign = dice.sign();
    let mean = warmth.coil();
    let last = bench.span.length - 1;
    let of = |i: usize| board * (warmth.board[i] - 21.0) + coil * (mean[i] - 21.0);
    let whole = of(last).abs().max(1e-12);
    let course: Vec<f64> = (0..=last).map(|i| -sign * of(i) / whole).collect();
    let fallen = course.iter().position(|c| (c / course[last] - 1.0).abs() < (-1f64).exp()).unwrap_or(last);
    let time_constant_s = bench.span.time_s(fallen);
    let rows = bench.at_rows(&course);
    Effect::new("warmup_exponential", Shape::Course(rows), move |bench, size| {
        Facts::default()
            .at("time", 0.0, (3.0 * time_constant_s).min(bench.duration_s()))
            .with("amplitude_deg_h", sign * size)
            .with("time_constant_s", time_constant_s)
    })
    .beside(&["rate_ramp"])
}

/// Ageing: nearly straight, a little faster at first.
pub fn ramp(bench: &mut Bench) -> Effect {
    let sign = bench.dice.sign();
    let early_h = bench.dice.uniform(40.0, 400.0);
    let course: Vec<f64> =
        bench.time_s().iter().map(|t| sign * early_h * (t / 3600.0 / early_h).ln_1p()).collect();
    let mean_slope = sign * (course[course.len() - 1] - course[0]).abs() / (bench.duration_s() / 3600.0);
    Effect::new("rate_ramp", Shape::Course(course), move |bench, size| {
        Facts::default().at("time", 0.0, bench.duration_s()).with("slope_deg_h_per_h", size * mean_slope)
    })
}

/// Tilt of a building in the sun: a day that is flatter at night.
pub fn day(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let (peak, flat) = (dice.uniform(0.0, 24.0), dice.uniform(0.0, 0.25));
    let sign = dice.sign();
    let course: Vec<f64> = (0..bench.span.length)
        .map(|i| {
            let sun = (std::f64::consts::TAU * (bench.span.hour(i) - peak) / 24.0).cos();
            sign * (sun + flat * (sun * sun - 0.5))
        })
        .collect();
    let rows = bench.at_rows(&course);
    Effect::new("diurnal", Shape::Course(rows), |bench, size| {
        Facts::default()
            .at("frequency", 0.7 / 86_400.0, 1.3 / 86_400.0)
            .at("time", 0.0, bench.duration_s())
            .with("amplitude_deg_h", size)
            .with("period_s", 86_400.0)
    })
}

fn hidden(bench: &mut Bench, course: &[f64], law: Law) -> Effect {
    let mut dice = bench.dice.fork();
    let response = law.respond(&mut dice, &bench.span, course);
    let scale = spread_of(&response).max(1e-12) * dice.sign();
    let rows: Vec<f64> = bench.at_rows(&response).iter().map(|r| r / scale).collect();
    let bend = spread_of(&without_line(&rows, &bench.time_s()));
    let effect = Effect::new("unobserved_driver", Shape::Course(rows), |bench, _| {
        Facts::default().at("time", 0.0, bench.duration_s())
    })
    .latent();
    // The course has a spread of 1. Where a straight line is nearly all of it, nobody can tell it from ageing.
    if bend * bend < 0.1 { effect.same(&["rate_ramp"]) } else { effect }
}

/// The chamber works, and nobody recorded a temperature.
pub fn chamber_hidden(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let (start, legs) = chamber::programme(&mut dice, bench.duration_s(), -10.0, 50.0);
    let air = chamber::air(&mut dice, &bench.span, start, &legs);
    let warmth = Body::draw(&mut dice, Pace::Slow).run(&bench.span, &air, false);
    let coil = warmth.coil();
    let law = *dice.one_of(&[Law::Linear, Law::Curve, Law::Hysteresis]);
    hidden(bench, &coil, law).of("chamber_hidden")
}

/// Air of the room with its relay, not recorded.
pub fn room_hidden(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let outside = weather::weather(&mut dice, &bench.span).outside_deg_c;
    let air = room::air(&mut dice, &bench.span, &outside);
    let coil = Body::draw(&mut dice, Pace::Slow).run(&bench.span, &air, false).coil();
    hidden(bench, &coil, Law::Linear).of("room_hidden")
}

/// Load steps of a supply that was not recorded, through the heat that they make.
pub fn supply_hidden(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let volts = supply::voltage(&mut dice, &bench.span);
    let [low, high] = range_of(&volts);
    let law = if high > low { Law::Lag } else { Law::Linear };
    hidden(bench, &volts, law).of("supply_hidden")
}

/// Swings of the pressure on a quiet day of gusts, not recorded.
pub fn weather_hidden(bench: &mut Bench) -> Effect {
    let mut dice = bench.dice.fork();
    let pressure = weather::weather(&mut dice, &bench.span).pressure_hpa;
    hidden(bench, &pressure, Law::Lag).of("weather_hidden")
}
