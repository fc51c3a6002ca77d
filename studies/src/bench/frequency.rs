//! A gyro on a table that moves over frequency. Its dynamics are differential equations solved in small steps: the module
//! holds no transfer function and imports nothing of the program under test.

use super::noise_source::NoiseSource;
use std::f64::consts::TAU;

/// Steps of the solution in a sample interval.
const STEPS_PER_SAMPLE: usize = 32;

/// How the unit follows the rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dynamics {
    /// At once.
    None,
    /// y' = 2πf·(u − y).
    OnePole {
        /// Corner, Hz.
        corner_hz: f64,
    },
    /// y'' = (2πf)²·(u − y) − 2ζ·2πf·y'.
    TwoPoles {
        /// Corner, Hz.
        corner_hz: f64,
        /// Damping ζ.
        damping: f64,
    },
    /// Mean of the rate over the time before.
    Average {
        /// Time, s.
        over_s: f64,
    },
}

/// How the table moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// One frequency after another, from the lowest to the highest in equal times and ratios.
    Sweep,
    /// Sines, one after another.
    Steps,
    /// A sum of many sines of random phase.
    Random,
}

/// A gyro on a table.
#[derive(Debug, Clone)]
pub struct OnTable {
    /// How it follows.
    pub dynamics: Dynamics,
    /// Delay, s.
    pub delay_s: f64,
    /// Scale factor, relative.
    pub gain: f64,
    /// Bias, deg/s.
    pub bias: f64,
    /// Noise of a sample, deg/s.
    pub noise: f64,
    /// Error of a reading of the angle, arcsec.
    pub reading_arcsec: f64,
    /// Motion.
    pub motion: Motion,
    /// Lowest and highest frequency, Hz.
    pub frequencies: (f64, f64),
    /// Amplitude of the rate, deg/s.
    pub amplitude: f64,
    /// Length, s.
    pub seconds: f64,
    /// Sample rate, Hz.
    pub hz: f64,
}

impl Default for OnTable {
    fn default() -> OnTable {
        OnTable {
            dynamics: Dynamics::TwoPoles { corner_hz: 40.0, damping: 0.7 },
            delay_s: 0.0015,
            gain: 1.001,
            bias: 0.02,
            noise: 0.02,
            reading_arcsec: 0.1,
            motion: Motion::Sweep,
            frequencies: (0.5, 60.0),
            amplitude: 10.0,
            seconds: 48.0,
            hz: 250.0,
        }
    }
}

/// A record: time in s, output in deg/s, angle of the table in deg.
pub struct Record {
    /// s
    pub time: Vec<f64>,
    /// deg/s
    pub output: Vec<f64>,
    /// deg
    pub angle: Vec<f64>,
}

/// Rate of the table at a time, deg/s.
struct Rate {
    motion: Motion,
    low: f64,
    ratio: f64,
    seconds: f64,
    amplitude: f64,
    /// Frequencies, Hz, and phases, rad.
    sines: Vec<(f64, f64)>,
}

/// Sines of a random motion.
const RANDOM_SINES: usize = 160;

/// Frequencies of steps.
const STEPS: usize = 16;

impl Rate {
    fn of(unit: &OnTable, source: &mut NoiseSource) -> Rate {
        let (low, high) = unit.frequencies;
        let sines = match unit.motion {
            Motion::Sweep => vec![],
            Motion::Steps => {
                let at = |i: usize| low * (high / low).powf(i as f64 / (STEPS - 1) as f64);
                (0..STEPS).map(|i| (at(i), 0.0)).collect()
            }
            Motion::Random => (0..RANDOM_SINES)
                .map(|i| {
                    let share = (i as f64 + source.uniform(0.0, 1.0)) / RANDOM_SINES as f64;
                    (low + (high - low) * share, source.uniform(0.0, TAU))
                })
                .collect(),
        };
        let (ratio, seconds, amplitude) = (high / low, unit.seconds, unit.amplitude);
        Rate { motion: unit.motion, low, ratio, seconds, amplitude, sines }
    }

    fn at(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            return 0.0;
        }
        match self.motion {
            Motion::Sweep => {
                let growth = self.ratio.ln() / self.seconds;
                let phase = TAU * self.low * ((growth * time_s).exp() - 1.0) / growth;
                self.amplitude * phase.sin()
            }
            Motion::Steps => {
                let dwell = self.seconds / self.sines.len() as f64;
                let step = ((time_s / dwell) as usize).min(self.sines.len() - 1);
                let (frequency, _) = self.sines[step];
                self.amplitude * (TAU * frequency * (time_s - step as f64 * dwell)).sin()
            }
            Motion::Random => {
                let each = self.amplitude / (self.sines.len() as f64 / 2.0).sqrt();
                self.sines.iter().map(|(f, phase)| each * (TAU * f * time_s + phase).sin()).sum()
            }
        }
    }
}

impl OnTable {
    /// What is recorded.
    pub fn record(&self, seed: u64) -> Record {
        let mut source = NoiseSource::new(seed);
        let rate = Rate::of(self, &mut source);
        let samples = (self.seconds * self.hz) as usize;
        let step = 1.0 / (self.hz * STEPS_PER_SAMPLE as f64);
        let mut record = Record { time: vec![], output: vec![], angle: vec![] };
        let (mut angle, mut state) = (0.0, (0.0, 0.0));
        // Angles at the steps, for the mean over a time before.
        let mut angles = vec![];
        let mut delayed_angle = 0.0;
        let (mut now, mut now_delayed) = (rate.at(0.0), rate.at(-self.delay_s));
        for i in 0..samples * STEPS_PER_SAMPLE {
            let t = i as f64 * step;
            if i % STEPS_PER_SAMPLE == 0 {
                let ideal = match self.dynamics {
                    Dynamics::None => rate.at(t - self.delay_s),
                    Dynamics::OnePole { .. } | Dynamics::TwoPoles { .. } => state.0,
                    Dynamics::Average { over_s } => {
                        let back = (over_s / step).round() as usize;
                        let before = angles.len().checked_sub(back).and_then(|k| angles.get(k)).copied();
                        (delayed_angle - before.unwrap_or(0.0)) / over_s
                    }
                };
                record.time.push(t);
                record.output.push(self.gain * ideal + self.bias + self.noise * source.normal());
                record.angle.push(angle + self.reading_arcsec / 3600.0 * source.normal());
            }
            angles.push(delayed_angle);
            // A rate of many sines is dear: that of the end of a step is that of the beginning of the next.
            let ahead = [0.5 * step, step].map(|later| rate.at(t + later));
            let ahead_delayed = [0.5 * step, step].map(|later| rate.at(t + later - self.delay_s));
            // Simpson's rule.
            angle += step / 6.0 * (now + 4.0 * ahead[0] + ahead[1]);
            delayed_angle += step / 6.0 * (now_delayed + 4.0 * ahead_delayed[0] + ahead_delayed[1]);
            state = self.followed(state, [now_delayed, ahead_delayed[0], ahead_delayed[1]], step);
            (now, now_delayed) = (ahead[1], ahead_delayed[1]);
        }
        record
    }

    /// The state after a step: Runge and Kutta of fourth order.
    fn followed(&self, state: (f64, f64), [first, middle, last]: [f64; 3], step: f64) -> (f64, f64) {
        let slope = |(y, v): (f64, f64), u: f64| match self.dynamics {
            Dynamics::OnePole { corner_hz } => (TAU * corner_hz * (u - y), 0.0),
            Dynamics::TwoPoles { corner_hz, damping } => {
                let w = TAU * corner_hz;
                (v, w * w * (u - y) - 2.0 * damping * w * v)
            }
            Dynamics::None | Dynamics::Average { .. } => (0.0, 0.0),
        };
        let moved = |(y, v): (f64, f64), (dy, dv): (f64, f64), by: f64| (y + by * dy, v + by * dv);
        let a = slope(state, first);
        let b = slope(moved(state, a, 0.5 * step), middle);
        let c = slope(moved(state, b, 0.5 * step), middle);
        let d = slope(moved(state, c, step), last);
        let mean = |x: [f64; 4]| (x[0] + 2.0 * x[1] + 2.0 * x[2] + x[3]) / 6.0;
        moved(state, (mean([a.0, b.0, c.0, d.0]), mean([a.1, b.1, c.1, d.1])), step)
    }

    /// Amplitude and lag of the output at a frequency, rad, from the equations run until only the forced motion is left.
    pub fn forced(&self, frequency_hz: f64) -> (f64, f64) {
        let rate = |t: f64| (TAU * frequency_hz * (t - self.delay_s)).sin();
        let (corner, slowest) = match self.dynamics {
            Dynamics::None => (frequency_hz, frequency_hz),
            Dynamics::OnePole { corner_hz } => (corner_hz, corner_hz),
            Dynamics::TwoPoles { corner_hz, damping } => (corner_hz, corner_hz * damping.min(1.0 / damping)),
            Dynamics::Average { over_s } => {
                // A mean has no motion of its own: its values a quarter of a period apart give both.
                let parts = 20_000;
                let part = over_s / f64::from(parts);
                let at = |t: f64| {
                    (0..parts).map(|k| rate(t - part * (f64::from(k) + 0.5))).sum::<f64>() / f64::from(parts)
                };
                let (sine, cosine) = (at(0.25 / frequency_hz), at(0.0));
                return (sine.hypot(cosine), -cosine.atan2(sine));
            }
        };
        let steps_per_period = 400.0 * (corner / frequency_hz).max(1.0).ceil();
        let step = 1.0 / (frequency_hz * steps_per_period);
        let periods = (6.0 * frequency_hz / slowest).ceil().max(2.0) + 1.0;
        let (begin, end) =
            (((periods - 1.0) * steps_per_period) as usize, (periods * steps_per_period) as usize);
        let (mut state, mut sine, mut cosine) = ((0.0, 0.0), 0.0, 0.0);
        for i in 0..end {
            let t = i as f64 * step;
            if i >= begin {
                let y = if self.dynamics == Dynamics::None { rate(t) } else { state.0 };
                sine += y * (TAU * frequency_hz * t).sin();
                cosine += y * (TAU * frequency_hz * t).cos();
            }
            state = self.followed(state, [rate(t), rate(t + 0.5 * step), rate(t + step)], step);
        }
        let half = 0.5 * (end - begin) as f64;
        (sine.hypot(cosine) / half, -cosine.atan2(sine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_falls_to_half_the_power_at_its_corner() {
        let unit =
            OnTable { dynamics: Dynamics::OnePole { corner_hz: 30.0 }, delay_s: 0.0, ..OnTable::default() };
        let (amplitude, lag) = unit.forced(30.0);
        assert!((amplitude - 0.5f64.sqrt()).abs() < 2e-4, "{amplitude}");
        assert!((lag - TAU / 8.0).abs() < 2e-3, "{lag}");
    }

    #[test]
    fn an_average_is_zero_at_one_over_its_time() {
        let unit =
            OnTable { dynamics: Dynamics::Average { over_s: 0.02 }, delay_s: 0.0, ..OnTable::default() };
        assert!(unit.forced(50.0).0 < 1e-3);
    }
}
