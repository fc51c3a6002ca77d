//! One file for each kind of recording, and what they share.

mod clocks;
mod fibre;
mod laser;
mod micro;
mod micro_temperature;

use sagnac::acceptance::{Outcome, Request, analysis, execute};
use sagnac::config::procedure::EffectiveLimits;
use sagnac::ingest::{Source, open};
use sagnac::noise::tau_grid::TauGrid;
use sagnac::record::UnitUnderTest;
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::units::Unit;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

fn channel(column: &str, role: Role, unit: &str) -> Channel {
    let column_ref = ColumnRef::Name(column.into());
    Channel { id: column.into(), column: column_ref, role, unit: Unit::parse(unit).unwrap(), scale: 1.0 }
}

/// A whole analysis: `time` names the column of stamps, else the sample rate holds.
pub fn analyse(
    file: &Path,
    time: Result<&str, f64>,
    rates: &[&str],
    unit: &str,
    taus: Option<&[f64]>,
) -> Outcome {
    let source = open(file).unwrap();
    let mut channels: Vec<Channel> = time.iter().map(|t| channel(t, Role::Time, "s")).collect();
    channels.extend(rates.iter().map(|r| channel(r, Role::Rate, unit)));
    let procedure = analysis::procedure(channels, time.err(), 0.0);
    let request = Request {
        kind: sagnac::record::RunKind::Analyze,
        procedure: &procedure,
        procedure_record: None,
        limits: &EffectiveLimits::default(),
        source: &source,
        use_stamps: time.is_ok(),
        unit: UnitUnderTest::default(),
        serial_of_recording: false,
        operator: None,
        station: None,
        now: chrono::DateTime::UNIX_EPOCH,
        taus: taus.map(|t| TauGrid::List(t.to_vec())),
        exact: false,
        bench_checks: None,
    };
    execute(&request, &mut |_, _| {}).unwrap()
}

/// σ(τ) of one estimator by averaging factor, from the table that is written for a channel.
pub fn curve(outcome: &Outcome, channel: &str, estimator: &str) -> BTreeMap<u64, f64> {
    let named = format!("sigma_tau_{channel}.csv");
    let (_, table) =
        outcome.tables.iter().find(|(name, _)| *name == named || name == "sigma_tau.csv").expect("a table");
    let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|f| f[0] == estimator).map(|f| (f[2].parse().unwrap(), f[5].parse().unwrap())).collect()
}

pub fn value(outcome: &Outcome, id: &str, channel: &str) -> f64 {
    let row = outcome.record.measurands.iter().find(|m| m.id == id && m.channel == channel).expect(id);
    row.value.unwrap_or_else(|| panic!("{id} of {channel} has no value"))
}

/// Asserts agreement within half a unit of the `digits`-th significant digit of the published number.
pub fn assert_digits(what: &str, ours: f64, published: f64, digits: i32) {
    let unit = 10f64.powi(published.abs().log10().floor() as i32 + 1 - digits);
    assert!((ours - published).abs() <= 0.5001 * unit, "{what}: {ours} against {published}");
}

/// Two columns of a file.
pub fn columns(file: &Path, names: &[&str]) -> Vec<Vec<f64>> {
    let source: Source = open(file).unwrap();
    let wanted: Vec<usize> =
        names.iter().map(|n| source.resolve(&ColumnRef::Name((*n).into())).unwrap()).collect();
    let mut out = vec![vec![]; names.len()];
    source
        .read(&wanted, &mut |block| {
            for (all, part) in out.iter_mut().zip(&block.columns) {
                all.extend_from_slice(part);
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    out
}

/// Rows of a small text table without quotes, by header.
pub fn table(file: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| header.iter().zip(line.split(',')).map(|(h, f)| ((*h).into(), f.into())).collect())
        .collect()
}
