//! A schedule as the record that it would give: its columns, its cosine modes, its length.

use crate::claim::Claim;
use crate::effect::{Column, Drivers};
use crate::mismatch::problem::deviations;
use crate::mismatch::spectral_data::SpectralData;
use crate::schedule::Schedule;

/// Samples of the averages that courses are compared on. Steps of a table and corners of ramps are many samples apart.
const SAMPLES: f64 = 1024.0;
/// Fewest rows of a recording that an explanation takes.
const FEWEST_ROWS: f64 = 64.0;
/// Samples of the record from which bins of longer ones are made.
const SEED_SAMPLES: usize = 64;

/// A schedule about to be carried out.
pub(super) struct Trial {
    /// Averages of a record without noise, for courses.
    pub spectral: SpectralData,
    /// The bins of the record at its sample rate, for processes.
    pub full: SpectralData,
    /// Rows of the recording.
    pub rows: f64,
}

impl Trial {
    /// The record that a schedule would give under a claim; `None` for one of too few rows.
    pub fn new(schedule: &Schedule, claim: &Claim) -> Option<Trial> {
        let rows = (schedule.duration_s() * claim.sample_rate_hz).round();
        if !(FEWEST_ROWS..=1e12).contains(&rows) {
            return None;
        }
        let averaged = (rows / SAMPLES).ceil();
        let samples = (rows / averaged).floor() as usize;
        let dt_s = averaged / claim.sample_rate_hz;
        let mut drivers = Drivers {
            dt_s,
            start_s: 0.5 * (averaged - 1.0) / claim.sample_rate_hz,
            samples,
            averaged: averaged as usize,
            claim: claim.mean,
            ..Drivers::default()
        };
        for profile in schedule.profiles(0.0, |_| 0.0) {
            let values = (0..samples).map(|i| profile.at(drivers.time_s(i))).collect();
            match profile.column {
                Column::Temperature => drivers.temperature = Some(values),
                Column::TableRate => drivers.table_rate = Some(values),
                Column::TableAngle => drivers.table_angle = Some(values),
                _ => {}
            }
        }
        drivers.smooth_temperature.clone_from(&drivers.temperature);
        let spectral = SpectralData::new(drivers, &vec![0.0; samples], &deviations(claim));
        let seed = Drivers {
            dt_s: 1.0 / claim.sample_rate_hz,
            samples: SEED_SAMPLES,
            averaged: 1,
            claim: claim.mean,
            ..Drivers::default()
        };
        let seed = SpectralData::new(seed, &[0.0; SEED_SAMPLES], &[]);
        Some(Trial { spectral, full: seed.longer(rows / SEED_SAMPLES as f64), rows })
    }
}
