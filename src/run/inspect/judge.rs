//! Judgements about a gyro channel: whether it stood still, what its lines say of the clock, whether it shows the Earth.

use super::tracks::scatter;
use crate::noise::data::BlockSeries;
use crate::noise::lines::SpectralLine;
use crate::noise::static_bias::EARTH_RATE_DEG_H;

/// Scatter of means over 1 s beyond which a unit may have moved: 0.1 deg/s. Slower than any table test, faster than
/// the bias of a gyro that is worth testing wanders.
const MOVED_DEG_H: f64 = 360.0;
/// How many times the scatter must exceed what the sample noise explains.
const BEYOND_NOISE: f64 = 5.0;
/// A single mean so far from the middle one tells of a short turn in a long rest.
const TURNED_DEG_H: f64 = 1800.0;
/// Ratio of the steps between neighbouring means to their scatter below which the change is slow.
const SLOW: f64 = 0.35;
/// Range of a temperature that can explain a slow change of the bias, degC.
const WARMING_DEG_C: f64 = 5.0;
/// Mains frequencies and their doubles, Hz.
const MAINS_HZ: [f64; 4] = [50.0, 60.0, 100.0, 120.0];

/// Whether a channel stood still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Motion {
    /// Nothing speaks against rest.
    Rest {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
        /// How many times that is what the noise of the samples explains, were it white; 0 where that is not known.
        beyond_noise: f64,
    },
    /// It hardly changed, but another axis of the unit was turned.
    Carried,
    /// It changed slowly by far more than the noise: a slow turn, or the bias with temperature.
    Slow {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
    },
    /// It was turned or driven.
    Moved {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
        /// Farthest mean from the middle one, deg/h.
        farthest_deg_h: f64,
    },
    /// Too few samples to tell.
    Unknown,
}

impl Motion {
    /// True where nothing speaks against rest.
    pub fn is_rest(&self) -> bool {
        matches!(self, Motion::Rest { .. })
    }

    /// True where the unit was turned, about this axis or another.
    pub fn is_motion(&self) -> bool {
        matches!(self, Motion::Moved { .. } | Motion::Carried)
    }
}

/// Judges the motion by means over 1 s (or an eighth of a shorter record). `sample_noise`: standard deviation of a
/// sample where the record is quietest; `warming`: largest range of a temperature, degC.
pub(super) fn motion(
    blocks: &BlockSeries,
    tau0_s: f64,
    sample_noise_deg_h: Option<f64>,
    warming_deg_c: f64,
) -> Motion {
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    let eighth = (blocks.mean.len() / 8).max(1);
    let merged = ((1.0 / block_s).ceil() as usize).clamp(1, eighth);
    let means = means(blocks, merged);
    let Some((deviation, steps)) = scatter(&means) else { return Motion::Unknown };
    let mut sorted = means.clone();
    let middle = sorted.len() / 2;
    let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let median = *median;
    let farthest = means.iter().map(|m| (m - median).abs()).fold(0.0, f64::max);
    let samples = merged as f64 * blocks.block_len.max(1) as f64;
    let noise = sample_noise_deg_h.unwrap_or(0.0) / samples.sqrt();
    let moved = deviation > MOVED_DEG_H.max(BEYOND_NOISE * noise)
        || farthest > TURNED_DEG_H.max(2.0 * BEYOND_NOISE * noise);
    if !moved {
        let beyond_noise = if noise > 0.0 { deviation / noise } else { 0.0 };
        Motion::Rest { scatter_deg_h: deviation, beyond_noise }
    } else if steps < SLOW * deviation && warming_deg_c >= WARMING_DEG_C {
        Motion::Slow { scatter_deg_h: deviation }
    } else {
        Motion::Moved { scatter_deg_h: deviation, farthest_deg_h: farthest }
    }
}

/// Means over `merged` blocks that are at least half full.
fn means(blocks: &BlockSeries, merged: usize) -> Vec<f64> {
    let full = blocks.block_len.max(1) as f64 * merged as f64;
    let counts = blocks.count.chunks(merged);
    let sums = blocks.mean.chunks(merged).zip(counts).map(|(means, counts)| {
        means.iter().zip(counts).filter(|(m, _)| m.is_finite()).fold((0.0, 0.0), |(sum, n), (m, c)| {
            let c = f64::from(*c);
            (sum + m * c, n + c)
        })
    });
    sums.filter(|(_, n)| *n >= 0.5 * full).map(|(sum, n)| sum / n).collect()
}

/// What a strong line says of the sample clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ClockRemark {
    /// Near a mains frequency, but off it: were it mains, the clock would be off by `factor`.
    Off {
        /// Frequency of the line by the recording's clock, Hz.
        line_hz: f64,
        /// The mains frequency or its double, Hz.
        mains_hz: f64,
        /// line / mains.
        factor: f64,
    },
    /// At the highest frequency that the record holds.
    AtNyquist {
        /// Frequency of the line, Hz.
        line_hz: f64,
    },
    /// Where mains would fold to.
    Alias {
        /// Frequency of the line, Hz.
        line_hz: f64,
        /// The mains frequency or its double, Hz.
        mains_hz: f64,
    },
}

/// Judges one line of a record sampled every `tau0_s` s.
pub(super) fn clock_remark(line: &SpectralLine, tau0_s: f64) -> Option<ClockRemark> {
    let (rate_hz, line_hz) = (1.0 / tau0_s, line.frequency_hz);
    let nyquist_hz = 0.5 * rate_hz;
    let off = |mains: f64| (line_hz / mains - 1.0).abs();
    let nearest = MAINS_HZ.iter().copied().min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    if off(nearest) <= 0.06 {
        let clear = off(nearest) > 0.005 && (line_hz - nearest).abs() > line.resolution_hz;
        return clear.then_some(ClockRemark::Off { line_hz, mains_hz: nearest, factor: line_hz / nearest });
    }
    if line_hz >= 0.97 * nyquist_hz {
        return Some(ClockRemark::AtNyquist { line_hz });
    }
    // Mains keeps its frequency to 0.2 %; where so wide a search would cover much of the spectrum, a hit says nothing.
    let tolerance = |mains: f64| (0.002 * mains).max(line.resolution_hz);
    let covered: f64 = MAINS_HZ.iter().filter(|m| **m > nyquist_hz).map(|m| 2.0 * tolerance(*m)).sum();
    if covered > 0.05 * nyquist_hz {
        return None;
    }
    let alias = |mains: f64| (mains - rate_hz * (mains / rate_hz).round()).abs();
    let hit = |m: &&f64| **m > nyquist_hz && (alias(**m) - line_hz).abs() <= tolerance(**m);
    MAINS_HZ.iter().find(hit).map(|m| ClockRemark::Alias { line_hz, mains_hz: *m })
}

/// Length of the mean vector of three axes when it is within 3 % of the rotation of the Earth, deg/h.
pub(super) fn earth(means_deg_h: &[f64]) -> Option<f64> {
    let [x, y, z] = means_deg_h else { return None };
    let length = (x * x + y * y + z * z).sqrt();
    ((length / EARTH_RATE_DEG_H - 1.0).abs() <= 0.03).then_some(length)
}
