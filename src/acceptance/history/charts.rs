//! Quantities over time, with control limits.

use super::selection::{Group, Selection, Tested};
use crate::estimate::{Limits, normal_quantile};
use crate::i18n::{Note, note};
use crate::lot::capability::{self, Capability};
use crate::lot::control_chart::{Chart, LEAST_VALUES, Measured, SETTLED_VALUES};
use crate::record::{
    HistoryCapability, HistoryChart, HistoryChartOf, HistoryControl, HistoryControlPoint, HistoryPoint,
    HistoryQuantity, Message,
};
use std::collections::BTreeMap;

/// The charts of some quantities: of the unit that was asked for or of the process, and of every bench that a reference unit
/// watches.
pub(super) fn charts(
    selection: &Selection<'_>,
    quantities: &[HistoryQuantity],
    of_unit: bool,
) -> Vec<HistoryChart> {
    let (of, group) = if of_unit {
        (HistoryChartOf::Unit, Group::of(selection.all().filter(Tested::counts)))
    } else {
        (HistoryChartOf::Process, Group::of(selection.first_of_each()))
    };
    let benches = if of_unit { vec![] } else { benches(selection) };
    let of_all = quantities.iter().filter_map(|q| chart(of, selection, &group, q));
    let of_bench =
        |q| benches.iter().filter_map(move |group| chart(HistoryChartOf::Bench, selection, group, q));
    of_all.chain(quantities.iter().flat_map(of_bench)).collect()
}

/// The results of each station and reference unit.
fn benches(selection: &Selection<'_>) -> Vec<Group> {
    let key = |t: &Tested<'_>| (t.attempt.entry.test.station.clone(), t.attempt.entry.unit.key());
    let mut benches: BTreeMap<(String, String), Vec<Tested<'_>>> = BTreeMap::new();
    for test in selection.references() {
        benches.entry(key(&test)).or_default().push(test);
    }
    benches.into_values().map(Group::of).collect()
}

/// A chart of results in the order of time; `None` of fewer than two values.
fn chart(
    of: HistoryChartOf,
    selection: &Selection<'_>,
    group: &Group,
    quantity: &HistoryQuantity,
) -> Option<HistoryChart> {
    let points = selection.points(quantity, group);
    let first = points.first().filter(|_| points.len() > 1)?;
    let mut notes: Vec<Note> = vec![];
    let limit = selection.limit(quantity, group).unwrap_or_else(|()| {
        notes.push("history.note.limits_differ".into());
        None
    });
    let measured: Vec<Measured> = points.iter().map(measured).collect();
    let chart = Chart::of(&measured);
    match &chart {
        None if points.len() < LEAST_VALUES => {
            notes.push(note!("history.note.few_values", n = points.len(), needed = LEAST_VALUES));
        }
        Some(_) if points.len() < SETTLED_VALUES => {
            notes.push(note!("history.note.unsettled", n = points.len(), needed = SETTLED_VALUES));
        }
        _ => {}
    }
    if points.iter().any(|p| p.interval.is_none()) {
        notes.push("history.note.no_interval".into());
    }
    let capability = (of == HistoryChartOf::Process).then(|| capable(&points, limit, &mut notes)).flatten();
    Some(HistoryChart {
        serial: (of != HistoryChartOf::Process).then(|| first.serial.clone()),
        station: (of == HistoryChartOf::Bench).then(|| first.station.clone()),
        of,
        quantity: quantity.clone(),
        limit,
        control: chart.map(control),
        capability,
        notes: notes.into_iter().map(Message::from).collect(),
        points,
    })
}

/// A value with the standard uncertainty that its interval tells.
pub(super) fn measured(point: &HistoryPoint) -> Measured {
    let standard = point.interval.filter(|i| i.coverage > 0.0 && i.coverage < 1.0 && i.high >= i.low);
    let standard = standard.map(|i| (i.high - i.low) / (2.0 * normal_quantile(0.5 + 0.5 * i.coverage)));
    Measured { value: point.value, standard: standard.unwrap_or(0.0) }
}

fn control(chart: Chart) -> HistoryControl {
    HistoryControl {
        center: chart.center,
        observed: chart.observed,
        process: chart.process,
        range_limit: chart.range_limit(),
        in_control: chart.is_in_control(),
        points: chart
            .points
            .into_iter()
            .map(|p| HistoryControlPoint {
                reach: p.reach,
                range: p.range,
                ewma: p.ewma,
                ewma_reach: p.ewma_reach,
                broken: p.broken.iter().map(|r| r.id().to_owned()).collect(),
                ewma_beyond: p.ewma_beyond,
            })
            .collect(),
    }
}

/// The capability of a process within its limits.
fn capable(
    points: &[HistoryPoint],
    limits: Option<Limits>,
    notes: &mut Vec<Note>,
) -> Option<HistoryCapability> {
    let limits = limits?;
    if points.len() < capability::LEAST_VALUES {
        let note = note!("history.note.no_capability", n = points.len());
        notes.push(note.with("needed", capability::LEAST_VALUES));
        return None;
    }
    let values: Vec<f64> = points.iter().map(|p| p.value).collect();
    let found = Capability::of(&values, limits)?;
    Some(HistoryCapability {
        units: found.values,
        mean: found.mean,
        deviation: found.deviation,
        cp: found.cp.map(|i| i.value),
        cp_at_least: found.cp.map(|i| i.at_least),
        cpk: found.cpk.value,
        cpk_at_least: found.cpk.at_least,
    })
}
