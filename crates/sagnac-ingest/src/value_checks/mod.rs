//! Checks of the values of a recording, in one pass and bounded memory. Faults are counted and located; nothing is
//! removed or repaired.
//!
//! Gyro channels: outliers, values at a rail, stuck values, stretches that occur twice, interpolation,
//! the quantization grid the values lie on. Other channels: only whether
//! the value ever changes, since a slow sensor repeats its values for long with good reason.

mod interpolated;
mod outliers;
mod place;
pub mod plausible;
mod quantization_grid;
mod rails;
mod repeats;
mod stuck;
mod summary;

use crate::faults::FaultLog;
use interpolated::InterpolationCheck;
use outliers::OutlierCheck;
use place::Place;
use quantization_grid::QuantizationGrid;
use rails::SaturationCheck;
use repeats::RepetitionCheck;
use sagnac_core::message::{Arg, note};
use sagnac_core::recording::{Channel, SampleBlock, Sink};
use stuck::StuckCheck;
use summary::{CHUNK, Summary, summary};

/// Samples after which a channel that never changed is remarked on.
const CONSTANT_AFTER: u64 = 1000;

/// Largest step of the quantization grid, in standard deviations, at which straight lines between samples can be detected.
const FINE: f64 = 1e-2;

/// Minimum number of samples of a gyro channel for a kind of fault to be detectable.
pub fn min_samples_for(fault: &str) -> u64 {
    match fault {
        "outliers" => outliers::MIN_SAMPLES as u64,
        "saturated" => rails::MIN_SAMPLES,
        "stuck" => 2 * stuck::MIN_SAMPLES,
        "repeated" => 2 * repeats::MIN_SAMPLES,
        _ => 1,
    }
}

/// Count, range, mean and quantization step of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueFacts {
    /// Samples with a finite value.
    pub count: u64,
    /// Samples without.
    pub non_finite: u64,
    /// Smallest value, in the unit of the analysis; NaN without a finite value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Mean.
    pub mean: f64,
    /// Step of the quantization grid that all values lie on; gyro channels only.
    pub quantization_step: Option<f64>,
}

/// Number of faulty samples of all gyro channels, by kind of fault.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ValueFaults {
    /// Samples far outside the noise about them.
    pub outliers: u64,
    /// Samples at a rail.
    pub saturated: u64,
    /// Samples that repeat the one before for longer than chance allows.
    pub stuck: u64,
    /// Samples in stretches that occurred before, bit for bit.
    pub repeated: u64,
    /// Threshold of the outlier test in robust standard deviations; `None` without a gyro channel.
    pub outlier_threshold: Option<f64>,
}

#[derive(Debug, Clone)]
struct GyroChecks {
    outliers: OutlierCheck,
    runs: StuckCheck,
    rails: SaturationCheck,
    grid: QuantizationGrid,
    repeats: RepetitionCheck,
    interpolation: InterpolationCheck,
}

#[derive(Debug, Clone)]
struct ChannelChecks {
    id: String,
    count: u64,
    non_finite: u64,
    min: f64,
    max: f64,
    /// First value, from which sums are taken so that a large offset costs no digits.
    origin: f64,
    sum: f64,
    squares: f64,
    gyro: Option<GyroChecks>,
    first: Place,
}

impl ChannelChecks {
    fn take(&mut self, values: &[f64], place: Place, interval_s: f64) {
        let mut done = 0;
        for part in values.chunks(CHUNK) {
            self.chunk(part, place.after(done, interval_s), interval_s);
            done += part.len() as u64;
        }
    }

    fn chunk(&mut self, values: &[f64], place: Place, interval_s: f64) {
        if self.count == 0 && self.non_finite == 0 {
            self.first = place;
        }
        let s = summary(values, self.origin);
        if s.sum.is_finite() && (self.count > 0 || values.is_empty()) {
            self.finite(values, &s, place, interval_s);
            return;
        }
        // A part of it has no value, or the origin is not known yet.
        let mut start = 0;
        while start < values.len() {
            let rest = values.get(start..).unwrap_or_default();
            let holes = rest.iter().take_while(|v| !v.is_finite()).count();
            self.non_finite += holes as u64;
            start += holes;
            let rest = values.get(start..).unwrap_or_default();
            let length = rest.iter().position(|v| !v.is_finite()).unwrap_or(rest.len());
            let run = rest.get(..length).unwrap_or_default();
            if let Some(&first) = run.first() {
                if self.count == 0 {
                    self.origin = first;
                }
                let here = place.after(start as u64, interval_s);
                self.finite(run, &summary(run, self.origin), here, interval_s);
            }
            start += length;
        }
    }

    fn finite(&mut self, values: &[f64], s: &Summary, place: Place, interval_s: f64) {
        if let Some(g) = &mut self.gyro {
            g.outliers.take(values, place);
            g.runs.take(values, place, interval_s);
            g.rails.take(values, s.min, s.max, place, interval_s);
            g.grid.take(values);
            g.repeats.take(values, place);
            g.interpolation.take(values);
        }
        self.count += values.len() as u64;
        self.min = self.min.min(s.min);
        self.max = self.max.max(s.max);
        self.sum += s.sum;
        self.squares += s.squares;
    }

    fn facts(&self) -> ValueFacts {
        let none = self.count == 0;
        ValueFacts {
            count: self.count,
            non_finite: self.non_finite,
            min: if none { f64::NAN } else { self.min },
            max: if none { f64::NAN } else { self.max },
            mean: if none { f64::NAN } else { self.origin + self.sum / self.count as f64 },
            quantization_step: self.gyro.as_ref().and_then(|g| g.grid.step()),
        }
    }

    fn standard_deviation(&self) -> f64 {
        let n = self.count.max(1) as f64;
        (self.squares / n - (self.sum / n).powi(2)).max(0.0).sqrt()
    }
}

/// Checks the values of all channels while they are streamed.
#[derive(Debug, Clone)]
pub struct ValueChecks {
    channels: Vec<ChannelChecks>,
    interval_s: f64,
}

impl ValueChecks {
    /// Checks for channels with a nominal sample interval, which is used to tell times.
    pub fn new(channels: &[Channel], interval_s: f64) -> ValueChecks {
        let channels = channels
            .iter()
            .map(|c| ChannelChecks {
                id: c.id.clone(),
                count: 0,
                non_finite: 0,
                min: f64::INFINITY,
                max: f64::NEG_INFINITY,
                origin: 0.0,
                sum: 0.0,
                squares: 0.0,
                gyro: c.role.is_gyro().then(|| GyroChecks {
                    outliers: OutlierCheck::new(interval_s),
                    runs: StuckCheck::default(),
                    rails: SaturationCheck::default(),
                    grid: QuantizationGrid::default(),
                    repeats: RepetitionCheck::new(interval_s),
                    interpolation: InterpolationCheck::default(),
                }),
                first: Place { row: 0, time_s: f64::NAN },
            })
            .collect();
        ValueChecks { channels, interval_s }
    }

    /// Counts the faults, adds them to the log, and returns the statistics of every channel.
    pub fn finish(mut self, log: &mut FaultLog) -> (Vec<ValueFacts>, ValueFaults) {
        let mut faults = ValueFaults::default();
        for channel in &mut self.channels {
            let facts = channel.facts();
            let deviation = channel.standard_deviation();
            let id = Some(channel.id.as_str());
            let constant = facts.count > 0 && facts.min == facts.max;
            let at = |p: Place| Some(p.time_s).filter(|t| t.is_finite());
            if let Some(g) = &mut channel.gyro {
                let (outliers, threshold) = g.outliers.finish();
                faults.outlier_threshold =
                    Some(faults.outlier_threshold.map_or(threshold, |t: f64| t.max(threshold)));
                faults.outliers += outliers;
                for (place, z) in g.outliers.listed(threshold) {
                    log.push("outlier", id, at(place), place.row, 1, || {
                        note!("fault_note.outlier", deviations = Arg::fixed(z, 1))
                    });
                }
                for rail in g.rails.found(deviation) {
                    faults.saturated += rail.count;
                    log.push("saturated", id, at(rail.first), rail.first.row, rail.count, || {
                        note!(
                            "fault_note.rail",
                            side = Arg::Key(rail.side.to_owned()),
                            value_deg_h = Arg::Stated(rail.value),
                            count = rail.count,
                            next = rail.next
                        )
                    });
                }
                let stuck = g.runs.finish();
                faults.stuck += stuck.count;
                if let Some(mean) = stuck.held {
                    log.push("stuck", id, at(channel.first), channel.first.row, facts.count, || {
                        note!("fault_note.held", times = Arg::fixed(mean, 1))
                    });
                }
                for &(place, length) in &stuck.listed {
                    log.push("stuck", id, at(place), place.row, length, || {
                        note!("fault_note.stuck", length, longest_by_chance = stuck.longest_by_chance)
                    });
                }
                let (repeated, list) = g.repeats.finish();
                faults.repeated += repeated;
                for repeat in list {
                    log.push("repeated", id, at(repeat.place), repeat.place.row, repeat.length, || {
                        note!(
                            "repeated.fault",
                            length = repeat.length,
                            first_row = repeat.first_row,
                            by_chance = repeat.by_chance
                        )
                    });
                }
                let coarse = facts.quantization_step.is_some_and(|q| q > FINE * deviation);
                if let Some(share) = g.interpolation.finish().filter(|_| !coarse && stuck.held.is_none()) {
                    log.push("interpolated", id, at(channel.first), channel.first.row, facts.count, || {
                        note!("interpolated.fault", percent = Arg::Text(format!("{:.0}", share * 100.0)))
                    });
                }
            } else if constant && facts.count > CONSTANT_AFTER {
                log.push("stuck", id, at(channel.first), channel.first.row, facts.count, || {
                    note!("fault_note.constant")
                });
            }
        }
        (self.channels.iter().map(ChannelChecks::facts).collect(), faults)
    }
}

impl Sink for ValueChecks {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let place = Place { row: block.first_row, time_s: block.time_s };
        for (channel, values) in self.channels.iter_mut().zip(block.values) {
            channel.take(values, place, self.interval_s);
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
