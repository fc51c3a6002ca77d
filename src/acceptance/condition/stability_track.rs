//! One pass over a channel that must stay within a band, such as the temperature of the unit or its supply: smoothed
//! extremes, the share outside the band, and the steepest trend.

use crate::numeric::sums::Compensated;
use std::collections::VecDeque;

/// Length of the windows in which the trend of the temperature is measured, s.
pub const TREND_WINDOW_S: f64 = 1800.0;

/// Streaming statistics of a channel, in its own unit (degC, V).
#[derive(Debug, Clone)]
pub struct StabilityTrack {
    smoothing_samples: usize,
    trend_samples: u64,
    tau0_s: f64,
    window: VecDeque<f64>,
    /// Sum of the window. What enters leaves again later: without compensation one absurd value would take the digits
    /// of all others with it.
    window_sum: Compensated,
    since_resum: usize,
    usable: u64,
    unusable: u64,
    sum: Compensated,
    raw_min: f64,
    raw_max: f64,
    smooth_min: Extreme,
    smooth_max: Extreme,
    band: Option<Band>,
    outside_count: u64,
    smooth_count: u64,
    trend: Trend,
    steepest_per_s: Option<f64>,
}

/// The condition that a channel is watched for: which one, and its position among those of its kind in the procedure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct StabilityKey {
    /// Id of the condition: `temperature`, `supply`, `range`.
    pub condition: &'static str,
    /// Position in the procedure, from 0.
    pub position: usize,
}

impl StabilityKey {
    /// The temperature condition at a position.
    pub fn temperature(position: usize) -> StabilityKey {
        StabilityKey { condition: "temperature", position }
    }

    /// The supply condition at a position.
    pub fn supply(position: usize) -> StabilityKey {
        StabilityKey { condition: "supply", position }
    }

    /// The range condition at a position.
    pub fn range(position: usize) -> StabilityKey {
        StabilityKey { condition: "range", position }
    }
}

/// A band of values, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
}

impl Band {
    /// The band of a tolerance about a nominal value.
    pub fn about(nominal: f64, tolerance: f64) -> Band {
        Band { low: nominal - tolerance, high: nominal + tolerance }
    }
}

/// An extreme and when it occurred.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extreme {
    /// Value, degC.
    pub value: f64,
    /// Time from the start of the recording, s.
    pub time_s: f64,
}

/// What the pass leaves behind.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityFacts {
    /// Usable samples.
    pub usable: u64,
    /// Samples that hold no number.
    pub unusable: u64,
    /// Mean, degC.
    pub mean: f64,
    /// Smallest single sample.
    pub raw_min: f64,
    /// Largest single sample.
    pub raw_max: f64,
    /// Smallest smoothed value.
    pub smooth_min: Extreme,
    /// Largest smoothed value.
    pub smooth_max: Extreme,
    /// Share of the smoothed values outside the band given at the start.
    pub share_outside: f64,
    /// Steepest trend in any half-hour window, degC/h; `None` when the record is shorter than one.
    pub steepest_deg_c_per_h: Option<f64>,
    /// Time over which values were smoothed, s.
    pub smoothing_s: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Trend {
    n: u64,
    /// First value: sums are taken from it, so that a large offset costs no digits.
    origin: f64,
    sum_y: f64,
    sum_xy: f64,
}

impl Trend {
    fn push(&mut self, value: f64) {
        if self.n == 0 {
            self.origin = value;
        }
        let y = value - self.origin;
        self.sum_y += y;
        self.sum_xy += self.n as f64 * y;
        self.n += 1;
    }

    /// Least-squares slope per sample.
    fn slope(&self) -> f64 {
        let n = self.n as f64;
        let centre = 0.5 * (n - 1.0);
        (self.sum_xy - centre * self.sum_y) * 12.0 / (n * (n * n - 1.0))
    }
}

impl StabilityTrack {
    /// A track with the smoothing time, the sample interval and the band inside which smoothed values count as good.
    pub fn new(smoothing_s: f64, tau0_s: f64, band: Option<Band>) -> StabilityTrack {
        let start = |value| Extreme { value, time_s: 0.0 };
        StabilityTrack {
            smoothing_samples: ((smoothing_s / tau0_s).round() as usize).clamp(1, 1 << 22),
            trend_samples: (TREND_WINDOW_S / tau0_s).round().max(2.0) as u64,
            tau0_s,
            window: VecDeque::new(),
            window_sum: Compensated::default(),
            since_resum: 0,
            usable: 0,
            unusable: 0,
            sum: Compensated::default(),
            raw_min: f64::INFINITY,
            raw_max: f64::NEG_INFINITY,
            smooth_min: start(f64::INFINITY),
            smooth_max: start(f64::NEG_INFINITY),
            band,
            outside_count: 0,
            smooth_count: 0,
            trend: Trend::default(),
            steepest_per_s: None,
        }
    }

    /// Takes samples; `time_s` is the time of the first one from the start of the recording.
    pub fn push(&mut self, values: &[f64], time_s: f64, continues: bool) {
        if !continues {
            self.flush_short_stretch(time_s);
            self.window.clear();
            self.window_sum = Compensated::default();
            self.trend = Trend::default();
        }
        for (i, &value) in values.iter().enumerate() {
            if !value.is_finite() {
                self.unusable += 1;
                continue;
            }
            self.usable += 1;
            self.sum.add(value);
            self.raw_min = self.raw_min.min(value);
            self.raw_max = self.raw_max.max(value);
            self.window.push_back(value);
            self.window_sum.add(value);
            if self.window.len() > self.smoothing_samples {
                self.window_sum.add(-self.window.pop_front().unwrap_or(0.0));
            }
            self.since_resum += 1;
            if self.since_resum > 1 << 16 {
                // A running sum drifts by rounding; now and then it is taken afresh.
                self.window_sum = Compensated::default();
                self.window.iter().for_each(|v| self.window_sum.add(*v));
                self.since_resum = 0;
            }
            if self.window.len() == self.smoothing_samples {
                let middle = time_s + (i as f64 - 0.5 * (self.smoothing_samples - 1) as f64) * self.tau0_s;
                self.smoothed(self.window_sum.value() / self.smoothing_samples as f64, middle);
            }
            self.trend.push(value);
            if self.trend.n == self.trend_samples {
                let slope = self.trend.slope() / self.tau0_s;
                if self.steepest_per_s.is_none_or(|s| slope.abs() > s.abs()) {
                    self.steepest_per_s = Some(slope);
                }
                self.trend = Trend::default();
            }
        }
    }

    fn smoothed(&mut self, value: f64, time_s: f64) {
        self.smooth_count += 1;
        if value < self.smooth_min.value {
            self.smooth_min = Extreme { value, time_s };
        }
        if value > self.smooth_max.value {
            self.smooth_max = Extreme { value, time_s };
        }
        if self.band.is_some_and(|b| value < b.low || value > b.high) {
            self.outside_count += 1;
        }
    }

    /// A stretch shorter than the smoothing time still counts, with the mean of what it has.
    fn flush_short_stretch(&mut self, time_s: f64) {
        if !self.window.is_empty() && self.window.len() < self.smoothing_samples {
            let mean = self.window_sum.value() / self.window.len() as f64;
            self.smoothed(mean, time_s);
        }
    }

    /// The facts; `None` when there was no usable sample.
    pub fn finish(mut self) -> Option<StabilityFacts> {
        self.flush_short_stretch(self.smooth_max.time_s);
        if self.usable == 0 {
            return None;
        }
        Some(StabilityFacts {
            usable: self.usable,
            unusable: self.unusable,
            mean: self.sum.value() / self.usable as f64,
            raw_min: self.raw_min,
            raw_max: self.raw_max,
            smooth_min: self.smooth_min,
            smooth_max: self.smooth_max,
            share_outside: self.outside_count as f64 / self.smooth_count.max(1) as f64,
            steepest_deg_c_per_h: self.steepest_per_s.map(|s| s * 3600.0),
            smoothing_s: self.smoothing_samples as f64 * self.tau0_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_suppresses_a_spike_and_keeps_an_excursion() {
        let mut track = StabilityTrack::new(10.0, 1.0, Some(Band::about(20.0, 0.4)));
        let mut values = vec![20.0; 1000];
        values[100] = 22.0;
        values[500..600].fill(20.6);
        track.push(&values, 0.0, true);
        let f = track.finish().unwrap();
        assert_eq!(f.raw_max, 22.0);
        assert!((f.smooth_max.value - 20.6).abs() < 1e-9);
        assert!((f.smooth_max.time_s - 509.0).abs() < 90.0);
        // 100 samples of excursion: all windows with at least 7 of 10 samples in it exceed the band.
        assert!((f.share_outside * 991.0 - 97.0).abs() < 0.5, "{}", f.share_outside * 991.0);
    }

    #[test]
    fn a_ramp_shows_its_trend() {
        let mut track = StabilityTrack::new(60.0, 10.0, None);
        let values: Vec<f64> = (0..720).map(|i| 20.0 + 4.0 * f64::from(i) * 10.0 / 3600.0).collect();
        track.push(&values, 0.0, true);
        assert!((track.finish().unwrap().steepest_deg_c_per_h.unwrap() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_channel_without_numbers_says_nothing() {
        let mut track = StabilityTrack::new(60.0, 1.0, None);
        track.push(&[f64::NAN; 5], 0.0, true);
        assert!(track.finish().is_none());
    }
}
