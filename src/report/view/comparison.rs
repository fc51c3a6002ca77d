//! Russian and Allan values of the same record, side by side, each with its convention.

use super::{Words, rows};
use crate::record::{MeasurandRecord, RunRecord};
use crate::report::number::{bound, limit_digits};
use serde::Serialize;

/// The comparison for one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Channel.
    pub channel: String,
    /// Lines of the comparison: one Russian value, one Allan value.
    pub pairs: Vec<Pair>,
    /// Ratios and predictions.
    pub ratios: Vec<Side>,
}

/// One line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// Value of the Russian practice.
    pub russian: Option<Side>,
    /// Value of the Allan analysis.
    pub allan: Option<Side>,
}

/// One value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Side {
    /// Name.
    pub name: String,
    /// What the name stands for.
    pub convention: String,
    /// Value.
    pub value: String,
    /// Interval.
    pub interval: String,
    /// Unit.
    pub unit: String,
}

/// What stands beside what.
const PAIRS: &[(&str, &str)] = &[
    ("russian_drift_100s", "bias_instability"),
    ("russian_drift_100s_3sigma", "bias_instability_minimum"),
    ("russian_drift_100s_predicted", "bias_instability_minimum_scaled"),
    ("russian_arw_10s", "angle_random_walk"),
    ("russian_sigma_10s", ""),
];

const RATIOS: &[&str] = &["ratio_russian_to_allan_bias", "ratio_russian_to_allan_arw"];

/// The comparisons, one for each channel that has a Russian value.
pub fn comparisons(record: &RunRecord, words: Words) -> Vec<Comparison> {
    let mut channels: Vec<&str> = vec![];
    for m in record.measurands.iter().filter(|m| m.id.starts_with("russian_")) {
        if !channels.contains(&m.channel.as_str()) {
            channels.push(&m.channel);
        }
    }
    channels
        .into_iter()
        .map(|channel| {
            let find = |id: &str| {
                record.measurands.iter().find(|m| m.channel == channel && m.id == id).map(|m| side(m, words))
            };
            Comparison {
                channel: channel.to_owned(),
                pairs: PAIRS
                    .iter()
                    .map(|(russian, allan)| Pair { russian: find(russian), allan: find(allan) })
                    .filter(|p| p.russian.is_some() || p.allan.is_some())
                    .collect(),
                ratios: RATIOS.iter().filter_map(|id| find(id)).collect(),
            }
        })
        .collect()
}

fn side(m: &MeasurandRecord, words: Words) -> Side {
    let unit = words.unit(&m.unit);
    let (value, unit) = match (m.value, m.upper_limit) {
        // The unit belongs to the number, the coverage to the statement.
        (None, Some(u)) => {
            let coverage = limit_digits(100.0 * u.coverage, 3, words.lang);
            let unit = words.with("report.unit_coverage", &[("unit", &unit), ("coverage", &coverage)]);
            (format!("≤\u{202f}{}", bound(u.value, true, words.lang)), unit)
        }
        _ => (rows::value(m, words), unit),
    };
    Side {
        name: words.name("measurand", &m.id),
        convention: words.t(&format!("convention.{}", m.id)),
        value,
        interval: rows::interval(m, words),
        unit,
    }
}
