//! What conditions are told about a gyro channel.

/// A gyro channel in the evaluated window.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GyroFact {
    /// Channel.
    pub channel: String,
    /// Mean, deg/h.
    pub mean_deg_h: f64,
    /// Standard uncertainty of the mean, deg/h.
    pub mean_uncertainty_deg_h: f64,
    /// Earth rate along the input axis with its standard uncertainty, deg/h, where the site is declared.
    pub earth_deg_h: Option<(f64, f64)>,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Overlapping Allan deviation at octaves: averaging time, s, and deviation, deg/h.
    pub deviations: Vec<(f64, f64)>,
    /// Longest stretch without a gap, s.
    pub longest_stretch_s: f64,
    /// Angle random walk that was identified, deg/sqrt(h).
    pub angle_random_walk: Option<f64>,
    /// Step of the output, deg/h, where the values lie on a lattice.
    pub quantization_step_deg_h: Option<f64>,
    /// How far the bias moves over temperature or while it warms up, deg/h, in a test of that.
    pub moves_deg_h: Option<f64>,
    /// The largest step of the mean that noise does not explain.
    pub bias_step: Option<BiasStep>,
    /// A change of the noise between parts of the record.
    pub noise_change: Option<NoiseChange>,
    /// How the values are spread about the means of short blocks, where they are white enough to tell.
    pub tails: Option<TailShape>,
}

/// How values are spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TailShape {
    /// Values.
    pub samples: u64,
    /// Fourth moment over the squared variance, less 3.
    pub excess_kurtosis: f64,
    /// How much shorter lines and rounding make the tails: the same, positive.
    pub explained: f64,
    /// Standard deviations beyond which values are counted.
    pub sigma: f64,
    /// Values beyond.
    pub beyond: u64,
    /// How many of them normal noise has.
    pub expected_beyond: f64,
}

/// A step of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasStep {
    /// Time from the start of the recording, s.
    pub time_s: f64,
    /// Size, deg/h.
    pub size_deg_h: f64,
    /// Size in units of what differences over the same time scatter by.
    pub significance: f64,
}

/// A change of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseChange {
    /// Largest over smallest scatter of neighbouring samples among the parts.
    pub ratio: f64,
    /// Middle of the part with the largest, s from the start of the recording.
    pub loudest_s: f64,
    /// Middle of the part with the smallest, s from the start of the recording.
    pub quietest_s: f64,
}

/// A column that a channel is read from.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnFact {
    /// Channel.
    pub channel: String,
    /// Name in the file.
    pub name: String,
    /// Unit that the file format declares.
    pub unit: Option<String>,
}
