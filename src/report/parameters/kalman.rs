//! The states of a Kalman filter that follow from the noise of each axis, as exact discrete matrices.
//!
//! The first state is the error of the angle; each other one is a part of the bias, which drives it. Between two steps the angle
//! collects white noise of density N² and the integral of the bias; a random walk and Gauss-Markov processes move on as their
//! equations say (Van Loan, IEEE Trans. Automatic Control 23(3) 1978, in closed form).

use super::axis::Axis;
use super::form::chain;
use super::target::{AXES, Sheet};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// deg/h in rad/s.
const DEG_H: f64 = PI / 180.0 / 3600.0;
/// s/h.
const SECONDS_PER_HOUR: f64 = 3600.0;
/// Steps over the correlation time below which series take the place of closed forms that cancel.
const SHORT_STEP: f64 = 1e-2;

/// A part of the bias: what is left of it after a step, what it adds to the angle meanwhile, and the covariance of its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
struct BiasState {
    /// Share that is left after the step.
    kept: f64,
    /// Angle that a bias of 1 collects in the step, s.
    collected_s: f64,
    /// Variance of the noise of the angle.
    angle: f64,
    /// Covariance of angle and bias.
    cross: f64,
    /// Variance of the noise of the bias.
    bias: f64,
}

/// The random walk of a density `k²`, (rad/s²)²/Hz.
fn random_walk(k: f64, step_s: f64) -> BiasState {
    let q = k * k;
    BiasState {
        kept: 1.0,
        collected_s: step_s,
        angle: q * step_s.powi(3) / 3.0,
        cross: q * step_s * step_s / 2.0,
        bias: q * step_s,
    }
}

/// A Gauss-Markov process of a standard deviation, rad/s, and a correlation time, s.
fn gauss_markov(rms: f64, time_s: f64, step_s: f64) -> BiasState {
    let x = step_s / time_s;
    let lost = -(-x).exp_m1();
    let density = 2.0 * rms * rms / time_s;
    let angle = if x < SHORT_STEP {
        density * step_s.powi(3) * (1.0 / 3.0 - x / 4.0 + 7.0 * x * x / 60.0 - x.powi(3) / 24.0)
    } else {
        density * time_s.powi(3) * (x - 2.0 * lost - 0.5 * (-2.0 * x).exp_m1())
    };
    BiasState {
        kept: (-x).exp(),
        collected_s: time_s * lost,
        angle,
        cross: 0.5 * density * (time_s * lost).powi(2),
        bias: -rms * rms * (-2.0 * x).exp_m1(),
    }
}

/// Names and states of the bias of an axis.
fn states(axis: &Axis, step_s: f64) -> Vec<(String, BiasState)> {
    let mut states = vec![];
    if let Some(k) = axis.random_walk.used() {
        let k = k * DEG_H / SECONDS_PER_HOUR.sqrt();
        states.push(("random_walk_rad_s".to_owned(), random_walk(k, step_s)));
    }
    for (kind, processes) in [("markov", axis.markov.clone()), ("flicker", chain(axis))] {
        for (i, p) in processes.iter().enumerate() {
            let state = gauss_markov(p.rms_deg_h * DEG_H, p.decay_time_s, step_s);
            states.push((format!("{kind}_{}_rad_s", i + 1), state));
        }
    }
    states
}

/// The matrices of one axis.
fn matrices(axis: &Axis, step_s: f64) -> Value {
    let states = states(axis, step_s);
    let size = states.len() + 1;
    let (mut f, mut q) = (vec![vec![0.0; size]; size], vec![vec![0.0; size]; size]);
    let white = axis.white.used().unwrap_or(0.0) * DEG_H * SECONDS_PER_HOUR.sqrt();
    f[0][0] = 1.0;
    q[0][0] = white * white * step_s;
    for (i, (_, state)) in states.iter().enumerate().map(|(i, s)| (i + 1, s)) {
        f[0][i] = state.collected_s;
        f[i][i] = state.kept;
        q[0][0] += state.angle;
        q[0][i] = state.cross;
        q[i][0] = state.cross;
        q[i][i] = state.bias;
    }
    let names: Vec<&str> =
        std::iter::once("angle_rad").chain(states.iter().map(|(n, _)| n.as_str())).collect();
    let reading = axis.quantization.used().map(|q| (q * DEG_H).powi(2));
    json!({ "channel": axis.channel, "states": names, "F": f, "Q": q, "R_angle_rad2": reading })
}

/// States and matrices of every axis that was measured: JSON.
pub fn write(sheet: &Sheet<'_>) -> String {
    let mut axes: Vec<&Axis> = Vec::with_capacity(AXES);
    for axis in sheet.axes {
        if axes.iter().all(|a| a.channel != axis.channel) {
            axes.push(axis);
        }
    }
    let axes: Vec<Value> = axes.into_iter().map(|axis| matrices(axis, sheet.step_s)).collect();
    let whole = json!({
        "format": "kalman/1",
        "notes": sheet.head,
        "step_s": sheet.step_s,
        "axes": axes,
    });
    format!("{whole:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The covariance of a step as the sum of many short ones: x' = F x + w for angle and bias.
    fn summed(rms: f64, time_s: f64, step_s: f64) -> BiasState {
        let parts = 20_000;
        let h = step_s / f64::from(parts);
        let (a, c) = ((-h / time_s).exp(), time_s * (1.0 - (-h / time_s).exp()));
        let variance = rms * rms * (1.0 - a * a);
        let (mut angle, mut cross, mut bias) = (0.0, 0.0, 0.0);
        for _ in 0..parts {
            angle += 2.0 * c * cross + c * c * bias;
            cross = a * cross + a * c * bias;
            bias = a * a * bias + variance;
        }
        BiasState {
            kept: (-step_s / time_s).exp(),
            collected_s: time_s * (1.0 - (-step_s / time_s).exp()),
            angle,
            cross,
            bias,
        }
    }

    #[test]
    fn a_step_is_the_sum_of_short_ones() {
        for (time_s, step_s) in [(100.0, 0.5), (100.0, 5.0), (3.0, 1.0), (0.2, 1.0)] {
            let (exact, sum) = (gauss_markov(2.0, time_s, step_s), summed(2.0, time_s, step_s));
            for (e, s) in [(exact.angle, sum.angle), (exact.cross, sum.cross), (exact.bias, sum.bias)] {
                assert!((e / s - 1.0).abs() < 2e-3, "{time_s} {step_s}: {e} {s}");
            }
            assert!((exact.collected_s - sum.collected_s).abs() < 1e-9 && exact.kept == sum.kept);
        }
    }

    #[test]
    fn series_and_closed_form_meet() {
        let below = gauss_markov(1.0, 100.0, 100.0 * SHORT_STEP * 0.999_999);
        let above = gauss_markov(1.0, 100.0, 100.0 * SHORT_STEP * 1.000_001);
        assert!((below.angle / above.angle - 1.0).abs() < 2e-5);
        // A very long correlation time is a random walk.
        let (slow, walk) = (gauss_markov(1.0, 1e9, 1.0), random_walk((2e-9_f64).sqrt(), 1.0));
        assert!((slow.angle / walk.angle - 1.0).abs() < 1e-6 && (slow.cross / walk.cross - 1.0).abs() < 1e-6);
    }
}
