//! Vibration by frequency at its edges: nothing rectified, another band or vibration beyond all bands in step, a temperature
//! with it, the shortest test and a sine for a band.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table::Bench;
use crate::bench::noise_source::csv;
use crate::bench::vibration::{OnShaker, PolePair, ShakenBand, two_bands};
use serde::Deserialize;
use std::fmt::Write;

/// A unit on a shaker.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ByFrequency {
    /// Bias per mean square in both bands, deg/h/g².
    per_square: (f64, f64),
    /// Bias per mean square beyond the bands, from 36 to 39 Hz, deg/h/g².
    beyond: f64,
    /// Rms in the two bands and beyond them in every interval with vibration, g.
    vibrations: Vec<[f64; 3]>,
    interval_s: f64,
    sine: bool,
    /// Response of the resonance at 24.3 Hz, of Q 8, deg/h/g; nothing without one.
    response: Option<f64>,
    drift: f64,
    /// Growth of the noise, 1/g.
    louder: f64,
    /// degC/g² and deg/h/degC.
    warms: (f64, f64),
    /// Coefficient that the procedure allows for, deg/h/degC.
    allowed: Option<f64>,
}

impl Default for ByFrequency {
    fn default() -> ByFrequency {
        let turns = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        ByFrequency {
            per_square: (0.0, 0.0),
            beyond: 0.0,
            vibrations: [turns, turns].concat(),
            interval_s: 24.0,
            sine: false,
            response: None,
            drift: 0.05,
            louder: 0.05,
            warms: (0.0, 0.0),
            allowed: None,
        }
    }
}

/// Frequency and quality factor of the resonance.
const RESONANCE: (f64, f64) = (24.3, 8.0);

impl ByFrequency {
    fn unit(&self) -> OnShaker {
        let plain = two_bands(self.per_square.0, 0.0);
        let mut bands = plain.bands.clone();
        bands[1].per_square = self.per_square.1;
        bands.push(ShakenBand { from_hz: 35.5, to_hz: 39.5, per_square: self.beyond });
        let (frequency_hz, quality) = RESONANCE;
        OnShaker {
            bands,
            vibrations: self.vibrations.iter().map(|v| v.to_vec()).collect(),
            interval_s: self.interval_s,
            sine: self.sine,
            resonance: self.response.map(|response| PolePair { frequency_hz, quality, response }),
            noise: (plain.noise.0, self.louder),
            drift: self.drift,
            warms: self.warms,
            ..plain
        }
    }

    fn truths(&self) -> Vec<Truth> {
        let in_band = |band: &str, value| {
            Truth::new("vibration_rectification_in_band", value).on(format!("rate@{band}"))
        };
        let mut truths = vec![in_band("5-13Hz", self.per_square.0), in_band("15-35Hz", self.per_square.1)];
        truths.push(Truth::new("vibration_resonance_response", self.response.unwrap_or(0.0)));
        if self.response.is_some() {
            truths.push(Truth::new("vibration_resonance_frequency", RESONANCE.0));
            truths.push(Truth::new("vibration_resonance_quality", RESONANCE.1));
        }
        truths
    }

    fn sections(&self) -> String {
        let allowed =
            self.allowed.map_or(String::new(), |a| format!("temperature_coefficient = \"{a} deg/h/degC\"\n"));
        let mut text = format!(
            "[vibration_test]\nsettling = \"2 s\"\nminimum_interval = \"6 s\"\nalternations = 1\n{allowed}"
        );
        for interval in 0..2 * self.vibrations.len() + 1 {
            let rms = if interval % 2 == 1 { self.vibrations[interval / 2] } else { [0.0; 3] };
            let level = rms.iter().map(|r| r * r).sum::<f64>().sqrt();
            let (from, to) = (self.interval_s * interval as f64, self.interval_s * (interval + 1) as f64);
            let _ = write!(
                text,
                "[[vibration_test.interval]]\nfrom = \"{from} s\"\nto = \"{to} s\"\nlevel = \"{level:.6} g\"\n"
            );
        }
        text + "[vibration_spectrum]\n[[vibration_spectrum.band]]\nfrom = \"5 Hz\"\nto = \"13 Hz\"\n\
                [[vibration_spectrum.band]]\nfrom = \"15 Hz\"\nto = \"35 Hz\"\n"
    }
}

impl Bench for ByFrequency {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let record = self.unit().record(seed);
        let columns = [
            column("rate", "rate_deg_h", "rate", "deg/h"),
            column("acc", "acceleration_g", "acceleration_z", "g"),
            column("temp", "temp_degC", "temperature", "degC"),
        ];
        let values: [&[f64]; 4] = [&record.time_s, &record.rate, &record.acceleration, &record.temperature];
        Simulated {
            csv: csv("time_s,rate_deg_h,acceleration_g,temp_degC", &values),
            procedure: procedure("Vibration by frequency", &columns, &self.sections(), ids),
            truths: self.truths(),
        }
    }
}
