//! Sizes of effects on the mean that would have been noticed.

use super::gate::Gate;
use super::null_model::NullModel;
use super::places::{At, Placed, summary};
use super::solve;
use crate::effect::{Effect, MeanModel, Param, Sizing, Values, number};
use crate::mismatch::noticeable_record::{Basis, NoticeableSize, WhyNot};
use std::collections::BTreeMap;

/// Of each column that can drive an effect, or of the effect.
pub(super) fn sizes(
    effect: &'static dyn Effect,
    model: &'static dyn MeanModel,
    null_model: &NullModel<'_>,
    gate: &Gate,
) -> Result<Vec<NoticeableSize>, WhyNot> {
    let sizings = model.sizings(&null_model.spectral().drivers);
    if sizings.is_empty() {
        return Err(WhyNot::NoSingleSize);
    }
    let found: Vec<NoticeableSize> =
        sizings.iter().filter_map(|s| of_sizing(effect, model, s, null_model, gate)).collect();
    if found.is_empty() { Err(WhyNot::NeverLargeEnough) } else { Ok(found) }
}

fn of_sizing(
    effect: &'static dyn Effect,
    model: &'static dyn MeanModel,
    sizing: &Sizing,
    null_model: &NullModel<'_>,
    gate: &Gate,
) -> Option<NoticeableSize> {
    let placed = sizing.places.iter().filter_map(|place| {
        let (size, rms_deg_h) = at_place(model, sizing, place, null_model, gate)?;
        Some(Placed { size, rms_deg_h: Some(rms_deg_h), at: told(effect.params(), place) })
    });
    let found = summary(placed.collect(), false)?;
    let Param { name, unit, corrects_claim, .. } = *sizing.parameter;
    Some(NoticeableSize {
        kind: effect.kind().to_owned(),
        column: sizing.column.map(|c| c.name().to_owned()),
        parameter: name.to_owned(),
        unit: unit.to_owned(),
        size: found.typical.size,
        claimed: corrects_claim.then_some(sizing.claimed),
        below: false,
        rms_deg_h: found.typical.rms_deg_h,
        at: found.typical.at,
        worst: found.worst,
        basis: Basis::Course,
    })
}

/// The size at one place, and what it adds, rms over the record, deg/h.
fn at_place(
    model: &dyn MeanModel,
    sizing: &Sizing,
    place: &Values,
    null_model: &NullModel<'_>,
    gate: &Gate,
) -> Option<(f64, f64)> {
    let drivers = &null_model.spectral().drivers;
    let course = |size: f64| model.sized_course(sizing, place, size, drivers);
    let spread = null_model.of_course(&course(sizing.begin)?, model).spread;
    let needed = gate.needed(sizing.parameters, sizing.trials, spread);
    let gain = |size: f64| course(size).map_or(f64::NAN, |c| null_model.of_course(&c, model).gain);
    let largest = sizing.parameter.upper - sizing.claimed;
    let size = solve::size(sizing.begin, largest, needed, gain)?;
    Some((size, deviation(&course(size)?)))
}

fn deviation(series: &[f64]) -> f64 {
    let n = series.len().max(1) as f64;
    let mean = series.iter().sum::<f64>() / n;
    (series.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// The reported parameters of a place.
fn told(params: &[Param], place: &Values) -> At {
    let reported = params.iter().filter(|p| p.reported);
    reported.filter_map(|p| Some((p.name.to_owned(), number(place, p.name)?))).collect::<BTreeMap<_, _>>()
}
