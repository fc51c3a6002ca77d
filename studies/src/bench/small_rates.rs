//! A gyro at small rates, with or without a dead zone.

use super::EARTH;
use super::drift::{Drift, normal};
use super::rate_table::{ARCSEC_PER_TURN, Recorded};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// A gyro at small rates about the vertical: the Earth's rotation is part of the input.
#[derive(Debug, Clone)]
pub struct SmallRates {
    /// Half width of the dead zone, deg/h.
    pub half_width: f64,
    /// Whether the output is short by it outside.
    pub subtractive: bool,
    /// Standard deviation of the rate noise inside the loop, which moves the input in and out of the zone, deg/h.
    pub loop_noise: f64,
    /// N, deg/sqrt(h).
    pub n: f64,
    /// 1/f noise of the one-sided density b²/(2πf), deg/h.
    pub b: f64,
    /// K, deg/h/sqrt(h).
    pub k: f64,
    /// Bias behind the zone, deg/h.
    pub bias: f64,
    /// Deviation of the scale factor, ppm.
    pub error_ppm: f64,
    /// Latitude, deg.
    pub latitude: f64,
    /// Distance of the rates, deg/h.
    pub spacing: f64,
    /// Number of the rates to each side.
    pub each_side: i32,
    /// Time at a rate, s.
    pub dwell_s: f64,
    /// Error of a reading of the table angle, arcsec.
    pub reading_arcsec: f64,
    /// Sample rate, Hz.
    pub hz: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for SmallRates {
    fn default() -> SmallRates {
        SmallRates {
            half_width: 0.3,
            subtractive: true,
            loop_noise: 0.0,
            n: 0.003,
            b: 0.0,
            k: 0.0,
            bias: 0.08,
            error_ppm: 60.0,
            latitude: 55.98,
            spacing: 0.125,
            each_side: 10,
            dwell_s: 120.0,
            reading_arcsec: 0.1,
            hz: 1.0,
            seed: 1,
        }
    }
}

impl SmallRates {
    /// Table rate at which the input is none, deg/h.
    pub fn centre(&self) -> f64 {
        -EARTH * self.latitude.to_radians().sin()
    }

    /// There and back over the rates.
    pub fn record(&self) -> Recorded {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(self.seed);
        let dt = 1.0 / self.hz;
        let up: Vec<f64> =
            (-self.each_side..=self.each_side).map(|i| self.centre() + f64::from(i) * self.spacing).collect();
        let rates: Vec<f64> = up.iter().copied().chain(up.iter().rev().skip(1).copied()).collect();
        let mut out = Recorded::default();
        let (mut t, mut angle) = (0.0, 40_000.0);
        let mut drift = (self.b > 0.0 || self.k > 0.0).then(|| Drift::new(self.b, self.k, &mut rng));
        for (i, rate) in rates.iter().enumerate() {
            while t < (i + 1) as f64 * self.dwell_s - 0.5 * dt {
                let input = rate - self.centre();
                let behind = |input: f64| {
                    if self.subtractive {
                        input.signum() * (input.abs() - self.half_width).max(0.0)
                    } else if input.abs() > self.half_width {
                        input
                    } else {
                        0.0
                    }
                };
                let zone = if self.loop_noise > 0.0 {
                    let turns = 200;
                    let sum: f64 =
                        (0..turns).map(|_| behind(input + self.loop_noise * normal(&mut rng))).sum();
                    sum / f64::from(turns)
                } else {
                    behind(input)
                };
                let y = (1.0 + 1e-6 * self.error_ppm) * zone
                    + self.bias
                    + drift.as_mut().map_or(0.0, |d| d.next(dt, &mut rng))
                    + self.n / (dt / 3600.0).sqrt() * normal(&mut rng);
                out.time_s.push(t);
                out.rate_deg_h.push(y);
                out.table_rate_deg_h.push(*rate);
                let reading = angle + self.reading_arcsec * normal(&mut rng);
                out.table_angle_arcsec.push(reading.rem_euclid(ARCSEC_PER_TURN));
                out.temperature.push(20.0);
                angle += rate * dt;
                t += dt;
            }
        }
        out
    }
}
