//! A contribution that is periodic in the sensed angle.

use crate::effect::shared::reach::varies;
use crate::effect::shared::search::{best_of, fast_level, peaks};
use crate::effect::shared::sinusoid::{averaged, pair, polar, wave};
use crate::effect::{
    Domain, Drivers, MeanModel, Param, Place, Regressors, SearchContext, Starts, Values, number,
};
use crate::numeric::optimize::parabolic_peak;
use crate::numeric::order::SortByNumber;
use crate::numeric::range::{Bounds, ends};
use rayon::prelude::*;
use sagnac_fft::{Complex, Fft, complex_forward};
use std::f64::consts::PI;
use std::sync::Arc;

pub struct ResetRipple;

static PARAMS: [Param; 4] = [
    Param::reported("period_arcsec", "arcsec", 1e-3, 1e7),
    Param::inner("amplitude_deg_h", "deg/h", 0.0, 1e5),
    Param::inner("phase_deg", "deg", -360.0, 360.0),
    Param::inner("sensed_bias_deg_h", "deg/h", -1e5, 1e5),
];

describe! {
    ResetRipple, "reset_ripple", Mean in Angle, needs [TableRate],
    confusers [Line, TableHarmonic, NoiseVarianceRate]
}

/// Shortest period that is looked for, arcsec.
const MIN_PERIOD_ARCSEC: f64 = 0.5;
/// Most periods of angle in a search.
const MAX_PERIODS: usize = 1 << 18;
/// Cells and samples that a search of one octave of periods may go through.
const OCTAVE_BUDGET: f64 = 4e7;
/// Largest departure of the bias from the claimed one, deg/h.
const MAX_BIAS_ERROR_DEG_H: f64 = 100.0;
/// Standard deviations of the fitted bias within which the true one is sought.
const BIAS_SEARCH_SIGMAS: f64 = 3.0;

/// Sensed angle at the middle of each sample since the first began, and its change over the sample, arcsec.
fn sensed(bias: f64, drivers: &Drivers) -> Option<(Vec<f64>, Vec<f64>)> {
    let rate = drivers.table_rate.as_ref()?;
    let mut angle = 0.0;
    let steps: Vec<f64> = rate.iter().map(|r| (3600.0 * r + bias) * drivers.dt_s).collect();
    let middles = steps.iter().map(|step| {
        angle += step;
        angle - 0.5 * step
    });
    let middles = middles.collect();
    Some((middles, steps))
}

/// Range of the sensed angle, arcsec.
fn extent(bias: f64, drivers: &Drivers) -> f64 {
    sensed(bias, drivers).map_or(1.0, |(angle, _)| {
        let Bounds { low, high } = ends(&angle);
        (high - low).max(1e-9)
    })
}

fn columns(period: f64, bias: f64, drivers: &Drivers) -> Vec<Vec<f64>> {
    match sensed(bias, drivers) {
        Some((angle, step)) if period > 0.0 => {
            pair(angle.len(), |i| (angle[i] / period, averaged(step[i] / period)))
        }
        _ => vec![],
    }
}

/// A search of the periods between one and twice that: the score is turned back at the middle of their frequencies, put on
/// a grid of angles a period wide and transformed. Only samples that cover less than a period count.
struct Octave {
    period: f64,
    samples: Vec<Sample>,
    low: f64,
    range: f64,
    dt_s: f64,
    plan: Arc<dyn Fft<f64>>,
}

/// A sample that counts.
struct Sample {
    /// Since the first of the record.
    number: usize,
    angle_arcsec: f64,
    /// Score, turned back for the angle.
    score: Complex<f64>,
}

/// Buffers of the search for one bias.
#[derive(Default)]
struct Buffers {
    grid: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
    gains: Vec<f64>,
}

/// The smallest product of twos and threes from `least` up: transforms of such sizes are quick.
fn quick_size(least: usize) -> usize {
    let of_threes = |threes: u32| {
        let three = 3usize.pow(threes);
        three * least.div_ceil(three).next_power_of_two()
    };
    (0..6).map(of_threes).min().unwrap_or(least)
}

impl Octave {
    /// Middle of the frequencies that are looked at, in cycles a period.
    const MIDDLE_FREQUENCY: f64 = 0.75;

    /// `margin` is what biases turn the angle by, arcsec.
    fn new(
        period: f64,
        (middles, steps): &(Vec<f64>, Vec<f64>),
        dt_s: f64,
        margin: f64,
        context: &SearchContext<'_>,
    ) -> Option<Octave> {
        let used = (0..middles.len()).filter(|i| steps[*i].abs() < period);
        let sample = |number: usize| {
            let angle_arcsec = middles[number];
            let turned = Complex::cis(-2.0 * PI * (Octave::MIDDLE_FREQUENCY * angle_arcsec / period).fract());
            Sample { number, angle_arcsec, score: turned * context.score[number] }
        };
        let samples: Vec<Sample> = used.map(sample).collect();
        let (low, high) = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| {
            (s.angle_arcsec.min(a), s.angle_arcsec.max(b))
        });
        let (low, high) = (low - margin, high + margin);
        let cells = (high - low) / period;
        if samples.len() < 32 || !cells.is_finite() || cells >= MAX_PERIODS as f64 {
            return None;
        }
        // Twice the range, so that periods between the cycles of the range are seen too.
        let size = quick_size((2 * (cells as usize + 1)).max(8));
        let plan = complex_forward(size);
        Some(Octave { period, samples, low, range: high - low, dt_s, plan })
    }

    /// Gains for one bias by their frequency into `buffers`; the frequency of the first and the step, cycles an arcsec.
    /// `level` is that of the noise.
    fn gains(&self, bias_deg_h: f64, level: f64, buffers: &mut Buffers) -> (f64, f64) {
        let size = self.plan.len();
        buffers.grid.clear();
        buffers.grid.resize(size, Complex::default());
        // A degree an hour is an arcsecond a second.
        let a_sample = bias_deg_h * self.dt_s;
        let turn = |samples: f64| {
            Complex::cis(-2.0 * PI * (Octave::MIDDLE_FREQUENCY * a_sample * samples / self.period).fract())
        };
        let (next, mut turned, mut expected) = (turn(1.0), Complex::default(), usize::MAX);
        for sample in &self.samples {
            turned = if sample.number == expected { turned * next } else { turn(sample.number as f64) };
            expected = sample.number + 1;
            let at = (sample.angle_arcsec + a_sample * sample.number as f64 - self.low) / self.period;
            if let Some(cell) = buffers.grid.get_mut(at as usize) {
                *cell += sample.score * turned;
            }
        }
        buffers.scratch.resize(self.plan.get_inplace_scratch_len(), Complex::default());
        self.plan.process_with_scratch(&mut buffers.grid, &mut buffers.scratch);
        let step = 1.0 / (size as f64 * self.period);
        let (quarter, middle) = (size / 4, Octave::MIDDLE_FREQUENCY / self.period);
        let scale = level / self.samples.len() as f64;
        let first = middle - quarter as f64 * step;
        let gain = |j: usize| {
            let f = first + j as f64 * step;
            let w = buffers.grid[(j + size - quarter) % size];
            if f * self.range >= 3.0 { w.norm_sqr() * scale } else { 0.0 }
        };
        buffers.gains.clear();
        buffers.gains.extend((0..=2 * quarter).map(gain));
        (first, step)
    }
}

impl MeanModel for ResetRipple {
    fn applies(&self, drivers: &Drivers) -> bool {
        let slow = |r: &&f64| (3600.0 * **r * drivers.dt_s).abs() < 3600.0;
        varies(drivers.table_rate.as_deref())
            && drivers.table_rate.iter().flatten().filter(slow).count() >= 64
    }

    /// An error of the bias turns the phase along the record: biases within a few turns of the fitted one are tried.
    fn starts(&self, drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
        let n = drivers.samples;
        if n < 64 || !context.is_of(n) {
            return Starts::none();
        }
        let fitted = drivers.claim.bias_deg_h;
        // The mean of a random walk is off from where it began by π²/3 times the variance of its slowest wave.
        let deviation = PI * (context.powers[1] / (3.0 * n as f64)).sqrt();
        let Some(angles) = sensed(fitted, drivers) else { return Starts::none() };
        let Bounds { low, high } = ends(&angles.0);
        let level = fast_level(context);
        let (mut period, mut found, mut trials) = (MIN_PERIOD_ARCSEC, vec![], 1.0);
        while period < (high - low) / 3.0 {
            // Half turns of the phase over the record that the uncertainty of the bias amounts to.
            let uncertain = BIAS_SEARCH_SIGMAS * deviation * drivers.length_s() / (0.5 * period);
            let affordable = 0.5 * OCTAVE_BUDGET / (8.0 * (high - low) / period + n as f64);
            let turns = uncertain.min(affordable).clamp(1.0, 1e4).ceil() as i32;
            let per_turn = 0.5 * period / drivers.length_s();
            let margin = f64::from(turns) * 0.5 * period;
            let Some(octave) = Octave::new(period, &angles, drivers.dt_s, margin, context) else {
                period *= 2.0;
                continue;
            };
            let of_bias = |buffers: &mut Buffers, k: i32| {
                let other = f64::from(k) * per_turn;
                let (first, step) = octave.gains(other, level, buffers);
                let nonlinear_parameters = |j: usize| {
                    let f = first + (j as f64 + parabolic_peak(&buffers.gains, j)) * step;
                    (buffers.gains[j], vec![1.0 / f, fitted + other])
                };
                peaks(&buffers.gains, 2, 6).into_iter().map(nonlinear_parameters).collect::<Vec<_>>()
            };
            let seen: Vec<Vec<_>> =
                (-turns..=turns).into_par_iter().map_init(Buffers::default, of_bias).collect();
            trials += seen.len() as f64 * (high - low) / period * 0.5;
            found.extend(seen.into_iter().flatten());
            period *= 2.0;
        }
        found.sort_descending_by(|a| a.0);
        let points = found.into_iter().take(6).map(|(_, s)| s);
        Starts { points: best_of(self, points, 3, drivers, context), trials }
    }

    fn bounds(&self, drivers: &Drivers) -> Vec<Bounds> {
        let bias = drivers.claim.bias_deg_h;
        let range = extent(bias, drivers);
        vec![
            Bounds::new(0.5 * MIN_PERIOD_ARCSEC, (0.5 * range).max(MIN_PERIOD_ARCSEC)),
            Bounds::new(bias - MAX_BIAS_ERROR_DEG_H, bias + MAX_BIAS_ERROR_DEG_H),
        ]
    }

    fn regressors(&self, nonlinear_parameters: &[f64], drivers: &Drivers) -> Regressors {
        let [period, bias] = nonlinear_parameters else { return Regressors::default() };
        Regressors::columns(columns(*period, *bias, drivers))
    }

    fn parameters(&self, nonlinear_parameters: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
        let [period, bias] = nonlinear_parameters else { return vec![f64::NAN; 4] };
        let (amplitude, phase) = polar(coefficients);
        vec![*period, amplitude, phase, *bias]
    }

    fn course(&self, values: &Values, drivers: &Drivers) -> Option<Vec<f64>> {
        let (period, amplitude) = (number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?);
        let phase = number(values, PARAMS[2].name).unwrap_or(0.0);
        let bias = number(values, PARAMS[3].name).unwrap_or(drivers.claim.bias_deg_h);
        let columns = columns(period, bias, drivers);
        (columns.len() == 2).then(|| wave(amplitude, phase, &columns))
    }

    /// The period of the sensed angle, and the rates at which a sample covers less than one.
    fn places(&self, nonlinear_parameters: &[f64], _coefficients: &[f64], drivers: &Drivers) -> Vec<Place> {
        let [period, bias] = nonlinear_parameters else { return vec![] };
        let range = extent(*bias, drivers);
        let half = (0.5 * period * period / range).min(0.25 * period);
        let fastest = period / drivers.dt_s / 3600.0;
        vec![
            Place { domain: Domain::Angle, from: (period - half) / 3600.0, to: (period + half) / 3600.0 },
            Place { domain: Domain::InputRate, from: -fastest, to: fastest },
        ]
    }

    fn steps(&self, drivers: &Drivers) -> Vec<f64> {
        let range = extent(drivers.claim.bias_deg_h, drivers);
        // A tenth of a cycle over the range for a period of some seconds of arc.
        vec![0.1 * 9.0 / range, 0.1 * 3.0 / drivers.length_s()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sensed_angle_is_that_of_the_table_and_of_the_bias() {
        // 1 deg/h over 1 s is 1 arcsec.
        let drivers =
            Drivers { dt_s: 2.0, samples: 2, table_rate: Some(vec![0.0, 0.001]), ..Drivers::default() };
        let (middles, steps) = sensed(10.0, &drivers).unwrap();
        assert!((steps[0] - 20.0).abs() < 1e-12 && (steps[1] - 27.2).abs() < 1e-12, "{steps:?}");
        assert!((middles[0] - 10.0).abs() < 1e-12 && (middles[1] - 33.6).abs() < 1e-12, "{middles:?}");
        assert!((extent(10.0, &drivers) - 23.6).abs() < 1e-12);
        assert_eq!(extent(10.0, &Drivers::default()), 1.0);
    }
}
