//! The units and schedules of the shipped samples, which the studies vary.

use super::generator::{Series, Turns, linear, squared};
use crate::chance::Noise;

/// Noise of the samples.
pub const NOISE: Noise = Noise { n: 0.002, b: 0.001, k: 0.0003 };
/// Levels of a magnetic field, mT.
pub const FIELD: [f64; 9] = [0.0, 0.5, 0.0, -0.5, 0.0, 0.5, 0.0, -0.5, 0.0];
/// Levels of a supply, V.
pub const SUPPLY: [f64; 9] = [5.0, 4.75, 5.0, 5.25, 5.0, 4.75, 5.0, 5.25, 5.0];
/// Levels of a shaker, g.
pub const SHAKER: [f64; 9] = [0.0, 2.0, 0.0, 4.0, 0.0, 2.0, 0.0, 4.0, 0.0];

/// Earth rate and bias together, deg/h.
const LEVEL: f64 = 12.467 + 0.12;

/// Eight runs whose bias scatters by so much, deg/h.
pub fn series(between: f64) -> Series {
    Series {
        runs: 8,
        run_s: 360.0,
        pause_s: 1200.0,
        between,
        trend: 0.0,
        per_deg_c: (0.0, 0.3),
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

/// Intervals at levels in turn, with a bias of so many deg/h per unit of the level.
pub fn turns(levels: &[f64], per_unit: f64) -> Turns {
    Turns {
        levels: levels.to_vec(),
        interval_s: 120.0,
        bias: linear,
        per_unit,
        drift: 0.05,
        noisier: |_| 1.0,
        warms: 0.0,
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

/// Intervals on a shaker: a bias that follows the square of the level, and noise that follows it by `noisier`.
pub fn shaken(per_unit: f64, noisier: fn(f64) -> f64) -> Turns {
    Turns { bias: squared, noisier, dt: 0.2, ..turns(&SHAKER, per_unit) }
}
