//! Russian and Allan values of the same record, side by side, each with its convention.

use super::rows;
use crate::measurand;
use crate::record::{MeasurandRecord, RunRecord};
use crate::report::number::{bound, limit_digits};
use crate::report::translator::Translator;
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
    (measurand::RUSSIAN_DRIFT_100S.id, measurand::BIAS_INSTABILITY.id),
    (measurand::RUSSIAN_DRIFT_100S_3SIGMA.id, measurand::BIAS_INSTABILITY_MINIMUM.id),
    (measurand::RUSSIAN_DRIFT_100S_PREDICTED.id, measurand::BIAS_INSTABILITY_MINIMUM_SCALED.id),
    (measurand::RUSSIAN_ARW_10S.id, measurand::ANGLE_RANDOM_WALK.id),
    (measurand::RUSSIAN_SIGMA_10S.id, ""),
];

const RATIOS: &[&str] =
    &[measurand::RATIO_RUSSIAN_TO_ALLAN_BIAS.id, measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id];

/// The comparisons, one for each channel that has a Russian value.
pub fn comparisons(record: &RunRecord, words: Translator) -> Vec<Comparison> {
    let mut channels: Vec<&str> = vec![];
    for m in record.measurands.iter().filter(|m| PAIRS.iter().any(|(russian, _)| *russian == m.id)) {
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

fn side(m: &MeasurandRecord, words: Translator) -> Side {
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
