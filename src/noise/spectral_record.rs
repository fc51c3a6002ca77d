//! The spectral statistics of a record, and what is identified from them.

use super::composite::Sampling;
use super::data::{BlockSeries, WelchSpectrum};
use super::evidence::{Evidence, Mask};
use super::fit_range::{RangedIdentification, identify_in_range};
use super::identify::Whittle;
use super::lines::SpectralLine;

/// What one pass left of a channel, as identification needs it.
#[derive(Debug, Clone, Copy)]
pub struct SpectralRecord<'a> {
    /// Block means.
    pub blocks: &'a BlockSeries,
    /// Averaged periodogram, where blocks hold more than one sample.
    pub welch: Option<&'a WelchSpectrum>,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Lines found in the periodogram.
    pub lines: &'a [SpectralLine],
    /// How samples were taken.
    pub sampling: Sampling,
}

impl SpectralRecord<'_> {
    /// The frequencies of the lines. A line fills the main lobe of the window: two bins to each side.
    pub fn masks(&self) -> Vec<Mask> {
        let mask =
            |l: &SpectralLine| Mask { frequency_hz: l.frequency_hz, half_width_hz: 2.0 * l.resolution_hz };
        self.lines.iter().map(mask).collect()
    }

    /// The evidence with the lines left out.
    pub fn evidence(&self) -> Evidence {
        Evidence::new(self.blocks, self.welch, self.tau0_s, &self.masks())
    }

    /// Identifies the noise.
    pub fn identify(&self, channel: &str) -> RangedIdentification {
        identify_in_range(&Whittle::default(), channel, &self.evidence(), 0.5 / self.tau0_s)
    }
}
