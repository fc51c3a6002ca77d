//! Start-up: first sample, valid data, power and inrush current.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table::Bench;
use crate::bench::noise_source::NoiseSource;
use crate::bench::start_up::{SUPPLY_V, SwitchedOn};
use serde::Deserialize;

/// A unit that is switched on.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Start {
    /// Largest time to the first sample and to valid data, s: each record draws its own between this and half of it.
    first_s: f64,
    valid_s: f64,
    steady_a: f64,
    noise_a: f64,
    hz: f64,
    seconds: f64,
    /// Instruments are off by normal deviates of their uncertainties, 0.1 % and 0.5 %.
    instruments: bool,
}

impl Default for Start {
    fn default() -> Start {
        Start {
            first_s: 0.8,
            valid_s: 6.0,
            steady_a: 0.7,
            noise_a: 0.02,
            hz: 50.0,
            seconds: 100.0,
            instruments: true,
        }
    }
}

impl Bench for Start {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let mut source = NoiseSource::new(seed ^ 0x5eed);
        let mut off = |relative: f64| if self.instruments { relative * source.normal() } else { 0.0 };
        let errors = (off(0.001), off(0.005));
        let unit = SwitchedOn {
            on_s: source.uniform(1.0, 3.0),
            first_s: source.uniform(0.5, 1.0) * self.first_s,
            valid_s: source.uniform(0.5, 1.0) * self.valid_s,
            steady_a: self.steady_a,
            noise_a: self.noise_a,
            errors,
            seconds: self.seconds,
            hz: self.hz,
            ..SwitchedOn::default()
        };
        let columns = [
            column("rate", "rate_deg_h", "rate", "deg/h"),
            column("supply", "supply_V", "supply", "V"),
            column("current", "current_A", "current", "A"),
            column("status", "status", "status", "1"),
        ];
        let sections = "[start_up_test]\non_voltage = \"3 V\"\nvalid_mask = 1\n";
        Simulated {
            csv: unit.csv(seed),
            procedure: procedure("Start-up", &columns, sections, ids),
            truths: vec![
                Truth::new("time_to_first_sample", unit.first_s),
                Truth::new("time_to_valid_data", unit.valid_s),
                Truth::new("power_steady", SUPPLY_V * unit.steady_a),
            ],
        }
    }
}
