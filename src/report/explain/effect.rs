//! A cause on a page: sentences, parameters, where it shows, and what the recording cannot tell from it.

use super::print::{Printed, capital, chance, difference, parameter, place, stated, title, value};
use super::sentence;
use crate::effect::find;
use crate::i18n::{EffectText, effect_text};
use crate::mismatch::finding::{Explanation, Finding};
use crate::report::number::{duration, limit_digits, percent};
use crate::report::page::{Block, Column, Facts, Layout, Listed, OnTerminal, Quantity, Table, Value};
use crate::report::translator::Translator;

/// The section of a cause. `number`: its place among the causes, counted from 1.
pub(super) fn section(number: usize, f: &Finding, all: &Explanation, words: Translator) -> Block {
    let heading = Value::Named { text: format!("{number}. {}", name(f, words)), id: f.kind.clone() };
    let sentences = sentence::finding(f, all, words).into_iter().map(Block::Paragraph);
    let unnamed = f.is_unnamed().then(|| Block::Hint(words.t("explain.unknown.hint")));
    let below = std::iter::once(Block::subheading(heading))
        .chain(sentences)
        .chain(unnamed)
        .chain(parameters(f, all, words).map(Block::Table))
        .chain([Block::Facts(about(f, all, words))])
        .chain(other_causes(f, all, words));
    Block::Section("effect", below.collect())
}

/// Title of a cause.
pub(super) fn name(f: &Finding, words: Translator) -> String {
    capital(&title(f.effect_id(), words))
}

/// Parameters in the order of the catalogue, the size of the contribution last; `None` without any.
pub(super) fn parameters(f: &Finding, all: &Explanation, words: Translator) -> Option<Table> {
    let order: Vec<&str> =
        find(f.effect_id()).map(|e| e.params().iter().map(|p| p.name).collect()).unwrap_or_default();
    let place = |name: &str| match order.iter().position(|p| *p == name) {
        Some(i) => i,
        None if name == "rms_deg_h" => usize::MAX,
        None => order.len(),
    };
    let mut given: Vec<_> = f.parameters.iter().collect();
    given.sort_by_key(|(name, _)| place(name));
    let printed: Vec<Printed> = given.iter().map(|(name, p)| value(name, p, words)).collect();
    let quantities = given.iter().zip(&printed).map(|((_, p), printed)| Quantity {
        number: Some(p.value),
        printed: printed.value.clone(),
        unit: words.unit(&p.unit),
    });
    let claimed = |name: &str| {
        let claimed = all.nuisances.iter().find(|n| n.name.rsplit('.').next() == Some(name));
        claimed.map(|n| limit_digits(n.claimed, 6, words.lang)).unwrap_or_default()
    };
    let claimed: Vec<String> = given.iter().map(|(name, _)| claimed(name)).collect();
    let short = |column: Column, id: &str| column.short(words.name("terminal_column", id));
    let table = Table::new("compact cards", given.len())
        .column(
            short(words.column("explain.column.parameter"), "parameter"),
            given.iter().map(|(name, _)| parameter(name, words)),
        )
        .column(short(words.number_column("report.value").class("n value"), "value"), quantities)
        .column(
            short(words.number_column("explain.column.interval"), "interval"),
            printed.iter().map(|p| p.interval.clone()),
        )
        .units(words.t("report.unit"));
    let table = if claimed.iter().all(String::is_empty) {
        table
    } else {
        table.column(words.number_column("explain.column.claimed").on_terminal(OnTerminal::Hidden), claimed)
    };
    (!given.is_empty()).then_some(table)
}

/// Where a cause shows, what it is worth, and what the catalogue says of its kind.
fn about(f: &Finding, all: &Explanation, words: Translator) -> Facts {
    let text = |part| effect_text(f.effect_id(), part, words.lang).to_owned();
    let places: Vec<String> = f.places.iter().map(|p| place(p, all.recording.length_s, words)).collect();
    // A cause without a name has no model.
    let worth = if f.is_unnamed() { String::new() } else { difference(f.delta_bic, words) };
    let heldout = f.heldout_gain.map(|v| difference(v, words)).unwrap_or_default();
    let removed = f.removed_share.filter(|s| s.is_finite()).map(|s| percent(s, words.lang));
    let rows: [(&str, Value); 11] = [
        ("explain.column.place_of", places.join("; ").into()),
        ("explain.column.worth", worth.into()),
        ("explain.column.p", chance(f.p_value, words).into()),
        ("explain.column.heldout", heldout.into()),
        ("explain.column.removed", removed.unwrap_or_default().into()),
        ("explain.column.mechanism", text(EffectText::Mechanism).into()),
        ("explain.column.formula", Value::Formula(words.formula(&text(EffectText::Formula)))),
        ("explain.column.signature", text(EffectText::Signature).into()),
        ("explain.column.told_by", text(EffectText::Distinguishing).into()),
        ("explain.column.confirm", text(EffectText::Confirm).into()),
        ("explain.column.source", text(EffectText::Source).into()),
    ];
    let rows = rows.into_iter().filter(|(_, value)| !value.plain().is_empty());
    Facts { class: "about", rows: rows.map(|(key, value)| (words.t(key).into(), value)).collect() }
}

/// Causes that the recording cannot tell from this one, each with what would.
fn other_causes(f: &Finding, all: &Explanation, words: Translator) -> Vec<Block> {
    let kinds: Vec<&str> = f.other_causes().map(String::as_str).collect();
    if kinds.is_empty() {
        return vec![];
    }
    let below = |name: &str| Column::text(name, "").listed(Listed::Below(String::new()));
    let sentences = |key: &str, part: EffectText| {
        let sentence = |kind: &&str| match effect_text(kind, part, words.lang) {
            "" => String::new(),
            text => words.with(key, &[("text", text)]),
        };
        kinds.iter().map(sentence).collect::<Vec<_>>()
    };
    let table = Table::new("", kinds.len())
        .column(Column::text("title", ""), kinds.iter().map(|k| capital(&title(k, words))))
        .column(below("signature"), sentences("explain.equivalents.signature", EffectText::Signature))
        .column(below("told_by"), sentences("explain.equivalents.told_by", EffectText::Distinguishing))
        .column(below("confirm"), sentences("explain.equivalents.confirm", EffectText::Confirm))
        .column(below("longer"), kinds.iter().map(|k| longer(k, &f.kind, all, words)))
        .laid_out(Layout::List, Layout::List);
    vec![Block::subheading(words.t("explain.equivalents.title")), Block::Table(table)]
}

/// Whether a longer record would tell a cause from the chosen one, and how long it must be.
fn longer(kind: &str, chosen: &str, all: &Explanation, words: Translator) -> String {
    let experiment = all.experiments.iter().find(|e| e.kind == chosen && e.against == kind);
    let times = experiment.and_then(|e| e.times_longer).filter(|t| t.is_finite());
    match (times, experiment) {
        (Some(times), _) if times <= 1.0 => words.t("explain.same_length"),
        (Some(times), _) => {
            let length = duration(rounded(times * all.recording.length_s), words.lang);
            let times = limit_digits(times, 2, words.lang);
            words.with("explain.longer", &[("times", &times), ("length", &length)])
        }
        (None, Some(_)) => words.t("explain.no_length"),
        (None, None) => String::new(),
    }
}

/// Two significant digits: a needed length is no finer known.
fn rounded(v: f64) -> f64 {
    format!("{v:.1e}").parse().unwrap_or(v)
}

/// Values that the claim states, each with what the recording says of it; `None` without any.
pub(super) fn stated_values(all: &Explanation, words: Translator) -> Option<Table> {
    let shown = |v: f64| limit_digits(v, 4, words.lang);
    let each = || all.nuisances.iter();
    // An exact value has no standard deviation to move by.
    let of_uncertain = |uncertainty: f64, text: String| if uncertainty > 0.0 { text } else { String::new() };
    let moved = |claimed: f64, augmented: f64, uncertainty: f64| {
        of_uncertain(uncertainty, difference((augmented - claimed) / uncertainty, words))
    };
    let number = |key: &str| words.number_column(key);
    let table = Table::new("cards", all.nuisances.len())
        .column(words.column("explain.stated.value"), each().map(|n| stated(&n.name, words)))
        .column(words.column("report.unit").class("unit"), each().map(|n| words.unit(&n.unit)))
        .column(number("explain.stated.claimed"), each().map(|n| limit_digits(n.claimed, 6, words.lang)))
        .column(
            number("explain.stated.uncertainty"),
            each().map(|n| of_uncertain(n.uncertainty, shown(n.uncertainty))),
        )
        .column(number("explain.stated.baseline"), each().map(|n| shown(n.baseline)))
        .column(number("explain.stated.augmented"), each().map(|n| shown(n.augmented)))
        .column(number("explain.stated.moved"), each().map(|n| moved(n.claimed, n.augmented, n.uncertainty)));
    (!table.rows.is_empty()).then_some(table)
}
