//! Small rates about the Earth's rotation: dead zones of every form, with edges anywhere between the rates.
//!
//! The unit is a staircase of input and output: an input follows from the table and the Earth, passes a response that is
//! written down here by cases, and noise is added behind it.

use super::case::{Simulated, Truth};
use super::on_table::{Column, column, procedure};
use super::table::Bench;
use crate::bench::EARTH;
use crate::bench::noise_source::{NoiseSource, csv};
use serde::Deserialize;

/// deg/√h
const N: f64 = 0.0025;
/// deg/h
const BIAS: f64 = 0.11;

/// Earth rate along the vertical at the latitude of the procedure, deg/h.
fn vertical() -> f64 {
    EARTH * 55.98f64.to_radians().sin()
}

/// What lies between input and output.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// Output is input.
    #[default]
    Line,
    /// What is lost stays lost.
    Play,
    /// All or nothing.
    Jump,
    /// Beams that lock.
    Lock,
    /// Nothing inside, and outside half of the half width is lost: no zone that the program knows.
    Stick,
    /// A part of every rate is lost inside, and what is lost stays lost outside.
    Weak,
    /// Steps of a read-out.
    Stairs,
}

/// A size that the table states, or one that is drawn between two.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum Size {
    Stated(f64),
    Drawn([f64; 2]),
}

impl Size {
    fn of(self, seed: u64) -> f64 {
        match self {
            Size::Stated(size) => size,
            Size::Drawn([low, high]) => NoiseSource::new(seed ^ 0x5eed).uniform(low, high),
        }
    }
}

/// One test.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sweep {
    form: Form,
    /// Half width of the zone, or step of a read-out, deg/h.
    size: Size,
    /// Standard deviation of noise on the input, deg/h.
    loop_noise: f64,
    /// Share of the rate that comes through a weak zone.
    share: f64,
    /// Distance of the rates, deg/h.
    spacing: f64,
    each_side: i32,
    dwell_s: usize,
    one_way: bool,
    /// Linear change of the bias over the test, deg/h.
    drift: f64,
    /// The middle of the rates lies as far as this from where the input is none, at random, deg/h.
    off: f64,
}

impl Default for Sweep {
    fn default() -> Sweep {
        Sweep {
            form: Form::Line,
            size: Size::Stated(0.0),
            loop_noise: 0.0,
            share: 0.0,
            spacing: 0.125,
            each_side: 10,
            dwell_s: 66,
            one_way: false,
            drift: 0.0,
            off: 0.0,
        }
    }
}

impl Sweep {
    /// Output at an input, with the zone of a size.
    fn response(&self, x: f64, size: f64, jitter: &[f64]) -> f64 {
        let play = |x: f64| x - x.clamp(-size, size);
        match self.form {
            Form::Line => x,
            Form::Play if self.loop_noise > 0.0 => {
                let sum: f64 = jitter.iter().map(|z| x + self.loop_noise * z).map(play).sum();
                sum / jitter.len() as f64
            }
            Form::Play => play(x),
            Form::Jump | Form::Lock | Form::Stick if x.abs() <= size => 0.0,
            Form::Jump => x,
            Form::Lock => x * (1.0 - (size / x).powi(2)).sqrt(),
            Form::Stick => x - x.clamp(-0.5 * size, 0.5 * size),
            Form::Weak => x - (1.0 - self.share) * x.clamp(-size, size),
            Form::Stairs => size * (x / size).round(),
        }
    }

    /// Rate from which half comes through, deg/h.
    fn threshold(&self, size: f64) -> f64 {
        match self.form {
            Form::Line | Form::Stairs => 0.0,
            Form::Play if self.loop_noise > 0.0 => threshold_shaken(size, self.loop_noise),
            Form::Play => 2.0 * size,
            Form::Jump | Form::Stick => size,
            Form::Lock => 2.0 * size / 3f64.sqrt(),
            // Half of the rate inside is enough; else x − (1 − share) δ is half of x.
            Form::Weak if self.share >= 0.5 => 0.0,
            Form::Weak => 2.0 * (1.0 - self.share) * size,
        }
    }

    fn steps(&self) -> Vec<f64> {
        let up: Vec<f64> = (-self.each_side..=self.each_side).map(|i| f64::from(i) * self.spacing).collect();
        let down = up.iter().rev().skip(1).copied().take(if self.one_way { 0 } else { up.len() });
        up.iter().copied().chain(down).collect()
    }

    fn truths(&self, size: f64) -> Vec<Truth> {
        // A zone from which half comes through moves the output by more than a tenth of what is expected: it is none,
        // though a user may read it as one.
        let (zone, resolution) = match self.form {
            Form::Line | Form::Weak => (0.0, 0.0),
            Form::Stairs => (0.0, size),
            _ => (size, 0.0),
        };
        // Half width of the 95 % interval of a mean of so many steps, by the white noise alone.
        let of_mean = |steps: f64| 1.96 * (60.0 * N / ((self.dwell_s - 4) as f64).sqrt()) / steps.sqrt();
        let steps = self.steps();
        let outside = of_mean(steps.iter().filter(|x| x.abs() > size).count() as f64);
        vec![
            Truth::new("dead_zone", zone).oracle(outside),
            Truth::new("dead_zone_noise", self.loop_noise),
            Truth::new("threshold", self.threshold(size)).oracle(2.0 * outside),
            Truth::new("resolution", resolution),
            // A line about its middle takes nothing of a mean: a drift fitted too leaves the oracle as it is.
            Truth::new("scale_factor_bias", BIAS).oracle(of_mean(steps.len() as f64)),
        ]
    }
}

impl Bench for Sweep {
    fn simulated(&self, _: &[String], seed: u64) -> Simulated {
        let size = self.size.of(seed);
        let off = if self.off > 0.0 { Size::Drawn([-self.off, self.off]).of(seed + 77) } else { 0.0 };
        let mut source = NoiseSource::new(seed);
        let steps = self.steps();
        let rows = steps.len() * self.dwell_s;
        let white = source.white(N, 1.0, rows);
        // Normal quantiles in place of draws would follow one another; draws are shared by all samples in turn.
        let jitter: Vec<f64> = (0..4096).map(|_| source.normal()).collect();
        let (mut time, mut output, mut table, mut read) = (vec![], vec![], vec![], vec![]);
        let mut angle = 71.0;
        for (row, noise) in white.iter().enumerate() {
            let rate = steps[row / self.dwell_s] + off - vertical();
            let some = (row * 64) % 4032;
            let behind = self.response(rate + vertical(), size, &jitter[some..some + 64]);
            time.push(row as f64);
            output.push(behind + BIAS + self.drift * (row as f64 / rows as f64 - 0.5) + noise);
            table.push(rate);
            read.push((angle + source.normal() * 0.1 / 3600.0_f64).rem_euclid(360.0));
            angle += rate / 3600.0;
        }
        let truths = self.truths(size);
        let ids: Vec<&str> = truths.iter().map(|t| t.id.as_str()).collect();
        Simulated {
            csv: csv("time_s,rate_deg_h,table_rate_deg_h,table_angle_deg", &[&time, &output, &table, &read]),
            procedure: procedure("Small rates", &COLUMNS, SECTIONS, &ids),
            truths,
        }
    }
}

/// Half of x comes through noise s at the threshold: by halving, with the closed form of the mean over normal noise.
fn threshold_shaken(d: f64, s: f64) -> f64 {
    let mean = |x: f64| {
        let step = 0.002;
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in -3000..=3000 {
            let z = step * f64::from(i);
            let w = (-0.5 * z * z).exp();
            let v = x + s * z;
            sum += w * (v - v.clamp(-d, d));
            weight += w;
        }
        sum / weight
    };
    if mean(1e-4) > 0.5e-4 {
        return 0.0;
    }
    let (mut low, mut high) = (1e-4, 2.0 * d);
    for _ in 0..40 {
        let x = 0.5 * (low + high);
        if mean(x) < 0.5 * x { low = x } else { high = x }
    }
    0.5 * (low + high)
}

const COLUMNS: [Column; 3] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("table", "table_rate_deg_h", "table_rate", "deg/h"),
    column("angle", "table_angle_deg", "table_angle", "deg"),
];

const SECTIONS: &str = r#"[rate_table]
settling = "2 s"
minimum_step = "60 s"
whole_turns = false
scale_factor_uncertainty = "500 ppm"
angle_uncertainty = "0.1 arcsec"
[conditions]
minimum_duration = "5 min"
[site]
latitude = "55.98 deg"
latitude_uncertainty = "1 arcsec"
elevation = "90 deg"
elevation_uncertainty = "0.1 mrad"
"#;
