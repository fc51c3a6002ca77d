//! The history of a store: yields, reasons, quantities over time, drift, stations, and the latest results.

mod chart;
mod csv;
mod stability;

pub use csv::csv;

use super::number::{count, date_time, limit_digits};
use super::page::{Block, Head, OnTerminal, Page, Table, Value};
use super::translator::Translator;
use super::view::FigureView;
use crate::acceptance::history::figures::{MONTHS_FIGURE, figure_id};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::record::{
    HistoryDrift, HistoryReason, HistoryRecord, HistoryResult, HistoryShare, HistoryStation, HistoryYield,
};
use std::collections::BTreeSet;

/// Most results that a page lists; all are in the other forms.
const MAX_ON_PAGE: usize = 200;
/// Most results that a terminal lists.
const MAX_ON_TERMINAL: usize = 20;
/// Digits of an address that are shown.
const ADDRESS_DIGITS: usize = 12;

/// The page of a history with its figures.
pub fn page(history: &HistoryRecord, figures: &[Figure], lang: Lang) -> Page {
    let words = Translator { lang };
    let head = head(history, words);
    let several = several_channels(history);
    let generator = format!("{} {}", history.program.name, history.program.version);
    let latest = history.results.last().map(|r| date_time(&r.evaluated_at)).unwrap_or_default();
    let months = FigureView::find(figures, MONTHS_FIGURE, words).map(|f| {
        let caption = f.title.clone();
        Block::Section("figures", vec![Block::Figure(Box::new(FigureView { caption, ..f }))])
    });
    let charts = history
        .charts
        .iter()
        .enumerate()
        .map(|(i, c)| chart::section(c, several, FigureView::find(figures, &figure_id(i), words), words));
    let asked = asked(history, words);
    let asked = (!asked.is_empty()).then(|| Block::Section("identity", vec![Block::identity(asked)]));
    let tables = Tables::new(history, several, words);
    let below = |key: &str, table: &Table, hint: Option<&str>| {
        let hint = hint.map(|key| Block::Hint(words.t(key)));
        let below = std::iter::once(Block::Table(table.clone())).chain(hint).collect();
        (!table.rows.is_empty()).then(|| Block::section("", words.t(key), below))
    };
    let results = results(&history.results, MAX_ON_PAGE, words);
    let more = history.results.len().saturating_sub(MAX_ON_PAGE);
    let more =
        (more > 0).then(|| Block::Hint(words.with("history.more", &[("n", &count(more as u64, lang))])));
    let results = std::iter::once(Block::Table(results)).chain(more).collect();
    Page {
        title: format!("{} · {}", head.title, head.kind),
        footer: format!("{latest} · {generator}"),
        blocks: std::iter::once(Block::Head(head))
            .chain(Block::remarks(history.notes.iter().map(|n| n.say(lang))))
            .chain(asked)
            .chain(below("history.yields", &tables.yields, Some("history.yields_hint")))
            .chain(below("history.reasons", &tables.reasons, None))
            .chain([Block::SummaryEnd])
            .chain(months)
            .chain(below("history.charts", &tables.charts, Some("history.charts_hint")))
            .chain(below("history.drifts", &tables.drifts, None))
            .chain(below("history.stabilities", &tables.stabilities, Some("history.stabilities_hint")))
            .chain(below("history.stations", &tables.stations, Some("history.stations_hint")))
            .chain(charts)
            .chain([Block::section("", words.t("history.results"), results)])
            .collect(),
        generator,
    }
}

/// A history on a terminal: the latest results, yields, reasons, what is out of control, drift, stations.
pub fn on_terminal(history: &HistoryRecord, lang: Lang) -> Vec<Block> {
    let words = Translator { lang };
    let several = several_channels(history);
    let tables = Tables::new(history, several, words);
    let columns = ["evaluated_at", "serial", "lot", "station", "attempt", "address", "reasons", "verdict"];
    let results = results(&history.results, MAX_ON_TERMINAL, words).only(&columns);
    let below = |key: &str, table: Table| {
        let is_shown = !table.rows.is_empty();
        let both = [Block::heading(words.t(key)), Block::Table(table)];
        both.into_iter().filter(move |_| is_shown)
    };
    std::iter::once(Block::Head(head(history, words)))
        .chain(below("history.results", results))
        .chain(below("history.yields", tables.yields))
        .chain(below("history.reasons", tables.reasons))
        .chain(below("history.charts", tables.charts))
        .chain(chart::out_of_control(&history.charts, several, words))
        .chain(below("history.drifts", tables.drifts))
        .chain(below("history.stabilities", tables.stabilities))
        .chain(below("history.stations", tables.stations))
        .chain(Block::remarks(history.notes.iter().map(|n| n.say(lang))))
        .collect()
}

fn head(history: &HistoryRecord, words: Translator) -> Head {
    let count = |n: usize| count(n as u64, words.lang);
    let counts = &history.counts;
    let (results, units) = (count(counts.results), count(counts.units));
    Head {
        kind: words.t("history.kind_of_page"),
        title: title(history, words),
        size: words.with("history.size", &[("results", &results), ("units", &units)]),
        ..Head::default()
    }
}

/// The tables that page and terminal have.
struct Tables {
    yields: Table,
    reasons: Table,
    charts: Table,
    drifts: Table,
    stabilities: Table,
    stations: Table,
}

impl Tables {
    fn new(history: &HistoryRecord, several: bool, words: Translator) -> Tables {
        Tables {
            yields: yields(&history.yields, words),
            reasons: reasons(&history.reasons, words),
            charts: chart::table(&history.charts, several, words),
            drifts: drifts(&history.drifts, several, words),
            stabilities: stability::table(&history.stabilities, several, words),
            stations: stations(&history.stations, several, words),
        }
    }
}

/// True where rows must name their channel.
fn several_channels(history: &HistoryRecord) -> bool {
    let channels: BTreeSet<&str> = history.charts.iter().map(|c| c.quantity.channel.as_str()).collect();
    channels.len() > 1
}

fn title(history: &HistoryRecord, words: Translator) -> String {
    let asked = &history.asked;
    let lots = (!asked.lots.is_empty()).then(|| asked.lots.join(", "));
    let parts = [asked.serial.clone(), asked.model.clone(), lots, asked.procedure.clone()];
    let named: Vec<String> = parts.into_iter().flatten().collect();
    if named.is_empty() { words.t("history.all") } else { named.join(" · ") }
}

fn asked(history: &HistoryRecord, words: Translator) -> Vec<(String, String)> {
    let asked = &history.asked;
    let lots = (!asked.lots.is_empty()).then(|| asked.lots.join(", "));
    let measurand = asked.measurand.as_ref().map(|m| words.name("measurand", m));
    let fields = [
        ("report.serial", asked.serial.clone()),
        ("report.model", asked.model.clone()),
        ("report.lot", lots),
        ("report.procedure", asked.procedure.clone()),
        ("report.quantity", measurand),
        ("report.station", asked.station.clone()),
        ("history.since", asked.since.clone()),
    ];
    let field = |(key, value): (&str, Option<String>)| Some((words.t(key), value?));
    fields.into_iter().filter_map(field).collect()
}

/// A counted share in percent: one that is exactly nil or all is so.
fn percent(share: f64, words: Translator) -> String {
    format!("{}\u{202f}%", limit_digits(100.0 * share, 3, words.lang))
}

/// A counted share with its interval, in percent.
pub(super) fn share(share: &HistoryShare, words: Translator) -> String {
    words.with(
        "history.share",
        &[
            ("value", &percent(share.value(), words)),
            ("low", &percent(share.low, words)),
            ("high", &percent(share.high, words)),
        ],
    )
}

fn yields(yields: &[HistoryYield], words: Translator) -> Table {
    let number = |key: &str| words.number_column(&format!("history.column.{key}"));
    Table::new("history cards", yields.len())
        .column(words.column("history.column.procedure"), yields.iter().map(|y| y.procedure.clone()))
        .column(number("units"), yields.iter().map(|y| count(y.first_pass.of as u64, words.lang)))
        .column(number("first_pass"), yields.iter().map(|y| share(&y.first_pass, words)))
        .column(number("last_pass"), yields.iter().map(|y| share(&y.last_pass, words)))
}

/// Name of a reason: that of a condition goes on with the name of its channel.
fn reason_name(kind: &str, name: &str, words: Translator) -> String {
    match kind {
        "error" => words.t("attempt.not_tested"),
        table => words.name(table, name.split('.').next().unwrap_or(name)),
    }
}

fn reasons(reasons: &[HistoryReason], words: Translator) -> Table {
    let number = |key: &str| words.number_column(&format!("history.column.{key}"));
    Table::new("history cards", reasons.len())
        .column(
            words.column("history.column.reason"),
            reasons.iter().map(|r| reason_name(&r.kind, &r.name, words)),
        )
        .column(
            words.column("history.column.kind").on_terminal(OnTerminal::Optional),
            reasons.iter().map(|r| words.name("history.kind", &r.kind)),
        )
        .column(number("results"), reasons.iter().map(|r| count(r.results as u64, words.lang)))
        .column(number("cumulative"), reasons.iter().map(|r| percent(r.cumulative, words)))
}

/// A value with the half width of its interval.
fn plus_minus(value: f64, half_width: f64, unit: &str, words: Translator) -> String {
    let digits = |v: f64| limit_digits(v, 3, words.lang);
    words.quantity(&format!("{}\u{202f}±\u{202f}{}", digits(value), digits(half_width)), unit)
}

fn drifts(drifts: &[HistoryDrift], several: bool, words: Translator) -> Table {
    let span = |d: &HistoryDrift| {
        let (from, to, n) = (date_time(&d.from), date_time(&d.to), count(d.tests as u64, words.lang));
        words.with("history.drift.span", &[("from", &from), ("to", &to), ("n", &n)])
    };
    let change = |d: &HistoryDrift| {
        Value::Text(plus_minus(d.change, d.change_half_width, &d.quantity.unit, words)).strong()
    };
    let per_year = |d: &HistoryDrift| {
        let both = d.per_year.zip(d.per_year_half_width);
        both.map_or_else(String::new, |(v, half)| plus_minus(v, half, &d.quantity.unit, words))
    };
    Table::new("history cards", drifts.len())
        .column(
            words.column("history.column.quantity"),
            drifts.iter().map(|d| Value::Sentence(chart::name(&d.quantity, several, words))),
        )
        .column(
            words.column("history.column.span").on_terminal(OnTerminal::Optional),
            drifts.iter().map(span),
        )
        .column(words.number_column("history.column.change"), drifts.iter().map(change))
        .column(
            words.number_column("history.column.per_year").on_terminal(OnTerminal::Optional),
            drifts.iter().map(per_year),
        )
        .column(
            words.column("history.column.meaning").on_terminal(OnTerminal::Hidden),
            drifts.iter().map(|d| meaning(d, words)),
        )
}

/// What a drift means, in a sentence.
fn meaning(d: &HistoryDrift, words: Translator) -> String {
    let is_shown = d.change.abs() > d.change_half_width;
    let meaning = words.t(if is_shown { "history.drift.shown" } else { "history.drift.not_shown" });
    if d.common <= 0.0 {
        return meaning;
    }
    let common = words.quantity(&limit_digits(d.common, 3, words.lang), &d.quantity.unit);
    format!("{meaning} {}", words.with("history.drift.common", &[("common", &common)]))
}

fn stations(stations: &[HistoryStation], several: bool, words: Translator) -> Table {
    let station = |s: &HistoryStation| {
        let name = if s.station.is_empty() { words.t("report.missing") } else { s.station.clone() };
        Value::state(if s.differs { "remark" } else { "ok" }, name)
    };
    let mean = |s: &HistoryStation| words.quantity(&limit_digits(s.mean, 4, words.lang), &s.quantity.unit);
    let difference = |s: &HistoryStation| {
        let both = s.difference.zip(s.half_width);
        both.map_or_else(String::new, |(d, half)| plus_minus(d, half, &s.quantity.unit, words))
    };
    Table::new("history cards", stations.len())
        .column(
            words.column("history.column.quantity"),
            stations.iter().map(|s| Value::Sentence(chart::name(&s.quantity, several, words))),
        )
        .column(words.column("history.column.station"), stations.iter().map(station))
        .column(
            words.number_column("history.column.units").on_terminal(OnTerminal::Optional),
            stations.iter().map(|s| count(s.units as u64, words.lang)),
        )
        .column(words.number_column("history.column.mean"), stations.iter().map(mean))
        .column(words.number_column("history.column.difference"), stations.iter().map(difference))
}

/// The latest results, the latest first, at most so many.
fn results(results: &[HistoryResult], most: usize, words: Translator) -> Table {
    let latest: Vec<&HistoryResult> = results.iter().rev().take(most).collect();
    let all = |of: &dyn Fn(&HistoryResult) -> String| latest.iter().map(|r| of(r)).collect::<Vec<_>>();
    let column = |key: &str| words.column(&format!("history.column.{key}"));
    let optional = |key: &str| column(key).on_terminal(OnTerminal::Optional);
    let revision = |r: &HistoryResult| {
        words.with("report.id_revision", &[("id", &r.procedure), ("revision", &r.revision)])
    };
    let attempt =
        |r: &HistoryResult| if r.attempt == 0 { String::new() } else { count(r.attempt, words.lang) };
    let address = |r: &HistoryResult| r.address.get(..ADDRESS_DIGITS).unwrap_or(&r.address).to_owned();
    let verdict = |r: &&HistoryResult| Value::state(r.verdict.id(), words.verdict(r.verdict));
    Table::new("results cards", latest.len())
        .column(column("evaluated_at").class("whole"), all(&|r| date_time(&r.evaluated_at)))
        .column(column("serial").class("whole"), all(&|r| serial(r, words)))
        .column(optional("lot").class("whole"), all(&|r| r.lot.clone()))
        .column(column("procedure").class("procedure"), all(&revision))
        .column(optional("station"), all(&|r| r.station.clone()))
        .column(words.number_column("history.column.attempt"), all(&attempt))
        .column(column("verdict"), latest.iter().map(verdict))
        .column(optional("reasons"), all(&|r| why(r, words)))
        .column(column("address").class("address"), all(&address))
}

/// Serial number, marked for a reference unit.
fn serial(r: &HistoryResult, words: Translator) -> String {
    let serial = if r.serial.is_empty() { words.t("report.missing") } else { r.serial.clone() };
    if r.reference { words.with("history.reference", &[("serial", &serial)]) } else { serial }
}

/// What kept the unit from passing, or what counts in place of the result.
fn why(r: &HistoryResult, words: Translator) -> String {
    if let Some(by) = &r.superseded_by {
        let because = r.superseded_because.as_deref().unwrap_or_default();
        let by = by.get(..ADDRESS_DIGITS).unwrap_or(by);
        return words.with("history.superseded", &[("by", by), ("because", because)]);
    }
    r.reasons.iter().map(|(kind, name)| reason_name(kind, name, words)).collect::<Vec<_>>().join(", ")
}
