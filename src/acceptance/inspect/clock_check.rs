//! Judgements about a gyro channel: what its lines say of the clock, whether it shows the Earth.

use crate::noise::lines::SpectralLine;
use crate::noise::static_bias::EARTH_RATE_DEG_H;

/// Mains frequencies and their doubles, Hz.
const MAINS_HZ: [f64; 4] = [50.0, 60.0, 100.0, 120.0];
/// Share of its frequency by which mains wanders.
const MAINS_TOLERANCE: f64 = 0.002;
/// Relative resolution from which a line is told from its neighbours.
const MAX_LINE_RESOLUTION: f64 = 0.005;
/// Peak over floor from which a line is held against the mains frequency: what is driven by mains is sharp, and in means of
/// short segments stands far above the floor.
const MIN_LINE_EXCESS: f64 = 8.0;

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

/// Whether a line stands where mains is: the clock that shows it there is right.
pub(super) fn is_mains(line: &SpectralLine) -> bool {
    let near =
        |mains: &f64| (line.frequency_hz - mains).abs() <= (MAINS_TOLERANCE * mains).max(line.resolution_hz);
    // Of a line near the wide end of its resolution nothing is said.
    line.resolution_hz <= MAX_LINE_RESOLUTION * line.frequency_hz && MAINS_HZ.iter().any(near)
}

/// Judges one line of a record sampled every `tau0_s` s.
pub(super) fn clock_remark(line: &SpectralLine, tau0_s: f64) -> Option<ClockRemark> {
    let (rate_hz, line_hz) = (1.0 / tau0_s, line.frequency_hz);
    let nyquist_hz = 0.5 * rate_hz;
    let off = |mains: f64| (line_hz / mains - 1.0).abs();
    let nearest = MAINS_HZ.iter().copied().min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    if off(nearest) <= 0.06 {
        let clear = off(nearest) > 0.005
            && (line_hz - nearest).abs() > line.resolution_hz
            && line.excess >= MIN_LINE_EXCESS;
        return clear.then_some(ClockRemark::Off { line_hz, mains_hz: nearest, factor: line_hz / nearest });
    }
    if line_hz >= 0.97 * nyquist_hz {
        return Some(ClockRemark::AtNyquist { line_hz });
    }
    // Mains keeps its frequency to 0.2 %; where so wide a search would cover much of the spectrum, a hit says nothing.
    let tolerance = |mains: f64| (MAINS_TOLERANCE * mains).max(line.resolution_hz);
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
