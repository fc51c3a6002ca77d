//! Response over frequency: bandwidth, latency, resonance and flatness.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table::Bench;
use crate::bench::frequency::{Dynamics, Motion, OnTable};
use crate::bench::noise_source::csv;
use serde::Deserialize;

/// A unit and the motion of the table.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OverFrequency {
    /// Corner of the poles, Hz.
    corner_hz: f64,
    /// Damping of two poles.
    damping: f64,
    /// One pole in place of two.
    one_pole: bool,
    /// Time of a moving average, s, in place of poles.
    average_s: Option<f64>,
    /// True for a unit that follows at once.
    flat: bool,
    delay_s: f64,
    gain: f64,
    /// Noise of a sample, deg/s.
    noise: f64,
    /// Error of a reading of the angle, arcsec.
    reading_arcsec: f64,
    motion: String,
    highest_hz: f64,
    seconds: f64,
    hz: f64,
    flat_to_hz: f64,
}

impl Default for OverFrequency {
    fn default() -> OverFrequency {
        OverFrequency {
            corner_hz: 40.0,
            damping: 0.7,
            one_pole: false,
            average_s: None,
            flat: false,
            delay_s: 0.0015,
            gain: 1.001,
            noise: 0.02,
            reading_arcsec: 0.1,
            motion: "sweep".to_owned(),
            highest_hz: 80.0,
            seconds: 60.0,
            hz: 250.0,
            flat_to_hz: 20.0,
        }
    }
}

impl OverFrequency {
    fn unit(&self) -> OnTable {
        let corner_hz = self.corner_hz;
        let dynamics = match (self.flat, self.average_s, self.one_pole) {
            (true, ..) => Dynamics::None,
            (_, Some(over_s), _) => Dynamics::Average { over_s },
            (_, _, true) => Dynamics::OnePole { corner_hz },
            _ => Dynamics::TwoPoles { corner_hz, damping: self.damping },
        };
        let motion = match self.motion.as_str() {
            "steps" => Motion::Steps,
            "random" => Motion::Random,
            _ => Motion::Sweep,
        };
        OnTable {
            dynamics,
            delay_s: self.delay_s,
            gain: self.gain,
            noise: self.noise,
            reading_arcsec: self.reading_arcsec,
            motion,
            frequencies: (0.5, self.highest_hz),
            seconds: self.seconds,
            hz: self.hz,
            ..OnTable::default()
        }
    }

    /// Truths by the equations of the unit.
    fn truths(&self) -> Vec<Truth> {
        let unit = self.unit();
        let amplitude = |f: f64| unit.forced(f).0;
        let lag = |f: f64| unit.forced(f).1;
        let slow = match (self.flat, self.average_s) {
            (true, _) => 1.0,
            (_, Some(over_s)) => 0.02 / over_s,
            _ => 0.02 * self.corner_hz,
        };
        let mut truths = vec![Truth::new("latency", 1e3 * lag(slow) / (std::f64::consts::TAU * slow))];
        if !self.flat {
            // The first crossing going up: beyond, a lag has turns left out and an average has side lobes.
            let falls = |stays: &dyn Fn(f64) -> bool| {
                let (mut low, mut high) = (5.0 * slow, 5.0 * slow);
                while stays(high) {
                    (low, high) = (high, 1.1 * high);
                }
                for _ in 0..30 {
                    let middle = 0.5 * (low + high);
                    if stays(middle) { low = middle } else { high = middle }
                }
                0.5 * (low + high)
            };
            let corner = falls(&|f| amplitude(f) > 0.5f64.sqrt());
            truths.extend([Truth::new("bandwidth_3db", corner), Truth::new("bandwidth_3db_model", corner)]);
            let quarter = falls(&|f| lag(f) < std::f64::consts::FRAC_PI_2);
            truths.push(Truth::new("bandwidth_phase_90", quarter));
        }
        let decibel = |a: f64| 20.0 * a.log10();
        let grid = |to: f64| (1..=60).map(move |i| to * f64::from(i) / 60.0);
        let peak = grid(self.highest_hz).map(|f| decibel(amplitude(f))).fold(0.0, f64::max);
        truths.push(Truth::new("resonance_peak", peak));
        let flatness = grid(self.flat_to_hz).map(|f| decibel(amplitude(f)).abs()).fold(0.0, f64::max);
        truths.push(Truth::new("response_flatness", flatness));
        truths
    }
}

impl Bench for OverFrequency {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let record = self.unit().record(seed);
        let sections = format!("[transfer_test]\nflat_to = \"{} Hz\"\n", self.flat_to_hz);
        let columns = [
            column("rate", "rate_deg_s", "rate", "deg/s"),
            column("angle", "table_angle_deg", "table_angle", "deg"),
        ];
        Simulated {
            csv: csv("time_s,rate_deg_s,table_angle_deg", &[&record.time, &record.output, &record.angle]),
            procedure: procedure("Transfer function", &columns, &sections, ids),
            truths: self.truths(),
        }
    }
}
