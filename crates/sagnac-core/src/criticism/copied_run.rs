//! Whether the runs of a series are runs of their own.

use crate::estimate::{Finding, Holds};
use crate::influence::repeatability::Repeatability;
use crate::message::{Arg, Note, note};

/// Finds a run that is another one saved again: it makes the scatter of the runs too small.
pub(super) fn examine(series: &Repeatability) -> Vec<Finding> {
    let Some(copied) = series.copied else { return vec![] };
    let key = match (copied.backwards, copied.correlation < 0.0) {
        (false, false) => "criticism_found.copied",
        (true, false) => "criticism_found.copied_backwards",
        (false, true) => "criticism_found.copied_inverted",
        (true, true) => "criticism_found.copied_backwards_inverted",
    };
    vec![Finding {
        measurands: vec![
            "bias_repeatability",
            "bias_repeatability_peak_to_peak",
            "bias_repeatability_trend",
            "bias_repeatability_temperature",
        ],
        holds: Holds::Nothing,
        found: Note::new(key)
            .with("first", copied.runs.0 + 1)
            .with("second", copied.runs.1 + 1)
            .with("correlation", Arg::figures(copied.correlation.abs(), 2)),
        advice: note!("criticism_advice.copied_run"),
    }]
}
