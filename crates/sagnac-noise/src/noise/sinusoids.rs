//! Lines as sinusoids, fitted to the block means of the whole record by least squares and taken out of them.
//!
//! The modes of a record have no window: a strong line leaks over all of them, as more lines and slow processes that are
//! none. Taken out, it leaves nothing beside its own few modes; and its amplitude and frequency are known as well as the
//! record can tell (Rife and Boorstyn, IEEE Trans. Inf. Theory 20, 1974) instead of as well as one segment can.

use super::data::BlockSeries;
use super::lines::{Sinusoid, SpectralLine};
use crate::numeric::optimize::golden_section_maximum;
use crate::numeric::order::SortByNumber;
use sagnac_fft::{RealToComplex, real_forward};
use std::f64::consts::PI;
use std::sync::Arc;

/// Highest frequency that block means follow, in cycles a block.
const MAX_CYCLES_PER_BLOCK: f64 = 0.45;
/// Fewest cycles in a record.
const MIN_CYCLES: f64 = 3.0;
/// Fewest block means.
const MIN_BLOCKS: usize = 64;
/// Lines that are fitted at most, the strongest first.
const MAX_SINUSOIDS: usize = 24;
/// Reach of the search about the frequency that the averaged periodogram shows, in its bins.
const SEARCH_REACH: f64 = 0.6;
/// Share of the power over the floor that a sinusoid must hold to stand for a line: less is no coherent line.
const MIN_POWER_SHARE: f64 = 0.5;
/// Standard deviations of its amplitude from which a sinusoid stands for a line that was taken to be stronger: noise alone
/// reaches them in one of 10¹³ modes.
const MIN_SCORE_ALONE: f64 = 8.0;
/// Modes to each side of a line over which it spreads where it wanders a little.
const SKIRT_MODES: usize = 8;
/// Modes beyond whose power is the noise about it.
const RING_MODES: usize = 12;
/// Standard deviations by which the power of the skirt must stand above the noise.
const MIN_SKIRT_SCORE: f64 = 5.0;

impl Sinusoid {
    /// True when it stands far above the noise about it and leaves nothing beside: a line then, however strong it was
    /// taken to be. A disturbance that hardly decays shows in a single mode, which tells its rms by a factor of two.
    fn stands_alone(&self) -> bool {
        let [a, b] = self.coefficients_deg_h;
        self.skirt_deg_h == 0.0 && a.hypot(b) > MIN_SCORE_ALONE * self.amplitude_deviation_deg_h
    }
}

/// Means that are turned by one table of angles, one step from each table to the next.
const AT_ONCE: usize = 16;

/// Turns by a constant angle, one after the other.
struct Turns {
    now: (f64, f64),
    step: (f64, f64),
}

impl Turns {
    fn new(angle: f64) -> Turns {
        let (sin, cos) = angle.sin_cos();
        Turns { now: (1.0, 0.0), step: (cos, sin) }
    }
}

impl Iterator for Turns {
    type Item = (f64, f64);

    /// Cosine and sine.
    fn next(&mut self) -> Option<(f64, f64)> {
        let ((c, s), (dc, ds)) = (self.now, self.step);
        self.now = (c * dc - s * ds, s * dc + c * ds);
        Some((c, s))
    }
}

/// Block means about their mean; 0 where there is none.
struct Means {
    values: Vec<f64>,
    present: Vec<bool>,
    block_s: f64,
    /// Transform of at least twice as many values, which shows a line at half its own width.
    transform: Arc<dyn RealToComplex<f64>>,
}

impl Means {
    fn of(blocks: &BlockSeries, tau0_s: f64) -> Means {
        let values = blocks.about_first();
        let present: Vec<bool> =
            values.iter().zip(&blocks.count).map(|(m, c)| m.is_finite() && *c > 0).collect();
        let transform = real_forward((2 * values.len()).next_power_of_two());
        let block_s = blocks.block_len.max(1) as f64 * tau0_s;
        let mut out = Means { values, present, block_s, transform };
        let count = out.count().max(1) as f64;
        let sum: f64 = out.values.iter().zip(&out.present).filter(|(_, p)| **p).map(|(v, _)| v).sum();
        for (value, present) in out.values.iter_mut().zip(&out.present) {
            *value = if *present { *value - sum / count } else { 0.0 };
        }
        out
    }

    fn count(&self) -> usize {
        self.present.iter().filter(|p| **p).count()
    }

    /// |Σ x e^{−iωk}|² over the number of means.
    fn power(&self, turn: f64) -> f64 {
        let mut table = [(0.0, 0.0); AT_ONCE];
        table.iter_mut().zip(Turns::new(turn)).for_each(|(t, turned)| *t = turned);
        let mut sum = (0.0, 0.0);
        for (values, (c, s)) in self.values.chunks(AT_ONCE).zip(Turns::new(AT_ONCE as f64 * turn)) {
            let (mut re, mut im) = (0.0, 0.0);
            for (value, (cos, sin)) in values.iter().zip(&table) {
                re += value * cos;
                im += value * sin;
            }
            sum = (sum.0 + re * c - im * s, sum.1 + re * s + im * c);
        }
        (sum.0 * sum.0 + sum.1 * sum.1) / self.count().max(1) as f64
    }

    /// Coefficients of cosine and sine beside a constant.
    fn coefficients(&self, turn: f64) -> Option<[f64; 2]> {
        let mut normal = nalgebra::Matrix3::<f64>::zeros();
        let mut right = nalgebra::Vector3::<f64>::zeros();
        for ((value, present), (c, s)) in self.values.iter().zip(&self.present).zip(Turns::new(turn)) {
            if *present {
                let row = nalgebra::Vector3::new(c, s, 1.0);
                normal += row * row.transpose();
                right += row * *value;
            }
        }
        let solved = normal.cholesky()?.solve(&right);
        Some([solved[0], solved[1]])
    }

    fn subtract(&mut self, sinusoid: &Sinusoid) {
        let [a, b] = sinusoid.coefficients_deg_h;
        let turns = Turns::new(2.0 * PI * sinusoid.frequency_hz * self.block_s);
        for ((value, present), (c, s)) in self.values.iter_mut().zip(&self.present).zip(turns) {
            if *present {
                *value -= a * c + b * s;
            }
        }
    }

    /// Frequency of the largest power within `reach_hz` of one, Hz.
    fn peak_near(&self, frequency_hz: f64, reach_hz: f64) -> Option<f64> {
        let plan = &self.transform;
        let size = plan.len();
        let mut input = plan.make_input_vec();
        input.iter_mut().zip(&self.values).for_each(|(i, v)| *i = *v);
        let mut spectrum = plan.make_output_vec();
        plan.process(&mut input, &mut spectrum).ok()?;
        let step = 1.0 / (size as f64 * self.block_s);
        let at = |f: f64| ((f / step).round().max(0.0) as usize).min(spectrum.len() - 1);
        let (low, high) = (at(frequency_hz - reach_hz).max(1), at(frequency_hz + reach_hz));
        let best = (low..=high).max_by(|a, b| spectrum[*a].norm_sqr().total_cmp(&spectrum[*b].norm_sqr()))?;
        let (low, high) = ((best as f64 - 1.0) * step, (best as f64 + 1.0) * step);
        Some(golden_section_maximum(low, high, 24, |f| self.power(2.0 * PI * f * self.block_s)))
    }

    /// The sinusoid about a frequency.
    fn sinusoid(&mut self, frequency_hz: f64, reach_hz: f64) -> Option<Sinusoid> {
        let frequency_hz = self.peak_near(frequency_hz, reach_hz)?;
        let turn = 2.0 * PI * frequency_hz * self.block_s;
        let coefficients_deg_h = self.coefficients(turn)?;
        let amplitude = coefficients_deg_h[0].hypot(coefficients_deg_h[1]);
        let mut out = Sinusoid {
            frequency_hz,
            coefficients_deg_h,
            amplitude_deviation_deg_h: 0.0,
            frequency_deviation_hz: 0.0,
            skirt_deg_h: 0.0,
        };
        self.subtract(&out);
        let mode = 2.0 * PI / self.values.len() as f64;
        let beside = |from: usize, to: usize| -> Vec<f64> {
            let turns = (from..to).flat_map(|k| [turn - k as f64 * mode, turn + k as f64 * mode]);
            turns.filter(|t| *t > mode && *t < PI).map(|t| self.power(t)).collect()
        };
        let (skirt, ring) =
            (beside(1, 1 + SKIRT_MODES), beside(1 + SKIRT_MODES, 1 + SKIRT_MODES + RING_MODES));
        let noise = ring.iter().sum::<f64>() / ring.len().max(1) as f64;
        let n = self.count() as f64;
        let more = skirt.iter().map(|p| p - noise).sum::<f64>();
        if more > MIN_SKIRT_SCORE * noise * (skirt.len() as f64).sqrt() {
            out.skirt_deg_h = (4.0 * more / n).sqrt();
        }
        out.amplitude_deviation_deg_h = (2.0 * noise / n).sqrt();
        let span = self.values.len() as f64;
        let turn_deviation = (24.0 * noise / n).sqrt() / (amplitude * span);
        out.frequency_deviation_hz = turn_deviation / (2.0 * PI * self.block_s);
        (amplitude > 0.0 && out.amplitude_deviation_deg_h.is_finite()).then_some(out)
    }
}

/// Share of a sinusoid's amplitude that a block mean keeps.
fn kept(frequency_hz: f64, block_len: u64, tau0_s: f64) -> f64 {
    let half = PI * frequency_hz * tau0_s;
    let n = block_len.max(1) as f64;
    if half.sin().abs() < 1e-9 { 1.0 } else { (n * half).sin() / (n * half.sin()) }
}

/// Fits those of the lines that block means follow and that were not fitted yet, the strongest first. A line that a
/// sinusoid does not stand for keeps what the averaged periodogram says of it.
pub fn fit(blocks: &BlockSeries, tau0_s: f64, lines: &mut [SpectralLine]) {
    let mut means = Means::of(blocks, tau0_s);
    let span_s = means.values.len() as f64 * means.block_s;
    let follows = |l: &SpectralLine| {
        l.frequency_hz * means.block_s < MAX_CYCLES_PER_BLOCK && l.frequency_hz * span_s > MIN_CYCLES
    };
    let mut order: Vec<usize> = (0..lines.len()).filter(|i| follows(&lines[*i])).collect();
    if means.count() < MIN_BLOCKS {
        return;
    }
    order.sort_descending_by(|a| lines[*a].amplitude_deg_h);
    lines.iter().filter_map(|l| l.sinusoid.as_ref()).for_each(|s| means.subtract(s));
    for i in order.into_iter().take(MAX_SINUSOIDS) {
        let line = &mut lines[i];
        if line.sinusoid.is_some() {
            continue;
        }
        let before = means.values.clone();
        let found = means.sinusoid(line.frequency_hz, SEARCH_REACH * line.resolution_hz);
        let share = found.map(|s| {
            let [a, b] = s.coefficients_deg_h;
            let kept = kept(s.frequency_hz, blocks.block_len, tau0_s);
            (s, a.hypot(b).hypot(s.skirt_deg_h) / kept, kept)
        });
        match share {
            Some((s, amplitude, kept))
                if amplitude > MIN_POWER_SHARE.sqrt() * line.amplitude_deg_h || s.stands_alone() =>
            {
                line.frequency_hz = s.frequency_hz;
                line.amplitude_deg_h = amplitude;
                let (amplitude_deviation_deg_h, skirt_deg_h) =
                    (s.amplitude_deviation_deg_h / kept, s.skirt_deg_h / kept);
                line.sinusoid = Some(Sinusoid { amplitude_deviation_deg_h, skirt_deg_h, ..s });
            }
            _ => means.values = before,
        }
    }
}

/// Block means with the sinusoids of the lines taken out.
pub fn without(blocks: &BlockSeries, tau0_s: f64, lines: &[SpectralLine]) -> BlockSeries {
    let mut out = blocks.clone();
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    for sinusoid in lines.iter().filter_map(|l| l.sinusoid) {
        let [a, b] = sinusoid.coefficients_deg_h;
        let turns = Turns::new(2.0 * PI * sinusoid.frequency_hz * block_s);
        for (mean, (c, s)) in out.mean.iter_mut().zip(turns) {
            *mean -= a * c + b * s;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn line(frequency_hz: f64, amplitude_deg_h: f64) -> SpectralLine {
        SpectralLine {
            frequency_hz,
            resolution_hz: 1.0 / 1024.0,
            amplitude_deg_h,
            excess: 100.0,
            false_alarm_probability: 0.0,
            harmonic_of: None,
            harmonic_order: 1,
            sinusoid: None,
        }
    }

    fn record(seed: u64, parts: &[(f64, f64)]) -> BlockSeries {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
        let n = 8192;
        let mean = (0..n).map(|i| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            let of = |(f, a): &(f64, f64)| a * (2.0 * PI * f * f64::from(i) + 0.7).cos();
            7.0 + noise + parts.iter().map(of).sum::<f64>()
        });
        let mean: Vec<f64> = mean.collect();
        BlockSeries { block_len: 1, first_index: 0, count: vec![1; n as usize], mean, rounding: vec![] }
    }

    #[test]
    fn amplitude_and_frequency_scatter_as_their_deviations_say() {
        let (f, a) = (0.013_37, 0.2);
        let (mut amplitude, mut frequency) = (0.0, 0.0);
        let runs = 20;
        for seed in 0..runs {
            let mut lines = [line(f + 2e-4, 0.19)];
            fit(&record(seed, &[(f, a)]), 1.0, &mut lines);
            let s = lines[0].sinusoid.unwrap();
            amplitude += ((lines[0].amplitude_deg_h - a) / s.amplitude_deviation_deg_h).powi(2) / runs as f64;
            frequency += ((lines[0].frequency_hz - f) / s.frequency_deviation_hz).powi(2) / runs as f64;
        }
        // χ² of 20 over 20: 0.37 to 2.00 in 99 %.
        assert!(
            (0.35..2.0).contains(&amplitude) && (0.35..2.0).contains(&frequency),
            "{amplitude} {frequency}"
        );
    }

    #[test]
    fn strong_lines_leave_nothing_of_themselves_beside_weak_ones() {
        let blocks = record(5, &[(0.021, 50.0), (0.0251, 0.3)]);
        let mut lines = [line(0.0250, 0.3), line(0.0212, 45.0)];
        fit(&blocks, 1.0, &mut lines);
        assert!((lines[1].amplitude_deg_h - 50.0).abs() < 0.1, "{lines:?}");
        assert!((lines[0].amplitude_deg_h - 0.3).abs() < 0.08, "{lines:?}");
        let left = without(&blocks, 1.0, &lines);
        let mean = left.mean.iter().sum::<f64>() / 8192.0;
        let variance = left.mean.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 8192.0;
        assert!((variance - 1.0).abs() < 0.06, "{variance}");
    }

    #[test]
    fn a_line_that_wanders_a_little_keeps_its_whole_power() {
        let mut blocks = record(9, &[]);
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(10);
        let mut phase = 0.3;
        for (i, mean) in blocks.mean.iter_mut().enumerate() {
            let step: f64 = StandardNormal.sample(&mut rng);
            phase += 0.008 * step;
            *mean += 20.0 * (2.0 * PI * 0.0421 * i as f64 + phase).cos();
        }
        let mut lines = [line(0.0421, 20.0)];
        fit(&blocks, 1.0, &mut lines);
        let s = lines[0].sinusoid.unwrap();
        let alone = s.coefficients_deg_h[0].hypot(s.coefficients_deg_h[1]);
        assert!(alone < 19.5 && s.skirt_deg_h > 3.0, "{s:?}");
        assert!((lines[0].amplitude_deg_h / 20.0 - 1.0).abs() < 0.01, "{lines:?}");
    }

    #[test]
    fn a_line_that_was_taken_to_be_too_strong_has_its_own_amplitude() {
        let mut lines = [line(0.0421, 0.4)];
        fit(&record(11, &[(0.0421, 0.25)]), 1.0, &mut lines);
        assert!(lines[0].sinusoid.is_some() && (lines[0].amplitude_deg_h - 0.25).abs() < 0.06, "{lines:?}");
        // Noise alone stands so high nowhere.
        let none = (0..20).all(|seed| {
            let mut lines = [line(0.0421, 0.4)];
            fit(&record(300 + seed, &[]), 1.0, &mut lines);
            lines[0].sinusoid.is_none()
        });
        assert!(none);
    }

    #[test]
    fn what_is_no_sinusoid_keeps_what_was_said_of_it() {
        let mut lines = [line(0.1, 3.0), line(0.49, 1.0), line(0.0001, 1.0)];
        fit(&record(6, &[]), 1.0, &mut lines);
        assert!(lines.iter().all(|l| l.sinusoid.is_none()), "{lines:?}");
        fit(&BlockSeries::default(), 1.0, &mut lines);
    }
}
