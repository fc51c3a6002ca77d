//! The steps of a rate table, printed.

use super::part::Part;
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::record::TableStepRecord;
use crate::report::number::{Rounding, align, digits, limit_digits};
use crate::report::page::{Block, Column, Table};
use crate::report::translator::Translator;
use crate::units::RateUnit;

/// Steps that a report lists; the rest stands in the table beside it.
const MAX_SHOWN: usize = 80;

/// A table for each channel.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let steps = &part.record.table_steps;
    let mut channels: Vec<&str> = steps.iter().map(|s| s.channel.as_str()).collect();
    channels.dedup();
    channels.into_iter().map(|channel| of(channel, part)).collect()
}

fn of(channel: &str, part: &Part<'_>) -> Block {
    let words = part.words;
    let lang = words.lang;
    let steps = &part.record.table_steps;
    let highest = steps.iter().fold(0.0, |m: f64, s| m.max(s.rate_deg_h.abs()));
    let unit = RateUnit::up_to(highest);
    let all: Vec<&TableStepRecord> = steps.iter().filter(|s| s.channel == channel).collect();
    let mut hint = words.t("table_steps.hint");
    if all.len() > MAX_SHOWN {
        let (some, whole) = (MAX_SHOWN.to_string(), all.len().to_string());
        hint.push(' ');
        hint.push_str(&words.with("table_steps.shown", &[("shown", &some), ("all", &whole)]));
    }
    let shown = all.get(..MAX_SHOWN).unwrap_or(&all);
    let each = |of: &dyn Fn(&TableStepRecord) -> String| shown.iter().map(|s| of(s)).collect::<Vec<_>>();
    // A rest is not exactly none by an angle that is read with errors.
    let rate = |s: &TableStepRecord| limit_digits(to_grid(unit.of(s.rate_deg_h), unit.of(highest)), 6, lang);
    let (mut rates, mut turns) =
        (each(&rate), each(&|s| limit_digits((s.turns * 1000.0).round() / 1000.0, 4, lang)));
    align(rates.iter_mut().collect(), lang);
    align(turns.iter_mut().collect(), lang);
    let head = words.with("table_steps.rate", &[("unit", &words.unit(unit.text()))]);
    let mut table = Table::new("steps", shown.len())
        .column(words.number_column("table_steps.from"), each(&|s| limit_digits(s.from_s, 6, lang)))
        .column(
            words.number_column("table_steps.length"),
            each(&|s| limit_digits(s.to_s - s.from_s, 4, lang)),
        )
        .column(Column::number("rate", head), rates)
        .column(words.number_column("table_steps.turns"), turns);
    if steps.iter().any(|s| s.temperature_deg_c.is_some()) {
        table = table.column(
            words.number_column("table_steps.temperature"),
            each(&|s| s.temperature_deg_c.map_or_else(String::new, |t| digits(t, 4, lang))),
        );
    }
    table = table
        .column(words.column("table_steps.approach"), each(&|s| approach(s).to_owned()))
        .column(words.number_column("table_steps.cycle"), each(&|s| s.cycle.to_string()))
        .column(words.number_column("table_steps.residual").class("n value"), each(&|s| residual(s, words).0))
        .column(words.number_column("report.interval95"), each(&|s| residual(s, words).1));
    let below = vec![Block::Hint(hint), Block::Table(table)];
    Block::section("", part.of_channel(&words.t("table_steps.title"), channel), below)
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

/// How the rate was reached.
fn approach(step: &TableStepRecord) -> &'static str {
    match step.approach {
        1 => "↑",
        -1 => "↓",
        _ => "",
    }
}

/// Residual, ppm of full scale, and its 95 % interval.
fn residual(step: &TableStepRecord, words: Translator) -> (String, String) {
    let lang = words.lang;
    let u = SCORE_TWO_SIDED_95 * step.standard_uncertainty_deg_h * step.residual_ppm.abs()
        / step.residual_deg_h.abs().max(f64::MIN_POSITIVE);
    let (low, high) = (step.residual_ppm - u, step.residual_ppm + u);
    let rounding = Rounding::of(step.residual_ppm, Some((low, high)));
    let [low, high] = [low, high].map(|v| rounding.show(v, lang));
    let interval = words.with("report.interval", &[("low", &low), ("high", &high)]);
    (rounding.show(step.residual_ppm, lang), interval)
}
