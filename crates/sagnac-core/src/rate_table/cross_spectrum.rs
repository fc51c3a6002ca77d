//! Spectra of the table's rate and of the output, and the spectrum that they share, averaged over segments of several
//! lengths while a recording goes by: bounded in memory at any length.
//!
//! Hann window, three quarters overlap, straight line removed (Bendat and Piersol, Random Data, chapter 11). With less overlap a
//! sweep that passes a frequency once finds the window rising or falling there, and a delay of the output then changes its amplitude.

use super::blocks::TURN_ARCSEC;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use sagnac_fft::{Complex, RealToComplex, real_forward};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Lengths of segments, samples: each gives the frequencies that the next longer one resolves finer than is needed.
const SEGMENT_LENGTHS: [usize; 4] = [1 << 8, 1 << 11, 1 << 14, 1 << 17];

/// First bin of a spectrum that is used: below, the line that was removed takes part of it.
const FIRST_BIN: usize = 4;

/// Bin of a shorter segment from which on it is used instead of a longer one. The curvature of the response within a few bins is in the
/// values of a sweep.
const TAKES_OVER_AT: usize = 64;

/// Highest frequency that is used, as a share of the sample rate.
const HIGHEST_SHARE: f64 = 0.45;

/// Segments that a sample lies in.
const SEGMENTS_PER_SAMPLE: usize = 4;

/// Fewest segments that tell noise from response.
const FEWEST_SEGMENTS: u64 = 12;

/// Segments that overlap by three quarters under a Hann window stand for fewer by this factor: 1 + 2·(0.659² + 0.167² + 0.008²)
/// (Welch 1967).
const OVERLAP_LOSS: f64 = 1.925;

/// What the segments show at one frequency of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Response: output over table rate.
    pub response: Complex<f64>,
    /// Variance of its real part, and of its imaginary part, from what the input does not explain.
    pub variance: f64,
    /// Share of the power of the output that the input explains.
    pub coherence: f64,
    /// Density of the table's rate, deg/h per √Hz, one-sided.
    pub input: f64,
}

/// Spectra of one length of segment.
struct Lengthwise {
    window: Vec<f64>,
    plan: Arc<dyn RealToComplex<f64>>,
    scratch: Vec<Complex<f64>>,
    /// Input first, then the outputs.
    kept: Vec<Vec<f64>>,
    spectra: Vec<Vec<Complex<f64>>>,
    input_power: Vec<f64>,
    /// Of each output: its power, and the product with the input.
    outputs: Vec<(Vec<f64>, Vec<Complex<f64>>)>,
    segments: u64,
}

impl Lengthwise {
    fn new(length: usize, outputs: usize) -> Lengthwise {
        let plan = real_forward(length);
        let bins = length / 2 + 1;
        let window = (0..length).map(|i| 0.5 - 0.5 * (TAU * i as f64 / length as f64).cos()).collect();
        Lengthwise {
            window,
            scratch: plan.make_scratch_vec(),
            plan,
            kept: vec![Vec::with_capacity(length); outputs + 1],
            spectra: vec![vec![Complex::default(); bins]; outputs + 1],
            input_power: vec![0.0; bins],
            outputs: vec![(vec![0.0; bins], vec![Complex::default(); bins]); outputs],
            segments: 0,
        }
    }

    fn push(&mut self, sample: &[f64]) {
        for (kept, value) in self.kept.iter_mut().zip(sample) {
            kept.push(*value);
        }
        if self.kept.first().is_some_and(|k| k.len() == self.window.len()) {
            self.segment();
            let hop = self.window.len() / SEGMENTS_PER_SAMPLE;
            self.kept.iter_mut().for_each(|k| drop(k.drain(..hop)));
        }
    }

    fn restart(&mut self) {
        self.kept.iter_mut().for_each(Vec::clear);
    }

    fn segment(&mut self) {
        for (kept, spectrum) in self.kept.iter().zip(&mut self.spectra) {
            let mut values = without_line(kept);
            values.iter_mut().zip(&self.window).for_each(|(v, w)| *v *= w);
            // Lengths agree by construction.
            let _ = self.plan.process_with_scratch(&mut values, spectrum, &mut self.scratch);
        }
        let Some((input, outputs)) = self.spectra.split_first() else { return };
        self.input_power.iter_mut().zip(input).for_each(|(sum, x)| *sum += x.norm_sqr());
        for ((power, product), output) in self.outputs.iter_mut().zip(outputs) {
            power.iter_mut().zip(output).for_each(|(sum, y)| *sum += y.norm_sqr());
            product.iter_mut().zip(input.iter().zip(output)).for_each(|(sum, (x, y))| *sum += x.conj() * y);
        }
        self.segments += 1;
    }

    /// The bins from `first` on to below `end` of an output.
    fn bins(&self, output: usize, (first, end): (usize, usize), interval_s: f64) -> Vec<Bin> {
        let Some((power, product)) = self.outputs.get(output) else { return vec![] };
        let (n, length) = (self.segments as f64, self.window.len() as f64);
        let power_of_window: f64 = self.window.iter().map(|w| w * w).sum();
        let one = |(k, ((xx, yy), xy)): (usize, ((&f64, &f64), &Complex<f64>))| {
            if *xx <= 0.0 || *yy <= 0.0 {
                return None;
            }
            let coherence = (xy.norm_sqr() / (xx * yy)).min(1.0);
            let noise = yy * (1.0 - coherence) * n / (n - OVERLAP_LOSS);
            Some(Bin {
                frequency_hz: k as f64 / (length * interval_s),
                response: xy / xx,
                variance: 0.5 * noise / n / xx * OVERLAP_LOSS,
                coherence,
                input: (2.0 * xx / n * interval_s / power_of_window).sqrt(),
            })
        };
        let all = self.input_power.iter().zip(power).zip(product).enumerate();
        all.skip(first).take(end.saturating_sub(first)).filter_map(one).collect()
    }
}

/// Values less the straight line that fits them best.
fn without_line(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let slope: f64 = values.iter().enumerate().map(|(i, v)| (i as f64 - middle) * (v - mean)).sum::<f64>()
        * 12.0
        / (n * (n * n - 1.0));
    values.iter().enumerate().map(|(i, v)| v - mean - slope * (i as f64 - middle)).collect()
}

/// Collects the spectra of every gyro channel against the motion of the table.
pub struct CrossSpectra {
    interval_s: f64,
    input: Option<usize>,
    /// True where the input is an angle, whose differences are the mean rate of the interval before each sample.
    by_angle: bool,
    gyros: Vec<(usize, String)>,
    lengthwise: Vec<Lengthwise>,
    angle_before: Option<f64>,
    sample: Vec<f64>,
}

impl CrossSpectra {
    /// For the channels of a recording; the angle of the table is used before its rate.
    pub fn new(channels: &[Channel], interval_s: f64) -> CrossSpectra {
        let slot = |role: Role| channels.iter().position(|c| c.role == role);
        let angle = slot(Role::TableAngle);
        let gyros: Vec<(usize, String)> = channels
            .iter()
            .enumerate()
            .filter(|(_, c)| c.role.is_gyro())
            .map(|(i, c)| (i, c.id.clone()))
            .collect();
        let lengthwise = SEGMENT_LENGTHS.iter().map(|l| Lengthwise::new(*l, gyros.len())).collect();
        CrossSpectra {
            interval_s,
            input: angle.or_else(|| slot(Role::TableRate)),
            by_angle: angle.is_some(),
            gyros,
            lengthwise,
            angle_before: None,
            sample: vec![],
        }
    }

    fn restart(&mut self) {
        self.angle_before = None;
        self.lengthwise.iter_mut().for_each(Lengthwise::restart);
    }

    /// Rate of the table at a sample, deg/h; `None` where it is not known.
    fn rate(&mut self, value: f64) -> Option<f64> {
        if !self.by_angle {
            return value.is_finite().then_some(value);
        }
        let before = self.angle_before.replace(value)?;
        // The shorter way round: an angle starts again after a turn. Arc seconds a second are degrees an hour.
        let turned = value - before;
        let turned = turned - TURN_ARCSEC * (turned / TURN_ARCSEC).round();
        turned.is_finite().then_some(turned / self.interval_s)
    }

    /// The bins of every gyro channel, by frequency. `interval_s` is the measured interval.
    pub fn finish(self, interval_s: f64) -> Vec<(String, Vec<Bin>)> {
        let usable: Vec<&Lengthwise> =
            self.lengthwise.iter().filter(|l| l.segments >= FEWEST_SEGMENTS).collect();
        let of = |gyro: usize| {
            let mut bins = vec![];
            for (i, one) in usable.iter().enumerate().rev() {
                let length = one.window.len();
                let shorter = i.checked_sub(1).and_then(|s| usable.get(s));
                let end = match shorter {
                    Some(s) => TAKES_OVER_AT * length / s.window.len(),
                    None => usize::MAX,
                };
                let is_longest = i + 1 == usable.len();
                let first = if is_longest { FIRST_BIN } else { TAKES_OVER_AT };
                let highest = (HIGHEST_SHARE * length as f64) as usize;
                bins.extend(one.bins(gyro, (first, end.min(highest)), interval_s));
            }
            if self.by_angle {
                bins.iter_mut().for_each(|b| at_the_sample(b, interval_s));
            }
            bins
        };
        self.gyros.iter().enumerate().map(|(i, (_, id))| (id.clone(), of(i))).collect()
    }
}

/// Makes the response to the mean rate of the interval before each sample that to the rate at the sample.
fn at_the_sample(bin: &mut Bin, interval_s: f64) {
    let half = 0.5 * TAU * bin.frequency_hz * interval_s;
    let averaging = half.sin() / half;
    bin.response = bin.response * averaging * Complex::from_polar(1.0, -half);
    bin.variance *= averaging * averaging;
    bin.input /= averaging;
}

impl Sink for CrossSpectra {
    fn push(&mut self, block: &SampleBlock<'_>) {
        if !block.continues {
            self.restart();
        }
        let Some(input) = self.input.and_then(|slot| block.values.get(slot)) else { return };
        for (i, value) in input.iter().enumerate() {
            let rate = self.rate(*value);
            let mut sample = std::mem::take(&mut self.sample);
            sample.clear();
            sample.extend(rate);
            let output = |slot: usize| block.values.get(slot).and_then(|v| v.get(i)).copied();
            sample.extend(self.gyros.iter().filter_map(|(slot, _)| output(*slot)));
            if sample.len() == self.gyros.len() + 1 && sample.iter().all(|v| v.is_finite()) {
                self.lengthwise.iter_mut().for_each(|l| l.push(&sample));
            } else if rate.is_some() || !value.is_finite() {
                // A value that cannot be used ends the stretch.
                self.restart();
            }
            self.sample = sample;
        }
    }
}
