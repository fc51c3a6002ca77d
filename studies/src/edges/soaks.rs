//! Scale factors over temperature, from rates that are repeated at soaks.

use super::case::{Simulated, Truth};
use super::on_table::{Column, column, procedure};
use super::table::Bench;
use crate::bench::soaks::Soaks;

const COLUMNS: [Column; 4] = [
    column("rate", "rate_deg_h", "rate", "deg/h"),
    column("table", "table_rate_deg_s", "table_rate", "deg/s"),
    column("angle", "table_angle_deg", "table_angle", "deg"),
    column("temp", "temp_degC", "temperature", "degC"),
];

const SECTIONS: &str = r#"[rate_table]
settling = "2 s"
minimum_step = "10 s"
whole_turns = true
soak_tolerance = "2 degC"
[conditions]
minimum_duration = "2 min"
"#;

impl Bench for Soaks {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let unit = Soaks { seed, ..self.clone() };
        let [peak_to_peak, slope, hysteresis] = unit.truths();
        Simulated {
            csv: unit.csv(),
            procedure: procedure("Soaks", &COLUMNS, SECTIONS, ids),
            truths: vec![
                Truth::new("sf_over_temperature_peak_to_peak", peak_to_peak),
                Truth::new("scale_factor_temperature_sensitivity", slope),
                Truth::new("sf_temperature_hysteresis", hysteresis),
            ],
        }
    }
}
