//! Runs of a series, or intervals without and with an influence, printed.

use super::part::Part;
use crate::record::IntervalMeanRecord;
use crate::report::number::{Rounding, align, digits, limit_digits};
use crate::report::page::{Block, Column, Table};
use crate::report::translator::Translator;

/// Rows that a report lists; the rest stands in the table beside it.
const MAX_SHOWN: usize = 80;

/// A table for each channel.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let means = &part.record.interval_means;
    let mut channels: Vec<&str> = means.iter().map(|m| m.channel.as_str()).collect();
    channels.dedup();
    channels.into_iter().map(|channel| of(channel, part)).collect()
}

fn of(channel: &str, part: &Part<'_>) -> Block {
    let words = part.words;
    let lang = words.lang;
    let all: Vec<&IntervalMeanRecord> =
        part.record.interval_means.iter().filter(|m| m.channel == channel).collect();
    let has_levels = all.iter().any(|m| m.level.is_some());
    let [title, hint, mean] = if has_levels {
        ["interval_means.title_intervals", "interval_means.hint_intervals", "interval_means.mean_intervals"]
    } else {
        ["interval_means.title_runs", "interval_means.hint_runs", "interval_means.mean_runs"]
    };
    let mut hint = words.t(hint);
    if all.len() > MAX_SHOWN {
        let (some, whole) = (MAX_SHOWN.to_string(), all.len().to_string());
        hint.push(' ');
        hint.push_str(&words.with("interval_means.shown", &[("shown", &some), ("all", &whole)]));
    }
    let shown = all.get(..MAX_SHOWN).unwrap_or(&all);
    let each = |of: &dyn Fn(&IntervalMeanRecord) -> String| shown.iter().map(|m| of(m)).collect::<Vec<_>>();
    let number = |head: String| Column::number("", head);
    let mut table = Table::new("steps", shown.len())
        .column(words.number_column("interval_means.number"), each(&|m| m.number.to_string()));
    if all.iter().any(|m| !m.name.is_empty()) {
        table = table.column(words.column("interval_means.name"), each(&|m| m.name.clone()));
    }
    table = table
        .column(words.number_column("interval_means.from"), each(&|m| limit_digits(m.from_s, 7, lang)))
        .column(
            words.number_column("interval_means.length"),
            each(&|m| limit_digits(m.to_s - m.from_s, 5, lang)),
        );
    if has_levels {
        let unit = all.iter().find_map(|m| m.level_unit.as_deref()).unwrap_or_default();
        let head = words.with("interval_means.level", &[("unit", &words.unit(unit))]);
        let mut levels = each(&|m| level(m, words));
        align(levels.iter_mut().collect(), lang);
        let evidence =
            |m: &IntervalMeanRecord| m.evidence.map_or_else(String::new, |e| words.name("evidence", e.id()));
        table = table.column(number(head), levels).column(words.column("report.evidence"), each(&evidence));
    }
    if all.iter().any(|m| m.temperature_deg_c.is_some()) {
        table = table.column(
            words.number_column("interval_means.temperature"),
            each(&|m| m.temperature_deg_c.map_or_else(String::new, |t| digits(t, 4, lang))),
        );
    }
    let head = words.with(mean, &[("unit", &words.unit("deg/h"))]);
    let rounding = |m: &IntervalMeanRecord| Rounding::of(m.mean_deg_h, Some((m.low_deg_h, m.high_deg_h)));
    let interval = |m: &IntervalMeanRecord| {
        let [low, high] = [m.low_deg_h, m.high_deg_h].map(|v| rounding(m).show(v, lang));
        words.with("report.interval", &[("low", &low), ("high", &high)])
    };
    table = table
        .column(number(head).class("n value"), each(&|m| rounding(m).show(m.mean_deg_h, lang)))
        .column(words.number_column("report.interval95"), each(&interval));
    let below = vec![Block::Hint(hint), Block::Table(table)];
    Block::section("", part.of_channel(&words.t(title), channel), below)
}

/// Level, with its axis.
fn level(m: &IntervalMeanRecord, words: Translator) -> String {
    let level = m.level.map_or_else(String::new, |l| limit_digits((l * 1e6).round() / 1e6, 4, words.lang));
    m.axis.as_ref().map_or_else(|| level.clone(), |axis| format!("{axis}: {level}"))
}
