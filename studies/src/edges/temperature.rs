//! Bias over temperature and the warm-up.
//!
//! The unit is a network of temperatures: chamber air with the ripple of its thermostat, housing with the sensor, the outer
//! and the inner layer of the coil. The Shupe effect comes from the difference of the layers, hysteresis from a body that is
//! pushed. Every effect can be exactly zero.

use super::case::{Simulated, Truth};
use super::table;
use crate::bench::noise_source::{NoiseSource, add, csv};
use serde::Deserialize;

/// A test of temperature or of the warm-up.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bench {
    /// Over temperature in a chamber.
    Chamber(Unit),
    /// From switching on.
    SwitchedOn(SwitchedOn),
}

impl table::Bench for Bench {
    fn simulated(&self, _: &[String], seed: u64) -> Simulated {
        match self {
            Bench::Chamber(unit) => unit.simulated(seed),
            Bench::SwitchedOn(unit) => unit.simulated(seed),
        }
    }
}

/// A unit over temperature, and the programme of the chamber: from the lower to the upper end of the range and back at each
/// rate, with rests.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Unit {
    /// deg/h per degC, about the middle of the range.
    line: f64,
    /// deg/h per degC², about the middle of the range.
    bend: f64,
    /// deg/h per degC/min.
    shupe: f64,
    /// Outer layer behind the housing, s.
    lag_s: f64,
    /// Half of the gap of the hysteresis, deg/h.
    half_gap: f64,
    /// Half width of the play, degC.
    play: f64,
    /// deg/√h
    n: f64,
    /// degC
    range: [f64; 2],
    /// degC/h
    rates: Vec<f64>,
    rest_s: f64,
}

impl Default for Unit {
    fn default() -> Unit {
        Unit {
            line: 0.0,
            bend: 0.0,
            shupe: 0.0,
            lag_s: 0.0,
            half_gap: 0.0,
            play: 2.0,
            n: 0.002,
            range: [-40.0, 60.0],
            rates: vec![50.0, 16.0],
            rest_s: 3600.0,
        }
    }
}

/// Interval of samples, s.
const DT_S: f64 = 60.0;
/// Inner layer behind the outer one, s.
const INNER_S: f64 = 20.0;

/// Rate and sensor, sample by sample.
fn recorded(unit: &Unit, from: &mut NoiseSource) -> (Vec<f64>, Vec<f64>) {
    let h = 2.0;
    let [low, high] = unit.range;
    let middle = 0.5 * (low + high);
    let mut legs = vec![(low, 1.0, unit.rest_s.max(300.0))];
    for rate in &unit.rates {
        legs.push((high, *rate, unit.rest_s));
        legs.push((low, *rate, unit.rest_s));
    }
    let (mut air, mut t) = (low, 0.0);
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
            body = body.clamp(outer - unit.play, outer + unit.play);
            let state = (outer - body) / unit.play;
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
    (rate, sensor)
}

impl Unit {
    fn truths(&self) -> Vec<Truth> {
        let half = 0.5 * (self.range[1] - self.range[0]);
        let fastest = self.rates.iter().copied().fold(0.0, f64::max) / 60.0;
        // Of a + bx² over even x in ±half: variances of the first and second Legendre polynomials.
        let rms = ((self.line * half).powi(2) / 3.0 + (self.bend * half * half).powi(2) * 4.0 / 45.0).sqrt();
        let at = |x: f64| self.line * x + self.bend * x * x;
        let turn = if self.bend == 0.0 { half } else { (-self.line / (2.0 * self.bend)).clamp(-half, half) };
        let values = [at(-half), at(half), at(turn)];
        let range =
            values.iter().fold(f64::MIN, |a, b| a.max(*b)) - values.iter().fold(f64::MAX, |a, b| a.min(*b));
        let across = (self.shupe - self.line * self.lag_s / 60.0) * fastest;
        vec![
            Truth::new("bias_temperature_sensitivity", self.line),
            Truth::new("bias_temperature_sensitivity_max", self.line),
            Truth::new("bias_temperature_rate_sensitivity", self.shupe),
            Truth::new("thermal_lag", self.lag_s),
            Truth::new("thermal_hysteresis", 2.0 * self.half_gap),
            Truth::new("bias_over_temperature_peak_to_peak", range),
            Truth::new("bias_over_temperature_rms", rms),
            Truth::new("bias_over_temperature_3sigma", 3.0 * rms),
            Truth::new("bias_loop_width", 2.0 * (across + self.half_gap)),
            Truth::new("bias_residual_rms", 60.0 * self.n / (2.0 * DT_S).sqrt()),
            Truth::new("ramp_rate", 60.0 * fastest).on("rate@ramp1"),
            Truth::new("angle_random_walk_at_temperature", self.n).on("rate@10"),
        ]
    }

    fn simulated(&self, seed: u64) -> Simulated {
        let (rate, sensor) = recorded(self, &mut NoiseSource::new(seed));
        let time: Vec<f64> = (0..rate.len()).map(|i| i as f64 * DT_S).collect();
        let [low, high] = self.range;
        let procedure = include_str!("../../../procedures/temperature-ramp.toml")
            .replace("minimum_duration = \"10 h\"", "minimum_duration = \"30 min\"")
            .replace("warm_up = \"30 min\"", "warm_up = \"0 s\"")
            .replace("residual_average", "highest_order = 3\nresidual_average")
            .replace("low = \"-40 degC\"", &format!("low = \"{low} degC\""))
            .replace("high = \"60 degC\"", &format!("high = \"{high} degC\""));
        Simulated {
            csv: csv("time_s,rate_deg_h,temp_degC", &[&time, &rate, &sensor]),
            procedure,
            truths: self.truths(),
        }
    }
}

/// Length of a record of the warm-up, s.
const LENGTH_S: f64 = 14_400.0;
/// Band of the procedure, deg/h.
const BAND: f64 = 0.02;

/// A unit from switching on: decays beside white noise.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwitchedOn {
    /// Amplitudes, deg/h, and time constants, s.
    decays: Vec<(f64, f64)>,
    /// deg/√h
    n: f64,
}

impl SwitchedOn {
    fn simulated(&self, seed: u64) -> Simulated {
        let dt = 10.0;
        let len = (LENGTH_S / dt) as usize;
        let at = |t: f64| self.decays.iter().map(|(a, s)| a * (-t / s).exp()).sum::<f64>();
        let end = (0..900).map(|i| at(LENGTH_S * (0.75 + 0.25 * (f64::from(i) + 0.5) / 900.0))).sum::<f64>()
            / 900.0;
        let time: Vec<f64> = (0..len).map(|i| i as f64 * dt).collect();
        let mut rate: Vec<f64> = time.iter().map(|t| 12.5 + at(t + 0.5 * dt)).collect();
        add(&mut rate, &NoiseSource::new(seed).white(self.n, dt, len));
        let outside = (0..LENGTH_S as usize).rev().find(|t| (at(*t as f64) - end).abs() > BAND);
        Simulated {
            csv: csv("time_s,rate_deg_h", &[&time, &rate]),
            procedure: include_str!("../../../procedures/warm-up.toml").to_owned(),
            truths: vec![
                Truth::new("turn_on_transient", at(0.0) - end),
                Truth::new("warm_up_time", outside.map_or(0.0, |t| t as f64 + 0.5)),
            ],
        }
    }
}
