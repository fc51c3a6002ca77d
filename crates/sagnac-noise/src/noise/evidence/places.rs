//! The places in frequency at which expectations are taken, laid out once for the many processes that a search tries.

use super::spectrum::Evidence;
use std::f64::consts::PI;
use std::ops::Range;

/// The transform that places belong to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transform {
    /// Cosine modes of so many means.
    Modes(usize),
    /// Bins of segments of so many samples under a Hann window.
    Segments(usize),
}

/// Turns of a phase at places of one transform: that from one mean to the next, and that over all means of the transform.
#[derive(Debug, Clone, Copy)]
pub struct Turns<'a> {
    /// Cosine of the turn from one mean to the next.
    pub cos: &'a [f64],
    /// Its sine.
    pub sin: &'a [f64],
    /// Cosine of the turn over the length of the transform.
    pub cos_round: &'a [f64],
    /// Its sine.
    pub sin_round: &'a [f64],
}

/// Neighbouring places of one transform.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    transform: Transform,
    tau_s: f64,
    places: Range<usize>,
}

/// The places of an evidence.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Places {
    runs: Vec<Run>,
    /// The four parts of [`Turns`], each for all places.
    turns: [Vec<f64>; 4],
    /// Places and degrees of freedom of each cell.
    cells: Vec<(usize, f64)>,
    /// Cells and degrees of freedom of each band.
    bands: Vec<(usize, f64)>,
}

impl Evidence {
    /// The places that stand for its bands.
    pub fn places(&self) -> Places {
        let mut out = Places::default();
        for band in &self.bands {
            let before = out.cells.len();
            for cell in &band.cells {
                let Some(piece) = self.pieces.get(cell.piece) else { continue };
                let indices = cell.indices();
                out.cells.push((indices.len(), cell.dof));
                for index in indices {
                    let bin = piece.bin(index);
                    let (transform, turns) = if bin.mode > 0 {
                        let (sin, cos) = (PI * bin.mode as f64 / bin.blocks as f64).sin_cos();
                        let half_turns = if bin.mode.is_multiple_of(2) { 1.0 } else { -1.0 };
                        (Transform::Modes(bin.blocks), [cos, sin, half_turns, 0.0])
                    } else {
                        let phase = 2.0 * PI * bin.frequency_hz * bin.tau_s;
                        let (sin, cos) = phase.sin_cos();
                        let (sin_round, cos_round) = (phase * bin.segment as f64).sin_cos();
                        (Transform::Segments(bin.segment), [cos, sin, cos_round, sin_round])
                    };
                    out.push(transform, bin.tau_s, turns);
                }
            }
            out.bands.push((out.cells.len() - before, band.dof));
        }
        out
    }
}

impl Places {
    fn push(&mut self, transform: Transform, tau_s: f64, turns: [f64; 4]) {
        let at = self.turns.first().map_or(0, Vec::len);
        match self.runs.last_mut().filter(|r| r.transform == transform && r.tau_s == tau_s) {
            Some(run) => run.places.end = at + 1,
            None => self.runs.push(Run { transform, tau_s, places: at..at + 1 }),
        }
        self.turns.iter_mut().zip(turns).for_each(|(all, turn)| all.push(turn));
    }

    /// The mean density of each band. `densities` fills those at neighbouring places of one transform of means over so many
    /// seconds.
    pub fn expectation(&self, densities: impl Fn(Transform, f64, Turns<'_>, &mut [f64])) -> Vec<f64> {
        let mut at_places = vec![0.0; self.turns.first().map_or(0, Vec::len)];
        for Run { transform, tau_s, places } in &self.runs {
            let Some(out) = at_places.get_mut(places.clone()) else { continue };
            let [cos, sin, cos_round, sin_round] =
                self.turns.each_ref().map(|all| all.get(places.clone()).unwrap_or_default());
            densities(*transform, *tau_s, Turns { cos, sin, cos_round, sin_round }, out);
        }
        let (mut values, mut cells) = (at_places.iter(), self.cells.iter());
        let mut of_cell =
            |(count, dof): &(usize, f64)| dof * (values.by_ref().take(*count).sum::<f64>() / *count as f64);
        let of_band = |(count, dof): &(usize, f64)| {
            cells.by_ref().take(*count).map(&mut of_cell).fold(0.0, |sum, cell| sum + cell) / dof
        };
        self.bands.iter().map(of_band).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::data::{BlockSeries, WelchSpectrum};
    use crate::noise::model::{Bin, Spectral};

    /// A density of the turns of a bin alone.
    struct OfTurns;

    fn of_turns(cos: f64, sin_round: f64, scale: f64) -> f64 {
        scale * (2.0 + cos) + sin_round
    }

    impl Spectral for OfTurns {
        fn density(&self, bin: &Bin) -> f64 {
            if bin.mode > 0 {
                return of_turns((PI * bin.mode as f64 / bin.blocks as f64).cos(), 0.0, bin.tau_s);
            }
            let phase = 2.0 * PI * bin.frequency_hz * bin.tau_s;
            of_turns(phase.cos(), (phase * bin.segment as f64).sin(), bin.tau_s)
        }

        fn knows_windows(&self) -> bool {
            true
        }
    }

    #[test]
    fn places_give_the_expectation_that_bins_one_by_one_give() {
        // Means over two samples below, a periodogram above.
        let count = 3000usize;
        let mean = (0..count).map(|i| ((i * 7919) % 1000) as f64 / 1000.0).collect();
        let blocks = BlockSeries { block_len: 2, mean, count: vec![2; count], ..BlockSeries::default() };
        let welch = WelchSpectrum {
            segment_len: 256,
            segments: 46,
            effective_averages: 23.0,
            averages_in_sums: 23.0,
            density: vec![1.0; 129],
        };
        let evidence = Evidence::new(&blocks, Some(&welch), 0.5, &[]);
        let places = evidence.places();
        let got = places.expectation(|_, tau_s, turns, out| {
            for ((o, cos), sin_round) in out.iter_mut().zip(turns.cos).zip(turns.sin_round) {
                *o = of_turns(*cos, *sin_round, tau_s);
            }
        });
        assert_eq!(places.runs.len(), 2);
        assert_eq!(got, evidence.expectation(&OfTurns));
    }
}
