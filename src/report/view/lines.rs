//! Spectral lines.

use super::common::probability;
use super::part::Part;
use crate::record::{LineRecord, RunRecord};
use crate::report::number::{NOTHING, Rounding, count, digits, duration};
use crate::report::page::{Block, Table};
use crate::report::translator::Translator;

/// Lines that a report lists; a comb of harmonics would bury the rest of it.
const MAX_SHOWN: usize = 16;

/// The strongest lines.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let (record, words) = (part.record, part.words);
    let lang = words.lang;
    let (lines, shown) = strongest(&record.lines, words);
    if lines.is_empty() {
        return vec![];
    }
    let each = |of: &dyn Fn(&LineRecord) -> String| lines.iter().map(|l| of(l)).collect::<Vec<_>>();
    let mut table = Table::new("", lines.len());
    if part.several_channels {
        table = table.column(words.column("report.channel"), each(&|l| l.channel.clone()));
    }
    let mut amplitude = words.number_column("report.amplitude");
    amplitude.head = words.with("report.amplitude", &[("unit", &words.unit("deg/h"))]);
    let table = table
        .column(words.number_column("report.frequency_hz"), each(&|l| frequency(l, words)))
        .column(words.number_column("report.period"), each(&|l| period(l, words)))
        .column(words.number_column("report.resolution_hz"), each(&|l| digits(l.resolution_hz, 2, lang)))
        .column(amplitude, each(&|l| digits(l.amplitude_deg_h, 3, lang)))
        .column(words.number_column("report.excess"), each(&|l| digits(l.excess, 3, lang)))
        .column(
            words.number_column("report.false_alarm"),
            each(&|l| probability(l.false_alarm_probability, words)),
        );
    let hint = (!shown.is_empty()).then_some(Block::Hint(shown));
    let below = std::iter::once(Block::Table(table)).chain(hint).collect();
    vec![Block::section("", words.t("report.lines"), below)]
}

/// The strongest lines in a sentence each, for a terminal.
pub fn sentences(record: &RunRecord, words: Translator) -> Vec<String> {
    let sentence = |l: &LineRecord| {
        let (frequency, period) = (frequency(l, words), period(l, words));
        let amplitude = digits(l.amplitude_deg_h, 3, words.lang);
        let args = [("frequency", frequency.as_str()), ("amplitude", &amplitude), ("period", &period)];
        words.with("terminal.line", &args)
    };
    strongest(&record.lines, words).0.into_iter().map(sentence).collect()
}

/// Frequency, Hz.
fn frequency(l: &LineRecord, words: Translator) -> String {
    let half = 0.5 * l.resolution_hz;
    let range = (l.frequency_hz - half, l.frequency_hz + half);
    Rounding::of(l.frequency_hz, Some(range)).show(l.frequency_hz, words.lang)
}

fn period(l: &LineRecord, words: Translator) -> String {
    if l.frequency_hz > 0.0 { duration(1.0 / l.frequency_hz, words.lang) } else { NOTHING.to_owned() }
}

/// The strongest lines, by frequency, and how many they are of all.
fn strongest(lines: &[LineRecord], words: Translator) -> (Vec<&LineRecord>, String) {
    let mut shown: Vec<&LineRecord> = lines.iter().collect();
    shown.sort_by(|a, b| b.amplitude_deg_h.total_cmp(&a.amplitude_deg_h));
    shown.truncate(MAX_SHOWN);
    shown.sort_by(|a, b| a.channel.cmp(&b.channel).then(a.frequency_hz.total_cmp(&b.frequency_hz)));
    let hint = if shown.len() < lines.len() {
        let (n, all) = (count(shown.len() as u64, words.lang), count(lines.len() as u64, words.lang));
        words.with("report.lines_shown", &[("shown", &n), ("all", &all)])
    } else {
        String::new()
    };
    (shown, hint)
}
