//! What the steps of a rate table show of every gyro channel: the analyses that the measurands of a procedure need.

use crate::config::procedure::Procedure;
use crate::config::procedure::scale_factor_unit::scale_factor_unit;
use crate::measurand::{Earth, Stimulus, TableEvidence, table_extras};
use crate::noise::static_bias::EARTH_RATE_DEG_H;
use crate::rate_table::design::Extra;
use crate::rate_table::{
    Setup, TableRun, alignment, dead_zone, overload, scale_factor, scale_over_temperature, sine,
};

/// True where a measurand of the procedure needs this stimulus.
pub(super) fn wants(procedure: &Procedure, stimulus: Stimulus) -> bool {
    let needs = |s: crate::measurand::OfSteps| s.stimulus == stimulus;
    procedure.measurands.iter().filter_map(|m| m.measurand.by_steps()).any(needs)
}

/// Evaluates every gyro channel.
pub(super) fn evaluate<'a>(
    procedure: &Procedure,
    run: &'a TableRun,
    setup: &'a Setup,
) -> Vec<TableEvidence<'a>> {
    let extras = table_extras(&|m| procedure.measures(m.id, None));
    let small_rates = wants(procedure, Stimulus::SmallRates);
    let beyond_range = wants(procedure, Stimulus::Overload);
    let soaks = wants(procedure, Stimulus::Soaks);
    let outer_turns = wants(procedure, Stimulus::OuterTurns);
    let tilts_change = extras.contains(&Extra::TiltOverTemperature);
    let site = procedure.site.as_ref();
    let vertical = site.map_or(0.0, |s| EARTH_RATE_DEG_H * s.latitude_deg.to_radians().sin());
    let one = |(gyro, channel): (usize, &String)| {
        let line = scale_factor::evaluate(run, gyro, setup, &extras);
        let response = line.as_ref().map(|l| &l.response).filter(|_| small_rates);
        let earth = site.map(|s| s.earth_rate_along(channel));
        let squareness = setup.alignment_uncertainty_rad;
        TableEvidence {
            as_recorded: scale_factor_unit(procedure, channel),
            earth: earth.map(|e| Earth { rate_deg_h: e.value, uncertainty_deg_h: e.uncertainty }),
            sine: setup.sine.then(|| sine::fit(&run.steps, gyro)).flatten(),
            dead_zone: response.and_then(|r| dead_zone::evaluate(&run.steps, gyro, r, channel, setup)),
            alignment: outer_turns
                .then(|| alignment::evaluate(&run.steps, channel, gyro, vertical, squareness, tilts_change)),
            overload: line
                .as_ref()
                .filter(|_| beyond_range)
                .and_then(|line| overload::evaluate(run, gyro, line, setup)),
            over_temperature: soaks.then(|| scale_over_temperature::evaluate(run, gyro, setup)),
            line,
            ..TableEvidence::new(gyro, channel, setup, &run.steps)
        }
    };
    run.blocks.gyros.iter().enumerate().map(one).collect()
}
