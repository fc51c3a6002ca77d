//! Bias over temperature and the warm-up.
//!
//! The unit is a network of temperatures: chamber air with the ripple of its thermostat, housing with the sensor, the outer
//! and the inner layer of the coil. The Shupe effect comes from the difference of the layers, hysteresis from a body that is
//! pushed. Every effect can be exactly zero.

use super::case::{Case, Edge, Exemption, Family, Simulated, Truth};
use crate::noise_source::{NoiseSource, add, csv};

const SLOPE: &str = "bias_temperature_sensitivity";
const STEEPEST: &str = "bias_temperature_sensitivity_max";
const SHUPE: &str = "bias_temperature_rate_sensitivity";
const LAG: &str = "thermal_lag";
const PLAY: &str = "thermal_hysteresis";
const RANGE: &str = "bias_over_temperature_peak_to_peak";
const RMS: &str = "bias_over_temperature_rms";
const SIGMA: &str = "bias_over_temperature_3sigma";
const LOOP: &str = "bias_loop_width";
const LEFT: &str = "bias_residual_rms";
const RAMP: &str = "ramp_rate";
const NOISE: &str = "angle_random_walk_at_temperature";
const TRANSIENT: &str = "turn_on_transient";
const TIME: &str = "warm_up_time";

const OVER: &[&str] = &[SLOPE, STEEPEST, SHUPE, LAG, PLAY, RANGE, RMS, SIGMA, LOOP, LEFT, RAMP, NOISE];

/// The family.
pub static FAMILY: Family = Family {
    name: "temperature",
    ids: &[SLOPE, STEEPEST, SHUPE, LAG, PLAY, RANGE, RMS, SIGMA, LOOP, LEFT, RAMP, NOISE, TRANSIENT, TIME],
    cases: &[
        Case { name: "no effect of temperature", edges: &[Edge::Zero], ids: OVER, records: 80, draw: none },
        Case {
            name: "a straight line, nothing else",
            edges: &[Edge::Alone, Edge::BesideLarge],
            ids: OVER,
            records: 80,
            draw: line,
        },
        Case { name: "a Shupe effect alone", edges: &[Edge::Alone], ids: OVER, records: 60, draw: shupe },
        Case { name: "a hysteresis alone", edges: &[Edge::Alone], ids: OVER, records: 60, draw: play },
        Case {
            name: "a lag on a curve, nothing else",
            edges: &[Edge::Alone],
            ids: &[SLOPE, RANGE, RMS, SIGMA, SHUPE, LAG, PLAY, NOISE],
            records: 60,
            draw: lag,
        },
        Case {
            name: "every effect, large, on a curve",
            edges: &[Edge::BesideLarge],
            ids: &[SLOPE, RANGE, RMS, SIGMA, SHUPE, LAG, PLAY, NOISE],
            records: 60,
            draw: all,
        },
        Case {
            name: "every effect below the noise",
            edges: &[Edge::BelowNoise],
            ids: OVER,
            records: 60,
            draw: faint,
        },
        Case {
            name: "one cycle of 20 degC at one rate without dwells",
            edges: &[Edge::Shortest, Edge::Coarsest],
            ids: OVER,
            records: 60,
            draw: short,
        },
        Case {
            name: "two rates over 20 degC",
            edges: &[Edge::BesideLarge],
            ids: &[SLOPE, SHUPE, LAG, PLAY, NOISE],
            records: 60,
            draw: narrow,
        },
        Case {
            name: "no transient after switching on",
            edges: &[Edge::Zero],
            ids: &[TRANSIENT, TIME],
            records: 100,
            draw: warm_at_once,
        },
        Case {
            name: "one decay after switching on",
            edges: &[Edge::Alone],
            ids: &[TRANSIENT, TIME],
            records: 100,
            draw: one_decay,
        },
        Case {
            name: "a transient below the noise",
            edges: &[Edge::BelowNoise],
            ids: &[TRANSIENT, TIME],
            records: 100,
            draw: faint_decay,
        },
        Case {
            name: "a decay beside a larger slow one",
            edges: &[Edge::BesideLarge],
            ids: &[TRANSIENT, TIME],
            records: 100,
            draw: two_decays,
        },
        Case {
            name: "a warm-up that fills a third of the record",
            edges: &[Edge::Shortest],
            ids: &[TRANSIENT, TIME],
            records: 100,
            draw: short_decay,
        },
    ],
    exempt: &[
        Exemption {
            edges: &[Edge::Grid],
            ids: OVER,
            reason: "temperature runs through every value between the ends of the schedule",
        },
        Exemption {
            edges: &[Edge::Nuisance],
            ids: OVER,
            reason: "what follows the temperature of the unit is its bias over temperature, whatever the cause",
        },
        Exemption {
            edges: &[Edge::Grid, Edge::Coarsest],
            ids: &[TRANSIENT, TIME],
            reason: "a warm-up has no schedule: the unit is switched on and rests",
        },
        Exemption {
            edges: &[Edge::Nuisance],
            ids: &[TRANSIENT, TIME],
            reason: "what drifts while the unit warms up is its warm-up, whatever the cause",
        },
    ],
};

/// A unit over temperature.
#[derive(Clone, Copy)]
struct Unit {
    /// deg/h per degC and per degC², about the middle of the range.
    line: f64,
    bend: f64,
    /// deg/h per degC/min.
    shupe: f64,
    /// Outer layer behind the housing, s.
    lag_s: f64,
    /// Half of the gap, deg/h, and half width of the play, degC.
    half_gap: f64,
    play_deg_c: f64,
    /// deg/√h, deg/h/√h.
    n: f64,
    k: f64,
}

const STILL: Unit =
    Unit { line: 0.0, bend: 0.0, shupe: 0.0, lag_s: 0.0, half_gap: 0.0, play_deg_c: 2.0, n: 0.002, k: 0.0 };

/// A chamber's programme: from the lower to the upper end and back at each rate, degC/h, with rests, s.
struct Programme {
    low: f64,
    high: f64,
    rates: &'static [f64],
    rest_s: f64,
}

const WIDE: Programme = Programme { low: -40.0, high: 60.0, rates: &[50.0, 16.0], rest_s: 3600.0 };
/// Interval of samples, s.
const DT_S: f64 = 60.0;
/// Inner layer behind the outer one, s.
const INNER_S: f64 = 20.0;

/// Rate and sensor, sample by sample.
fn recorded(unit: &Unit, chamber: &Programme, from: &mut NoiseSource) -> (Vec<f64>, Vec<f64>) {
    let h = 2.0;
    let middle = 0.5 * (chamber.low + chamber.high);
    let mut legs = vec![(chamber.low, 1.0, chamber.rest_s.max(300.0))];
    for rate in chamber.rates {
        legs.push((chamber.high, *rate, chamber.rest_s));
        legs.push((chamber.low, *rate, chamber.rest_s));
    }
    let (mut air, mut t) = (chamber.low, 0.0);
    let (mut housing, mut outer, mut inner, mut body) = (air, air, air, air);
    let (mut rate, mut sensor) = (vec![], vec![]);
    let (mut sum, mut heat, mut count) = (0.0, 0.0, 0);
    for (to, per_h, rest_s) in legs {
        let mut rested = 0.0;
        while rested < rest_s || air != to {
            let most = per_h / 3600.0 * h;
            if air == to {
                rested += h;
            }
            air += (to - air).clamp(-most, most);
            // The thermostat swings by 0.2 degC about the programme.
            let blown = air + 0.2 * (std::f64::consts::TAU * t / 170.0).sin();
            housing += h * (blown - housing) / 200.0;
            outer = if unit.lag_s > 0.0 { outer + h * (housing - outer) / unit.lag_s } else { housing };
            let across = (outer - inner) / INNER_S;
            inner += h * across;
            body = body.clamp(outer - unit.play_deg_c, outer + unit.play_deg_c);
            let state = (outer - body) / unit.play_deg_c;
            let x = outer - middle;
            sum += unit.line * x + unit.bend * x * x + unit.shupe * 60.0 * across + unit.half_gap * state;
            heat += housing;
            count += 1;
            t += h;
            if count == (DT_S / h) as usize {
                rate.push(12.5 + sum / f64::from(count as u32));
                sensor.push(heat / f64::from(count as u32) + 0.005 * from.normal());
                (sum, heat, count) = (0.0, 0.0, 0);
            }
        }
    }
    let len = rate.len();
    add(&mut rate, &from.white(unit.n, DT_S, len));
    add(&mut rate, &from.walk(unit.k, DT_S, len));
    (rate, sensor)
}

/// A recording over temperature with what is true of the unit.
fn over(unit: Unit, chamber: &Programme, seed: u64, ids: &[&'static str]) -> Simulated {
    let mut from = NoiseSource::new(seed);
    let (rate, sensor) = recorded(&unit, chamber, &mut from);
    let time: Vec<f64> = (0..rate.len()).map(|i| i as f64 * DT_S).collect();
    let half = 0.5 * (chamber.high - chamber.low);
    let fastest = chamber.rates.iter().copied().fold(0.0, f64::max) / 60.0;
    // Of a + bx² over even x in ±half: variances of the first and second Legendre polynomials.
    let rms = ((unit.line * half).powi(2) / 3.0 + (unit.bend * half * half).powi(2) * 4.0 / 45.0).sqrt();
    let at = |x: f64| unit.line * x + unit.bend * x * x;
    let turn = if unit.bend == 0.0 { half } else { (-unit.line / (2.0 * unit.bend)).clamp(-half, half) };
    let values = [at(-half), at(half), at(turn)];
    let range =
        values.iter().fold(f64::MIN, |a, b| a.max(*b)) - values.iter().fold(f64::MAX, |a, b| a.min(*b));
    let truth = |id: &'static str| {
        let value = match id {
            SLOPE | STEEPEST => unit.line,
            SHUPE => unit.shupe,
            LAG => unit.lag_s,
            PLAY => 2.0 * unit.half_gap,
            RANGE => range,
            RMS => rms,
            SIGMA => 3.0 * rms,
            LOOP => 2.0 * ((unit.shupe - unit.line * unit.lag_s / 60.0) * fastest + unit.half_gap),
            LEFT => 60.0 * unit.n / (2.0 * DT_S).sqrt(),
            RAMP => 60.0 * fastest,
            _ => unit.n,
        };
        let truth = Truth::new(id, value);
        match id {
            RAMP => truth.on("rate@ramp1"),
            NOISE => truth.on("rate@10"),
            LEFT => truth,
            _ if value == 0.0 => truth,
            LAG | RANGE | RMS | SIGMA => truth.max(value),
            _ => truth.max_abs(value.abs()),
        }
    };
    let procedure = include_str!("../../../procedures/temperature-ramp.toml")
        .replace("minimum_duration = \"10 h\"", "minimum_duration = \"30 min\"")
        .replace("warm_up = \"30 min\"", "warm_up = \"0 s\"")
        .replace("residual_average", "highest_order = 3\nresidual_average")
        .replace("low = \"-40 degC\"", &format!("low = \"{} degC\"", chamber.low))
        .replace("high = \"60 degC\"", &format!("high = \"{} degC\"", chamber.high));
    Simulated {
        csv: csv("time_s,rate_deg_h,temp_degC", &[&time, &rate, &sensor]),
        procedure,
        truths: ids.iter().map(|id| truth(id)).collect(),
    }
}

const ON_A_CURVE: &[&str] = &[SLOPE, RANGE, RMS, SIGMA, SHUPE, LAG, PLAY, NOISE];

fn none(seed: u64) -> Simulated {
    over(STILL, &WIDE, seed, OVER)
}

fn line(seed: u64) -> Simulated {
    over(Unit { line: 1.2e-3, ..STILL }, &WIDE, seed, OVER)
}

fn shupe(seed: u64) -> Simulated {
    over(Unit { shupe: 0.05, ..STILL }, &WIDE, seed, OVER)
}

fn play(seed: u64) -> Simulated {
    over(Unit { half_gap: 0.008, ..STILL }, &WIDE, seed, OVER)
}

fn lag(seed: u64) -> Simulated {
    over(Unit { line: 1.2e-3, bend: 1.5e-5, lag_s: 900.0, ..STILL }, &WIDE, seed, ON_A_CURVE)
}

fn all(seed: u64) -> Simulated {
    let unit = Unit { line: 2e-3, bend: 2e-5, shupe: 0.06, lag_s: 700.0, half_gap: 0.01, ..STILL };
    over(unit, &WIDE, seed, ON_A_CURVE)
}

fn faint(seed: u64) -> Simulated {
    let unit = Unit { line: 2e-6, shupe: 1e-3, half_gap: 2e-4, n: 0.004, ..STILL };
    over(unit, &WIDE, seed, OVER)
}

fn short(seed: u64) -> Simulated {
    let chamber = Programme { low: 0.0, high: 20.0, rates: &[30.0], rest_s: 0.0 };
    over(Unit { line: 2e-3, ..STILL }, &chamber, seed, OVER)
}

fn narrow(seed: u64) -> Simulated {
    let chamber = Programme { low: 0.0, high: 20.0, rates: &[57.0, 4.3], rest_s: 3600.0 };
    let unit =
        Unit { line: 2e-3, bend: 2e-5, shupe: 0.05, lag_s: 600.0, half_gap: 0.006, play_deg_c: 1.5, ..STILL };
    over(unit, &chamber, seed, &[SLOPE, SHUPE, LAG, PLAY, NOISE])
}

/// Length of a record of the warm-up, s.
const LENGTH_S: f64 = 14_400.0;
/// Band of the procedure, deg/h.
const BAND: f64 = 0.02;

/// A recording from switching on: decays (deg/h, s) beside white noise.
fn switched_on(decays: &[(f64, f64)], n: f64, seed: u64) -> Simulated {
    let dt = 10.0;
    let len = (LENGTH_S / dt) as usize;
    let mut from = NoiseSource::new(seed);
    let at = |t: f64| decays.iter().map(|(a, s)| a * (-t / s).exp()).sum::<f64>();
    let end =
        (0..900).map(|i| at(LENGTH_S * (0.75 + 0.25 * (f64::from(i) + 0.5) / 900.0))).sum::<f64>() / 900.0;
    let time: Vec<f64> = (0..len).map(|i| i as f64 * dt).collect();
    let mut rate: Vec<f64> = time.iter().map(|t| 12.5 + at(t + 0.5 * dt)).collect();
    add(&mut rate, &from.white(n, dt, len));
    let outside = (0..LENGTH_S as usize).rev().find(|t| (at(*t as f64) - end).abs() > BAND);
    let warm = outside.map_or(0.0, |t| t as f64 + 0.5);
    let transient = Truth::new(TRANSIENT, at(0.0) - end);
    let warm = Truth::new(TIME, warm);
    Simulated {
        csv: csv("time_s,rate_deg_h", &[&time, &rate]),
        procedure: include_str!("../../../procedures/warm-up.toml").to_string(),
        truths: vec![
            if transient.value == 0.0 { transient } else { transient.clone().max_abs(transient.value.abs()) },
            if warm.value == 0.0 { warm.max(900.0) } else { warm.clone().max(warm.value) },
        ],
    }
}

fn warm_at_once(seed: u64) -> Simulated {
    switched_on(&[], 0.001, seed)
}

fn one_decay(seed: u64) -> Simulated {
    switched_on(&[(0.4, 600.0)], 0.001, seed)
}

fn faint_decay(seed: u64) -> Simulated {
    switched_on(&[(0.002, 600.0)], 0.002, seed)
}

fn two_decays(seed: u64) -> Simulated {
    switched_on(&[(0.2, 200.0), (-0.5, 1400.0)], 0.001, seed)
}

fn short_decay(seed: u64) -> Simulated {
    switched_on(&[(0.3, 1700.0)], 0.001, seed)
}
