//! Tilts of the input axis from turns about the outer axis of a rate table.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::Estimate;
use crate::rate_table::combine::spread;

/// Tilt about the first reference axis.
pub static MISALIGNMENT_X: Measurand = Measurand::of_steps(
    "misalignment_x",
    "mrad",
    "tilt of the input axis about the first reference axis",
    Stimulus::OuterTurns,
    |m, e| tilt(m, e, 0),
)
.signed();

/// Tilt about the second reference axis.
pub static MISALIGNMENT_Y: Measurand = Measurand::of_steps(
    "misalignment_y",
    "mrad",
    "tilt of the input axis about the second reference axis",
    Stimulus::OuterTurns,
    |m, e| tilt(m, e, 1),
)
.signed();

fn tilt(m: &Measurand, e: &TableEvidence<'_>, axis: usize) -> Vec<Estimate> {
    const METHOD: &str = "outer_axis_turns";
    let Some(tilt) = e.alignment.as_ref().and_then(|a| a.tilts.get(axis)) else { return vec![] };
    vec![match tilt {
        Ok(tilt) => {
            let calibration = 1e3 * e.setup.rate_uncertainty * tilt.value.abs();
            m.measured(&e.channel, 1e3 * tilt.value, spread(tilt, 1e3, &[calibration]), METHOD)
        }
        Err(why) => m.not_identifiable(&e.channel, None, METHOD).note(why.clone()),
    }]
}
