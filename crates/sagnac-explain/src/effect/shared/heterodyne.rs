//! A period of an angle whose rate has an offset that nobody knows: the score is turned back by the angle for one period after another,
//! and a transform over time shows every offset at once.

use crate::numeric::order::SortByNumber;
use rayon::prelude::*;
use sagnac_fft::{Complex, complex_forward};
use std::f64::consts::PI;

/// A sample of the search.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Since the first of the record.
    pub number: usize,
    /// Angle without the offset.
    pub angle_arcsec: f64,
    /// Score of the likelihood for its value.
    pub score: f64,
}

/// Frequencies, offsets and samples that a search goes through.
#[derive(Debug, Clone, Copy)]
pub struct Scope {
    /// Frequencies of the angle, cycles an arcsec: the first and the last.
    pub frequencies: [f64; 2],
    /// Step between them.
    pub step: f64,
    /// Offset of the rate either way, arcsec/s.
    pub offset_arcsec_s: f64,
    /// Interval of the samples, s.
    pub dt_s: f64,
    /// Samples of the record.
    pub samples: usize,
}

/// The best offset for a frequency of the angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beat {
    /// Cycles an arcsec.
    pub frequency: f64,
    /// Arcsec/s.
    pub offset_arcsec_s: f64,
    /// Square of the sum of the scores.
    pub power: f64,
}

impl Scope {
    /// Frequencies of the angle that are tried.
    pub fn rows(&self) -> usize {
        ((self.frequencies[1] - self.frequencies[0]) / self.step).max(0.0) as usize + 1
    }

    /// Independent places: frequencies half a cycle apart, times the offsets that the length of the record tells apart.
    pub fn trials(&self) -> f64 {
        let highest = self.frequencies[1] * self.offset_arcsec_s;
        0.5 * self.rows() as f64 * (1.0 + 2.0 * highest * self.samples as f64 * self.dt_s)
    }

    /// Samples and, four times, places of transforms that a search of so many samples goes through.
    pub fn cost(&self, samples: usize) -> f64 {
        self.rows() as f64 * (samples as f64 + 4.0 * self.size() as f64)
    }

    /// Length of a transform.
    fn size(&self) -> usize {
        quick_size(2 * self.samples.div_ceil(self.block()))
    }

    /// Samples that are summed before the transform: a quarter of a turn of the fastest beat at most.
    fn block(&self) -> usize {
        let highest = self.frequencies[1] * self.offset_arcsec_s;
        let most = (self.samples / 16).max(1);
        ((0.25 / (highest * self.dt_s)) as usize).clamp(1, most)
    }
}

/// The smallest product of twos and threes from `least` up: transforms of such sizes are quick.
pub fn quick_size(least: usize) -> usize {
    let of_threes = |threes: u32| {
        let three = 3usize.pow(threes);
        three * least.div_ceil(three).next_power_of_two()
    };
    (0..6).map(of_threes).min().unwrap_or(least)
}

/// The strongest beats, the first the strongest, of rows that are no neighbours.
pub fn strongest(samples: &[Sample], scope: &Scope, wanted: usize) -> Vec<Beat> {
    /// Frequencies that one worker goes through from one exact turn.
    const ROWS_A_WORKER: usize = 32;
    /// Frequencies beside a beat that are the same beat.
    const NEIGHBOUR_STEPS: f64 = 2.5;
    let block = scope.block();
    let size = scope.size();
    let plan = complex_forward(size);
    let turn = |cycles: f64| Complex::cis(-2.0 * PI * cycles.fract());
    let next: Vec<Complex<f64>> = samples.iter().map(|s| turn(scope.step * s.angle_arcsec)).collect();
    let starts: Vec<usize> = (0..scope.rows()).step_by(ROWS_A_WORKER).collect();
    let of_worker = |start: &usize| {
        let frequency = |row: usize| scope.frequencies[0] + row as f64 * scope.step;
        let first = frequency(*start);
        let mut turned: Vec<Complex<f64>> =
            samples.iter().map(|s| turn(first * s.angle_arcsec) * s.score).collect();
        let mut sums = vec![Complex::default(); size];
        let mut scratch = vec![Complex::default(); plan.get_inplace_scratch_len()];
        let rows = *start..(start + ROWS_A_WORKER).min(scope.rows());
        rows.map(|row| {
            sums.fill(Complex::default());
            for ((z, sample), next) in turned.iter_mut().zip(samples).zip(&next) {
                if let Some(sum) = sums.get_mut(sample.number / block) {
                    *sum += *z;
                }
                *z *= next;
            }
            plan.process_with_scratch(&mut sums, &mut scratch);
            best_of_row(&sums, frequency(row), block as f64 * scope.dt_s, scope.offset_arcsec_s)
        })
        .collect::<Vec<Beat>>()
    };
    let mut beats: Vec<Beat> = starts.par_iter().map(of_worker).flatten().collect();
    beats.sort_descending_by(|b| b.power);
    let mut out: Vec<Beat> = vec![];
    for beat in beats {
        let beside = |o: &Beat| (o.frequency - beat.frequency).abs() < NEIGHBOUR_STEPS * scope.step;
        if out.len() < wanted && !out.iter().any(beside) {
            out.push(beat);
        }
    }
    out
}

/// The strongest offset of one row, of those either way that are asked for.
fn best_of_row(spectrum: &[Complex<f64>], frequency: f64, block_s: f64, most: f64) -> Beat {
    let size = spectrum.len();
    let step_hz = 1.0 / (size as f64 * block_s);
    let last = ((most * frequency / step_hz) as usize).min(size / 2 - 1);
    let offset = |k: usize, sign: f64| sign * k as f64 * step_hz / frequency;
    let places = (0..=last).flat_map(|k| [(k, k, 1.0), ((size - k) % size, k, -1.0)]);
    let beats = places.map(|(bin, k, sign)| Beat {
        frequency,
        offset_arcsec_s: offset(k, sign),
        power: spectrum[bin].norm_sqr(),
    });
    let none = Beat { frequency, offset_arcsec_s: 0.0, power: 0.0 };
    beats.fold(none, |best, beat| if beat.power > best.power { beat } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_period_and_the_offset_of_the_rate_are_found_at_once() {
        // A table that swings by 3000 arcsec either way, a period of 37 arcsec, and a rate that is off by 0.42 arcsec/s.
        let (period, offset, dt_s, samples) = (37.0, 0.42, 0.5, 6000);
        let angle = |t: f64| 3000.0 * (0.011 * t).sin() + 5.0 * t;
        let sample = |number: usize| {
            let t = (number as f64 + 0.5) * dt_s;
            let score = (2.0 * PI * (angle(t) + offset * t) / period + 0.7).cos();
            Sample { number, angle_arcsec: angle(t), score }
        };
        let all: Vec<Sample> = (0..samples).map(sample).collect();
        let scope = Scope {
            frequencies: [1.0 / 64.0, 1.0 / 32.0],
            step: 0.5 / 6000.0,
            offset_arcsec_s: 1.5,
            dt_s,
            samples,
        };
        let found = strongest(&all, &scope, 3);
        assert!((1.0 / found[0].frequency - period).abs() < 0.1, "{found:?}");
        assert!((found[0].offset_arcsec_s - offset).abs() < 0.01, "{found:?}");
        assert!(found.len() == 3 && found[0].power > 3.0 * found[1].power, "{found:?}");
        // Half the rows, and the turns of 1.5/32 Hz either way in 3000 s.
        assert!((scope.trials() - 0.5 * 188.0 * (1.0 + 2.0 * 1.5 / 32.0 * 3000.0)).abs() < 200.0);
    }
}
