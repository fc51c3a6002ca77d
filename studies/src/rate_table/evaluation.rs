//! Simulated tests on a table evaluated as a run does, without the acceptance around it.

use crate::bench::rate_table::{RateTable, Recorded};
use sagnac::rate_table::blocks::{Blocks, Collector};
use sagnac::rate_table::{Setup, TableRun};
use sagnac::recording::{Channel, ColumnRef, Role, SampleBlock, Sink};
use sagnac::units::Unit;

/// Steps of a recording of channels at an interval in s, each channel by its role.
pub fn run_of(channels: &[(Role, Vec<f64>)], dt: f64, setup: &Setup) -> TableRun {
    let named: Vec<(&str, Role, Vec<f64>)> = channels.iter().map(|(r, v)| (r.id(), *r, v.clone())).collect();
    TableRun::new(blocks_of(named, dt), setup)
}

/// Channels by their ids, in the units of the analysis.
pub fn channels(named: &[(&str, Role)]) -> Vec<Channel> {
    named
        .iter()
        .map(|(id, role)| Channel {
            id: (*id).into(),
            column: ColumnRef::Name((*id).into()),
            role: *role,
            unit: role.internal_unit().and_then(|u| Unit::parse(u).ok()).expect("a unit"),
            scale: 1.0,
        })
        .collect()
}

/// Blocks of a recording of named channels at an interval in s.
pub fn blocks_of(recorded: Vec<(&str, Role, Vec<f64>)>, dt: f64) -> Blocks {
    let list = channels(&recorded.iter().map(|(id, role, _)| (*id, *role)).collect::<Vec<_>>());
    let values: Vec<Vec<f64>> = recorded.into_iter().map(|c| c.2).collect();
    let mut collector = Collector::new(&list, dt, None);
    collector.push(&SampleBlock {
        first_index: 0,
        first_row: 1,
        time_s: 0.0,
        continues: false,
        values: &values,
    });
    collector.finish(dt)
}

/// Steps of a recording of a bench, with the setup of the test.
pub fn on_bench(bench: &RateTable, recorded: &Recorded) -> (TableRun, Setup) {
    let setup = Setup {
        settling_s: 4.0,
        minimum_step_s: 20.0,
        by_angle: true,
        angle_uncertainty_arcsec: bench.reading_arcsec,
        full_scale_deg_h: Some(bench.full_scale()),
        of_rate_from_deg_h: Some(18_000.0),
        ..Setup::default()
    };
    let channels = [
        (Role::Rate, recorded.rate_deg_h.clone()),
        (Role::TableRate, recorded.table_rate_deg_h.clone()),
        (Role::TableAngle, recorded.table_angle_arcsec.clone()),
        (Role::Temperature, recorded.temperature.clone()),
    ];
    (run_of(&channels, 1.0 / bench.hz, &setup), setup)
}
