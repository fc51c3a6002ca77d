//! A quantity over time, printed.

use crate::i18n::Localize;
use crate::record::{HistoryCapability, HistoryChart, HistoryChartOf, HistoryControl, HistoryQuantity};
use crate::report::number::{count, date_time, limit, limit_digits};
use crate::report::translator::Translator;
use crate::report::view::FigureView;
use serde::Serialize;

/// Points that are named one by one.
const MAX_NAMED_POINTS: usize = 10;

/// A chart, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChartView {
    /// Quantity, with what the chart is of.
    pub name: String,
    /// `remark` where something lies beyond the control limits, `ok` where nothing does, `none` without them.
    pub status: &'static str,
    /// The same in words.
    pub status_word: String,
    /// Values.
    pub values: String,
    /// Mean with the spread of the process.
    pub center: String,
    /// Limits; empty where there are none.
    pub limit: String,
    /// Cp with its lower bound; empty where it is not stated.
    pub cp: String,
    /// Cpk with its lower bound.
    pub cpk: String,
    /// What lies beyond, and what must be known, in sentences.
    pub sentences: Vec<String>,
    /// The drawing.
    pub figure: Option<FigureView>,
}

impl ChartView {
    pub(super) fn new(
        chart: &HistoryChart,
        several: bool,
        figure: Option<FigureView>,
        words: Translator,
    ) -> ChartView {
        let name = of(chart, several, words);
        let status = match &chart.control {
            None => "none",
            Some(control) if control.in_control => "ok",
            Some(_) => "remark",
        };
        let unit = &chart.quantity.unit;
        let mut sentences = chart.control.as_ref().map_or_else(Vec::new, |c| beyond(chart, c, words));
        sentences.extend(chart.notes.iter().map(|n| n.say(words.lang)));
        let index = |of: fn(&HistoryCapability) -> Option<(f64, f64)>| {
            chart.capability.as_ref().and_then(of).map_or_else(String::new, |(value, at_least)| {
                let digits = |v: f64| limit_digits(v, 3, words.lang);
                words.with("history.index", &[("value", &digits(value)), ("at_least", &digits(at_least))])
            })
        };
        ChartView {
            figure: figure.map(|f| FigureView { title: name.clone(), ..f }),
            status,
            status_word: words.name("history.control", status),
            values: count(chart.points.len() as u64, words.lang),
            center: chart.control.as_ref().map_or_else(String::new, |c| center(c, unit, words)),
            limit: limits(chart, words),
            cp: index(|c| c.cp.zip(c.cp_at_least)),
            cpk: index(|c| Some((c.cpk, c.cpk_at_least))),
            sentences,
            name,
        }
    }
}

/// Name of a quantity, with its phase and channel where there are several.
pub(super) fn name(q: &HistoryQuantity, several: bool, words: Translator) -> String {
    let parts = [Some(words.name("measurand", &q.measurand)), q.phase.clone()];
    let parts = parts.into_iter().flatten().chain(several.then(|| q.channel.clone()));
    parts.collect::<Vec<_>>().join(" · ")
}

fn of(chart: &HistoryChart, several: bool, words: Translator) -> String {
    let quantity = name(&chart.quantity, several, words);
    let serial = chart.serial.as_deref().unwrap_or_default();
    let station = match chart.station.as_deref() {
        Some("") | None => words.t("report.missing"),
        Some(station) => station.to_owned(),
    };
    match chart.of {
        HistoryChartOf::Process => quantity,
        HistoryChartOf::Unit => words.with("history.of_unit", &[("quantity", &quantity), ("serial", serial)]),
        HistoryChartOf::Bench => words
            .with("history.of_bench", &[("quantity", &quantity), ("serial", serial), ("station", &station)]),
    }
}

fn center(control: &HistoryControl, unit: &str, words: Translator) -> String {
    let digits = |v: f64, n: usize| limit_digits(v, n, words.lang);
    words.with(
        "history.center",
        &[
            ("center", &words.quantity(&digits(control.center, 4), unit)),
            ("observed", &digits(control.observed, 2)),
            ("process", &digits(control.process, 2)),
        ],
    )
}

fn limits(chart: &HistoryChart, words: Translator) -> String {
    let side = |v: f64, sign: char| {
        format!("{sign}\u{202f}{}", words.quantity(&limit(v, words.lang), &chart.quantity.unit))
    };
    let Some(limit) = chart.limit else { return String::new() };
    let both = [limit.min.map(|v| side(v, '≥')), limit.max.map(|v| side(v, '≤'))];
    both.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// Each point that breaks a rule, in a sentence.
fn beyond(chart: &HistoryChart, control: &HistoryControl, words: Translator) -> Vec<String> {
    let mut out = vec![];
    for (i, (point, flags)) in chart.points.iter().zip(&control.points).enumerate() {
        let mut rules: Vec<String> = flags.broken.iter().map(|r| words.name("history.rule", r)).collect();
        if flags.ewma_beyond {
            rules.push(words.t("history.rule.ewma"));
        }
        if !rules.is_empty() {
            out.push(words.with(
                "history.beyond",
                &[
                    ("number", &count((i + 1) as u64, words.lang)),
                    ("serial", &point.serial),
                    ("at", &date_time(&point.evaluated_at)),
                    ("rules", &rules.join("; ")),
                ],
            ));
        }
    }
    if out.len() > MAX_NAMED_POINTS {
        let more = out.len() - MAX_NAMED_POINTS;
        out.truncate(MAX_NAMED_POINTS);
        out.push(words.with("history.more_points", &[("n", &count(more as u64, words.lang))]));
    }
    out
}
