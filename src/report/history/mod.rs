//! The history of a store as its page and its words on the terminal show it.

mod chart;
mod csv;

pub use chart::ChartView;
pub use csv::csv;

use super::number::{count, date_time, limit_digits};
use super::translator::{Field, Translator};
use super::view::FigureView;
use crate::acceptance::history::figures::{self, MONTHS, figure_id};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize};
use crate::record::{HistoryDrift, HistoryRecord, HistoryResult, HistoryShare, HistoryStation};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Results that a page lists; all are in the other forms.
const LISTED: usize = 200;
/// Digits of an address that are shown.
const SHOWN: usize = 12;

/// Everything that the page of a history shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistoryView {
    /// The question, in one line.
    pub title: String,
    /// How many results and units there are.
    pub size: String,
    /// The question.
    pub asked: Vec<Field>,
    /// What must be known of the whole.
    pub notes: Vec<String>,
    /// Yields.
    pub yields: Vec<YieldView>,
    /// What kept units from passing.
    pub reasons: Vec<ReasonView>,
    /// Verdicts by month.
    pub months: Option<FigureView>,
    /// Quantities over time.
    pub charts: Vec<ChartView>,
    /// Drift of the unit.
    pub drifts: Vec<DriftView>,
    /// Stations set against each other.
    pub stations: Vec<StationView>,
    /// The latest results, the latest first.
    pub results: Vec<ResultView>,
    /// That there are more of them; empty otherwise.
    pub more: String,
    /// Line at the foot of every page.
    pub footer: String,
    /// The program with its version.
    pub generator: String,
}

/// A yield, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct YieldView {
    /// Procedure.
    pub procedure: String,
    /// First-pass yield with its interval.
    pub first_pass: String,
    /// Last-pass yield with its interval.
    pub last_pass: String,
    /// Units.
    pub units: String,
}

/// A reason, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReasonView {
    /// Its subject, in words.
    pub kind: String,
    /// Its name.
    pub name: String,
    /// Results.
    pub results: String,
    /// Share of all reasons up to this one.
    pub cumulative: String,
}

/// A drift, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriftView {
    /// Quantity.
    pub name: String,
    /// From when to when, and how many tests.
    pub span: String,
    /// Change with its interval.
    pub change: String,
    /// The same per year; empty for few tests.
    pub per_year: String,
    /// What it means, in a sentence.
    pub meaning: String,
}

/// A station, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StationView {
    /// Quantity.
    pub name: String,
    /// Station.
    pub station: String,
    /// Units.
    pub units: String,
    /// Mean.
    pub mean: String,
    /// Difference from the others with its interval.
    pub difference: String,
    /// `remark` for a station that differs, else `ok`.
    pub status: &'static str,
}

/// A result, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResultView {
    /// When.
    pub evaluated_at: String,
    /// Serial number, marked for a reference unit.
    pub serial: String,
    /// Lot.
    pub lot: String,
    /// Procedure with its revision.
    pub procedure: String,
    /// Station.
    pub station: String,
    /// Number of the attempt.
    pub attempt: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// What kept the unit from passing, or what counts in place of the result.
    pub reasons: String,
    /// Beginning of the address.
    pub address: String,
}

impl HistoryView {
    /// Builds the view.
    pub fn new(history: &HistoryRecord, lang: Lang) -> HistoryView {
        let words = Translator { lang };
        let figures = figures::all(history);
        let by_id: BTreeMap<&str, (usize, &Figure)> =
            figures.iter().enumerate().map(|(at, f)| (f.id.as_str(), (at, f))).collect();
        let drawn = |id: &str| by_id.get(id).map(|(at, f)| FigureView::of(f, at + 1, words));
        let several = several_channels(history);
        let generator = format!("{} {}", history.program.name, history.program.version);
        let latest = history.results.last().map(|r| date_time(&r.evaluated_at)).unwrap_or_default();
        let charts = history.charts.iter().enumerate();
        HistoryView {
            title: title(history, words),
            size: words.with(
                "history.size",
                &[
                    ("results", &count(history.counts.results as u64, lang)),
                    ("units", &count(history.counts.units as u64, lang)),
                ],
            ),
            asked: asked(history, words),
            notes: history.notes.iter().map(|n| n.say(lang)).collect(),
            yields: yields(history, words),
            reasons: reasons(history, words),
            months: drawn(MONTHS),
            charts: charts.map(|(i, c)| ChartView::new(c, several, drawn(&figure_id(i)), words)).collect(),
            drifts: history.drifts.iter().map(|d| drift(d, several, words)).collect(),
            stations: history.stations.iter().map(|s| station(s, several, words)).collect(),
            results: history.results.iter().rev().take(LISTED).map(|r| result(r, words)).collect(),
            more: match history.results.len().saturating_sub(LISTED) {
                0 => String::new(),
                more => words.with("history.more", &[("n", &count(more as u64, lang))]),
            },
            footer: format!("{latest} · {generator}"),
            generator,
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

fn asked(history: &HistoryRecord, words: Translator) -> Vec<Field> {
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
    let field = |(key, value): (&str, Option<String>)| Some(Field { label: words.t(key), value: value? });
    fields.into_iter().filter_map(field).collect()
}

/// A counted share in percent: one that is exactly nil or all is so.
fn percent(share: f64, words: Translator) -> String {
    format!("{}\u{202f}%", limit_digits(100.0 * share, 3, words.lang))
}

fn share(share: &HistoryShare, words: Translator) -> String {
    let value = share.count as f64 / share.of.max(1) as f64;
    words.with(
        "history.share",
        &[
            ("value", &percent(value, words)),
            ("low", &percent(share.low, words)),
            ("high", &percent(share.high, words)),
        ],
    )
}

fn yields(history: &HistoryRecord, words: Translator) -> Vec<YieldView> {
    let each = history.yields.iter().map(|y| YieldView {
        procedure: y.procedure.clone(),
        first_pass: share(&y.first_pass, words),
        last_pass: share(&y.last_pass, words),
        units: count(y.first_pass.of as u64, words.lang),
    });
    each.collect()
}

/// Name of a reason: that of a condition goes on with the name of its channel.
fn reason_name(kind: &str, name: &str, words: Translator) -> String {
    match kind {
        "error" => words.t("attempt.not_tested"),
        table => words.name(table, name.split('.').next().unwrap_or(name)),
    }
}

fn reasons(history: &HistoryRecord, words: Translator) -> Vec<ReasonView> {
    let each = history.reasons.iter().map(|r| ReasonView {
        kind: words.name("history.kind", &r.kind),
        name: reason_name(&r.kind, &r.name, words),
        results: count(r.results as u64, words.lang),
        cumulative: percent(r.cumulative, words),
    });
    each.collect()
}

/// A value with the half width of its interval.
fn plus_minus(value: f64, half_width: f64, unit: &str, words: Translator) -> String {
    let digits = |v: f64| limit_digits(v, 3, words.lang);
    words.quantity(&format!("{}\u{202f}±\u{202f}{}", digits(value), digits(half_width)), unit)
}

fn drift(d: &HistoryDrift, several: bool, words: Translator) -> DriftView {
    let unit = &d.quantity.unit;
    let is_shown = d.change.abs() > d.change_half_width;
    let key = if is_shown { "history.drift.shown" } else { "history.drift.not_shown" };
    let mut meaning = words.t(key);
    if d.common > 0.0 {
        let common = words.quantity(&limit_digits(d.common, 3, words.lang), unit);
        meaning = format!("{meaning} {}", words.with("history.drift.common", &[("common", &common)]));
    }
    let per_year = d.per_year.zip(d.per_year_half_width);
    DriftView {
        name: chart::name(&d.quantity, several, words),
        span: words.with(
            "history.drift.span",
            &[
                ("from", &date_time(&d.from)),
                ("to", &date_time(&d.to)),
                ("n", &count(d.tests as u64, words.lang)),
            ],
        ),
        change: plus_minus(d.change, d.change_half_width, unit, words),
        per_year: per_year.map_or_else(String::new, |(v, half)| plus_minus(v, half, unit, words)),
        meaning,
    }
}

fn station(s: &HistoryStation, several: bool, words: Translator) -> StationView {
    let unit = &s.quantity.unit;
    let missing = words.t("report.missing");
    StationView {
        name: chart::name(&s.quantity, several, words),
        station: if s.station.is_empty() { missing } else { s.station.clone() },
        units: count(s.units as u64, words.lang),
        mean: words.quantity(&limit_digits(s.mean, 4, words.lang), unit),
        difference: s
            .difference
            .zip(s.half_width)
            .map_or_else(String::new, |(d, half)| plus_minus(d, half, unit, words)),
        status: if s.differs { "remark" } else { "ok" },
    }
}

fn result(r: &HistoryResult, words: Translator) -> ResultView {
    let names: Vec<String> = r.reasons.iter().map(|(kind, name)| reason_name(kind, name, words)).collect();
    let reasons = match (&r.superseded_by, &r.superseded_because) {
        (Some(by), because) => words.with(
            "history.superseded",
            &[("by", by.get(..SHOWN).unwrap_or(by)), ("because", because.as_deref().unwrap_or_default())],
        ),
        _ => names.join(", "),
    };
    let serial = if r.serial.is_empty() { words.t("report.missing") } else { r.serial.clone() };
    ResultView {
        evaluated_at: date_time(&r.evaluated_at),
        serial: if r.reference { words.with("history.reference", &[("serial", &serial)]) } else { serial },
        lot: r.lot.clone(),
        procedure: words.with("report.id_revision", &[("id", &r.procedure), ("revision", &r.revision)]),
        station: r.station.clone(),
        attempt: if r.attempt == 0 { String::new() } else { count(r.attempt, words.lang) },
        verdict: r.verdict.id(),
        verdict_word: words.verdict(r.verdict),
        reasons,
        address: r.address.get(..SHOWN).unwrap_or(&r.address).to_owned(),
    }
}
