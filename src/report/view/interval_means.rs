//! Runs of a series, or intervals without and with an influence, printed.

use crate::record::{IntervalMeanRecord, RunRecord};
use crate::report::number::{Rounding, align, digits, limit_digits};
use crate::report::translator::Translator;
use serde::Serialize;

/// Rows that a report lists; the rest stands in the table beside it.
const SHOWN: usize = 80;

/// The means of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IntervalMeans {
    /// Channel.
    pub channel: String,
    /// Heading of the table.
    pub title: String,
    /// What its numbers are.
    pub hint: String,
    /// Heading of the levels, with their unit.
    pub level_title: String,
    /// Heading of the means, with their unit.
    pub mean_title: String,
    /// Whether phases or files are named.
    pub has_names: bool,
    /// Whether there are levels.
    pub has_levels: bool,
    /// Whether there are temperatures.
    pub has_temperatures: bool,
    /// The means.
    pub rows: Vec<IntervalMean>,
    /// How many of them are shown; empty when all are.
    pub shown: String,
}

/// One run or interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IntervalMean {
    /// Number.
    pub number: usize,
    /// Phase or file.
    pub name: String,
    /// Start, s.
    pub from: String,
    /// Length, s.
    pub length: String,
    /// Level, with its axis.
    pub level: String,
    /// How the level is known, in words.
    pub evidence: String,
    /// Temperature; empty without one.
    pub temperature: String,
    /// Mean.
    pub mean: String,
    /// 95 % interval of it.
    pub interval: String,
}

pub(super) fn interval_means(record: &RunRecord, words: Translator) -> Vec<IntervalMeans> {
    let mut channels: Vec<&str> = record.interval_means.iter().map(|m| m.channel.as_str()).collect();
    channels.dedup();
    channels.into_iter().map(|channel| of(channel, record, words)).collect()
}

fn of(channel: &str, record: &RunRecord, words: Translator) -> IntervalMeans {
    let all: Vec<&IntervalMeanRecord> =
        record.interval_means.iter().filter(|m| m.channel == channel).collect();
    let has_levels = all.iter().any(|m| m.level.is_some());
    let [title, hint, mean] = if has_levels {
        ["interval_means.title_intervals", "interval_means.hint_intervals", "interval_means.mean_intervals"]
    } else {
        ["interval_means.title_runs", "interval_means.hint_runs", "interval_means.mean_runs"]
    };
    let unit = all.iter().find_map(|m| m.level_unit.as_deref()).unwrap_or_default();
    let deg_h = words.unit("deg/h");
    let shown = if all.len() > SHOWN {
        let (some, whole) = (SHOWN.to_string(), all.len().to_string());
        words.with("interval_means.shown", &[("shown", &some), ("all", &whole)])
    } else {
        String::new()
    };
    let mut rows: Vec<IntervalMean> = all.iter().take(SHOWN).map(|m| one(m, words)).collect();
    align(rows.iter_mut().map(|r| &mut r.level).collect(), words.lang);
    IntervalMeans {
        channel: channel.to_owned(),
        title: words.t(title),
        hint: words.t(hint),
        level_title: words.with("interval_means.level", &[("unit", &words.unit(unit))]),
        mean_title: words.with(mean, &[("unit", &deg_h)]),
        has_names: all.iter().any(|m| !m.name.is_empty()),
        has_levels,
        has_temperatures: all.iter().any(|m| m.temperature_deg_c.is_some()),
        rows,
        shown,
    }
}

fn one(m: &IntervalMeanRecord, words: Translator) -> IntervalMean {
    let lang = words.lang;
    let rounding = Rounding::of(m.mean_deg_h, Some((m.low_deg_h, m.high_deg_h)));
    let level = m.level.map_or_else(String::new, |l| limit_digits((l * 1e6).round() / 1e6, 4, lang));
    IntervalMean {
        number: m.number,
        name: m.name.clone(),
        from: limit_digits(m.from_s, 7, lang),
        length: limit_digits(m.to_s - m.from_s, 5, lang),
        level: m.axis.as_ref().map_or_else(|| level.clone(), |axis| format!("{axis}: {level}")),
        evidence: m.evidence.map_or_else(String::new, |e| words.name("evidence", e.id())),
        temperature: m.temperature_deg_c.map_or_else(String::new, |t| digits(t, 4, lang)),
        mean: rounding.show(m.mean_deg_h, lang),
        interval: words.with(
            "report.interval",
            &[("low", &rounding.show(m.low_deg_h, lang)), ("high", &rounding.show(m.high_deg_h, lang))],
        ),
    }
}
