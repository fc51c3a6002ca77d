//! Entrance: identification by the method that the options ask for.

use super::joint::identify_joint;
use super::options::Options;
use super::result::Identification;
use super::standard::identify_standard;
use crate::noise::evidence::Evidence;

/// Identifies the noise of a channel: which terms are claimed, each with its interval or its upper limit, the models
/// they make, and how well those fit.
///
/// `channel` is copied into the estimates. An evidence with too few bands gives an identification that claims nothing and
/// has no limits.
///
/// ```
/// use sagnac_noise::noise::data::NoiseType;
/// use sagnac_noise::noise::evidence::Evidence;
/// use sagnac_noise::noise::identification::{Options, identify};
/// use sagnac_noise::noise::model::NoiseModel;
///
/// // Ten hours at 1 Hz: what a record of 0.002 deg/√h is expected to give.
/// let model = NoiseModel { n: 0.002, ..NoiseModel::default() };
/// let found = identify("rate", &Evidence::expected(&model, 36_000, 1.0), &Options::default());
///
/// assert_eq!(found.claimed, [NoiseType::AngleRandomWalk]);
/// let n = found.angle_random_walk.value.unwrap_or(f64::NAN);
/// assert!((n / 0.002 - 1.0).abs() < 1e-3);
/// assert!(found.bias_instability.upper_limit.is_some());
/// ```
pub fn identify(channel: &str, evidence: &Evidence, options: &Options) -> Identification {
    run(channel, evidence, options, None, true)
}

/// As [`identify`], without intervals and limits, which take most of the time: what is claimed, the models, the misfit.
pub fn describe(channel: &str, evidence: &Evidence, options: &Options) -> Identification {
    run(channel, evidence, options, None, false)
}

/// Intervals and limits for what [`describe`] found in the same evidence with the same options; equal to [`identify`],
/// and faster, since the search has been made.
pub fn complete(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    described: &Identification,
) -> Identification {
    run(channel, evidence, options, Some(described), true)
}

fn run(
    channel: &str,
    evidence: &Evidence,
    options: &Options,
    described: Option<&Identification>,
    intervals: bool,
) -> Identification {
    if options.processes {
        let searched = described.and_then(|d| d.searched.as_ref());
        identify_joint(channel, evidence, options, searched, intervals)
    } else {
        identify_standard(channel, evidence, &options.standard, intervals)
    }
}
