//! Stability of a unit over days as a table.

use super::chart;
use crate::i18n::Localize;
use crate::record::{HistoryInterval, HistoryStability};
use crate::report::number::{count, limit_digits};
use crate::report::page::{OnTerminal, Table, Value};
use crate::report::translator::Translator;

/// A row for each quantity: runs and days, the scatter of both, the trend, and why something is withheld.
pub(super) fn table(list: &[HistoryStability], several: bool, words: Translator) -> Table {
    let size = |s: &HistoryStability| {
        let [runs, days] = [s.runs, s.days].map(|n| count(n as u64, words.lang));
        words.with("history.stability.size", &[("runs", &runs), ("days", &days)])
    };
    let known = |s: &HistoryStability, of: Option<HistoryInterval>| match of {
        Some(found) => words.quantity(&interval(found, words), &s.quantity.unit),
        None => String::new(),
    };
    let of_day = |s: &HistoryStability| match s.day_deviation_at_most {
        Some(most) => {
            let most = words.quantity(&digits(most, words), &s.quantity.unit);
            words.with("report.at_most", &[("value", &most), ("coverage", "95")])
        }
        None => known(s, s.day_deviation),
    };
    let why = |s: &HistoryStability| {
        let said: Vec<String> = s.notes.iter().map(|n| n.say(words.lang)).collect();
        Value::Sentence(said.join(" "))
    };
    let number = |key: &str| words.number_column(&format!("history.column.{key}"));
    let table = Table::new("history cards", list.len())
        .column(
            words.column("history.column.quantity"),
            list.iter().map(|s| Value::Sentence(chart::name(&s.quantity, several, words))),
        )
        .column(words.column("history.column.runs").on_terminal(OnTerminal::Optional), list.iter().map(size))
        .column(number("run_deviation"), list.iter().map(|s| known(s, s.run_deviation)))
        .column(number("day_deviation"), list.iter().map(of_day))
        .column(number("per_month"), list.iter().map(|s| known(s, s.per_month)));
    if list.iter().all(|s| s.notes.is_empty()) {
        return table;
    }
    table.column(words.column("history.column.withheld"), list.iter().map(why))
}

fn digits(value: f64, words: Translator) -> String {
    limit_digits(value, 3, words.lang)
}

fn interval(found: HistoryInterval, words: Translator) -> String {
    let [value, low, high] = [found.value, found.low, found.high].map(|v| digits(v, words));
    words.with("history.share", &[("value", &value), ("low", &low), ("high", &high)])
}
