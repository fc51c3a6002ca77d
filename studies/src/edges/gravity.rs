//! Sensitivity to acceleration, from positions in the field of gravity.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table::Bench;
use crate::bench::gravity::{FOURTEEN, Gravity};
use crate::bench::noise_source::csv;
use serde::Deserialize;
use std::fmt::Write;

/// Rows of the model, in the order of the truths of a unit.
const IDS: [&str; 8] = [
    "g_sensitivity_i",
    "g_sensitivity_o",
    "g_sensitivity_s",
    "g2_sensitivity_ii",
    "g2_sensitivity_oo",
    "g2_sensitivity_io",
    "g2_sensitivity_is",
    "g2_sensitivity_os",
];
/// Faces of a cube.
const SIX: [(f64, f64); 6] = [(90.0, 0.0), (-90.0, 0.0), (0.0, 0.0), (0.0, 90.0), (0.0, 180.0), (0.0, 270.0)];

/// A unit and its positions.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InGravity {
    /// Six faces in place of the fourteen positions.
    six: bool,
    linear: [f64; 3],
    quadratic: [f64; 5],
    /// deg/h
    bias: f64,
    /// deg/h
    b: f64,
    /// Standard deviation of the scale factor, ppm.
    scale_factor_ppm: f64,
    /// Standard deviation of a direction, arcmin.
    tilt_arcmin: f64,
    dwell_s: usize,
}

impl Default for InGravity {
    fn default() -> InGravity {
        InGravity {
            six: false,
            linear: [0.0; 3],
            quadratic: [0.0; 5],
            bias: 0.2,
            b: 0.0,
            scale_factor_ppm: 0.0,
            tilt_arcmin: 0.0,
            dwell_s: 300,
        }
    }
}

impl Bench for InGravity {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let unit = Gravity {
            bias: self.bias,
            linear: self.linear,
            quadratic: self.quadratic,
            b: self.b,
            scale_factor: 1e-6 * self.scale_factor_ppm,
            tilt: (self.tilt_arcmin / 60.0).to_radians(),
            dwell_s: self.dwell_s,
            ..Gravity::default()
        };
        let positions: &[(f64, f64)] = if self.six { &SIX } else { &FOURTEEN };
        let output = unit.record(positions, seed);
        let time: Vec<f64> = (0..output.len()).map(|i| i as f64).collect();
        let order = if self.six { "linear" } else { "quadratic" };
        let mut sections = format!(
            "[acceleration_test]\norder = \"{order}\"\nscale_factor_uncertainty = \"{} ppm\"\n\
             direction_uncertainty = \"{} arcmin\"\n",
            self.scale_factor_ppm, self.tilt_arcmin
        );
        for (k, (elevation, roll)) in positions.iter().enumerate() {
            let (from, to) = (k * self.dwell_s + 10, (k + 1) * self.dwell_s);
            // Writing to a text cannot fail.
            let _ = write!(
                sections,
                "[[acceleration_test.position]]\nfrom = \"{from} s\"\nto = \"{to} s\"\nelevation = \"{elevation} deg\"\n\
                 roll = \"{roll} deg\"\n"
            );
        }
        sections +=
            "[site]\nlatitude = \"55.98 deg\"\nlatitude_uncertainty = \"1 arcsec\"\nelevation = \"90 deg\"\n";
        let coefficients = self.linear.iter().chain(&self.quadratic);
        let determined = if self.six { 3 } else { IDS.len() };
        let truths = IDS.iter().zip(coefficients).map(|(id, value)| Truth::new(*id, *value)).take(determined);
        Simulated {
            csv: csv("time_s,rate_deg_h", &[&time, &output]),
            procedure: procedure("Gravity", &[column("rate", "rate_deg_h", "rate", "deg/h")], &sections, ids),
            truths: truths.collect(),
        }
    }
}
