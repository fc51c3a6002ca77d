//! Rates up to the range of a unit and beyond, from rates of a table that are known exactly.

use super::case::{Simulated, Truth};
use super::on_table::{column, procedure};
use super::table::Bench;
use crate::bench::noise_source::{NoiseSource, csv};
use serde::Deserialize;

/// Samples a second, and seconds at one rate.
const HZ: f64 = 10.0;
const DWELL_S: f64 = 14.0;
/// Part of the rate by which the output may be off.
const ERROR: f64 = 0.01;
/// Full scale that the procedure states, deg/s.
const FULL: f64 = 100.0;

/// A unit with rails, and the rates that it is turned at.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rails {
    /// Rates of the way out, deg/s, gone through in both directions.
    out: Vec<f64>,
    /// Highest and lowest output, deg/s; none of a unit that follows every rate.
    rails: Option<[f64; 2]>,
    /// Time at the rail after an overload, s.
    recovery_s: f64,
    error_ppm: f64,
    /// deg/h
    bias: f64,
    /// deg/√h
    n: f64,
}

impl Default for Rails {
    fn default() -> Rails {
        Rails {
            out: vec![0.0, 10.0, 25.0, 50.0, 75.0, 90.0, 100.0, 110.0, 120.0, 130.0, 140.0],
            rails: None,
            recovery_s: 0.0,
            error_ppm: 0.0,
            bias: 2.0,
            n: 0.02,
        }
    }
}

impl Bench for Rails {
    fn simulated(&self, ids: &[String], seed: u64) -> Simulated {
        let back = |sign: f64| self.out.iter().map(move |r| sign * r).chain([0.0]);
        let rates: Vec<f64> = back(1.0).chain(back(-1.0)).collect();
        let of_step = (HZ * DWELL_S) as usize;
        let mut source = NoiseSource::new(seed);
        let noise = source.white(self.n, 1.0 / HZ, rates.len() * of_step);
        let [high, low] = self.rails.map_or([f64::INFINITY, f64::NEG_INFINITY], |r| r.map(|r| 3600.0 * r));
        let mut columns = [vec![], vec![], vec![]];
        let (mut rail, mut until_s) = (0.0, f64::NEG_INFINITY);
        for (i, noise) in noise.iter().enumerate() {
            let (time_s, rate) = (i as f64 / HZ, 3600.0 * rates[i / of_step]);
            let free = rate * (1.0 + 1e-6 * self.error_ppm) + self.bias + noise;
            if !(low..=high).contains(&free) {
                (rail, until_s) = (free.clamp(low, high), time_s + self.recovery_s);
            }
            let output = if time_s <= until_s { rail } else { free };
            [time_s, output, rate / 3600.0].into_iter().zip(&mut columns).for_each(|(v, c)| c.push(v));
        }
        let sections = format!(
            "[rate_table]\nsettling = \"4 s\"\nminimum_step = \"5 s\"\nwhole_turns = false\nfull_scale = \"{FULL} deg/s\"\n\
             maximum_rate_error = \"{} %\"\n[conditions]\nminimum_duration = \"1 min\"\n",
            100.0 * ERROR
        );
        let [time, output, table] = &columns;
        Simulated {
            csv: csv("time_s,rate_deg_h,table_rate_deg_s", &[time, output, table]),
            procedure: procedure(
                "Overload",
                &[
                    column("rate", "rate_deg_h", "rate", "deg/h"),
                    column("table", "table_rate_deg_s", "table_rate", "deg/s"),
                ],
                &sections,
                ids,
            ),
            truths: self.truths(),
        }
    }
}

impl Rails {
    fn truths(&self) -> Vec<Truth> {
        let factor = 1.0 + 1e-6 * self.error_ppm;
        // Where the rail is so far below the line as the error allows; a unit without rails follows every rate of a table.
        let largest = |rail: f64| (rail.abs() - self.bias * rail.signum() / 3600.0) / factor / (1.0 - ERROR);
        let rate = self.rails.map_or(10.0 * FULL, |r| largest(r[0]).min(largest(r[1])));
        let mut truths = vec![Truth::new("polarity", 1.0), Truth::new("maximum_rate", rate)];
        if let Some([high, low]) = self.rails {
            truths.push(Truth::new("saturation_level", high).on("rate@positive"));
            truths.push(Truth::new("saturation_level", low).on("rate@negative"));
            truths.push(Truth::new("overload_recovery", self.recovery_s));
        }
        truths
    }
}
