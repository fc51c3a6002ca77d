//! A quantity over time: its row, what lies beyond its limits, and its drawing.

use crate::i18n::Localize;
use crate::record::{HistoryCapability, HistoryChart, HistoryChartOf, HistoryControl, HistoryQuantity};
use crate::report::number::{count, date_time, limit, limit_digits};
use crate::report::page::{Block, OnTerminal, Table, Value};
use crate::report::translator::Translator;
use crate::report::view::FigureView;

/// Most points that are named one by one.
const MAX_NAMED_POINTS: usize = 10;

/// The charts, a row each.
pub(super) fn table(charts: &[HistoryChart], several: bool, words: Translator) -> Table {
    let number = |key: &str| words.number_column(&format!("history.column.{key}"));
    let optional = |key: &str| number(key).on_terminal(OnTerminal::Optional);
    let values = |c: &HistoryChart| count(c.points.len() as u64, words.lang);
    let central = |c: &HistoryChart| {
        let unit = &c.quantity.unit;
        c.control.as_ref().map_or_else(String::new, |control| center(control, unit, words))
    };
    let cp = |c: &HistoryCapability| c.cp.zip(c.cp_at_least);
    let cpk = |c: &HistoryCapability| Some((c.cpk, c.cpk_at_least));
    let status = |c: &HistoryChart| {
        let id = status(c);
        Value::state(id, words.name("history.control", id))
    };
    Table::new("history cards", charts.len())
        .column(
            words.column("history.column.quantity"),
            charts.iter().map(|c| Value::Sentence(of(c, several, words))),
        )
        .column(optional("values"), charts.iter().map(values))
        .column(words.column("history.column.center"), charts.iter().map(central))
        .column(
            words.number_column("report.limit").on_terminal(OnTerminal::Hidden),
            charts.iter().map(|c| limits(c, words)),
        )
        .column(optional("cp"), charts.iter().map(|c| index(c, cp, words)))
        .column(optional("cpk"), charts.iter().map(|c| index(c, cpk, words)))
        .column(words.column("history.column.control"), charts.iter().map(status))
}

/// What is said of a chart, and its drawing.
pub(super) fn section(
    chart: &HistoryChart,
    several: bool,
    figure: Option<FigureView>,
    words: Translator,
) -> Block {
    let name = of(chart, several, words);
    let drawn = figure.map(|f| {
        let caption = format!("{name}. {}", words.t("history.chart_caption"));
        Block::Figure(Box::new(FigureView { title: name.clone(), caption, ..f }))
    });
    let below = Block::remarks(sentences(chart, words)).into_iter().chain(drawn).collect();
    Block::section("figures", Value::Sentence(name), below)
}

/// The charts in which something lies beyond the control limits, with what it is.
pub(super) fn out_of_control(charts: &[HistoryChart], several: bool, words: Translator) -> Vec<Block> {
    let one = |chart: &HistoryChart| {
        let said = sentences(chart, words).into_iter().map(Block::Paragraph);
        std::iter::once(Block::heading(of(chart, several, words))).chain(said).collect::<Vec<_>>()
    };
    charts.iter().filter(|c| status(c) == "remark").flat_map(one).collect()
}

/// `remark` where something lies beyond the control limits, `ok` where nothing does, `none` without them.
fn status(chart: &HistoryChart) -> &'static str {
    match &chart.control {
        None => "none",
        Some(control) if control.in_control => "ok",
        Some(_) => "remark",
    }
}

/// What lies beyond, and what must be known.
fn sentences(chart: &HistoryChart, words: Translator) -> Vec<String> {
    let beyond = chart.control.as_ref().map_or_else(Vec::new, |c| beyond(chart, c, words));
    beyond.into_iter().chain(chart.notes.iter().map(|n| n.say(words.lang))).collect()
}

/// An index of capability with its lower bound; empty where it is not stated.
fn index(
    chart: &HistoryChart,
    of: fn(&HistoryCapability) -> Option<(f64, f64)>,
    words: Translator,
) -> String {
    let digits = |v: f64| limit_digits(v, 3, words.lang);
    let found = chart.capability.as_ref().and_then(of);
    found.map_or_else(String::new, |(value, at_least)| {
        words.with("history.index", &[("value", &digits(value)), ("at_least", &digits(at_least))])
    })
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
