//! How well a noise model fits its record.

use super::Message;
use crate::noise::residual::View;
use serde::{Deserialize, Serialize};

/// One view of the residual of one channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GoodnessOfFitRecord {
    /// Channel.
    pub channel: String,
    /// View of the residual.
    pub view: View,
    /// Largest departure as a normal score; the excess kurtosis for `amplitude`.
    pub statistic: f64,
    /// Probability of a larger departure anywhere in this view if the model is right.
    pub p_value: f64,
    /// Whether the model fails here: Holm's procedure over the views of the channel at 1 %.
    pub departs: bool,
    /// Where the departure is largest: Hz, s, s, or standard deviations, by view.
    pub from: f64,
    /// End of that interval; absent where it is open.
    pub to: Option<f64>,
    /// Its size: power over model less 1; autocorrelation; deviation over model less 1; values beyond four standard
    /// deviations over expected ones less 1.
    pub excess: f64,
    /// The same in words.
    pub message: Message,
}
