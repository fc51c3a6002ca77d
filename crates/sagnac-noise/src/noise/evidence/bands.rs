//! Bands of the modes and bins of transforms: mean powers, and where narrow structure must be resolved.

use crate::noise::model::{Bin, Spectral};
use crate::numeric::order::SortByNumber;

/// Relative width of a band.
const RELATIVE_WIDTH: f64 = 0.04;
/// Bands beyond this number, which only many gaps can make, are joined.
const MAX_BANDS: usize = 800;
/// Width of a band over the distance to the centre of a zone plus the half width of that.
const WIDTH_PER_DISTANCE: f64 = 0.2;

/// Places that stand for one cell at most.
const MAX_PLACES: usize = 4;

/// One transform that contributes modes or bins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Averaging time of the means, s.
    pub(super) tau_s: f64,
    /// Frequency step, Hz.
    pub(super) step_hz: f64,
    /// Means transformed; 0 for the averaged periodogram.
    pub(super) blocks: usize,
    /// Mean of full count / usable count.
    pub(super) filling: f64,
}

impl Piece {
    pub(super) fn bin(&self, index: f64) -> Bin {
        Bin {
            frequency_hz: index * self.step_hz,
            tau_s: self.tau_s,
            filling: self.filling,
            mode: if self.blocks > 0 { index.round() as usize } else { 0 },
            blocks: self.blocks,
            segment: if self.blocks > 0 { 0 } else { (1.0 / (self.step_hz * self.tau_s)).round() as usize },
        }
    }

    pub(super) fn expectation(&self, term: &dyn Spectral, index: f64) -> f64 {
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
pub(super) struct Cell {
    pub(super) piece: usize,
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) dof: f64,
}

impl Cell {
    /// The places that stand for it, as indices of bins with their fractions.
    pub(super) fn indices(&self) -> impl ExactSizeIterator<Item = f64> {
        let (from, width) = (self.from as f64, self.to - self.from + 1);
        let count = width.min(MAX_PLACES);
        (0..count).map(move |i| from + ((i as f64 + 0.5) * width as f64 / count as f64 - 0.5))
    }
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
    pub(super) cells: Vec<Cell>,
}

impl Band {
    /// The power that is left when a ramp of `r` deg/h/h is taken out.
    pub fn power_without_ramp(&self, r: f64) -> f64 {
        (self.power - 2.0 * r * self.cross + r * r * self.ramp).max(0.0)
    }

    /// The middle of the band on a logarithmic scale, Hz.
    pub fn centre_hz(&self) -> f64 {
        (self.low_hz * self.high_hz).sqrt()
    }
}

/// One cosine mode of block means, or one bin of the averaged periodogram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineBin {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Two-sided density, (deg/h)²/Hz.
    pub power: f64,
    /// Degrees of freedom.
    pub dof: f64,
    pub(super) cross: f64,
    pub(super) ramp: f64,
    pub(super) piece: u32,
    pub(super) index: u32,
    /// Keeps a band of its own.
    pub(super) alone: bool,
}

/// A resonance that bands must resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Its centre, Hz.
    pub centre_hz: f64,
    /// Half its width at half power, Hz.
    pub half_width_hz: f64,
}

impl FineBin {
    /// True when `next` is the neighbour above in the same transform.
    pub fn precedes(&self, next: &FineBin) -> bool {
        self.piece == next.piece && self.index + 1 == next.index
    }
}

/// Widest band at a frequency, Hz.
fn max_width_hz(frequency_hz: f64, relative: f64, zones: &[Zone]) -> f64 {
    zones.iter().fold(relative * frequency_hz, |width, zone| {
        width.min(WIDTH_PER_DISTANCE * ((frequency_hz - zone.centre_hz).abs() + zone.half_width_hz))
    })
}

/// Joins bands of different stretches that lie side by side.
fn merge(bands: Vec<Band>) -> Vec<Band> {
    let mut out: Vec<Band> = vec![];
    for band in bands {
        match out.last_mut() {
            Some(last)
                if band.high_hz <= last.low_hz * (1.0 + RELATIVE_WIDTH) && last.dof.min(band.dof) > 1.0
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
pub(super) fn bands_of(fine: &[FineBin], zones: &[Zone]) -> Vec<Band> {
    let mut bands: Vec<Band> = vec![];
    for bin in fine {
        let (piece, k, f) = (bin.piece as usize, bin.index as usize, bin.frequency_hz);
        // Bins of one transform arrive in ascending order, so that only the newest band can take them.
        if !bin.alone
            && let Some(band) = bands.last_mut()
            && let Some(cell) = band.cells.last_mut()
            && cell.piece == piece
            && cell.to + 1 == k
            && f - band.low_hz <= max_width_hz(0.5 * (f + band.low_hz), RELATIVE_WIDTH, zones)
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
    bands.sort_ascending_by(|a| a.low_hz);
    if bands.len() > MAX_BANDS + 64 * zones.len() {
        bands = merge(bands);
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bin(index: u32, alone: bool) -> FineBin {
        let frequency_hz = 0.001 * f64::from(index);
        let power = f64::from(index);
        FineBin { frequency_hz, power, dof: 1.0, cross: 0.0, ramp: 0.0, piece: 0, index, alone }
    }

    #[test]
    fn bands_hold_all_degrees_of_freedom_and_the_mean_power() {
        let fine: Vec<FineBin> = (1..=2000).map(|k| bin(k, k <= 10)).collect();
        let bands = bands_of(&fine, &[]);
        assert!(bands.iter().take(10).all(|b| b.low_hz == b.high_hz));
        assert_eq!(bands.iter().map(|b| b.dof).sum::<f64>(), 2000.0);
        let total: f64 = bands.iter().map(|b| b.dof * b.power).sum();
        assert!((total / 2_001_000.0 - 1.0).abs() < 1e-12);
        for band in bands.iter().filter(|b| b.dof > 1.0) {
            assert!(
                band.high_hz - band.low_hz <= RELATIVE_WIDTH * 0.5 * (band.low_hz + band.high_hz) + 1e-12
            );
        }
    }

    #[test]
    fn bands_are_narrow_where_a_resonance_must_be_resolved() {
        let zone = Zone { centre_hz: 1.0, half_width_hz: 0.005 };
        let fine: Vec<FineBin> = (1..=2000).map(|k| bin(k, false)).collect();
        let widest = |from: f64, to: f64| {
            let bands = bands_of(&fine, &[zone]);
            let inside = bands.iter().filter(|b| b.low_hz > from && b.high_hz < to);
            inside.map(|b| b.high_hz - b.low_hz).fold(0.0, f64::max)
        };
        // A fifth of the half width at the centre; 4 % of the frequency far away.
        assert!(widest(0.995, 1.005) < 0.0021 && widest(1.6, 2.0) > 0.05);
    }

    #[test]
    fn a_bin_of_a_piece_is_a_mode_of_a_transform_or_one_of_a_periodogram() {
        let piece = Piece { tau_s: 2.0, step_hz: 0.001, blocks: 250, filling: 1.5 };
        let mode = piece.bin(30.0);
        assert!((mode.frequency_hz - 0.03).abs() < 1e-15);
        assert_eq!((mode.tau_s, mode.filling, mode.mode, mode.blocks, mode.segment), (2.0, 1.5, 30, 250, 0));
        // A periodogram with a step of 0.001 Hz of means over 2 s has segments of 500.
        let bin = Piece { blocks: 0, ..piece }.bin(30.0);
        assert_eq!((bin.mode, bin.blocks, bin.segment), (0, 0, 500));
    }

    /// A density that is the square of the index of the bin.
    struct Square;

    impl Spectral for Square {
        fn density(&self, bin: &Bin) -> f64 {
            (bin.frequency_hz / 0.001).powi(2)
        }
    }

    #[test]
    fn a_windowed_bin_sees_a_third_of_the_bend_between_its_neighbours() {
        let piece = Piece { tau_s: 2.0, step_hz: 0.001, blocks: 0, filling: 1.0 };
        // i² + ((i + 1)² − 2i² + (i − 1)²)/6 = i² + 1/3; the first bins, the last one and modes are as they are.
        for (index, more) in [(1.0, 0.0), (2.0, 1.0), (30.0, 1.0), (249.0, 1.0), (250.0, 0.0)] {
            let got = piece.expectation(&Square, index) - index * index;
            assert!((got - more / 3.0).abs() < 1e-6, "{index}: {got}");
        }
        let mode = Piece { blocks: 250, ..piece };
        assert!((mode.expectation(&Square, 30.0) - 900.0).abs() < 1e-9);
    }
}
