//! The evidence bin by bin: what bands are made of, and where narrow structure is looked for.

use super::build::banded;
use super::{Band, Evidence};
use std::sync::Arc;

/// One mode or bin.
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

/// Width of a band over the distance to the centre of a zone plus the half width of that.
const GRADING: f64 = 0.2;

/// Widest band at a frequency, Hz.
pub(super) fn widest(frequency_hz: f64, relative: f64, zones: &[Zone]) -> f64 {
    zones.iter().fold(relative * frequency_hz, |width, zone| {
        width.min(GRADING * ((frequency_hz - zone.centre_hz).abs() + zone.half_width_hz))
    })
}

impl Evidence {
    /// The bins, in ascending frequency within each transform; empty for an expected evidence.
    pub fn fine(&self) -> &[FineBin] {
        &self.fine
    }

    /// The same evidence with bands that resolve the zones.
    pub fn resolving(&self, zones: &[Zone]) -> Evidence {
        if zones.is_empty() || self.fine.is_empty() {
            return self.clone();
        }
        let bands: Vec<Band> = banded(&self.fine, zones);
        Evidence { bands, ..self.clone() }
    }

    /// The same evidence without the cosine modes that `hidden` names by the averaging time of their means (s), their order
    /// and the number of means.
    pub fn leaving_out(&self, hidden: impl Fn(f64, usize, usize) -> bool) -> Evidence {
        let out = |bin: &FineBin| {
            let piece = self.pieces.get(bin.piece as usize).filter(|p| p.blocks > 0);
            piece.is_some_and(|p| hidden(p.tau_s, bin.index as usize, p.blocks))
        };
        let fine: Vec<FineBin> = self.fine.iter().filter(|b| !out(b)).copied().collect();
        if fine.len() == self.fine.len() {
            return self.clone();
        }
        Evidence { bands: banded(&fine, &[]), fine: Arc::new(fine), ..self.clone() }
    }

    /// Mean power of the band nearest to a frequency, (deg/h)²/Hz; 0 without any.
    pub fn power_near(&self, frequency_hz: f64) -> f64 {
        let distance = |b: &Band| (b.centre_hz() - frequency_hz).abs();
        self.bands.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(0.0, |b| b.power)
    }

    /// Frequency step of the transform that shows a frequency best, Hz.
    pub fn resolution_hz(&self, frequency_hz: f64) -> f64 {
        let nearest = self
            .fine
            .iter()
            .min_by(|a, b| {
                let distance = |x: &FineBin| (x.frequency_hz - frequency_hz).abs();
                distance(a).total_cmp(&distance(b))
            })
            .and_then(|bin| self.pieces.get(bin.piece as usize));
        nearest.map_or(f64::INFINITY, |p| p.step_hz)
    }
}

impl FineBin {
    /// True when `next` is the neighbour above in the same transform.
    pub fn precedes(&self, next: &FineBin) -> bool {
        self.piece == next.piece && self.index + 1 == next.index
    }
}
