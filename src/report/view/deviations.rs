//! The Allan family as a table: one line for each averaging time, one column for each estimator.

use crate::record::{DeviationRecord, RunRecord};
use crate::report::number::{Rounding, limit_digits};
use crate::report::translator::Translator;
use serde::Serialize;

/// The table of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Deviations {
    /// Channel.
    pub channel: String,
    /// Names of the estimators.
    pub estimators: Vec<String>,
    /// Lines by averaging time.
    pub rows: Vec<DeviationRow>,
}

/// One averaging time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviationRow {
    /// Averaging time, s.
    pub tau: String,
    /// One cell for each estimator; empty where it has no value.
    pub cells: Vec<DeviationCell>,
}

/// One deviation with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviationCell {
    /// Value.
    pub value: String,
    /// Interval.
    pub interval: String,
}

pub(super) fn deviations(record: &RunRecord, words: Translator) -> Vec<Deviations> {
    let mut tables: Vec<(&str, Vec<&DeviationRecord>)> = vec![];
    for point in &record.deviations {
        match tables.iter_mut().find(|(channel, _)| *channel == point.channel) {
            Some((_, points)) => points.push(point),
            None => tables.push((&point.channel, vec![point])),
        }
    }
    tables.into_iter().map(|(channel, points)| table(channel, &points, words)).collect()
}

fn table(channel: &str, points: &[&DeviationRecord], words: Translator) -> Deviations {
    let mut estimators: Vec<&str> = vec![];
    let mut taus: Vec<f64> = vec![];
    for p in points {
        if !estimators.contains(&p.estimator.as_str()) {
            estimators.push(&p.estimator);
        }
        if !taus.contains(&p.tau_s) {
            taus.push(p.tau_s);
        }
    }
    taus.sort_by(f64::total_cmp);
    let cell = |tau: f64, estimator: &str| {
        let found = points.iter().find(|p| p.tau_s == tau && p.estimator == estimator);
        found.map_or_else(
            || DeviationCell { value: String::new(), interval: String::new() },
            |p| printed(p, words),
        )
    };
    let rows = taus
        .into_iter()
        .map(|tau| DeviationRow {
            tau: limit_digits(tau, 6, words.lang),
            cells: estimators.iter().map(|e| cell(tau, e)).collect(),
        })
        .collect();
    Deviations {
        channel: channel.to_owned(),
        estimators: estimators.into_iter().map(|e| words.t(estimator(e))).collect(),
        rows,
    }
}

/// Key of the name of an estimator.
fn estimator(id: &str) -> &'static str {
    match id {
        "mdev" => "goodness.estimator.mdev",
        "hdev" => "goodness.estimator.hdev",
        "totdev" => "goodness.estimator.totdev",
        _ => "goodness.estimator.oadev",
    }
}

fn printed(p: &DeviationRecord, words: Translator) -> DeviationCell {
    let range = p.low_deg_h.zip(p.high_deg_h);
    // The lower side of the interval sets the digits: the upper one of few degrees of freedom would leave none.
    let value = p.deviation_deg_h;
    let rounding = Rounding::of(value, range.map(|(low, _)| (low, 2.0 * value - low)));
    let show = |v: f64| rounding.show(v, words.lang);
    DeviationCell {
        value: show(value),
        interval: range.map_or_else(String::new, |(low, high)| {
            words.with("report.interval", &[("low", &show(low)), ("high", &show(high))])
        }),
    }
}
