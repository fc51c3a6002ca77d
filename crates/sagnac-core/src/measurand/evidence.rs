//! What one pass left behind about a gyro channel, with what was identified from it.

use crate::message::Note;
use crate::noise::data::{BlockSeries, WelchSpectrum};
use crate::noise::digest::RateDigest;
use crate::noise::identification::Identification;
use crate::noise::intervals::BoundedPoint;
use crate::noise::lines::SpectralLine;
use crate::noise::motion::Motion;
use crate::noise::residual::GoodnessOfFit;
use crate::noise::windows::WindowStatistics;
use crate::temperature::findings::Findings;
use crate::temperature::warm_up::WarmUpFindings;

/// Earth rate along an input axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Earth {
    /// Component along the axis, deg/h.
    pub rate_deg_h: f64,
    /// Its standard uncertainty, deg/h.
    pub uncertainty_deg_h: f64,
}

/// One gyro channel of a run.
#[derive(Debug)]
pub struct GyroEvidence {
    /// Channel id.
    pub channel: String,
    /// True when the run has more than one gyro channel, so that figures and files need the name.
    pub several: bool,
    /// Measured mean sample interval, s.
    pub tau0_s: f64,
    /// Longest stretch without a gap, s.
    pub longest_stretch_s: f64,
    /// What the accumulators left.
    pub digest: RateDigest,
    /// σ(τ) of the overlapping Allan deviation on the grid asked for.
    pub sigma_tau: Vec<BoundedPoint>,
    /// σ(τ) at octaves, whatever the grid.
    pub octaves: Vec<BoundedPoint>,
    /// The noise model.
    pub identification: Identification,
    /// How well the model fits.
    pub goodness: GoodnessOfFit,
    /// Spectral lines.
    pub lines: Vec<SpectralLine>,
    /// The strongest line that was found and is more than the record can hold.
    pub withheld_line: Option<Note>,
    /// Whether the unit stood still.
    pub motion: Motion,
    /// Earth rate along the axis, where the site is known.
    pub earth: Option<Earth>,
    /// What a test over temperature showed, where the procedure asks for one.
    pub over_temperature: Option<Findings>,
    /// What a test of the warm-up showed, where the procedure asks for one.
    pub warm_up: Option<WarmUpFindings>,
}

impl GyroEvidence {
    /// Usable time, s.
    pub fn usable_s(&self) -> f64 {
        self.digest.samples as f64 * self.tau0_s
    }

    /// The window statistics of a window length in s, where the record has two such windows.
    pub fn windows(&self, window_s: f64) -> Option<&WindowStatistics> {
        self.digest.windows.iter().find(|w| w.window_s == window_s && w.n >= 2 && w.fits(self.tau0_s))
    }

    /// Whether whole samples make windows of a length in s.
    pub fn samples_fit(&self, window_s: f64) -> bool {
        self.digest.windows.iter().filter(|w| w.window_s == window_s).all(|w| w.fits(self.tau0_s))
    }

    /// σ of 100-s means, deg/h.
    pub fn drift_100s(&self) -> Option<f64> {
        self.windows(100.0).map(|w| w.standard_deviation).filter(|s| s.is_finite() && *s > 0.0)
    }

    /// The id of a figure of this channel.
    pub fn figure_id(&self, stem: &str) -> String {
        if self.several { format!("{stem}_{}", self.channel) } else { stem.to_owned() }
    }

    /// The channel as a figure shows it: empty when there is only one.
    pub fn figure_channel(&self) -> String {
        if self.several { self.channel.clone() } else { String::new() }
    }

    /// Block means of the record.
    pub fn blocks(&self) -> &BlockSeries {
        &self.digest.blocks
    }

    /// The averaged periodogram.
    pub fn spectrum(&self) -> &WelchSpectrum {
        &self.digest.welch.spectrum
    }
}
