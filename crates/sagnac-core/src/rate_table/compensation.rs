//! Scale factor and bias over temperature as a table that a system can compensate by: TOML, JSON and a C header.
//!
//! With the nominal scale factor applied, the rate is `(output − bias_deg_h(T)) / (1 + 1e-6·scale_factor_error_ppm(T))`. Values
//! between two temperatures are on straight lines; beyond the ends nothing is known.

use super::scale_over_temperature::{Point, ScaleOverTemperature};
use crate::c_header::CHeader;
use serde::Serialize;

/// A compensation table of a channel: scale factor and bias at every soak temperature, both ways averaged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScaleCompensation {
    /// Version of the format.
    pub format: &'static str,
    /// Channel.
    pub channel: String,
    /// Serial number of the unit.
    pub serial: Option<String>,
    /// Range of the temperatures, degC.
    pub valid_deg_c: [f64; 2],
    /// Largest rate of the test, deg/h.
    pub valid_to_deg_h: f64,
    /// Temperatures, degC, rising.
    pub temperature_deg_c: Vec<f64>,
    /// Deviation of the scale factor from the nominal one at them, ppm.
    pub scale_factor_error_ppm: Vec<f64>,
    /// Standard uncertainty of that without the equipment, ppm.
    pub scale_factor_uncertainty_ppm: Vec<f64>,
    /// Output at rest at them, deg/h, with the Earth rate that the recording held.
    pub bias_deg_h: Vec<f64>,
    /// Standard uncertainty of that without the equipment, deg/h.
    pub bias_uncertainty_deg_h: Vec<f64>,
}

impl ScaleCompensation {
    /// The table of what the soaks of a channel show, up to a rate in deg/h.
    pub fn of(
        found: &ScaleOverTemperature,
        channel: &str,
        serial: Option<&str>,
        highest_deg_h: f64,
    ) -> ScaleCompensation {
        let points = found.at_points();
        let list = |of: fn(&Point) -> f64| points.iter().map(of).collect::<Vec<f64>>();
        let ends = points.first().zip(points.last());
        ScaleCompensation {
            format: "scale-factor-compensation/1",
            channel: channel.to_owned(),
            serial: serial.map(str::to_owned),
            valid_deg_c: ends.map_or([f64::NAN; 2], |(low, high)| [low.temperature, high.temperature]),
            valid_to_deg_h: highest_deg_h,
            temperature_deg_c: list(|p| p.temperature),
            scale_factor_error_ppm: list(|p| 1e6 * (p.factor.value - 1.0)),
            scale_factor_uncertainty_ppm: list(|p| 1e6 * p.factor.standard),
            bias_deg_h: list(|p| p.bias.value),
            bias_uncertainty_deg_h: list(|p| p.bias.standard),
        }
    }

    /// The table as the text of a C header.
    pub fn header(&self) -> String {
        let mut out = CHeader::new("SCALE_FACTOR_COMPENSATION", &self.channel);
        out.define("SF_VALID_LOW_DEGC", self.valid_deg_c[0]);
        out.define("SF_VALID_HIGH_DEGC", self.valid_deg_c[1]);
        out.define("SF_VALID_TO_DEGH", self.valid_to_deg_h);
        out.count("SF_POINTS", self.temperature_deg_c.len());
        out.gap();
        out.array("SF_TEMPERATURE_DEGC", &self.temperature_deg_c);
        out.array("SF_ERROR_PPM", &self.scale_factor_error_ppm);
        out.array("SF_BIAS_DEGH", &self.bias_deg_h);
        out.finish()
    }
}
