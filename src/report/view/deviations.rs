//! The Allan family as a table: one line for each averaging time, one column for each estimator.

use super::part::Part;
use crate::record::DeviationRecord;
use crate::report::number::{Rounding, limit_digits};
use crate::report::page::{Block, Column, Table, Value};
use crate::report::translator::Translator;

/// A table for each channel.
pub fn deviations(part: &Part<'_>) -> Vec<Block> {
    let mut tables: Vec<(&str, Vec<&DeviationRecord>)> = vec![];
    for point in &part.record.deviations {
        match tables.iter_mut().find(|(channel, _)| *channel == point.channel) {
            Some((_, points)) => points.push(point),
            None => tables.push((&point.channel, vec![point])),
        }
    }
    let heading = part.words.t("goodness.family");
    let both = |(channel, points): (&str, Vec<&DeviationRecord>)| {
        let heading = Block::subheading(part.of_channel(&heading, channel));
        [heading, Block::Table(table(&points, part.words))]
    };
    tables.into_iter().flat_map(both).collect()
}

fn table(points: &[&DeviationRecord], words: Translator) -> Table {
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
    let table = Table::new("family", taus.len()).column(
        words.number_column("goodness.tau"),
        taus.iter().map(|tau| limit_digits(*tau, 6, words.lang)),
    );
    estimators.into_iter().fold(table, |table, id| {
        let cell = |tau: &f64| {
            let found = points.iter().find(|p| p.tau_s == *tau && p.estimator == id);
            found.map_or(Value::Empty, |p| printed(p, words))
        };
        table.column(Column::number(id, words.t(estimator(id))), taus.iter().map(cell))
    })
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

/// Value, below it the interval.
fn printed(p: &DeviationRecord, words: Translator) -> Value {
    let range = p.low_deg_h.zip(p.high_deg_h);
    // The lower side of the interval sets the digits: the upper one of few degrees of freedom would leave none.
    let value = p.deviation_deg_h;
    let rounding = Rounding::of(value, range.map(|(low, _)| (low, 2.0 * value - low)));
    let show = |v: f64| rounding.show(v, words.lang);
    let interval = |(low, high)| words.with("report.interval", &[("low", &show(low)), ("high", &show(high))]);
    Value::Text(show(value)).over(range.map(interval).map(Value::Text))
}
