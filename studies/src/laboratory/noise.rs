//! Noise of the light source and of the electronics, made in time: white by draws, flicker by a sum of relaxations, random
//! walk by summing. No filter of a wanted spectrum is used.

use super::dice::Dice;
use super::process::relaxation;
use std::f64::consts::{LN_10, PI, TAU};

/// Coefficients of IEEE Std 952.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Angle random walk, deg/√h.
    pub n: f64,
    /// Bias instability, deg/h.
    pub b: f64,
    /// Rate random walk, deg/h/√h.
    pub k: f64,
}

impl Levels {
    /// Two-sided density in (deg/h)²/Hz, as the contract states it.
    pub fn density(&self, frequency_hz: f64) -> f64 {
        let w = TAU * frequency_hz;
        3600.0 * self.n * self.n + self.b * self.b / w + self.k * self.k / (3600.0 * w * w)
    }
}

/// The three parts of the noise of a recording, deg/h per row.
#[derive(Debug, Clone)]
pub struct Parts {
    /// White.
    pub white: Vec<f64>,
    /// Flicker.
    pub flicker: Vec<f64>,
    /// Random walk.
    pub walk: Vec<f64>,
}

impl Parts {
    /// Draws the noise of some levels.
    pub fn draw(dice: &mut Dice, levels: Levels, rows: usize, rate_hz: f64) -> Parts {
        Parts {
            white: white(dice, levels.n, rows, rate_hz),
            flicker: flicker(dice, levels.b, rows, rate_hz),
            walk: walk(dice, levels.k, rows, rate_hz),
        }
    }

    /// Their sum.
    pub fn sum(&self) -> Vec<f64> {
        (0..self.white.len()).map(|i| self.white[i] + self.flicker[i] + self.walk[i]).collect()
    }
}

/// White noise of N.
pub fn white(dice: &mut Dice, n: f64, rows: usize, rate_hz: f64) -> Vec<f64> {
    let sigma = 60.0 * n * rate_hz.sqrt();
    (0..rows).map(|_| sigma * dice.normal()).collect()
}

/// Flicker of B: relaxations whose rates are spread evenly over the decades, four in each (A. van der Ziel, Physica 16
/// (1950) 359), from the sample rate down to a twentieth of
/// the inverse of the record's length.
pub fn flicker(dice: &mut Dice, b: f64, rows: usize, rate_hz: f64) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    if b == 0.0 {
        return sum;
    }
    let spacing = LN_10 / 4.0;
    // A density A of variance per unit of ln(rate) gives A/(2f), which is to be B²/(2πf).
    let sigma = b * (spacing / PI).sqrt();
    let duration_s = rows as f64 / rate_hz;
    // Sampled relaxations fold their upper part back. Begun here, they give 1/f within 1 % up to a fifth of the sample rate.
    let mut decay = 2.5 * rate_hz;
    while decay > TAU / (20.0 * duration_s) {
        let part = relaxation(dice, rows, 1.0 / rate_hz, 1.0 / decay, sigma);
        sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        decay /= spacing.exp();
    }
    sum
}

/// Random walk of K.
pub fn walk(dice: &mut Dice, k: f64, rows: usize, rate_hz: f64) -> Vec<f64> {
    let step = k / (3600.0 * rate_hz).sqrt();
    let mut at = 0.0;
    (0..rows)
        .map(|_| {
            at += step * dice.normal();
            at
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::modes::Modes;

    /// Mean power over the stated density in a band, over some draws.
    fn ratio(levels: Levels, band: [f64; 2], seed: u64) -> f64 {
        let (rows, rate_hz) = (1 << 14, 4.0);
        let (mut sum, mut of) = (0.0, 0.0);
        for draw in 0..60 {
            let noise = Parts::draw(&mut Dice::new(seed + draw), levels, rows, rate_hz).sum();
            let modes = Modes::of(&noise, rate_hz);
            for (f, x) in
                modes.frequency_hz.iter().zip(&modes.value).filter(|(f, _)| (band[0]..band[1]).contains(*f))
            {
                sum += x * x / (levels.density(*f) * rate_hz);
                of += 1.0;
            }
        }
        sum / of
    }

    #[test]
    fn the_density_is_that_of_the_contract() {
        let nothing = Levels { n: 0.0, b: 0.0, k: 0.0 };
        // From 4 periods in the record; flicker and walk well below Nyquist.
        for (levels, band, within) in [
            (Levels { n: 0.01, ..nothing }, [0.001, 2.0], 0.01),
            (Levels { b: 0.1, ..nothing }, [0.001, 0.01], 0.06),
            (Levels { b: 0.1, ..nothing }, [0.01, 0.1], 0.03),
            (Levels { b: 0.1, ..nothing }, [0.1, 0.4], 0.03),
            (Levels { k: 0.1, ..nothing }, [0.001, 0.01], 0.08),
            (Levels { k: 0.1, ..nothing }, [0.01, 0.4], 0.03),
            (Levels { n: 0.004, b: 0.1, k: 0.5 }, [0.001, 2.0], 0.02),
        ] {
            let found = ratio(levels, band, 10);
            assert!((found - 1.0).abs() < within, "{levels:?} {band:?}: {found}");
        }
    }
}
