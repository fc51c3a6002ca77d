//! Tilts of the input axis from turns about the outer axis of a rate table.

use super::descriptor::{Measurand, Stimulus};
use super::evidence::TableEvidence;
use crate::estimate::Estimate;
use crate::rate_table::combine::spread;
use crate::rate_table::design::Extra;

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

/// Change of the tilt about the first reference axis with temperature.
pub static MISALIGNMENT_X_TEMPERATURE_SENSITIVITY: Measurand = Measurand::of_steps(
    "misalignment_x_temperature_sensitivity",
    "mrad/degC",
    "change of the tilt about the first reference axis with temperature",
    Stimulus::OuterTurns,
    |m, e| change(m, e, 0),
)
.extras(&[Extra::TiltOverTemperature])
.signed();

/// Change of the tilt about the second reference axis with temperature.
pub static MISALIGNMENT_Y_TEMPERATURE_SENSITIVITY: Measurand = Measurand::of_steps(
    "misalignment_y_temperature_sensitivity",
    "mrad/degC",
    "change of the tilt about the second reference axis with temperature",
    Stimulus::OuterTurns,
    |m, e| change(m, e, 1),
)
.extras(&[Extra::TiltOverTemperature])
.signed();

const METHOD: &str = "outer_axis_turns";

fn change(m: &Measurand, e: &TableEvidence<'_>, axis: usize) -> Vec<Estimate> {
    let Some(change) = e.alignment.as_ref().and_then(|a| a.changes.get(axis)) else { return vec![] };
    vec![match change {
        Ok(change) => m.measured(&e.channel, 1e3 * change.value, spread(change, 1e3, &[]), METHOD),
        Err(why) => m.not_identifiable(&e.channel, None, METHOD).note(why.clone()),
    }]
}

fn tilt(m: &Measurand, e: &TableEvidence<'_>, axis: usize) -> Vec<Estimate> {
    let Some(tilt) = e.alignment.as_ref().and_then(|a| a.tilts.get(axis)) else { return vec![] };
    vec![match tilt {
        Ok(tilt) => {
            let calibration = [e.setup.of_table_rate(1e3 * tilt.value)];
            m.measured(&e.channel, 1e3 * tilt.value, spread(tilt, 1e3, &calibration), METHOD)
                .components(&calibration)
        }
        Err(why) => m.not_identifiable(&e.channel, None, METHOD).note(why.clone()),
    }]
}

#[cfg(test)]
mod tests {
    use super::super::test_evidence::{combination, near, notes, on_table, shows, student, withholds};
    use super::*;
    use crate::message::note;
    use crate::rate_table::Setup;
    use crate::rate_table::alignment::Alignment;
    use crate::rate_table::steps::Steps;

    #[test]
    fn tilts_are_in_mrad_with_the_calibration_of_the_table() {
        let (setup, steps) = (Setup { rate_uncertainty: 4e-3, ..Setup::default() }, Steps::default());
        let tilts = [Ok(combination(-2e-3, 6e-6)), Err(note!("known.no_outer_turns"))];
        let alignment = Some(Alignment { channel: "g".into(), changes: tilts.clone(), tilts, factor: None });
        let e = TableEvidence { alignment, ..on_table(&setup, &steps, None) };
        let rows = MISALIGNMENT_X.evaluate_steps(&e);
        shows(&rows[0], -2.0, "outer_axis_turns");
        // 4 parts in a thousand of 2 mrad beside 0.006 mrad.
        near(student(&rows[0]).0, 0.01);
        let rows = MISALIGNMENT_Y.evaluate_steps(&e);
        withholds(&rows[0], None, "outer_axis_turns");
        assert_eq!(notes(&rows[0]), ["known.no_outer_turns"]);
        assert!(MISALIGNMENT_X.evaluate_steps(&on_table(&setup, &steps, None)).is_empty());
        let rows = MISALIGNMENT_X_TEMPERATURE_SENSITIVITY.evaluate_steps(&e);
        shows(&rows[0], -2.0, "outer_axis_turns");
        near(student(&rows[0]).0, 0.006);
        let rows = MISALIGNMENT_Y_TEMPERATURE_SENSITIVITY.evaluate_steps(&e);
        withholds(&rows[0], None, "outer_axis_turns");
    }
}
