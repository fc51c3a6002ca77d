//! Statistics that one pass over a rate channel leaves behind: those from which everything about its noise is
//! computed. All of bounded size, whatever the length of the record. Rates in deg/h, times in s.

use serde::{Deserialize, Serialize};

/// Means of consecutive blocks on the uniform sample grid, the block length chosen so that at most `2^18` remain.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BlockSeries {
    /// Samples in a full block: a power of two.
    pub block_len: u64,
    /// Grid index of the first sample of the first block.
    pub first_index: u64,
    /// Mean of the usable samples of each block, deg/h; NaN where there is none.
    pub mean: Vec<f64>,
    /// Number of usable samples in each block.
    pub count: Vec<u32>,
    /// Rounding error of each mean, deg/h: where the offset is large against the noise, a mean over many samples
    /// has more digits than one double holds. Empty: nothing.
    pub rounding: Vec<f64>,
}

impl BlockSeries {
    /// The means less the first one, with every digit they have; NaN where there is none.
    pub fn about_first(&self) -> Vec<f64> {
        let first = self.mean.iter().copied().find(|m| m.is_finite()).unwrap_or(0.0);
        let rest = self.rounding.iter().copied().chain(std::iter::repeat(0.0));
        self.mean.iter().zip(rest).map(|(m, r)| (m - first) + r).collect()
    }
}

/// Averaged periodogram (Welch: Hann window, three quarters overlap, mean of each segment removed).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WelchSpectrum {
    /// Samples in a segment.
    pub segment_len: usize,
    /// Number of segments averaged.
    pub segments: u64,
    /// Equivalent number of independent averages in each bin.
    pub effective_averages: f64,
    /// Averages that each bin adds to a sum over many: less, since neighbouring bins of a Hann window share power, and at
    /// most what makes all bins together weigh as the samples.
    pub averages_in_sums: f64,
    /// Two-sided density in units of (deg/h)² × sample interval: multiply by τ0 in s for (deg/h)²/Hz.
    /// Bin k lies at frequency k / (segment_len τ0), k = 0 ..= segment_len / 2.
    pub density: Vec<f64>,
}

/// Kind of power-law noise, named by the exponent α of its rate spectrum f^α.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoiseType {
    /// White angle noise, quantisation: α = +2.
    Quantization,
    /// White rate noise, angle random walk: α = 0.
    AngleRandomWalk,
    /// Flicker rate noise, bias instability: α = −1.
    Flicker,
    /// Rate random walk: α = −2.
    RateRandomWalk,
    /// Deterministic ramp; treated as rate random walk where degrees of freedom are needed.
    RateRamp,
}

impl NoiseType {
    /// The id used in `sigma_tau.csv`.
    pub fn id(self) -> &'static str {
        match self {
            NoiseType::Quantization => "quantization",
            NoiseType::AngleRandomWalk => "angle_random_walk",
            NoiseType::Flicker => "flicker",
            NoiseType::RateRandomWalk => "rate_random_walk",
            NoiseType::RateRamp => "rate_ramp",
        }
    }

    /// Exponent α of the rate spectrum.
    pub fn alpha(self) -> i32 {
        match self {
            NoiseType::Quantization => 2,
            NoiseType::AngleRandomWalk => 0,
            NoiseType::Flicker => -1,
            NoiseType::RateRandomWalk | NoiseType::RateRamp => -2,
        }
    }
}

/// One point of an Allan-type deviation, before any interval is put on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeviationPoint {
    /// Averaging factor, samples.
    pub m: u64,
    /// Terms summed.
    pub terms: u64,
    /// Step between summed terms, samples (1: every overlapping term).
    pub stride: u64,
    /// Deviation, deg/h.
    pub deviation: f64,
}
