//! What a comparison of Russian with Allan values needs of a channel, so that results can be compared without their
//! recordings.

use crate::estimate::Interval;
pub use crate::noise::prediction::Agreement;
use serde::{Deserialize, Serialize};

/// Russian and Allan values of one channel of one record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ComparisonRecord {
    /// Channel.
    pub channel: String,
    /// Usable time, s.
    pub length_s: f64,
    /// Sample interval, s.
    pub sample_interval_s: f64,
    /// What was taken out before standard deviations were formed: `mean`, nothing else.
    pub detrend: String,
    /// Standard deviations of means over 100 s and 10 s against their prediction.
    pub windows: Vec<WindowRecord>,
    /// How the variance of the 100-s means is made up of Allan variances, exactly.
    pub octaves: Option<OctavesRecord>,
    /// The smallest Allan deviation and what angle random walk alone would give.
    pub minimum: Option<MinimumRecord>,
    /// From where on the record could show a floor.
    pub floor: Option<FloorRecord>,
    /// The model predictions are made with.
    pub model: ModelRecord,
}

/// One window length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WindowRecord {
    /// Window length asked for, s.
    pub window_s: f64,
    /// Window length taken, a whole number of samples, s.
    pub exact_s: f64,
    /// Windows.
    pub n: u64,
    /// Standard deviation of the means, n − 1, deg/h.
    pub observed: f64,
    /// √E\[s²\] of the model for this record length, deg/h.
    pub predicted: Option<f64>,
    /// 95 % interval of the prediction, deg/h.
    pub predicted_interval: Option<Interval>,
    /// Observed over predicted.
    pub ratio: Option<f64>,
    /// Its 95 % interval.
    pub ratio_interval: Option<Interval>,
    /// Whether observed and predicted agree within the interval of their ratio.
    pub agreement: Option<Agreement>,
    /// What each part of the model has in E\[s²\], the largest first.
    pub shares: Vec<ShareRecord>,
}

/// One part of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShareRecord {
    /// `angle_random_walk`, `flicker`, `rate_random_walk`, `quantization`, `rate_ramp`, `markov`, `quasi_periodic`,
    /// `line`.
    pub part: String,
    /// Which of several of a kind, from 0.
    pub index: usize,
    /// Share of E\[s²\], 0 to 1.
    pub share: f64,
    /// What it alone would give, deg/h.
    pub deviation_deg_h: f64,
}

/// The octave identity s²·(n − 1)/n = ½ Σ σ²(2^j τ) over disjoint pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OctavesRecord {
    /// Windows used: the largest power of two.
    pub windows: u64,
    /// Windows that the record has.
    pub of: u64,
    /// Standard deviation of the windows used, deg/h.
    pub sigma: f64,
    /// The octaves, from the shortest averaging time up.
    pub octaves: Vec<OctaveRecord>,
}

/// One octave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OctaveRecord {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Allan deviation of disjoint pairs, deg/h.
    pub deviation_deg_h: f64,
    /// Share in the variance of the means.
    pub share: f64,
    /// Share that the model expects.
    pub expected_share: Option<f64>,
}

/// The minimum of the overlapping Allan deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MinimumRecord {
    /// Smallest deviation, deg/h.
    pub deviation_deg_h: f64,
    /// Where, s.
    pub tau_s: f64,
    /// Degrees of freedom there.
    pub edf: f64,
    /// Longest averaging time read, s: the last octave up to a fifth of the record.
    pub largest_tau_s: f64,
    /// σ of 100-s means over it.
    pub ratio: Option<f64>,
    /// 5, 50 and 95 % quantiles of that ratio for a unit with angle random walk alone, same record length and rule.
    pub null_ratio: Option<[f64; 3]>,
}

/// From where on a figure would measure bias instability.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FloorRecord {
    /// B taken, deg/h: the value found, or the upper limit.
    pub b_deg_h: f64,
    /// True when B is an upper limit: times are then the least that could be.
    pub is_limit: bool,
    /// Averaging time at which floor and angle random walk are equal, s.
    pub crossover_s: f64,
    /// Record length from which B is known to 20 % (Cramér-Rao bound), h; absent beyond 20 000 h.
    pub identifiable_h: Option<f64>,
}

/// A model with the covariance of its parameters.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelRecord {
    /// Fitted parameters.
    pub parameters: Vec<ParameterRecord>,
    /// Their covariance, in their order and units.
    pub covariance: Vec<Vec<f64>>,
    /// Misfit per degree of freedom of the spectrum about the model.
    #[serde(default)]
    pub misfit: Option<f64>,
    /// Probability of a larger one if the model is right.
    #[serde(default)]
    pub misfit_probability: Option<f64>,
    /// Coherent lines.
    pub lines: Vec<CoherentLine>,
}

/// A coherent line of a model; in JSON a pair.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "(f64, f64)", into = "(f64, f64)")]
pub struct CoherentLine {
    /// Amplitude, deg/h.
    pub amplitude_deg_h: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

impl From<(f64, f64)> for CoherentLine {
    fn from((amplitude_deg_h, frequency_hz): (f64, f64)) -> CoherentLine {
        CoherentLine { amplitude_deg_h, frequency_hz }
    }
}

impl From<CoherentLine> for (f64, f64) {
    fn from(line: CoherentLine) -> (f64, f64) {
        (line.amplitude_deg_h, line.frequency_hz)
    }
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterRecord {
    /// Id, as of the measurand where there is one.
    pub id: String,
    /// Which of several of a kind, from 0.
    pub index: usize,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: String,
}
