//! Noise of an output as data sheets state it: rms over the whole band, density in a band, largest ratio to a mask.
//!
//! Everything comes from the averaged periodogram. Its neighbouring bins share power, so that the degrees of freedom of a mean
//! over bins are fewer than the sum of theirs. Lines are left out of densities: what a line adds depends on the width of the
//! band, and no mean tells it.

use super::digest::RateDigest;
use super::lines::{FIRST_BIN, HALF_LOBE_BINS, SpectralLine};
use super::welch::WelchResult;
use crate::estimate::{Spread, normal_probability};
use std::f64::consts::PI;

/// A test of the noise in bands of frequency.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NoiseTest {
    /// Bands in which the density is determined.
    pub bands: Vec<Band>,
    /// Corners of the mask, in the order of frequency.
    pub mask: Vec<MaskPoint>,
}

/// Frequencies from one to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lowest frequency, Hz.
    pub from_hz: f64,
    /// Highest frequency, Hz.
    pub to_hz: f64,
}

impl Band {
    /// Its name in rows and limits, such as `20-60Hz`.
    pub fn name(&self) -> String {
        format!("{}-{}Hz", self.from_hz, self.to_hz)
    }

    /// Width, Hz.
    pub fn width_hz(&self) -> f64 {
        self.to_hz - self.from_hz
    }
}

/// Corner of a mask: straight lines in the logarithms join it to its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskPoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Largest one-sided density there, (deg/h)/√Hz.
    pub density: f64,
}

/// Mean of a power over the bins of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMean {
    /// Mean power.
    pub power: f64,
    /// Equivalent degrees of freedom.
    pub dof: f64,
}

/// Largest ratio of the density to a mask, over sections of a sixth of an octave.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskRatio {
    /// The largest ratio found.
    pub ratio: f64,
    /// The section it was found in.
    pub section: Band,
    /// Sections compared.
    pub sections: usize,
    /// Confidence distribution of the largest ratio.
    pub spread: Spread,
}

/// Sections of a mask in an octave.
const SECTIONS_PER_OCTAVE: f64 = 6.0;
/// Least number of bins of a section of a mask.
const LEAST_BINS_OF_SECTION: usize = 4;
/// Rounding of a frequency that may lie on a bin, in bins.
const ON_BIN: f64 = 1e-6;

/// One-sided density of an output over frequency, with the bins of lines left out.
#[derive(Debug, Clone)]
pub struct OutputSpectrum {
    /// One-sided density of each bin, (deg/h)²/Hz; `None` where a line or the mean hides it.
    density: Vec<Option<f64>>,
    /// Distance of the bins, Hz.
    step_hz: f64,
    /// Independent averages of a bin.
    averages: f64,
    /// Correlation of neighbouring bins, with that of all farther ones.
    neighbour: f64,
}

impl OutputSpectrum {
    /// The spectrum of an output sampled every `tau0_s`, without `lines`; `None` for a record too short for one.
    pub fn of(welch: &WelchResult, tau0_s: f64, lines: &[SpectralLine]) -> Option<OutputSpectrum> {
        let spectrum = &welch.spectrum;
        let bins = spectrum.density.len();
        if spectrum.segments == 0 || bins <= FIRST_BIN + 1 {
            return None;
        }
        let step_hz = 1.0 / (spectrum.segment_len as f64 * tau0_s);
        // The last bin, half the sample rate, has half the degrees of freedom.
        let told = |k: usize| k >= FIRST_BIN && k + 1 < bins && line_over(lines, k).is_none();
        let density =
            (0..).zip(&spectrum.density).map(|(k, d)| told(k).then_some(2.0 * d * tau0_s)).collect();
        let averages = spectrum.effective_averages;
        let neighbour = (0.5 * (2.0 * averages / spectrum.averages_in_sums - 1.0)).max(0.0);
        Some(OutputSpectrum { density, step_hz, averages, neighbour })
    }

    /// Lowest and highest frequency that the spectrum shows.
    pub fn range(&self) -> Band {
        let last = self.density.len().saturating_sub(1) as f64;
        Band { from_hz: (FIRST_BIN as f64 - 0.5) * self.step_hz, to_hz: last * self.step_hz }
    }

    /// True where the spectrum shows the whole of a band.
    pub fn shows(&self, band: Band) -> bool {
        let (own, rounding) = (self.range(), ON_BIN * self.step_hz);
        band.from_hz >= own.from_hz - rounding && band.to_hz <= own.to_hz + rounding
    }

    /// Mean of the density times `weight` of the frequency over the bins of a band; `None` without a bin.
    pub fn mean(&self, band: Band, weight: impl Fn(f64) -> f64) -> Option<BandMean> {
        let powers = self.powers(band, weight);
        let told = powers.iter().flatten().count() as f64;
        let (mut sum, mut squares) = (0.0, 0.0);
        for power in powers.iter().flatten() {
            sum += power;
            // The square of an estimate is too large by its own variance.
            squares += power * power / (1.0 + 1.0 / self.averages);
        }
        for pair in powers.windows(2) {
            if let [Some(one), Some(next)] = pair {
                squares += 2.0 * self.neighbour * one * next;
            }
        }
        (sum > 0.0).then(|| BandMean { power: sum / told, dof: 2.0 * self.averages * sum * sum / squares })
    }

    /// Powers of the bins of a band, weighted.
    fn powers(&self, band: Band, weight: impl Fn(f64) -> f64) -> Vec<Option<f64>> {
        let first = (band.from_hz / self.step_hz - ON_BIN).ceil().max(0.0) as usize;
        let end = (band.to_hz / self.step_hz + ON_BIN).floor() as usize + 1;
        let bins = self.density.iter().enumerate().take(end).skip(first);
        bins.map(|(k, d)| d.map(|d| d * weight(k as f64 * self.step_hz))).collect()
    }

    /// The largest ratio of the root of the density to a mask; `None` where no section of the mask is shown.
    ///
    /// That the largest ratio is at most so much, each section says alone; that it is at least so much is said by the best of
    /// several, so that the risk is shared among all of them.
    pub fn mask_ratio(&self, mask: &[MaskPoint]) -> Option<MaskRatio> {
        let sections: Vec<(Band, f64, Spread)> = self
            .sections(mask)
            .into_iter()
            .filter_map(|section| {
                let mean = self.mean(section, |f| mask_at(mask, f).map_or(0.0, |limit| limit.powi(-2)))?;
                Some((section, mean.power.sqrt(), Spread::ChiSquare { dof: mean.dof }))
            })
            .collect();
        let (section, ratio, _) = sections.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let count = sections.len() as f64;
        let bound = |confidence: f64| {
            let bounds = sections.iter().filter_map(|(_, ratio, spread)| spread.bound(*ratio, confidence));
            bounds.fold(f64::NEG_INFINITY, f64::max)
        };
        let at = |score: f64| {
            let confidence = normal_probability(score);
            (score, bound(if score < 0.0 { confidence / count } else { confidence }))
        };
        let curve = (-20..=20).map(|i| at(0.2 * f64::from(i))).filter(|p| p.1.is_finite()).collect();
        Some(MaskRatio {
            ratio: *ratio,
            section: *section,
            sections: sections.len(),
            spread: Spread::Curve(curve),
        })
    }

    /// Sections of a mask in the order of frequency, each of a sixth of an octave or more and with some bins.
    fn sections(&self, mask: &[MaskPoint]) -> Vec<Band> {
        let (Some(first), Some(last)) = (mask.first(), mask.last()) else { return vec![] };
        let own = self.range();
        let (from_hz, to_hz) = (first.frequency_hz.max(own.from_hz), last.frequency_hz.min(own.to_hz));
        let told = |section: Band| self.powers(section, |_| 1.0).iter().flatten().count();
        let mut sections: Vec<Band> = vec![];
        let mut low_hz = from_hz;
        while low_hz < to_hz {
            let narrow_hz = low_hz * 2f64.powf(1.0 / SECTIONS_PER_OCTAVE);
            let mut section = Band { from_hz: low_hz, to_hz: narrow_hz.min(to_hz) };
            while told(section) < LEAST_BINS_OF_SECTION && section.to_hz < to_hz {
                section.to_hz = (section.to_hz + self.step_hz).min(to_hz);
            }
            match sections.last_mut() {
                // The rest of the mask belongs to the section before it.
                Some(before) if told(section) < LEAST_BINS_OF_SECTION => before.to_hz = section.to_hz,
                _ => sections.push(section),
            }
            low_hz = section.to_hz.max(low_hz + ON_BIN * self.step_hz);
        }
        sections
    }
}

/// The mask at a frequency, (deg/h)/√Hz; `None` outside it.
pub fn mask_at(mask: &[MaskPoint], frequency_hz: f64) -> Option<f64> {
    let rounding = 1.0 + 1e-12;
    let next = mask.iter().position(|p| p.frequency_hz * rounding >= frequency_hz)?;
    let high = mask.get(next)?;
    let Some(low) = next.checked_sub(1).and_then(|k| mask.get(k)) else {
        return (high.frequency_hz <= frequency_hz * rounding).then_some(high.density);
    };
    let share = (frequency_hz / low.frequency_hz).ln() / (high.frequency_hz / low.frequency_hz).ln();
    Some(low.density * (high.density / low.density).powf(share.min(1.0)))
}

/// Inverse of the bins in which the power below the first bin lies, by which its scatter is counted. With it the variance of a mean square is 0.95
/// to 1.17 times that of the exact traces of flicker and random walks beside white noise, with segments of one and of four blocks.
const SLOW_BINS_INVERSE: f64 = 3.0;

/// Equivalent degrees of freedom of the standard deviation about means of short blocks (`digest.histogram`), from the
/// spectrum of what scatters; `None` where nothing does.
///
/// The variance of a mean square over n samples is twice the mean square of the density over n. A line adds no scatter of its own,
/// only its product with the noise beside it. Heavy tails widen it by half the excess kurtosis.
pub fn rms_dof(digest: &RateDigest, lines: &[SpectralLine]) -> Option<f64> {
    let (histogram, spectrum) = (&digest.histogram, &digest.welch.spectrum);
    let variance = histogram.standard_deviation.powi(2);
    if variance <= 0.0 || histogram.samples == 0 || spectrum.segments == 0 {
        return None;
    }
    let length = spectrum.segment_len as f64;
    let bins = spectrum.density.len();
    // Density beside a line, in units of the sample interval.
    let beside = |line: &SpectralLine| {
        let near = (1..bins).filter(|k| bins_from(line, *k) <= 3.0 * HALF_LOBE_BINS as f64);
        let told: Vec<f64> = near
            .filter(|k| line_over(lines, *k).is_none())
            .filter_map(|k| spectrum.density.get(k).copied())
            .collect();
        told.iter().sum::<f64>() / told.len().max(1) as f64
    };
    let (mut power, mut squares) = (0.0, 0.0);
    for (k, density) in spectrum.density.iter().enumerate().take(bins.saturating_sub(1)).skip(1) {
        let density = line_over(lines, k).map_or(*density, beside);
        let passed = passed_by_block_means(k as f64 / length);
        power += 2.0 * passed * density / length;
        // Not the square of what is passed: the means of blocks mix frequencies below one cycle a block.
        squares += 2.0 * passed * density * density / length / (1.0 + 1.0 / spectrum.effective_averages);
    }
    let (mut of_lines, mut products) = (0.0, 0.0);
    for line in lines {
        let own = 0.5 * line.amplitude_deg_h.powi(2);
        of_lines += own;
        products += own * beside(line);
    }
    let slow = (variance - of_lines - power).max(0.0);
    squares += SLOW_BINS_INVERSE * slow * slow * length;
    let tails = 1.0 + 0.5 * histogram.excess_kurtosis.max(0.0);
    let scatter = (2.0 * squares * tails + 4.0 * products) / histogram.samples as f64;
    Some(2.0 * variance * variance / scatter)
}

/// The line that fills a bin.
fn line_over(lines: &[SpectralLine], bin: usize) -> Option<&SpectralLine> {
    lines.iter().find(|line| bins_from(line, bin) <= HALF_LOBE_BINS as f64 + 0.5)
}

/// Distance of a bin from a line, in bins.
fn bins_from(line: &SpectralLine, bin: usize) -> f64 {
    (line.frequency_hz / line.resolution_hz - bin as f64).abs()
}

/// Share of a power that is left about the means of blocks, by frequency in cycles a sample.
fn passed_by_block_means(frequency: f64) -> f64 {
    let turn = PI * frequency * super::histogram::BLOCK_SAMPLES as f64;
    1.0 - (turn.sin() / turn).powi(2)
}

#[cfg(test)]
#[path = "in_band_tests.rs"]
mod tests;
