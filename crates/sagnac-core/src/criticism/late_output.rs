//! Whether the output had settled at the rates of the table before they were evaluated.

use crate::estimate::{Finding, Holds};
use crate::evidence::TableEvidence;
use crate::message::{Arg, note};
use crate::rate_table::late::Late;

/// Everything that rests on the means of steps.
const OF_STEPS: [&str; 15] = [
    "scale_factor",
    "scale_factor_error",
    "scale_factor_nonlinearity",
    "scale_factor_nonlinearity_of_rate",
    "scale_factor_residual",
    "scale_factor_asymmetry",
    "scale_factor_odd",
    "scale_factor_even",
    "scale_factor_repeatability",
    "scale_factor_hysteresis",
    "scale_factor_temperature_sensitivity",
    "scale_factor_bias",
    "sine_response",
    "dead_zone",
    "threshold",
];
/// Share of the change of rate over the relative standard uncertainty of the scale factor from which it matters.
const MATTERS_FROM: f64 = 0.5;
/// Relative standard uncertainty of a scale factor that counts at most: what is later than steps are long makes it large itself.
const MOST_UNCERTAINTY: f64 = 0.01;

/// Finds an output that follows the table late.
pub(super) fn examine(table: &TableEvidence<'_>) -> Vec<Finding> {
    let Some(Late { share, .. }) = Late::of(table.steps, table.gyro) else { return vec![] };
    let known = table.line.as_ref().map_or(0.0, |line| line.factor_uncertainty() / line.factor.abs());
    if share.value.abs() < MATTERS_FROM * known.min(MOST_UNCERTAINTY) {
        return vec![];
    }
    vec![Finding {
        measurands: OF_STEPS.to_vec(),
        holds: Holds::Nothing,
        found: note!(
            "criticism_found.late_output",
            share_ppm = Arg::figures(1e6 * share.value, 2),
            sigma = Arg::figures((share.value / share.standard).abs(), 2)
        ),
        advice: note!("criticism_advice.late_output", settling_s = Arg::figures(table.setup.settling_s, 2)),
    }]
}
