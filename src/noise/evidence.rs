//! The spectral evidence of a record: mean power in disjoint frequency bands, with the expectation of every term in
//! them. What a likelihood needs and no more; a few hundred bands whatever the length of the record.
//!
//! Low frequencies come from the cosine modes of the block means (one χ² with one degree of freedom each, no leakage
//! from a random walk), high frequencies from the averaged periodogram. No frequency is used twice.
//! Source: Whittle's likelihood with the expectation of the transform in place of the density (debiased Whittle,
//! Sykulski et al., Biometrika 106, 2019).

use super::data::{BlockSeries, WelchSpectrum};
use super::model::{Bin, NoiseModel, Spectral, TERMS};
use crate::numeric::cosine::dct2;

/// Modes that keep a band of their own.
const SINGLE_MODES: usize = 64;
/// Relative width of a band.
const BAND_WIDTH: f64 = 0.04;
/// Blocks with less than this share of their samples count as empty.
const LEAST_FILLING: f64 = 0.125;
/// Shortest stretch of blocks that is transformed on its own.
const LEAST_STRETCH: usize = 16;
/// Bands beyond this number, which only many gaps can make, are joined.
const MANY_BANDS: usize = 800;
/// Most coarse blocks when a record has gaps.
const COARSE_BLOCKS: usize = 1024;

/// A frequency range to leave out: a spectral line found elsewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mask {
    /// Frequency of the line, Hz.
    pub frequency_hz: f64,
    /// Half width of the range left out, Hz; one resolution step of the transform is added to it.
    pub half_width_hz: f64,
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
    fn expectation(&self, term: &dyn Spectral, index: f64) -> f64 {
        let bin = |index: f64| Bin {
            frequency_hz: index * self.step_hz,
            tau_s: self.tau_s,
            filling: self.filling,
            mode: if self.blocks > 0 { index.round() as usize } else { 0 },
            blocks: self.blocks,
        };
        let here = term.density(&bin(index));
        let nyquist = 0.5 / (self.tau_s * self.step_hz);
        if self.blocks > 0 || index < 2.0 || index + 1.0 > nyquist {
            return here;
        }
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
        let (span_s, usable_s) = (series.len() as f64 * series.tau_s, series.samples() as f64 * tau0_s);
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
            let segments = (2 * samples / segment_len as u64).max(2) - 1;
            top *= 0.5;
            let flat = vec![1.0; segment_len / 2 + 1];
            let effective_averages = 0.947 * segments as f64;
            builder
                .add_welch(&WelchSpectrum { segment_len, segments, effective_averages, density: flat }, top);
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

    /// Degrees of freedom of all bands together.
    pub fn dof(&self) -> f64 {
        self.bands.iter().map(|b| b.dof).sum()
    }
}

/// Block means with counts, at one averaging time.
struct Series {
    tau_s: f64,
    mean: Vec<f64>,
    count: Vec<f64>,
    full: f64,
}

impl Series {
    fn new(blocks: &BlockSeries, tau0_s: f64) -> Series {
        let full = blocks.block_len.max(1) as f64;
        let usable = |m: f64, c: u32| m.is_finite() && c > 0 && f64::from(c) >= LEAST_FILLING * full;
        let pairs: Vec<(f64, f64)> = blocks
            .mean
            .iter()
            .zip(&blocks.count)
            .map(|(&m, &c)| if usable(m, c) { (m, f64::from(c)) } else { (0.0, 0.0) })
            .collect();
        Series {
            tau_s: full * tau0_s,
            mean: pairs.iter().map(|p| p.0).collect(),
            count: pairs.iter().map(|p| p.1).collect(),
            full,
        }
    }

    fn len(&self) -> usize {
        self.mean.len()
    }

    fn samples(&self) -> f64 {
        self.count.iter().sum()
    }

    /// Without empty blocks at the two ends; `None` when too little is left.
    fn trimmed(mut self) -> Option<Series> {
        let first = self.count.iter().position(|c| *c > 0.0)?;
        let last = self.count.iter().rposition(|c| *c > 0.0)?;
        self.mean = self.mean.get(first..=last)?.to_vec();
        self.count = self.count.get(first..=last)?.to_vec();
        (self.len() >= LEAST_STRETCH).then_some(self)
    }

    fn is_whole(&self) -> bool {
        self.count.iter().all(|c| *c > 0.0)
    }

    /// Means over `factor` blocks; a rest at the end is left out.
    fn merged(&self, factor: usize) -> Series {
        let full = self.full * factor as f64;
        let pairs = self.mean.chunks_exact(factor).zip(self.count.chunks_exact(factor)).map(|(m, c)| {
            let count: f64 = c.iter().sum();
            let sum: f64 = m.iter().zip(c).map(|(m, c)| m * c).sum();
            if count >= LEAST_FILLING * full { (sum / count, count) } else { (0.0, 0.0) }
        });
        let (mean, count) = pairs.unzip();
        Series { tau_s: self.tau_s * factor as f64, mean, count, full }
    }

    /// Ranges of blocks without an empty one, at least [`LEAST_STRETCH`] long.
    fn stretches(&self) -> Vec<std::ops::Range<usize>> {
        let mut out = vec![];
        let mut start = None;
        for i in 0..=self.len() {
            match (self.count.get(i).is_some_and(|c| *c > 0.0), start) {
                (true, None) => start = Some(i),
                (false, Some(s)) => {
                    if i - s >= LEAST_STRETCH {
                        out.push(s..i);
                    }
                    start = None;
                }
                _ => {}
            }
        }
        out
    }
}

/// Cosine modes of a ramp of 1 deg/h/h over `blocks` means.
fn ramp_modes(blocks: usize, tau_s: f64) -> Vec<f64> {
    // The exact sum: only odd modes, −√(2/M)·cos(a)/(2 sin²(a)) each, with a = πk/(2M).
    let m = blocks as f64;
    let scale = (2.0 / m).sqrt() * tau_s / 3600.0;
    (0..blocks)
        .map(|k| {
            let a = std::f64::consts::PI * k as f64 / (2.0 * m);
            if k % 2 == 1 { -scale * a.cos() / (2.0 * a.sin().powi(2)) } else { 0.0 }
        })
        .collect()
}

/// Joins bands of different stretches that lie side by side.
fn merge(bands: Vec<Band>) -> Vec<Band> {
    let mut out: Vec<Band> = vec![];
    for band in bands {
        match out.last_mut() {
            Some(last)
                if band.high_hz <= last.low_hz * (1.0 + BAND_WIDTH) && last.dof.min(band.dof) > 1.0
                    || band.low_hz == last.low_hz =>
            {
                let total = last.dof + band.dof;
                let share = band.dof / total;
                last.power += (band.power - last.power) * share;
                last.cross += (band.cross - last.cross) * share;
                last.ramp += (band.ramp - last.ramp) * share;
                last.dof = total;
                last.high_hz = last.high_hz.max(band.high_hz);
                last.cells.extend(band.cells);
            }
            _ => out.push(band),
        }
    }
    out
}

struct Builder<'a> {
    evidence: Evidence,
    masks: &'a [Mask],
}

impl<'a> Builder<'a> {
    fn new(tau0_s: f64, masks: &'a [Mask]) -> Builder<'a> {
        Builder { evidence: Evidence { tau0_s, ..Default::default() }, masks }
    }

    fn finish(mut self, span_s: f64, usable_s: f64) -> Evidence {
        self.evidence.span_s = span_s;
        self.evidence.usable_s = usable_s;
        let bands = &mut self.evidence.bands;
        bands.sort_by(|a, b| a.low_hz.total_cmp(&b.low_hz));
        if bands.len() > MANY_BANDS {
            *bands = merge(std::mem::take(bands));
        }
        self.evidence
    }

    fn piece(&mut self, piece: Piece) -> usize {
        self.evidence.pieces.push(piece);
        self.evidence.pieces.len() - 1
    }

    fn masked(&self, frequency_hz: f64, step_hz: f64, tau_s: f64) -> bool {
        self.masks.iter().any(|mask| {
            // Means over tau fold a line back about multiples of 1/tau.
            let turns = mask.frequency_hz * tau_s;
            let folded = (turns - turns.round()).abs() / tau_s;
            (frequency_hz - folded).abs() <= mask.half_width_hz + step_hz
        })
    }

    fn add_series(&mut self, series: &Series, top: f64) {
        if series.is_whole() {
            self.add_stretch(series, 0..series.len(), 0.0, top, true);
            return;
        }
        // The coarse scale: the finest at which no block is empty.
        let mut factor = 1;
        let mut coarse = None;
        while series.len() / (2 * factor) >= LEAST_STRETCH {
            factor *= 2;
            let merged = series.merged(factor);
            if merged.is_whole() && merged.len() <= COARSE_BLOCKS {
                coarse = Some(merged);
                break;
            }
        }
        let mut split = 0.0;
        if let Some(coarse) = &coarse {
            // Half the coarse Nyquist frequency: above it, gaps inside coarse blocks matter.
            split = (0.25 / coarse.tau_s).min(top);
            self.add_stretch(coarse, 0..coarse.len(), 0.0, split, true);
        }
        // The fine scale: the finest at which most samples lie in stretches long enough.
        let total = series.samples();
        let mut fine_factor = 1;
        loop {
            let fine = series.merged(fine_factor);
            let stretches = fine.stretches();
            let kept: f64 = stretches.iter().map(|r| fine.count[r.clone()].iter().sum::<f64>()).sum();
            let last = coarse.is_none() || fine_factor * 2 >= factor;
            if kept >= 0.5 * total || last {
                self.evidence.samples_in_short_stretches = (total - kept).max(0.0) as u64;
                for range in stretches {
                    self.add_stretch(&fine, range, split, top, split == 0.0);
                }
                return;
            }
            fine_factor *= 2;
        }
    }

    fn add_stretch(
        &mut self,
        series: &Series,
        range: std::ops::Range<usize>,
        from: f64,
        to: f64,
        single: bool,
    ) {
        let (Some(mean), Some(count)) = (series.mean.get(range.clone()), series.count.get(range)) else {
            return;
        };
        let blocks = mean.len();
        if blocks < LEAST_STRETCH {
            return;
        }
        let filling = count.iter().map(|c| series.full / c).sum::<f64>() / blocks as f64;
        let centre = mean.iter().sum::<f64>() / blocks as f64;
        let centred: Vec<f64> = mean.iter().map(|m| m - centre).collect();
        let step_hz = 0.5 / (blocks as f64 * series.tau_s);
        let piece = self.piece(Piece { tau_s: series.tau_s, step_hz, blocks, filling });
        self.add_modes(piece, &dct2(&centred), &ramp_modes(blocks, series.tau_s), from, to, single);
    }

    /// Adds the modes of a piece with `from` < f ≤ `to`.
    fn add_modes(&mut self, piece: usize, modes: &[f64], ramp: &[f64], from: f64, to: f64, single: bool) {
        let Some(&Piece { tau_s, step_hz, .. }) = self.evidence.pieces.get(piece) else { return };
        for (k, (c, r)) in modes.iter().zip(ramp).enumerate().skip(1) {
            let f = k as f64 * step_hz;
            if f <= from || f > to * (1.0 + 1e-9) || self.masked(f, step_hz, tau_s) {
                continue;
            }
            let alone = single && k <= SINGLE_MODES;
            self.add_bin(piece, k, 1.0, [c * c * tau_s, c * r * tau_s, r * r * tau_s], alone);
        }
    }

    fn add_welch(&mut self, welch: &WelchSpectrum, from: f64) {
        let tau0_s = self.evidence.tau0_s;
        let step_hz = 1.0 / (welch.segment_len as f64 * tau0_s);
        let piece = self.piece(Piece { tau_s: tau0_s, step_hz, blocks: 0, filling: 1.0 });
        // Neighbouring bins of a Hann window share power, so that each adds half of its 2·averages: together the
        // bins then weigh as the fourth power of the window does (0.947 of the samples).
        let dof = welch.effective_averages.max(1.0);
        let nyquist = welch.segment_len / 2;
        for (k, density) in welch.density.iter().enumerate().take(nyquist).skip(2) {
            let f = k as f64 * step_hz;
            if f <= from || self.masked(f, 2.0 * step_hz, tau0_s) {
                continue;
            }
            self.add_bin(piece, k, dof, [density * tau0_s, 0.0, 0.0], false);
        }
    }

    fn add_bin(&mut self, piece: usize, k: usize, dof: f64, sums: [f64; 3], alone: bool) {
        let Some(step_hz) = self.evidence.pieces.get(piece).map(|p| p.step_hz) else { return };
        let f = k as f64 * step_hz;
        let bands = &mut self.evidence.bands;
        // Bins of one transform arrive in ascending order, so that only the newest band can take them.
        if !alone
            && let Some(band) = bands.last_mut()
            && let Some(cell) = band.cells.last_mut()
            && cell.piece == piece
            && cell.to + 1 == k
            && f <= band.low_hz * (1.0 + BAND_WIDTH)
        {
            let total = band.dof + dof;
            for (value, sum) in [&mut band.power, &mut band.cross, &mut band.ramp].into_iter().zip(sums) {
                *value += (sum - *value) * dof / total;
            }
            band.dof = total;
            band.high_hz = f;
            cell.to = k;
            cell.dof = total;
            return;
        }
        bands.push(Band {
            low_hz: f,
            high_hz: f,
            dof,
            power: sums[0],
            cross: sums[1],
            ramp: sums[2],
            cells: vec![Cell { piece, from: k, to: k, dof }],
        });
    }
}
