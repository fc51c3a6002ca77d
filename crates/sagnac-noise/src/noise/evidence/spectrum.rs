//! The evidence: bands with the expectation of every term in them.

use super::bands::{Band, FineBin, Piece, Zone, bands_of};
use crate::noise::model::Spectral;
use std::sync::Arc;

/// The spectral evidence of one rate channel: mean powers in bands of frequency, with what is needed for the expected power
/// of any term in them.
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
    pub(super) pieces: Vec<Piece>,
    pub(super) fine: Arc<Vec<FineBin>>,
}

impl Evidence {
    /// The mean power that a term of coefficient 1 is expected to have in each band, (deg/h)²/Hz.
    pub fn expectation(&self, term: &dyn Spectral) -> Vec<f64> {
        self.bands
            .iter()
            .map(|band| {
                let mut sum = 0.0;
                for cell in &band.cells {
                    let Some(piece) = self.pieces.get(cell.piece) else { continue };
                    let indices = cell.indices();
                    let count = indices.len() as f64;
                    let mean = indices.map(|i| piece.expectation(term, i)).sum::<f64>() / count;
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

    /// The bins, in ascending frequency within each transform; empty for an expected evidence.
    pub fn fine(&self) -> &[FineBin] {
        &self.fine
    }

    /// A copy whose bands are narrow enough to resolve the resonances in `zones`.
    pub fn resolving(&self, zones: &[Zone]) -> Evidence {
        if zones.is_empty() || self.fine.is_empty() {
            return self.clone();
        }
        let bands: Vec<Band> = bands_of(&self.fine, zones);
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
        Evidence { bands: bands_of(&fine, &[]), fine: Arc::new(fine), ..self.clone() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::NoiseModel;

    #[test]
    fn white_noise_has_one_level_in_every_band() {
        let evidence = Evidence::expected(&NoiseModel { n: 0.01, ..NoiseModel::default() }, 10_000, 1.0);
        // Two-sided: N² in (deg/h)²/Hz is 3600 N².
        assert!(evidence.bands.iter().all(|b| (b.power / (3600.0 * 1e-4) - 1.0).abs() < 1e-12));
        assert!((evidence.power_near(0.1) / 0.36 - 1.0).abs() < 1e-12);
        // All modes but the mean.
        assert_eq!(evidence.dof(), 9_999.0);
        let half = evidence.up_to(0.25);
        assert!((half.dof() / 5_000.0 - 1.0).abs() < 0.05 && half.bands.iter().all(|b| b.high_hz <= 0.25));
    }
}
