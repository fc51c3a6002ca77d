//! One unit over its tests, and stations over their units.

use super::charts::measured;
use super::selection::{Group, Selection, Tested};
use crate::lot::control_chart::Measured;
use crate::lot::drift::drift;
use crate::lot::station::{Difference, against_others};
use crate::record::{HistoryDrift, HistoryPoint, HistoryQuantity, HistoryStation};
use chrono::DateTime;
use std::collections::BTreeMap;

/// Days of a year.
pub(super) const YEAR_DAYS: f64 = 365.25;
const DAY_S: f64 = 86_400.0;

/// The drift of the unit in every quantity that two tests have.
pub(super) fn drifts(
    selection: &Selection<'_>,
    quantities: &[HistoryQuantity],
    common: f64,
) -> Vec<HistoryDrift> {
    let counted = Group::of(selection.all().filter(Tested::counts));
    let each = |quantity: &HistoryQuantity| one(selection, &counted, quantity, common);
    quantities.iter().filter_map(each).collect()
}

fn one(
    selection: &Selection<'_>,
    counted: &Group,
    quantity: &HistoryQuantity,
    common: f64,
) -> Option<HistoryDrift> {
    let all = selection.points(quantity, counted);
    // A value that does not say when it was measured tells nothing of a drift.
    let timed: Vec<(f64, &HistoryPoint)> =
        all.iter().filter_map(|p| Some((days(&p.evaluated_at)?, p))).collect();
    let (first, last) = (timed.first()?, timed.last()?);
    let times: Vec<f64> = timed.iter().map(|(t, _)| (t - first.0) / YEAR_DAYS).collect();
    let values: Vec<Measured> = timed.iter().map(|(_, p)| measured(p)).collect();
    let found = drift(&times, &values, common)?;
    Some(HistoryDrift {
        quantity: quantity.clone(),
        tests: timed.len(),
        from: first.1.evaluated_at.clone(),
        to: last.1.evaluated_at.clone(),
        change: found.change,
        change_half_width: found.change_half_width,
        common,
        per_year: found.slope.map(|s| s.value),
        per_year_half_width: found.slope.map(|s| s.half_width),
        steady_probability: found.steady_probability,
    })
}

/// Days since 1970 of a moment in RFC 3339.
pub(super) fn days(moment: &str) -> Option<f64> {
    let moment = DateTime::parse_from_rfc3339(moment).ok()?;
    Some(moment.timestamp() as f64 / DAY_S)
}

/// The stations of every quantity that several have.
pub(super) fn stations(selection: &Selection<'_>, quantities: &[HistoryQuantity]) -> Vec<HistoryStation> {
    let first = Group::of(selection.first_of_each());
    let each = |quantity: &HistoryQuantity| {
        let mut groups: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for point in selection.points(quantity, &first) {
            groups.entry(point.station).or_default().push(point.value);
        }
        if groups.len() < 2 {
            return vec![];
        }
        let (names, values): (Vec<String>, Vec<Vec<f64>>) = groups.into_iter().unzip();
        let differences = against_others(&values);
        let station =
            |((station, values), difference): ((String, &Vec<f64>), &Option<Difference>)| HistoryStation {
                quantity: quantity.clone(),
                station,
                units: values.len(),
                mean: values.iter().sum::<f64>() / values.len() as f64,
                difference: difference.map(|d| d.value),
                half_width: difference.map(|d| d.half_width),
                differs: difference.is_some_and(|d| d.is_shown()),
            };
        names.into_iter().zip(&values).zip(&differences).map(station).collect::<Vec<_>>()
    };
    quantities.iter().flat_map(each).collect()
}
