//! Turns block means and an averaged periodogram into an evidence.

use super::bands::{FineBin, Piece, bands_of};
use super::spectrum::Evidence;
use crate::noise::data::{BlockSeries, WelchSpectrum};
use crate::noise::model::{NoiseModel, TERMS};
use crate::numeric::cosine::dct2;
use crate::numeric::order::SortByNumber;
use std::sync::Arc;

/// Blocks with less than this share of their samples count as empty.
const MIN_FILLING: f64 = 0.125;
/// Shortest stretch of blocks that is transformed on its own.
const MIN_STRETCH: usize = 16;
/// Modes that keep a band of their own.
const SINGLE_MODES: usize = 64;
/// Most coarse blocks when a record has gaps.
const MAX_COARSE_BLOCKS: usize = 1024;

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
    /// True where a mode of means over `tau_s`, or a bin of a periodogram (`windowed`), is left out: the line, folded back about multiples
    /// of 1/τ, lies near.
    pub fn hides(&self, frequency_hz: f64, step_hz: f64, tau_s: f64, windowed: bool) -> bool {
        self.in_transform(step_hz, tau_s, windowed).holds(frequency_hz)
    }

    /// What it leaves out of a transform.
    fn in_transform(&self, step_hz: f64, tau_s: f64, windowed: bool) -> Hidden {
        let turns = self.frequency_hz * tau_s;
        let half_width_hz = if windowed { self.windowed_half_width_hz } else { self.half_width_hz };
        Hidden { centre_hz: (turns - turns.round()).abs() / tau_s, half_width_hz: half_width_hz + step_hz }
    }
}

/// A range of frequencies that is left out of a transform.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hidden {
    centre_hz: f64,
    half_width_hz: f64,
}

impl Hidden {
    fn holds(&self, frequency_hz: f64) -> bool {
        (frequency_hz - self.centre_hz).abs() <= self.half_width_hz
    }
}

/// The ranges that masks leave out of a transform, by their centres: of some hundred lines only those near a mode are looked at.
struct HiddenRanges {
    ranges: Vec<Hidden>,
    reach_hz: f64,
}

impl HiddenRanges {
    fn new(masks: &[Mask], step_hz: f64, tau_s: f64, windowed: bool) -> HiddenRanges {
        let mut ranges: Vec<Hidden> =
            masks.iter().map(|m| m.in_transform(step_hz, tau_s, windowed)).collect();
        ranges.sort_ascending_by(|r| r.centre_hz);
        let widest_hz = ranges.iter().map(|r| r.half_width_hz).fold(0.0, f64::max);
        // A little more, so that no rounding leaves one out.
        HiddenRanges { ranges, reach_hz: 1.01 * widest_hz }
    }

    fn hold(&self, frequency_hz: f64) -> bool {
        let first = self.ranges.partition_point(|r| r.centre_hz < frequency_hz - self.reach_hz);
        let near = self.ranges.get(first..).unwrap_or_default().iter();
        near.take_while(|r| r.centre_hz <= frequency_hz + self.reach_hz).any(|r| r.holds(frequency_hz))
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

/// Block means with counts, at one averaging time.
struct Series {
    tau_s: f64,
    /// Means less the first one.
    mean: Vec<f64>,
    count: Vec<f64>,
    full: f64,
}

impl Series {
    fn new(blocks: &BlockSeries, tau0_s: f64) -> Series {
        let full = blocks.block_len.max(1) as f64;
        let usable = |m: f64, c: u32| m.is_finite() && c > 0 && f64::from(c) >= MIN_FILLING * full;
        let pairs: Vec<(f64, f64)> = blocks
            .about_first()
            .into_iter()
            .zip(&blocks.count)
            .map(|(m, &c)| if usable(m, c) { (m, f64::from(c)) } else { (0.0, 0.0) })
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
        (self.len() >= MIN_STRETCH).then_some(self)
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
            if count >= MIN_FILLING * full { (sum / count, count) } else { (0.0, 0.0) }
        });
        let (mean, count) = pairs.unzip();
        Series { tau_s: self.tau_s * factor as f64, mean, count, full }
    }

    /// Ranges of blocks without an empty one, at least [`MIN_STRETCH`] long.
    fn stretches(&self) -> Vec<std::ops::Range<usize>> {
        let mut out = vec![];
        let mut start = None;
        for i in 0..=self.len() {
            match (self.count.get(i).is_some_and(|c| *c > 0.0), start) {
                (true, None) => start = Some(i),
                (false, Some(s)) => {
                    if i - s >= MIN_STRETCH {
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

/// Collects modes and bins.
struct Builder<'a> {
    evidence: Evidence,
    masks: &'a [Mask],
    fine: Vec<FineBin>,
}

impl<'a> Builder<'a> {
    fn new(tau0_s: f64, masks: &'a [Mask]) -> Builder<'a> {
        Builder { evidence: Evidence { tau0_s, ..Default::default() }, masks, fine: vec![] }
    }

    fn finish(mut self, span_s: f64, usable_s: f64) -> Evidence {
        self.evidence.span_s = span_s;
        self.evidence.usable_s = usable_s;
        self.evidence.bands = bands_of(&self.fine, &[]);
        self.evidence.fine = Arc::new(self.fine);
        self.evidence
    }

    fn piece(&mut self, piece: Piece) -> usize {
        self.evidence.pieces.push(piece);
        self.evidence.pieces.len() - 1
    }

    fn add_series(&mut self, series: &Series, top: f64) {
        if series.is_whole() {
            self.add_stretch(series, 0..series.len(), 0.0, top, true);
            return;
        }
        // The coarse scale: the finest at which no block is empty.
        let mut factor = 1;
        let mut coarse = None;
        while series.len() / (2 * factor) >= MIN_STRETCH {
            factor *= 2;
            let merged = series.merged(factor);
            if merged.is_whole() && merged.len() <= MAX_COARSE_BLOCKS {
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
        if blocks < MIN_STRETCH {
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
        let hidden = HiddenRanges::new(self.masks, step_hz, tau_s, false);
        for (k, (c, r)) in modes.iter().zip(ramp).enumerate().skip(1) {
            let f = k as f64 * step_hz;
            if f <= from || f > to * (1.0 + 1e-9) || hidden.hold(f) {
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
        let dof = welch.averages_in_sums.max(1.0);
        let nyquist = welch.segment_len / 2;
        let hidden = HiddenRanges::new(self.masks, 2.0 * step_hz, tau0_s, true);
        for (k, density) in welch.density.iter().enumerate().take(nyquist).skip(2) {
            let f = k as f64 * step_hz;
            if f <= from || hidden.hold(f) {
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
        if count >= MIN_STRETCH {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_hides_what_is_near_its_line_folded_back() {
        let mask = Mask { frequency_hz: 0.7, half_width_hz: 0.01, windowed_half_width_hz: 0.03 };
        let hidden = |tau_s: f64, windowed: bool| -> Vec<i32> {
            (0..1000).filter(|i| mask.hides(0.001 * f64::from(*i), 0.0025, tau_s, windowed)).collect()
        };
        // At 0.7 Hz within 0.0125, and within 0.0325 of a periodogram.
        assert_eq!(hidden(0.1, false), (688..=712).collect::<Vec<_>>());
        assert_eq!(hidden(0.1, true), (668..=732).collect::<Vec<_>>());
        // Means over 1 s show it at 0.3 Hz, over 4 s, 2.8 turns, at 0.05 Hz.
        assert_eq!(hidden(1.0, false), (288..=312).collect::<Vec<_>>());
        assert_eq!(hidden(4.0, false), (38..=62).collect::<Vec<_>>());
    }

    #[test]
    fn many_masks_hide_what_each_of_them_hides() {
        let mask = |i: u32| Mask {
            frequency_hz: 0.000_37 * f64::from(i * i % 4001),
            half_width_hz: 1e-5 * f64::from(i % 7),
            windowed_half_width_hz: 2e-4 * f64::from(i % 5),
        };
        let masks: Vec<Mask> = (0..300).map(mask).collect();
        for (step_hz, tau_s, windowed) in [(1e-5, 1.0, false), (1e-4, 2.5, false), (1e-3, 1.0, true)] {
            let hidden = HiddenRanges::new(&masks, step_hz, tau_s, windowed);
            let places: Vec<f64> = (0..5000).map(|i| 1e-4 * f64::from(i)).collect();
            let by_each = |f: f64| masks.iter().any(|m| m.hides(f, step_hz, tau_s, windowed));
            assert!(places.iter().all(|f| hidden.hold(*f) == by_each(*f)));
            let left = places.iter().filter(|f| !hidden.hold(**f)).count();
            assert!(left > 0 && left < places.len(), "{left}");
        }
        assert!(!HiddenRanges::new(&[], 0.1, 1.0, false).hold(0.2));
    }

    #[test]
    fn modes_of_a_ramp_are_those_of_its_transform() {
        for (blocks, tau_s) in [(8usize, 2.0), (15, 0.5)] {
            let ramp: Vec<f64> = (0..blocks).map(|i| i as f64 * tau_s / 3600.0).collect();
            let transform = crate::numeric::cosine::dct2(&ramp);
            let modes = ramp_modes(blocks, tau_s);
            for (k, (a, b)) in modes.iter().zip(&transform).enumerate().skip(1) {
                assert!((a - b).abs() < 1e-15, "{k}: {a} {b}");
            }
        }
    }
}
