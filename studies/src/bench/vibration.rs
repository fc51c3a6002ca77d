//! A gyro on a shaker with an accelerometer beside it: bands of vibration in turns, a bias that is rectified from each, and a
//! resonance. Uses nothing of the program under test.

use super::chance::Chance;
use std::f64::consts::TAU;

/// What the shaker leaves free at either end of a band, Hz.
const MARGIN_HZ: f64 = 1.0;

/// A band that is shaken.
#[derive(Clone, Copy, Debug, serde::Deserialize)]
pub struct ShakenBand {
    /// Lowest frequency, Hz.
    pub from_hz: f64,
    /// Highest frequency, Hz.
    pub to_hz: f64,
    /// Bias per mean square of the acceleration in it, deg/h/g².
    pub per_square: f64,
}

/// A pole pair of the unit.
#[derive(Clone, Copy, Debug, serde::Deserialize)]
pub struct PolePair {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Quality factor.
    pub quality: f64,
    /// Response at its frequency, deg/h/g.
    pub response: f64,
}

/// A unit and its test.
#[derive(Clone, Debug)]
pub struct OnShaker {
    /// Samples a second.
    pub hz: f64,
    /// Length of an interval, s.
    pub interval_s: f64,
    /// The bands.
    pub bands: Vec<ShakenBand>,
    /// Rms acceleration in every band in the intervals with vibration, g. One without stands before, between and behind.
    pub vibrations: Vec<Vec<f64>>,
    /// True for one sine in the middle of every band, false for many close to each other.
    pub sine: bool,
    /// The resonance.
    pub resonance: Option<PolePair>,
    /// Response beside it, the same at all frequencies, deg/h/g.
    pub level_response: f64,
    /// Angle random walk, deg/√h, and what it grows by with the rms, 1/g.
    pub noise: (f64, f64),
    /// Drift over the test, deg/h.
    pub drift: f64,
    /// Temperature per mean square, degC/g², and bias per temperature, deg/h/degC.
    pub warms: (f64, f64),
}

/// What was recorded.
#[derive(Clone, Debug, Default)]
pub struct Shaken {
    /// s
    pub time_s: Vec<f64>,
    /// deg/h
    pub rate: Vec<f64>,
    /// g
    pub acceleration: Vec<f64>,
    /// degC
    pub temperature: Vec<f64>,
}

/// Bias of the unit, deg/h.
const BIAS: f64 = 12.5;

/// One tone: the real and imaginary part of its acceleration, of the turn from a sample to the next, and of the response.
struct Tone {
    now: (f64, f64),
    turn: (f64, f64),
    response: (f64, f64),
}

fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

impl OnShaker {
    /// The response at a frequency, deg/h/g.
    fn response(&self, f: f64) -> (f64, f64) {
        let Some(pole) = self.resonance else { return (self.level_response, 0.0) };
        let x = f / pole.frequency_hz;
        let (re, im) = (1.0 - x * x, x / pole.quality);
        let of = pole.response / pole.quality / (re * re + im * im);
        (self.level_response + of * re, -of * im)
    }

    fn tones(&self, band: &ShakenBand, rms: f64, chance: &mut Chance) -> Vec<Tone> {
        let count = ((band.to_hz - band.from_hz - 2.0 * MARGIN_HZ) * self.interval_s).floor() as usize;
        let frequencies: Vec<f64> = if self.sine {
            vec![0.5 * (band.from_hz + band.to_hz)]
        } else {
            (0..count).map(|i| band.from_hz + MARGIN_HZ + (i as f64 + 0.5) / self.interval_s).collect()
        };
        let amplitude = rms * (2.0 / frequencies.len().max(1) as f64).sqrt();
        let of = |f: &f64| {
            let phase = TAU * chance.uniform();
            let turn = TAU * f / self.hz;
            Tone {
                now: (amplitude * phase.cos(), amplitude * phase.sin()),
                turn: (turn.cos(), turn.sin()),
                response: self.response(*f),
            }
        };
        frequencies.iter().map(of).collect()
    }

    /// The recording of a seed.
    pub fn record(&self, seed: u64) -> Shaken {
        let mut chance = Chance::new(seed);
        let each = (self.interval_s * self.hz).round() as usize;
        let intervals = 2 * self.vibrations.len() + 1;
        let count = each * intervals;
        let white = 60.0 * self.noise.0 * self.hz.sqrt();
        let mut out = Shaken::default();
        for interval in 0..intervals {
            let quiet = vec![];
            let rms = if interval % 2 == 1 { &self.vibrations[interval / 2] } else { &quiet };
            let mut tones: Vec<Vec<Tone>> = self
                .bands
                .iter()
                .zip(rms)
                .map(|(band, rms)| if *rms > 0.0 { self.tones(band, *rms, &mut chance) } else { vec![] })
                .collect();
            let total: f64 = rms.iter().map(|r| r * r).sum();
            let louder = 1.0 + self.noise.1 * total.sqrt();
            for i in 0..each {
                let at = interval * each + i;
                let (mut acceleration, mut rate) = (0.0, 0.0);
                for (own, band) in tones.iter_mut().zip(&self.bands) {
                    let mut of_band = 0.0;
                    for tone in own {
                        of_band += tone.now.0;
                        rate += product(tone.now, tone.response).0;
                        tone.now = product(tone.now, tone.turn);
                    }
                    acceleration += of_band;
                    rate += band.per_square * of_band * of_band;
                }
                let warmer = self.warms.0 * total;
                rate += BIAS + self.drift * at as f64 / count as f64 + self.warms.1 * warmer;
                out.time_s.push(at as f64 / self.hz);
                out.rate.push(rate + white * louder * chance.normal());
                out.acceleration.push(acceleration + 0.002 * chance.normal());
                out.temperature.push(20.0 + warmer + 0.003 * chance.normal());
            }
        }
        out
    }
}

/// Two bands in turns, twice each, at 2 g: one that is rectified by so many deg/h/g² and a resonance of so many deg/h/g in the other.
pub fn two_bands(per_square: f64, response: f64) -> OnShaker {
    OnShaker {
        hz: 80.0,
        interval_s: 24.0,
        bands: vec![
            ShakenBand { from_hz: 5.0, to_hz: 13.0, per_square },
            ShakenBand { from_hz: 15.0, to_hz: 35.0, per_square: 0.02 },
        ],
        vibrations: vec![vec![2.0, 0.0], vec![0.0, 2.0], vec![2.0, 0.0], vec![0.0, 2.0]],
        sine: false,
        resonance: Some(PolePair { frequency_hz: 24.0, quality: 8.0, response }),
        level_response: 0.2,
        noise: (0.002, 0.05),
        drift: 0.05,
        warms: (0.0, 0.0),
    }
}
