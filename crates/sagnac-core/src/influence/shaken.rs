//! Acceleration by frequency in every interval: mean squares in bands, from the averaged periodogram of the accelerometer.

use crate::noise::in_band::Band;
use crate::noise::welch::{MAX_SEGMENT, MIN_SEGMENT, WelchAccumulator, WelchResult};

/// Bins of a periodogram in the narrowest band, where the intervals are long enough.
const BINS_OF_NARROWEST: f64 = 16.0;

/// Fewest bins of a band: under a Hann window a sine lies in four.
const FEWEST_BINS: f64 = 4.0;

/// Segments that fit into the shortest interval end to end.
const SEGMENTS_OF_SHORTEST: usize = 2;

/// Mean squares of the acceleration in the intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaken {
    /// The bands.
    pub bands: Vec<Band>,
    /// Mean square in every band, an interval each, g².
    pub in_bands: Vec<Vec<f64>>,
    /// Mean square beyond all bands, an interval each, g².
    pub elsewhere: Vec<f64>,
    /// Distance of the bins, Hz.
    pub step_hz: f64,
}

/// Collects the acceleration of every interval.
pub struct Accelerations {
    bands: Vec<Band>,
    interval_s: f64,
    segment: usize,
    intervals: Vec<WelchAccumulator>,
}

impl Accelerations {
    /// For intervals of so many samples each, sampled every `interval_s`.
    pub fn new(bands: &[Band], interval_s: f64, samples: &[u64]) -> Accelerations {
        let narrowest = bands.iter().map(Band::width_hz).fold(f64::INFINITY, f64::min);
        let wanted = (BINS_OF_NARROWEST / (narrowest * interval_s)).min(MAX_SEGMENT as f64) as usize;
        let shortest = samples.iter().copied().min().unwrap_or(0) as usize / SEGMENTS_OF_SHORTEST;
        let fits = (shortest.max(1) + 1).next_power_of_two() / 2;
        let segment = wanted.next_power_of_two().min(fits).clamp(MIN_SEGMENT, MAX_SEGMENT);
        let intervals = samples.iter().map(|_| WelchAccumulator::with_segment(segment)).collect();
        Accelerations { bands: bands.to_vec(), interval_s, segment, intervals }
    }

    /// Takes the next samples of an interval, g. One that is not a number ends a stretch, as does a gap.
    pub fn push(&mut self, interval: usize, samples: &[f64], continues: bool) {
        let Some(welch) = self.intervals.get_mut(interval) else { return };
        let mut continues = continues;
        for part in samples.split(|v| !v.is_finite()) {
            welch.push(part, continues);
            continues = false;
        }
    }

    /// The mean squares; not a number in an interval without a whole segment.
    pub fn finish(self) -> Shaken {
        let step_hz = 1.0 / (self.segment as f64 * self.interval_s);
        let results: Vec<WelchResult> = self.intervals.into_iter().map(WelchAccumulator::finish).collect();
        let sum = |result: &WelchResult, inside: &dyn Fn(f64) -> bool| -> f64 {
            if result.spectrum.segments == 0 {
                return f64::NAN;
            }
            // The density is two-sided, in units of the sample interval; the first bin holds the mean that was removed.
            let bins = result.spectrum.density.iter().enumerate().skip(1);
            let own = bins.filter(|(k, _)| inside(*k as f64 * step_hz)).map(|(_, d)| d);
            2.0 * own.sum::<f64>() / self.segment as f64
        };
        let within = |band: &Band, f: f64| (band.from_hz..=band.to_hz).contains(&f);
        let of_band = |band: &Band| results.iter().map(|r| sum(r, &|f| within(band, f))).collect();
        let beyond = |f: f64| !self.bands.iter().any(|band| within(band, f));
        Shaken {
            in_bands: self.bands.iter().map(of_band).collect(),
            elsewhere: results.iter().map(|r| sum(r, &beyond)).collect(),
            bands: self.bands,
            step_hz,
        }
    }
}

impl Shaken {
    /// Rms acceleration in every interval, over all frequencies, g.
    pub fn rms_g(&self) -> Vec<f64> {
        let total = |k: usize| {
            let in_bands: f64 = self.in_bands.iter().filter_map(|b| b.get(k)).sum();
            (in_bands + self.elsewhere.get(k).copied().unwrap_or(0.0)).sqrt()
        };
        (0..self.elsewhere.len()).map(total).collect()
    }

    /// True for a band that the periodogram resolves.
    pub fn resolves(&self, band: &Band) -> bool {
        band.width_hz() >= FEWEST_BINS * self.step_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn band(from_hz: f64, to_hz: f64) -> Band {
        Band { from_hz, to_hz }
    }

    #[test]
    fn a_sine_has_half_the_square_of_its_amplitude_in_its_band_alone() {
        let bands = [band(10.0, 20.0), band(30.0, 50.0)];
        let sine = |f: f64, amplitude: f64| -> Vec<f64> {
            (0..4000).map(|i| 0.3 + amplitude * (TAU * f * f64::from(i) / 200.0).sin()).collect()
        };
        let mut shaken = Accelerations::new(&bands, 1.0 / 200.0, &[4000, 4000]);
        for (interval, samples) in [sine(15.0, 2.0), sine(70.0, 1.0)].iter().enumerate() {
            samples.chunks(999).enumerate().for_each(|(k, part)| shaken.push(interval, part, k > 0));
        }
        let shaken = shaken.finish();
        let near = |value: f64, truth: f64| assert!((value - truth).abs() < 2e-3, "{value} {truth}");
        near(shaken.in_bands[0][0], 2.0);
        near(shaken.in_bands[1][0], 0.0);
        near(shaken.elsewhere[0], 0.0);
        near(shaken.elsewhere[1], 0.5);
        near(shaken.rms_g()[0], 2f64.sqrt());
        assert!(shaken.resolves(&bands[0]) && !shaken.resolves(&band(10.0, 10.5)), "{}", shaken.step_hz);
    }

    #[test]
    fn an_interval_shorter_than_a_segment_has_no_mean_square() {
        let mut shaken = Accelerations::new(&[band(10.0, 20.0)], 0.005, &[4000, 4000]);
        shaken.push(0, &[0.1; 20], false);
        assert!(shaken.finish().in_bands[0].iter().all(|m| m.is_nan()));
    }
}
