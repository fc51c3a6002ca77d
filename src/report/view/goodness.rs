//! How well the noise models fit, view by view.

use super::common::probability;
use crate::record::RunRecord;
use crate::report::translator::Translator;
use serde::Serialize;

/// One view of the residual of one channel, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Goodness {
    /// Channel.
    pub channel: String,
    /// The view, in words.
    pub view: String,
    /// True when the model fails here.
    pub departs: bool,
    /// Probability of a larger departure if the model is right.
    pub probability: String,
    /// Where it fails and by how much, or that it fits.
    pub message: String,
}

pub(super) fn goodness(record: &RunRecord, words: Translator) -> Vec<Goodness> {
    record
        .goodness_of_fit
        .iter()
        .map(|g| Goodness {
            channel: g.channel.clone(),
            view: words.t(&format!("goodness.view.{}", g.view.id())),
            departs: g.departs,
            probability: probability(g.p_value, words),
            message: words.say(&g.message),
        })
        .collect()
}
