//! Turns block means and an averaged periodogram into bands.

use super::fine::widest;
use super::series::{LEAST_STRETCH, Series};
use super::{Band, Cell, Evidence, FineBin, Mask, Piece, Zone};
use crate::noise::data::WelchSpectrum;
use crate::numeric::cosine::dct2;
use std::sync::Arc;

/// Modes that keep a band of their own.
const SINGLE_MODES: usize = 64;
/// Relative width of a band.
const BAND_WIDTH: f64 = 0.04;
/// Bands beyond this number, which only many gaps can make, are joined.
const MANY_BANDS: usize = 800;
/// Most coarse blocks when a record has gaps.
const COARSE_BLOCKS: usize = 1024;

/// Cosine modes of a ramp of 1 deg/h/h over `blocks` means.
pub(super) fn ramp_modes(blocks: usize, tau_s: f64) -> Vec<f64> {
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

/// Bands of bins: those of one transform that lie side by side are joined while the band stays narrow enough.
pub(super) fn banded(fine: &[FineBin], zones: &[Zone]) -> Vec<Band> {
    let mut bands: Vec<Band> = vec![];
    for bin in fine {
        let (piece, k, f) = (bin.piece as usize, bin.index as usize, bin.frequency_hz);
        // Bins of one transform arrive in ascending order, so that only the newest band can take them.
        if !bin.alone
            && let Some(band) = bands.last_mut()
            && let Some(cell) = band.cells.last_mut()
            && cell.piece == piece
            && cell.to + 1 == k
            && f - band.low_hz <= widest(0.5 * (f + band.low_hz), BAND_WIDTH, zones)
        {
            let total = band.dof + bin.dof;
            let sums = [bin.power, bin.cross, bin.ramp];
            for (value, sum) in [&mut band.power, &mut band.cross, &mut band.ramp].into_iter().zip(sums) {
                *value += (sum - *value) * bin.dof / total;
            }
            band.dof = total;
            band.high_hz = f;
            cell.to = k;
            cell.dof = total;
            continue;
        }
        bands.push(Band {
            low_hz: f,
            high_hz: f,
            dof: bin.dof,
            power: bin.power,
            cross: bin.cross,
            ramp: bin.ramp,
            cells: vec![Cell { piece, from: k, to: k, dof: bin.dof }],
        });
    }
    bands.sort_by(|a, b| a.low_hz.total_cmp(&b.low_hz));
    if bands.len() > MANY_BANDS + 64 * zones.len() {
        bands = merge(bands);
    }
    bands
}

pub(super) struct Builder<'a> {
    evidence: Evidence,
    masks: &'a [Mask],
    fine: Vec<FineBin>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(tau0_s: f64, masks: &'a [Mask]) -> Builder<'a> {
        Builder { evidence: Evidence { tau0_s, ..Default::default() }, masks, fine: vec![] }
    }

    pub(super) fn finish(mut self, span_s: f64, usable_s: f64) -> Evidence {
        self.evidence.span_s = span_s;
        self.evidence.usable_s = usable_s;
        self.evidence.bands = banded(&self.fine, &[]);
        self.evidence.fine = Arc::new(self.fine);
        self.evidence
    }

    pub(super) fn piece(&mut self, piece: Piece) -> usize {
        self.evidence.pieces.push(piece);
        self.evidence.pieces.len() - 1
    }

    fn masked(&self, frequency_hz: f64, step_hz: f64, tau_s: f64, windowed: bool) -> bool {
        self.masks.iter().any(|mask| mask.hides(frequency_hz, step_hz, tau_s, windowed))
    }

    pub(super) fn add_series(&mut self, series: &Series, top: f64) {
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
    pub(super) fn add_modes(
        &mut self,
        piece: usize,
        modes: &[f64],
        ramp: &[f64],
        from: f64,
        to: f64,
        single: bool,
    ) {
        let Some(&Piece { tau_s, step_hz, .. }) = self.evidence.pieces.get(piece) else { return };
        for (k, (c, r)) in modes.iter().zip(ramp).enumerate().skip(1) {
            let f = k as f64 * step_hz;
            if f <= from || f > to * (1.0 + 1e-9) || self.masked(f, step_hz, tau_s, false) {
                continue;
            }
            let alone = single && k <= SINGLE_MODES;
            self.add_bin(piece, k, 1.0, [c * c * tau_s, c * r * tau_s, r * r * tau_s], alone);
        }
    }

    pub(super) fn add_welch(&mut self, welch: &WelchSpectrum, from: f64) {
        let tau0_s = self.evidence.tau0_s;
        let step_hz = 1.0 / (welch.segment_len as f64 * tau0_s);
        let piece = self.piece(Piece { tau_s: tau0_s, step_hz, blocks: 0, filling: 1.0 });
        let dof = welch.averages_in_sums.max(1.0);
        let nyquist = welch.segment_len / 2;
        for (k, density) in welch.density.iter().enumerate().take(nyquist).skip(2) {
            let f = k as f64 * step_hz;
            if f <= from || self.masked(f, 2.0 * step_hz, tau0_s, true) {
                continue;
            }
            self.add_bin(piece, k, dof, [density * tau0_s, 0.0, 0.0], false);
        }
    }

    fn add_bin(&mut self, piece: usize, k: usize, dof: f64, sums: [f64; 3], alone: bool) {
        let Some(step_hz) = self.evidence.pieces.get(piece).map(|p| p.step_hz) else { return };
        let [power, cross, ramp] = sums;
        self.fine.push(FineBin {
            frequency_hz: k as f64 * step_hz,
            power,
            dof,
            cross,
            ramp,
            piece: piece as u32,
            index: k as u32,
            alone,
        });
    }
}
