//! The units of a comparison on pages and on a terminal: their figures, their limits, and what is said of each.

use super::columns::{Row, of_record, table};
use crate::acceptance::compare::{Unit, part_name};
use crate::figure::Figure;
use crate::i18n::Note;
use crate::record::{MeasurandRecord, ModelRecord, ShareRecord, WindowRecord};
use crate::report::number::{digits, limit_digits, percent};
use crate::report::page::{Block, Table, Value};
use crate::report::translator::Translator;
use crate::report::view::{FigureView, limit_text};

/// Smallest share of a variance that has a row of its own.
const MIN_SHARE_SHOWN: f64 = 0.001;

/// The columns of a terminal.
const ON_TERMINAL: [&str; 12] = [
    "label",
    "length_s",
    "n",
    "sigma100_deg_h",
    "minimum_deg_h",
    "ratio_minimum",
    "null",
    "arw10_deg_rt_h",
    "n_deg_rt_h",
    "ratio_arw",
    "observed_over_predicted",
    "verdict",
];

/// The columns of the bias.
const BIAS: [&str; 9] = [
    "label_and_origin",
    "length_s",
    "n",
    "sigma100_deg_h",
    "sigma100_3sigma_deg_h",
    "minimum_deg_h",
    "minimum_scaled_deg_h",
    "b_deg_h",
    "floor_deg_h",
];

/// The columns of angle random walk.
const WALK: [&str; 7] =
    ["label", "n10", "sigma10_deg_h", "arw10_deg_rt_h", "n_deg_rt_h", "ratio_arw", "arw_inverse"];

/// The columns of what explains drift and ratio.
const EXPLAINED: [&str; 7] =
    ["label", "predicted_deg_h", "observed_over_predicted", "verdict", "ratio_minimum", "null", "null_50"];

/// Units, limits and figures on pages.
pub(super) fn blocks(units: &[Unit], figures: &[Figure], words: Translator) -> Vec<Block> {
    let all = table(units, words);
    let below = |key: &str, columns: &[&str], hint: Option<&str>| {
        let hint = hint.map(|key| Block::Hint(words.t(key)));
        let table = Block::Table(all.only(columns));
        Block::section("", words.t(key), std::iter::once(table).chain(hint).collect())
    };
    let limits = limits(units, words);
    let limits = (!limits.rows.is_empty()).then(|| {
        let below = vec![Block::Hint(words.t("compare.limits_hint")), Block::Table(limits)];
        [Block::SummaryEnd, Block::section("", words.t("compare.limits"), below)]
    });
    let drawn = |id: &str| {
        let figure = FigureView::find(figures, id, words)?;
        let caption = if figure.caption.is_empty() { figure.title.clone() } else { figure.caption.clone() };
        Some(Block::Section("figures", vec![Block::Figure(Box::new(FigureView { caption, ..figure }))]))
    };
    let each = units.iter().enumerate();
    let each =
        each.map(|(i, u)| section(u, FigureView::find(figures, &format!("octaves_{}", i + 1), words), words));
    [
        Block::Hint(words.t("compare.hint")),
        below("compare.bias", &BIAS, Some("compare.bias_hint")),
        below("compare.walk", &WALK, None),
        below("compare.explained", &EXPLAINED, Some("compare.explained_hint")),
    ]
    .into_iter()
    .chain(limits.into_iter().flatten())
    .chain(drawn("sigma_tau"))
    .chain(drawn("ratios"))
    .chain(each)
    .collect()
}

/// The figures of each unit, what is said of it, and its limits.
pub(super) fn on_terminal(units: &[Unit], words: Translator) -> Vec<Block> {
    let said = |unit: &Unit| {
        let notes = unit.summary.iter().chain(&unit.missing);
        notes.map(|n| format!("{}: {}", unit.label(), words.say(n))).collect::<Vec<_>>()
    };
    let limits = limits(units, words);
    let limits = (!limits.rows.is_empty()).then(|| {
        let columns = ["unit", "quantity", "value", "limit", "verdict"];
        [Block::heading(words.t("compare.limits")), Block::Table(limits.only(&columns))]
    });
    [Block::Table(table(units, words).only(&ON_TERMINAL)), Block::Paragraph(words.t("compare.more.units"))]
        .into_iter()
        .chain(Block::remarks(units.iter().flat_map(said)))
        .chain(limits.into_iter().flatten())
        .collect()
}

/// What is said of a unit, what its drift is made of, and the octaves.
fn section(unit: &Unit, figure: Option<FigureView>, words: Translator) -> Block {
    let lang = words.lang;
    let row = Row { unit, words };
    let minimum = row.minimum().map(|m| {
        let (tau, largest) = (limit_digits(m.tau_s, 3, lang), limit_digits(m.largest_tau_s, 3, lang));
        words.with("compare.minimum_at", &[("tau", &tau), ("largest", &largest)])
    });
    let place: Vec<String> = std::iter::once(unit.path.clone()).chain(minimum).collect();
    let say = |notes: &[Note]| Block::remarks(notes.iter().map(|n| words.say(n)));
    let shares = unit.detail.as_ref().zip(row.window(100.0)).map(|(d, w)| shares(w, &d.model, words));
    let shares = shares.filter(|table| !table.rows.is_empty()).map(Block::Table);
    let below = std::iter::once(Block::Hint(place.join(" · ")))
        .chain(say(&unit.summary))
        .chain(say(&unit.missing))
        .chain(shares)
        .chain(figure.map(|f| Block::Figure(Box::new(f))));
    Block::section("figures", unit.label(), below.collect())
}

/// The parts of a prediction that are worth a row; the small ones stand together in the last.
fn shares(window: &WindowRecord, model: &ModelRecord, words: Translator) -> Table {
    let (shown, small): (Vec<&ShareRecord>, Vec<&ShareRecord>) =
        window.shares.iter().partition(|s| s.share >= MIN_SHARE_SHOWN);
    let rest = ShareRecord {
        part: words.t("compare.more.rest"),
        index: 0,
        share: small.iter().map(|s| s.share).sum(),
        deviation_deg_h: small.iter().map(|s| s.deviation_deg_h.powi(2)).sum::<f64>().sqrt(),
    };
    let rest = (!small.is_empty()).then_some(&rest);
    let names = shown.iter().map(|s| words.say(&part_name(s, model)));
    let names = names.chain(rest.map(|r| r.part.clone())).collect::<Vec<_>>();
    let rows: Vec<&ShareRecord> = shown.iter().copied().chain(rest).collect();
    Table::new("budget", rows.len())
        .column(words.column("compare.part_of"), names)
        .column(words.number_column("compare.share"), rows.iter().map(|s| percent(s.share, words.lang)))
        .column(
            words.number_column("compare.alone"),
            rows.iter().map(|s| digits(s.deviation_deg_h, 3, words.lang)),
        )
}

/// The limits of all units, each with the figure that it names.
fn limits(units: &[Unit], words: Translator) -> Table {
    let limited = units.iter().flat_map(|u| u.quantities.iter().map(move |q| (u, q)));
    let limited: Vec<(&Unit, &MeasurandRecord)> = limited.filter(|(_, q)| q.limit.is_some()).collect();
    let all =
        |of: &dyn Fn(&MeasurandRecord) -> String| limited.iter().map(|(_, q)| of(q)).collect::<Vec<_>>();
    let verdict = |(_, q): &(&Unit, &MeasurandRecord)| {
        Value::state(q.verdict.id(), words.name("verdict", q.verdict.id()))
    };
    let source = |q: &MeasurandRecord| q.limit.as_ref().map(|l| l.source.clone()).unwrap_or_default();
    Table::new("cards", limited.len())
        .column(words.column("compare.column.unit").class("whole"), limited.iter().map(|(u, _)| u.label()))
        .column(words.column("report.quantity"), all(&|q| words.name("measurand", &q.id)))
        .column(
            words.number_column("report.value"),
            all(&|q| words.quantity(&of_record(q, words).printed, &q.unit)),
        )
        .column(words.number_column("report.limit"), all(&|q| limit_text(q, words)))
        .column(words.column("report.verdict"), limited.iter().map(verdict))
        .column(words.column("report.file").class("file"), all(&source))
}
