//! Spectra of the table's rate and of the output, and the spectrum that they share, averaged over segments of several
//! lengths while a recording goes by: bounded in memory at any length.
//!
//! Hann window, three quarters overlap, straight line removed (Bendat and Piersol, Random Data, chapter 11). What the output delays past the
//! window is told by the input under the derivatives of the window, and belongs to the model: a sweep passes a frequency once, where the
//! window rises or falls.

use super::blocks::TURN_ARCSEC;
use crate::recording::{Channel, Role, SampleBlock, Sink};
use sagnac_fft::{Complex, RealToComplex, real_forward};
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Lengths of segments, samples: each gives the frequencies that the next longer one resolves finer than is needed.
const SEGMENT_LENGTHS: [usize; 4] = [1 << 8, 1 << 11, 1 << 14, 1 << 17];

/// First bin of a spectrum that is used: below, the line that was removed takes part of it.
const FIRST_BIN: usize = 4;

/// Bin of a shorter segment from which on it is used instead of a longer one: more segments tell its noise.
const TAKES_OVER_AT: usize = 8;

/// Highest frequency that is used, as a share of the sample rate.
const HIGHEST_SHARE: f64 = 0.45;

/// Segments that a sample lies in.
const SEGMENTS_PER_SAMPLE: usize = 4;

/// Fewest segments that tell noise from response.
const FEWEST_SEGMENTS: u64 = 12;

/// Segments that overlap by three quarters under a Hann window stand for fewer by this factor: 1 + 2·(0.659² + 0.167² + 0.008²)
/// (Welch 1967).
const OVERLAP_LOSS: f64 = 1.925;

/// What a response delays past the window: with X₁ and X₂ the spectra under the first and second derivative of the window,
/// `Y = H·X + j/(2π)·H'·X₁ − H''/(8π²)·X₂ + …`, so that a response read as Y/X has these terms in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WindowTerms {
    /// X₁ over X, 1/s.
    pub first: Complex<f64>,
    /// X₂ over X, 1/s².
    pub second: Complex<f64>,
    /// Sample interval where the input is the mean rate of the interval before each sample, s; 0 where it is the rate at the sample.
    pub averaged_over_s: f64,
}

/// Step of a derivative over frequency, relative.
const FREQUENCY_STEP: f64 = 1e-3;

impl WindowTerms {
    /// The response that is read at a frequency where the true one to the rate at the sample is `response`.
    pub fn read(&self, frequency_hz: f64, response: impl Fn(f64) -> Complex<f64>) -> Complex<f64> {
        let of_input = |f: f64| {
            let half = 0.5 * TAU * f * self.averaged_over_s;
            let mean = if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
            response(f) / (Complex::from_polar(1.0, -half) * mean)
        };
        let step = FREQUENCY_STEP * frequency_hz;
        let (before, at, after) =
            (of_input(frequency_hz - step), of_input(frequency_hz), of_input(frequency_hz + step));
        let slope = (after - before) / (2.0 * step);
        let bend = (after - at * 2.0 + before) / (step * step);
        at + Complex::new(0.0, 1.0 / TAU) * slope * self.first - bend * self.second / (2.0 * TAU * TAU)
    }
}

/// Largest distance of the motion that a bin holds from its frequency, in bins: beyond, the bin holds what the window leaks.
const LARGEST_DISTANCE: f64 = 1.0;

/// Neighbouring bins of which the mean power is taken for that of the noise of the readings.
const QUIET_BINS: usize = 16;

/// Largest mean coherence of such bins: some is there by chance in few segments.
const LARGEST_QUIET_COHERENCE: f64 = 0.3;

/// What the segments show at one frequency of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Response of the output to the input as recorded.
    pub response: Complex<f64>,
    /// What the window adds to it, from the input alone.
    pub window: WindowTerms,
    /// Variance of its real part, and of its imaginary part, from what the input does not explain.
    pub variance: f64,
    /// Share of the power of the output that the input explains.
    pub coherence: f64,
}

/// Spectra of one length of segment.
struct Lengthwise {
    /// The window, and its derivatives in steps of a sample.
    windows: [Vec<f64>; 3],
    plan: Arc<dyn RealToComplex<f64>>,
    scratch: Vec<Complex<f64>>,
    /// Input first, then the outputs.
    kept: Vec<Vec<f64>>,
    spectra: Vec<Vec<Complex<f64>>>,
    input_power: Vec<f64>,
    /// Products of the input with the input under the derivatives of the window.
    under_derivatives: [Vec<Complex<f64>>; 2],
    under: Vec<Complex<f64>>,
    /// Of each output: its power, and the product with the input.
    outputs: Vec<(Vec<f64>, Vec<Complex<f64>>)>,
    segments: u64,
}

impl Lengthwise {
    fn new(length: usize, outputs: usize) -> Lengthwise {
        let plan = real_forward(length);
        let bins = length / 2 + 1;
        let step = TAU / length as f64;
        let hann = |of: fn(f64) -> f64, scale: f64| -> Vec<f64> {
            (0..length).map(|i| scale * of(step * i as f64)).collect()
        };
        let windows = [
            hann(|angle| 1.0 - angle.cos(), 0.5),
            hann(f64::sin, 0.5 * step),
            hann(f64::cos, 0.5 * step * step),
        ];
        Lengthwise {
            windows,
            scratch: plan.make_scratch_vec(),
            plan,
            kept: vec![Vec::with_capacity(length); outputs + 1],
            spectra: vec![vec![Complex::default(); bins]; outputs + 1],
            input_power: vec![0.0; bins],
            under_derivatives: [vec![Complex::default(); bins], vec![Complex::default(); bins]],
            under: vec![Complex::default(); bins],
            outputs: vec![(vec![0.0; bins], vec![Complex::default(); bins]); outputs],
            segments: 0,
        }
    }

    /// Samples in a segment.
    fn len(&self) -> usize {
        self.windows[0].len()
    }

    fn push(&mut self, sample: &[f64]) {
        for (kept, value) in self.kept.iter_mut().zip(sample) {
            kept.push(*value);
        }
        if self.kept.first().is_some_and(|k| k.len() == self.len()) {
            self.segment();
            let hop = self.len() / SEGMENTS_PER_SAMPLE;
            self.kept.iter_mut().for_each(|k| drop(k.drain(..hop)));
        }
    }

    fn restart(&mut self) {
        self.kept.iter_mut().for_each(Vec::clear);
    }

    fn segment(&mut self) {
        let [window, ..] = &self.windows;
        for (kept, spectrum) in self.kept.iter().zip(&mut self.spectra) {
            let mut values = without_line(kept);
            values.iter_mut().zip(window).for_each(|(v, w)| *v *= w);
            // Lengths agree by construction.
            let _ = self.plan.process_with_scratch(&mut values, spectrum, &mut self.scratch);
        }
        if let (Some(kept), Some(input)) = (self.kept.first(), self.spectra.first()) {
            let flat = without_line(kept);
            for (window, sums) in self.windows.iter().skip(1).zip(&mut self.under_derivatives) {
                let mut values: Vec<f64> = flat.iter().zip(window).map(|(v, w)| v * w).collect();
                let _ = self.plan.process_with_scratch(&mut values, &mut self.under, &mut self.scratch);
                let pairs = input.iter().zip(&self.under);
                sums.iter_mut().zip(pairs).for_each(|(sum, (x, u))| *sum += x.conj() * u);
            }
        }
        let Some((input, outputs)) = self.spectra.split_first() else { return };
        self.input_power.iter_mut().zip(input).for_each(|(sum, x)| *sum += x.norm_sqr());
        for ((power, product), output) in self.outputs.iter_mut().zip(outputs) {
            power.iter_mut().zip(output).for_each(|(sum, y)| *sum += y.norm_sqr());
            product.iter_mut().zip(input.iter().zip(output)).for_each(|(sum, (x, y))| *sum += x.conj() * y);
        }
        self.segments += 1;
    }

    /// Power of the noise of the readings, as [`InputKind::of_white_readings`] has it: that of the quietest frequencies at which an output follows
    /// nothing; 0 where it follows the input everywhere.
    fn noise_of_readings(&self, output: usize, input: InputKind) -> f64 {
        let Some((power, product)) = self.outputs.get(output).filter(|_| input != InputKind::Other) else {
            return 0.0;
        };
        let highest = (HIGHEST_SHARE * self.len() as f64) as usize;
        let mean = |of: &dyn Fn(usize) -> f64, first: usize| {
            (first..first + QUIET_BINS).map(of).sum::<f64>() / QUIET_BINS as f64
        };
        let at = |of: &[f64], k: usize| of.get(k).copied().unwrap_or(0.0);
        let coherence = |k: usize| {
            let both = at(&self.input_power, k) * at(power, k);
            product.get(k).map_or(0.0, |p| p.norm_sqr() / both.max(f64::MIN_POSITIVE))
        };
        let level = |k: usize| at(&self.input_power, k) / input.of_white_readings(k, self.len());
        let starts = (FIRST_BIN..highest.saturating_sub(QUIET_BINS)).step_by(QUIET_BINS);
        let quiet = starts.filter(|k| mean(&coherence, *k) < LARGEST_QUIET_COHERENCE);
        quiet.map(|k| mean(&level, k)).min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// The bins from `first` on to below `end` of an output.
    fn bins(
        &self,
        output: usize,
        (first, end): (usize, usize),
        interval_s: f64,
        input: InputKind,
    ) -> Vec<Bin> {
        let Some((power, product)) = self.outputs.get(output) else { return vec![] };
        let readings = self.noise_of_readings(output, input);
        let averaged_over_s = if input == InputKind::TableAngle { interval_s } else { 0.0 };
        let (n, length) = (self.segments as f64, self.len() as f64);
        let [under_first, under_second] = &self.under_derivatives;
        let one = |(k, ((xx, yy), xy)): (usize, ((&f64, &f64), &Complex<f64>))| {
            let of = |sums: &[Complex<f64>], per: f64| {
                sums.get(k).map_or_else(Complex::default, |u| u / (xx * per))
            };
            let first = of(under_first, interval_s);
            // Under the derivative of the window, motion at a distance d of frequency has 2πd of its spectrum.
            let distance = first.norm() / TAU * length * interval_s;
            if *xx <= 0.0 || *yy <= 0.0 || distance > LARGEST_DISTANCE {
                return None;
            }
            let coherence = (xy.norm_sqr() / (xx * yy)).min(1.0);
            // Noise of the readings is power of the input that the output does not follow.
            let of_reading = (readings * input.of_white_readings(k, self.len()) / xx).min(1.0 - coherence);
            let xx = &(xx * (1.0 - of_reading));
            let noise = yy * (1.0 - coherence) * n / (n - OVERLAP_LOSS);
            Some(Bin {
                frequency_hz: k as f64 / (length * interval_s),
                response: xy / xx,
                window: WindowTerms {
                    first,
                    second: of(under_second, interval_s * interval_s),
                    averaged_over_s,
                },
                variance: 0.5 * noise / n / xx * OVERLAP_LOSS,
                coherence,
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

/// Kinds of the input of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum InputKind {
    /// Angle of the table, whose differences are the mean rate of the interval before each sample.
    TableAngle,
    /// Rate of the table.
    TableRate,
    /// Another channel, which the output follows at few frequencies: they do not tell the noise of its readings.
    Other,
}

impl InputKind {
    /// Power of white noise of the readings in a bin of a segment of `length` samples, of unit size; 0 where it is not told.
    fn of_white_readings(self, bin: usize, length: usize) -> f64 {
        match self {
            InputKind::TableAngle => 2.0 - 2.0 * (TAU * bin as f64 / length as f64).cos(),
            InputKind::TableRate => 1.0,
            InputKind::Other => 0.0,
        }
    }
}

/// Collects the spectra of every gyro channel against the motion of the table.
pub struct CrossSpectra {
    interval_s: f64,
    input: Option<usize>,
    kind: InputKind,
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
        let input = angle.or_else(|| slot(Role::TableRate));
        let kind = if angle.is_some() { InputKind::TableAngle } else { InputKind::TableRate };
        CrossSpectra { kind, ..CrossSpectra::from(channels, interval_s, input) }
    }

    /// From the channel of one position as the input, in its own unit.
    pub fn from(channels: &[Channel], interval_s: f64, input: Option<usize>) -> CrossSpectra {
        let gyros: Vec<(usize, String)> = channels
            .iter()
            .enumerate()
            .filter(|(_, c)| c.role.is_gyro())
            .map(|(i, c)| (i, c.id.clone()))
            .collect();
        let lengthwise = SEGMENT_LENGTHS.iter().map(|l| Lengthwise::new(*l, gyros.len())).collect();
        CrossSpectra {
            interval_s,
            input,
            kind: InputKind::Other,
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

    /// The input at a sample: the rate of the table in deg/h, or the value of the channel; `None` where it is not known.
    fn rate(&mut self, value: f64) -> Option<f64> {
        if self.kind != InputKind::TableAngle {
            return value.is_finite().then_some(value);
        }
        let before = self.angle_before.replace(value)?;
        // The shorter way round: an angle starts again after a turn. Arc seconds a second are degrees an hour.
        let turned = value - before;
        let turned = turned - TURN_ARCSEC * (turned / TURN_ARCSEC).round();
        turned.is_finite().then_some(turned / self.interval_s)
    }

    /// Takes some rows of a block.
    pub fn push_rows(&mut self, block: &SampleBlock<'_>, rows: Range<usize>, continues: bool) {
        if !continues {
            self.restart();
        }
        let Some(input) = self.input.and_then(|slot| block.values.get(slot)) else { return };
        for (i, value) in input.iter().enumerate().take(rows.end).skip(rows.start) {
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

    /// The bins of every gyro channel in the longest segments that tell noise from response, for what is sharp.
    pub fn finish_finest(self, interval_s: f64) -> Vec<(String, Vec<Bin>)> {
        let finest = self.lengthwise.iter().rev().find(|l| l.segments >= FEWEST_SEGMENTS);
        let of = |gyro: usize| {
            let highest = |l: &Lengthwise| (HIGHEST_SHARE * l.len() as f64) as usize;
            finest.map_or_else(Vec::new, |l| l.bins(gyro, (FIRST_BIN, highest(l)), interval_s, self.kind))
        };
        self.gyros.iter().enumerate().map(|(i, (_, id))| (id.clone(), of(i))).collect()
    }

    /// The bins of every gyro channel, by frequency. `interval_s` is the measured interval.
    pub fn finish(self, interval_s: f64) -> Vec<(String, Vec<Bin>)> {
        let usable: Vec<&Lengthwise> =
            self.lengthwise.iter().filter(|l| l.segments >= FEWEST_SEGMENTS).collect();
        let of = |gyro: usize| {
            let mut bins = vec![];
            for (i, one) in usable.iter().enumerate().rev() {
                let length = one.len();
                let shorter = i.checked_sub(1).and_then(|s| usable.get(s));
                let end = match shorter {
                    Some(s) => TAKES_OVER_AT * length / s.len(),
                    None => usize::MAX,
                };
                let is_longest = i + 1 == usable.len();
                let first = if is_longest { FIRST_BIN } else { TAKES_OVER_AT };
                let highest = (HIGHEST_SHARE * length as f64) as usize;
                bins.extend(one.bins(gyro, (first, end.min(highest)), interval_s, self.kind));
            }
            bins
        };
        self.gyros.iter().enumerate().map(|(i, (_, id))| (id.clone(), of(i))).collect()
    }
}

impl Sink for CrossSpectra {
    fn push(&mut self, block: &SampleBlock<'_>) {
        self.push_rows(block, 0..block.len(), block.continues);
    }
}
