//! The spectral evidence of a record: mean power in disjoint frequency bands, with the expectation of every term in
//! them. What a likelihood needs and no more; a few hundred bands whatever the length of the record.
//!
//! Low frequencies come from the cosine modes of the block means (one χ² with one degree of freedom each, no leakage
//! from a random walk), high frequencies from the averaged periodogram. No frequency is used twice.
//! Source: Whittle's likelihood with the expectation of the transform in place of the density (debiased Whittle,
//! Sykulski et al., Biometrika 106, 2019).

mod build;
mod fine;
mod series;

use self::build::{Builder, ramp_modes};
pub use self::fine::{FineBin, Zone};
use self::series::{LEAST_STRETCH, Series};
use super::data::{BlockSeries, WelchSpectrum};
use super::model::{Bin, NoiseModel, Spectral, TERMS};
use std::sync::Arc;

/// A frequency range to leave out: a spectral line found elsewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mask {
    /// Frequency of the line, Hz.
    pub frequency_hz: f64,
    /// Half width of the range left out of modes, Hz; one resolution step of the transform is added to it.
    pub half_width_hz: f64,
    /// The same of an averaged periodogram, Hz.
    pub windowed_half_width_hz: f64,
}

impl Mask {
    /// Whether a mode of means over `tau_s` is left out, or a bin of a periodogram: the line, folded back about multiples
    /// of 1/τ, lies near.
    pub fn hides(&self, frequency_hz: f64, step_hz: f64, tau_s: f64, windowed: bool) -> bool {
        let turns = self.frequency_hz * tau_s;
        let folded = (turns - turns.round()).abs() / tau_s;
        let half_width_hz = if windowed { self.windowed_half_width_hz } else { self.half_width_hz };
        (frequency_hz - folded).abs() <= half_width_hz + step_hz
    }
}

/// One transform that contributes modes or bins.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    /// Averaging time of the means, s.
    tau_s: f64,
    /// Frequency step, Hz.
    step_hz: f64,
    /// Means transformed; 0 for the averaged periodogram.
    blocks: usize,
    /// Mean of full count / usable count.
    filling: f64,
}

impl Piece {
    fn bin(&self, index: f64) -> Bin {
        Bin {
            frequency_hz: index * self.step_hz,
            tau_s: self.tau_s,
            filling: self.filling,
            mode: if self.blocks > 0 { index.round() as usize } else { 0 },
            blocks: self.blocks,
            segment: if self.blocks > 0 { 0 } else { (1.0 / (self.step_hz * self.tau_s)).round() as usize },
        }
    }

    fn expectation(&self, term: &dyn Spectral, index: f64) -> f64 {
        let here = term.density(&self.bin(index));
        let nyquist = 0.5 / (self.tau_s * self.step_hz);
        if self.blocks > 0 || index < 2.0 || index + 1.0 > nyquist || term.knows_windows() {
            return here;
        }
        let bin = |index: f64| self.bin(index);
        // A Hann window spreads a density over a kernel with a second moment of one third of a bin squared.
        here + (term.density(&bin(index - 1.0)) - 2.0 * here + term.density(&bin(index + 1.0))) / 6.0
    }
}

/// A run of neighbouring modes of one piece.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    piece: usize,
    from: usize,
    to: usize,
    dof: f64,
}

/// Mean power in one band.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Lowest frequency in it, Hz.
    pub low_hz: f64,
    /// Highest frequency in it, Hz.
    pub high_hz: f64,
    /// Degrees of freedom: the power is distributed as its expectation times χ²/dof.
    pub dof: f64,
    /// Two-sided density, (deg/h)²/Hz.
    pub power: f64,
    /// Cross term of the data with a ramp of 1 deg/h/h, same scale.
    pub cross: f64,
    /// Power of a ramp of 1 deg/h/h, same scale.
    pub ramp: f64,
    cells: Vec<Cell>,
}

impl Band {
    /// The power that is left when a ramp of `r` deg/h/h is taken out.
    pub fn power_without_ramp(&self, r: f64) -> f64 {
        (self.power - 2.0 * r * self.cross + r * r * self.ramp).max(0.0)
    }

    /// Its middle on a logarithmic scale, Hz.
    pub fn centre_hz(&self) -> f64 {
        (self.low_hz * self.high_hz).sqrt()
    }
}

/// The evidence of one rate channel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Evidence {
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Length of the record from the first to the last usable block, s.
    pub span_s: f64,
    /// Usable time, s.
    pub usable_s: f64,
    /// Bands, ascending in frequency within each piece.
    pub bands: Vec<Band>,
    /// Samples in stretches too short between gaps to be transformed at high frequency; they still count in the
    /// coarse means.
    pub samples_in_short_stretches: u64,
    pieces: Vec<Piece>,
    fine: Arc<Vec<FineBin>>,
}

impl Evidence {
    /// Builds the evidence of a record.
    ///
    /// `blocks` gives the low frequencies and, when its blocks hold one sample, all of them; `welch` the rest.
    /// Frequencies within a mask are left out, also where the line folds back into the block means.
    pub fn new(blocks: &BlockSeries, welch: Option<&WelchSpectrum>, tau0_s: f64, masks: &[Mask]) -> Evidence {
        let series = Series::new(blocks, tau0_s);
        let mut builder = Builder::new(tau0_s, masks);
        let Some(series) = series.trimmed() else { return builder.finish(0.0, 0.0) };
        let (span_s, usable_s) = (series.len() as f64 * series.tau_s, series.samples() * tau0_s);
        let block_nyquist = 0.5 / series.tau_s;
        let mut top = block_nyquist;
        if blocks.block_len > 1
            && let Some(welch) = welch.filter(|w| w.segment_len >= 16 && w.segments > 0)
        {
            let step = 1.0 / (welch.segment_len as f64 * tau0_s);
            // Half the block Nyquist frequency keeps clear of what block averaging folds back.
            top = (0.5 * block_nyquist).max(4.0 * step).min(block_nyquist);
            builder.add_welch(welch, top);
        }
        builder.add_series(&series, top);
        builder.finish(span_s, usable_s)
    }

    /// The evidence a record of `samples` samples is expected to give if `model` is true: power equal to its
    /// expectation in every band.
    pub fn expected(model: &NoiseModel, samples: u64, tau0_s: f64) -> Evidence {
        let mut block_len = 1u64;
        while samples / block_len > 1 << 18 {
            block_len *= 2;
        }
        // Frequencies that blocks do not resolve are described by a periodogram of as many bins as suffice.
        let count = (samples / block_len) as usize;
        let mut builder = Builder::new(tau0_s, &[]);
        let tau_s = block_len as f64 * tau0_s;
        let mut top = 0.5 / tau_s;
        if block_len > 1 {
            let segment_len = (64 * block_len) as usize;
            let averages = 2.0 * samples as f64 / segment_len as f64;
            top *= 0.5;
            let spectrum = WelchSpectrum {
                segment_len,
                segments: (2.0 * averages) as u64,
                effective_averages: averages,
                averages_in_sums: averages,
                density: vec![1.0; segment_len / 2 + 1],
            };
            builder.add_welch(&spectrum, top);
        }
        if count >= LEAST_STRETCH {
            let piece = builder.piece(Piece {
                tau_s,
                step_hz: 0.5 / (count as f64 * tau_s),
                blocks: count,
                filling: 1.0,
            });
            let ramp = ramp_modes(count, tau_s);
            builder.add_modes(piece, &vec![0.0; count], &ramp, 0.0, top, true);
        }
        let length = samples as f64 * tau0_s;
        let mut evidence = builder.finish(length, length);
        // There is nothing in it that could be looked at more closely.
        evidence.fine = Arc::default();
        let mut power = vec![0.0; evidence.bands.len()];
        for term in TERMS {
            let square = model.coefficient(term).powi(2);
            if square > 0.0 {
                for (p, e) in power.iter_mut().zip(evidence.expectation(&term)) {
                    *p += square * e;
                }
            }
        }
        for (band, p) in evidence.bands.iter_mut().zip(power) {
            band.power = p + model.r * model.r * band.ramp;
            band.cross = model.r * band.ramp;
        }
        evidence
    }

    /// The mean power that a term of coefficient 1 is expected to have in each band, (deg/h)²/Hz.
    pub fn expectation(&self, term: &dyn Spectral) -> Vec<f64> {
        self.bands
            .iter()
            .map(|band| {
                let mut sum = 0.0;
                for cell in &band.cells {
                    let Some(piece) = self.pieces.get(cell.piece) else { continue };
                    let width = cell.to - cell.from + 1;
                    let points = width.min(4);
                    let mean: f64 = (0..points)
                        .map(|i| {
                            let offset = (i as f64 + 0.5) * width as f64 / points as f64 - 0.5;
                            piece.expectation(term, cell.from as f64 + offset)
                        })
                        .sum::<f64>()
                        / points as f64;
                    sum += cell.dof * mean;
                }
                sum / band.dof
            })
            .collect()
    }

    /// The part of the evidence at and below a frequency.
    pub fn up_to(&self, highest_hz: f64) -> Evidence {
        let mut part = self.clone();
        part.bands.retain(|b| b.high_hz <= highest_hz);
        part.fine = Arc::new(self.fine.iter().filter(|b| b.frequency_hz <= highest_hz).copied().collect());
        part
    }

    /// Degrees of freedom of all bands together.
    pub fn dof(&self) -> f64 {
        self.bands.iter().map(|b| b.dof).sum()
    }
}
