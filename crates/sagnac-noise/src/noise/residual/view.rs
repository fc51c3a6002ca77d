//! The views of a residual, and what each finds.

use serde::{Deserialize, Serialize};

/// A way to look at a residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum View {
    /// Power by frequency.
    Frequency,
    /// Autocorrelation by lag.
    Lag,
    /// Allan variance by averaging time.
    AveragingTime,
    /// Distribution of the values.
    Amplitude,
    /// Jumps of the level.
    Jump,
}

impl View {
    /// Every view, in the order of reports.
    pub const ALL: [View; 5] = [View::Frequency, View::Lag, View::AveragingTime, View::Amplitude, View::Jump];

    /// Id in results.
    pub fn id(self) -> &'static str {
        match self {
            View::Frequency => "frequency",
            View::Lag => "lag",
            View::AveragingTime => "averaging_time",
            View::Amplitude => "amplitude",
            View::Jump => "jump",
        }
    }
}

/// Where a record departs most from its model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Begin: Hz, s, s, standard deviations, or s since the record began, by view.
    pub from: f64,
    /// End, same unit.
    pub to: f64,
    /// Size: power over model less 1; autocorrelation; deviation over model less 1; values beyond four standard
    /// deviations over expected ones less 1; deg/h.
    pub excess: f64,
}

/// One view judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// The view.
    pub view: View,
    /// Largest departure as a normal score; the excess kurtosis for amplitudes.
    pub statistic: f64,
    /// Probability of a larger one anywhere in this view if the model is right.
    pub p_value: f64,
    /// Place and size of that departure.
    pub departure: Departure,
}
