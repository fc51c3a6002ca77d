//! Tilts of the input axis by turns of the outer axis at several inner angles.
//!
//! The outer axis stands vertical, the inner one lies in the horizontal plane and the input axis nearly along it. With the
//! outer rate Ω, the inner angle β and the angle ε that the axes of the table lack of a right one, the input is
//! (Ω + Ω_up)(ε + θ_y cos β + θ_x sin β) beside the northern rotation, which turns with the table.

use super::case::{Simulated, Truth};
use super::on_table::{Column, column, procedure};
use super::table::Bench;
use crate::bench::EARTH;
use crate::bench::noise_source::{NoiseSource, csv};
use serde::Deserialize;

const LATITUDE_DEG: f64 = 55.98;
/// deg/√h
const N: f64 = 0.004;

/// Scatter of the thermometer, degC.
const READING_DEG_C: f64 = 0.02;

/// Seconds at rest before a turn, of a change of rate, and of a turn.
const REST: usize = 10;
const TURN: usize = 42;

/// Samples a second, and outer rate, deg/s.
const HZ: usize = 5;
const OUTER: f64 = 20.0;

/// A test on two axes.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TwoAxes {
    tilt_mrad: (f64, f64),
    #[serde(default = "four_angles")]
    inner_deg: Vec<f64>,
    /// deg/h over the test.
    #[serde(default)]
    drift: f64,
    /// Change of the tilts with temperature, mrad/degC, about the mean of the test.
    #[serde(default)]
    per_degree_mrad: (f64, f64),
    /// Temperatures at which the turns are made, degC; none: they are not recorded.
    #[serde(default)]
    temperatures: Vec<f64>,
}

fn four_angles() -> Vec<f64> {
    vec![0.0, 90.0, 180.0, 270.0]
}

/// Inner angle, its rate and the outer rate of a row, deg and deg/s.
struct Row {
    inner: f64,
    inner_rate: f64,
    outer: f64,
}

impl TwoAxes {
    /// Half width of the 95 % interval of a tilt in mrad, everything else given: half of the rows show it whole, or all by
    /// their sines.
    fn oracle(&self) -> f64 {
        // 42 s less the settling of 4 s: two turns of 18 s.
        let of_turn = 60.0 * N / 36f64.sqrt();
        let rows = 2.0 * self.inner_deg.iter().map(|b| b.to_radians().sin().powi(2)).sum::<f64>();
        1e3 * 1.96 * of_turn / (3600.0 * OUTER * rows.sqrt())
    }

    fn motion(&self) -> Vec<Row> {
        let dt = 1.0 / HZ as f64;
        let mut rows = vec![];
        let mut at = self.inner_deg[0];
        for target in &self.inner_deg {
            // To the angle at 30 deg/s, then turns to both sides between rests.
            while (target - at).abs() > 1e-9 {
                let step = (target - at).clamp(-30.0 * dt, 30.0 * dt);
                rows.push(Row { inner: at, inner_rate: step / dt, outer: 0.0 });
                at += step;
            }
            for (outer, seconds) in [(0.0, REST), (OUTER, TURN), (0.0, REST), (-OUTER, TURN)] {
                rows.extend((0..seconds * HZ).map(|_| Row { inner: at, inner_rate: 0.0, outer }));
            }
        }
        rows
    }
}

impl Bench for TwoAxes {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let squareness_mrad = 0.02 * NoiseSource::new(seed ^ 0x717).normal();
        let mut source = NoiseSource::new(seed);
        let dt = 1.0 / HZ as f64;
        let up = EARTH * LATITUDE_DEG.to_radians().sin();
        let north = EARTH * LATITUDE_DEG.to_radians().cos();
        let (x, y) = self.tilt_mrad;
        let once = self.motion();
        let soaks = self.temperatures.len().max(1);
        let mean = self.temperatures.iter().sum::<f64>() / soaks as f64;
        let at_row = |row: usize| self.temperatures.get(row / once.len()).copied().unwrap_or(mean);
        let motion: Vec<&Row> = (0..soaks).flat_map(|_| &once).collect();
        let rows = motion.len();
        let white = source.white(N, dt, rows);
        let (mut azimuth, mut output) = (0.4f64, vec![]);
        for (row, Row { inner, inner_rate, outer }) in motion.iter().copied().enumerate() {
            let beta = inner.to_radians();
            let warmer = at_row(row) - mean;
            let (x, y) = (x + self.per_degree_mrad.0 * warmer, y + self.per_degree_mrad.1 * warmer);
            let lean = 1e-3 * (squareness_mrad + y * beta.cos() + x * beta.sin());
            let through = 3600.0 * outer + up;
            let middle = azimuth + (0.5 * outer * dt).to_radians();
            azimuth += (outer * dt).to_radians();
            output.push(
                through * lean
                    + north * middle.cos()
                    + 3600.0 * inner_rate
                    + 0.3
                    + self.drift * row as f64 / rows as f64
                    + white[row],
            );
        }
        let time: Vec<f64> = (0..rows).map(|row| row as f64 * dt).collect();
        let of = |value: fn(&Row) -> f64| motion.iter().map(|r| value(r)).collect::<Vec<f64>>();
        let mut thermometer = NoiseSource::new(seed ^ 0x7e4);
        let temperature: Vec<f64> =
            (0..rows).map(|row| at_row(row) + READING_DEG_C * thermometer.normal()).collect();
        let (x_change, y_change) = self.per_degree_mrad;
        let mut truths = vec![
            Truth::new("misalignment_x", x).oracle(self.oracle()),
            Truth::new("misalignment_y", y).oracle(self.oracle()),
        ];
        if !self.temperatures.is_empty() {
            truths = vec![
                Truth::new("misalignment_x_temperature_sensitivity", x_change),
                Truth::new("misalignment_y_temperature_sensitivity", y_change),
            ];
        }
        Simulated {
            csv: csv(
                "time_s,rate_deg_h,inner_rate_deg_s,inner_angle_deg,outer_rate_deg_s,temp_degC",
                &[&time, &output, &of(|r| r.inner_rate), &of(|r| r.inner), &of(|r| r.outer), &temperature],
            ),
            procedure: procedure("Tilts", &COLUMNS, SECTIONS, ids),
            truths,
        }
    }
}

const COLUMNS: [Column; 5] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("inner_rate", "inner_rate_deg_s", "table_rate", "deg/s"),
    column("inner_angle", "inner_angle_deg", "table_angle", "deg"),
    column("outer", "outer_rate_deg_s", "outer_rate", "deg/s"),
    column("temp", "temp_degC", "temperature", "degC"),
];

const SECTIONS: &str = r#"[rate_table]
settling = "4 s"
minimum_step = "15 s"
whole_turns = true
rate_uncertainty = "10 ppm"
alignment_uncertainty = "0.02 mrad"
[conditions]
minimum_duration = "2 min"
[site]
latitude = "55.98 deg"
latitude_uncertainty = "10 arcsec"
elevation = "90 deg"
elevation_uncertainty = "1 mrad"
"#;
