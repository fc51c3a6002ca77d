//! Whether the bias had settled after each change of level, and whether the plain means of the intervals say the same as the
//! model of the noise.

use crate::estimate::{Finding, Holds};
use crate::evidence::ComparisonEvidence;
use crate::influence::response::{ByMeans, Response};
use crate::message::{Arg, Note, note};

/// Everything that rests on the change of the output between levels.
const OF_LEVELS: [&str; 10] = [
    "magnetic_sensitivity",
    "supply_sensitivity",
    "vibration_sensitivity",
    "vibration_rectification_in_band",
    "influence_sensitivity",
    "influence_sensitivity_quadratic",
    "bias_shift",
    "scale_factor_influence_sensitivity",
    "scale_factor_influence_sensitivity_quadratic",
    "scale_factor_shift",
];

fn finding(found: Note, advice: Note) -> Vec<Finding> {
    vec![Finding { measurands: OF_LEVELS.to_vec(), holds: Holds::Nothing, found, advice }]
}

pub(super) fn examine(compared: &ComparisonEvidence<'_>) -> Vec<Finding> {
    let bias = compared.bias;
    if let Some(moves) = bias.moves_before {
        return finding(
            note!(
                "criticism_found.moves_before",
                time = Arg::figures(moves.time_s, 2),
                chance = Arg::figures(moves.by_chance, 1)
            ),
            note!("criticism_advice.slow_part_removed"),
        );
    }
    if let Some(response) = bias.response.as_ref().filter(|r| r.goes_on()) {
        return finding(
            said("criticism_found.still_responding", response),
            note!("criticism_advice.still_responding", wait = Arg::figures(response.waiting_s(), 2)),
        );
    }
    let contradiction = bias.by_means.iter().find(|b| bias.response.is_none() && b.contradicts());
    contradiction.map_or(vec![], |b| {
        finding(differ("criticism_found.interval_means", b), note!("criticism_advice.interval_means"))
    })
}

/// A sentence on a response with its numbers.
fn said(key: &'static str, response: &Response) -> Note {
    Note::new(key)
        .with("time_constant", Arg::figures(response.time_constant_s, 2))
        .with("percent", Arg::figures(100.0 * response.remaining, 2))
}

/// A sentence on two estimates that differ.
fn differ(key: &'static str, both: &ByMeans) -> Note {
    Note::new(key)
        .with("means", Arg::figures(both.means.value, 3))
        .with("model", Arg::figures(both.model.value, 3))
}
