//! Russian and Allan values of the same record, side by side, each with its convention.

use super::part::Part;
use super::rows;
use crate::measurand;
use crate::record::MeasurandRecord;
use crate::report::number::{bound, limit_digits};
use crate::report::page::{Block, Table, Value};
use crate::report::translator::Translator;

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

/// A table for each channel that has a Russian value.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let mut channels: Vec<&str> = vec![];
    for m in part.record.measurands.iter().filter(|m| PAIRS.iter().any(|(russian, _)| *russian == m.id)) {
        if !channels.contains(&m.channel.as_str()) {
            channels.push(&m.channel);
        }
    }
    if channels.is_empty() {
        return vec![];
    }
    let mut below = vec![Block::Hint(words.t("report.comparison_hint"))];
    for channel in channels {
        below.extend(part.several_channels.then(|| Block::subheading(channel)));
        below.push(Block::Table(table(channel, part)));
    }
    vec![Block::section("", words.t("report.comparison"), below)]
}

/// A Russian value and an Allan value in each line, then ratios.
fn table(channel: &str, part: &Part<'_>) -> Table {
    let words = part.words;
    let find = |id: &str| part.record.measurands.iter().find(|m| m.channel == channel && m.id == id);
    let pairs = PAIRS.iter().map(|(russian, allan)| (find(russian), find(allan)));
    let ratios = RATIOS.iter().map(|id| (find(id), None));
    let lines: Vec<(Option<&MeasurandRecord>, Option<&MeasurandRecord>)> =
        pairs.chain(ratios).filter(|(russian, allan)| russian.is_some() || allan.is_some()).collect();
    let name = |m: Option<&MeasurandRecord>| m.map_or(Value::Empty, |m| name(m, words));
    let value = |m: Option<&MeasurandRecord>| m.map_or(Value::Empty, |m| value(m, words));
    let shown = || words.number_column("report.value_interval");
    Table::new("comparison", lines.len())
        .column(words.column("report.russian"), lines.iter().map(|l| name(l.0)))
        .column(shown(), lines.iter().map(|l| value(l.0)))
        .column(words.column("report.allan").class("second"), lines.iter().map(|l| name(l.1)))
        .column(shown(), lines.iter().map(|l| value(l.1)))
}

/// Name, below it the convention that it stands for.
fn name(m: &MeasurandRecord, words: Translator) -> Value {
    let convention = words.t(&format!("convention.{}", m.id));
    Value::Text(words.name("measurand", &m.id)).over([Value::Text(convention)])
}

/// Value with its unit, below it the interval.
fn value(m: &MeasurandRecord, words: Translator) -> Value {
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
    let value = if unit.is_empty() { value } else { format!("{value} {unit}") };
    Value::Text(value).over([Value::Text(rows::interval(m, words))])
}
