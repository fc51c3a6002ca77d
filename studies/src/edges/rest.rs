//! A unit at rest: its white noise and what it has beside it.

use serde::Deserialize;

/// N of every unit, deg/√h.
pub(super) const N: f64 = 0.002;
/// What a unit has beside its white noise.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Part {
    /// Flicker, deg/h, from the interval to the length of the record: what is slower belongs to the bias.
    Flicker(f64),
    /// Random walk, deg/h/√h.
    Walk(f64),
    /// Ramp about the middle, deg/h/h.
    Ramp(f64),
    /// Angle noise, arcsec: the difference of neighbouring errors of angle.
    Quantized(f64),
    /// A line whose amplitude is that after averaging over the interval.
    Line { amplitude: f64, hz: f64 },
    /// A first-order process.
    Markov { sigma: f64, tau_s: f64 },
    /// A disturbance about a frequency.
    Periodic { rms: f64, hz: f64, decay_s: f64 },
}

/// A unit at rest.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rest {
    pub(super) samples: usize,
    /// Interval of samples, s.
    #[serde(default = "a_second")]
    pub(super) dt_s: f64,
    /// deg/h
    pub(super) bias: f64,
    /// In the order in which they are drawn.
    #[serde(default)]
    pub(super) parts: Vec<Part>,
    /// The parts are too weak to move what white noise gives.
    #[serde(default)]
    pub(super) weak: bool,
}

fn a_second() -> f64 {
    1.0
}
