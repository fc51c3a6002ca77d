//! The steps of a rate table, printed.

use crate::record::{RunRecord, TableStepRecord};
use crate::report::number::{Rounding, align, digits, limit_digits};
use crate::report::translator::Translator;
use crate::units::RateUnit;
use serde::Serialize;

/// Steps that a report lists; the rest stands in the table beside it.
const SHOWN: usize = 80;

/// The steps of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableSteps {
    /// Channel.
    pub channel: String,
    /// Unit of the rates.
    pub rate_unit: &'static str,
    /// True when a step has a temperature.
    pub has_temperatures: bool,
    /// The steps.
    pub rows: Vec<TableStep>,
    /// How many of them are shown; empty when all are.
    pub shown: String,
}

/// One step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableStep {
    /// Start, s.
    pub from: String,
    /// Length, s.
    pub length: String,
    /// Rate.
    pub rate: String,
    /// Turns.
    pub turns: String,
    /// Temperature; empty without one.
    pub temperature: String,
    /// How the rate was reached.
    pub approach: &'static str,
    /// Cycle.
    pub cycle: usize,
    /// Residual, ppm of full scale.
    pub residual: String,
    /// 95 % interval of it.
    pub interval: String,
}

pub(super) fn table_steps(record: &RunRecord, words: Translator) -> Vec<TableSteps> {
    let mut tables: Vec<TableSteps> = vec![];
    let highest = record.table_steps.iter().fold(0.0, |m: f64, s| m.max(s.rate_deg_h.abs()));
    let unit = RateUnit::up_to(highest);
    let count = |channel: &str| record.table_steps.iter().filter(|s| s.channel == channel).count();
    let has_temperatures = record.table_steps.iter().any(|s| s.temperature_deg_c.is_some());
    for step in &record.table_steps {
        if tables.last().is_none_or(|t| t.channel != step.channel) {
            let n = count(&step.channel);
            let shown = if n > SHOWN {
                let args = [("shown", SHOWN.to_string()), ("all", n.to_string())];
                words.with("table_steps.shown", &args.each_ref().map(|(k, v)| (*k, v.as_str())))
            } else {
                String::new()
            };
            let channel = step.channel.clone();
            tables.push(TableSteps {
                channel,
                rate_unit: unit.text(),
                has_temperatures,
                rows: vec![],
                shown,
            });
        }
        if let Some(table) = tables.last_mut().filter(|t| t.rows.len() < SHOWN) {
            table.rows.push(one(step, unit, unit.of(highest), words));
        }
    }
    for table in &mut tables {
        align(table.rows.iter_mut().map(|r| &mut r.rate).collect(), words.lang);
        align(table.rows.iter_mut().map(|r| &mut r.turns).collect(), words.lang);
    }
    tables
}

/// A value rounded to a millionth of the decade of the highest.
fn to_grid(value: f64, highest: f64) -> f64 {
    if highest > 0.0 {
        let grid = 10f64.powf(5.0 - highest.log10().floor());
        (value * grid).round() / grid + 0.0
    } else {
        value
    }
}

fn one(step: &TableStepRecord, unit: RateUnit, highest: f64, words: Translator) -> TableStep {
    let lang = words.lang;
    let u = 1.96 * step.standard_uncertainty_deg_h * step.residual_ppm.abs()
        / step.residual_deg_h.abs().max(f64::MIN_POSITIVE);
    let (low, high) = (step.residual_ppm - u, step.residual_ppm + u);
    let rounding = Rounding::of(step.residual_ppm, Some((low, high)));
    TableStep {
        from: limit_digits(step.from_s, 6, lang),
        length: limit_digits(step.to_s - step.from_s, 4, lang),
        // A rest is not exactly none by an angle that is read with errors.
        rate: limit_digits(to_grid(unit.of(step.rate_deg_h), highest), 6, lang),
        turns: limit_digits((step.turns * 1000.0).round() / 1000.0, 4, lang),
        temperature: step.temperature_deg_c.map_or_else(String::new, |t| digits(t, 4, lang)),
        approach: match step.approach {
            1 => "↑",
            -1 => "↓",
            _ => "",
        },
        cycle: step.cycle,
        residual: rounding.show(step.residual_ppm, lang),
        interval: words.with(
            "report.interval",
            &[("low", &rounding.show(low, lang)), ("high", &rounding.show(high, lang))],
        ),
    }
}
