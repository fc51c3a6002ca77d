//! A quantity of a data sheet, printed.

use crate::i18n::Localize;
use crate::record::{SheetBound, SheetOf, SheetQuantity, SheetRisk, SheetScale, SheetShare, SheetSide};
use crate::report::number::{Rounding, bound, count, limit_digits};
use crate::report::translator::Translator;
use crate::report::view::FigureView;
use serde::Serialize;

/// A quantity over the lot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantityView {
    /// Name, with its phase and channel where there are several.
    pub name: String,
    /// Unit of every number that states none.
    pub unit: String,
    /// Units that count.
    pub units: String,
    /// How many of them are only bounded, in words; empty where none is.
    pub bounded: String,
    /// Median; empty where it cannot be told.
    pub typical: String,
    /// Its interval.
    pub interval: String,
    /// Spread between units; in percent where it is one of logarithms.
    pub between_units: String,
    /// Spread between lots.
    pub between_lots: String,
    /// Spread of the measurement.
    pub measurement: String,
    /// Bounds for true values.
    pub bound_true: String,
    /// Bounds for measured values.
    pub bound_measured: String,
    /// Each bound with what it means.
    pub bounds: Vec<BoundView>,
    /// How all bounds were obtained, in words; empty where they were obtained in several ways.
    pub method: String,
    /// How the quantity was read, in words; empty where results differ or do not say.
    pub reading: String,
    /// Largest value.
    pub largest: String,
    /// Serial number of the unit that has it.
    pub largest_of: String,
    /// Limit of the results; empty where there is none.
    pub limit: String,
    /// What the number of the quantity means, in sentences.
    pub meaning: Vec<String>,
    /// What must be known with it.
    pub notes: Vec<String>,
    /// The units with their intervals.
    pub figure: Option<FigureView>,
}

/// A bound, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundView {
    /// The bound.
    pub value: String,
    /// How it was obtained, in words.
    pub method: String,
    /// What it promises, in a sentence.
    pub meaning: String,
}

impl QuantityView {
    /// Builds the view; `several` where the channel must be named.
    pub(super) fn new(
        q: &SheetQuantity,
        several: bool,
        figure: Option<FigureView>,
        words: Translator,
    ) -> QuantityView {
        let title = title(q, words);
        let name = [Some(title.clone()), q.phase.clone()];
        let name = name.into_iter().flatten().chain(several.then(|| words.channel(&q.channel, &q.id)));
        let rounding =
            q.typical.as_ref().map(|t| Rounding::of(t.value, Some((t.interval.low, t.interval.high))));
        let show =
            |v: f64| rounding.map_or_else(|| limit_digits(v, 4, words.lang), |r| r.show(v, words.lang));
        let spread = |v: f64| match q.scale {
            SheetScale::Log => spread_text(q, v, words),
            SheetScale::Linear => limit_digits(v, 2, words.lang),
        };
        let footnote = q.footnote.as_ref().map(|f| words.local(f));
        QuantityView {
            name: name.collect::<Vec<_>>().join(" · "),
            unit: words.unit(&q.unit),
            units: count(q.units as u64, words.lang),
            bounded: match q.bounded {
                0 => String::new(),
                n => words.with("datasheet.units_bounded", &[("bounded", &count(n as u64, words.lang))]),
            },
            typical: q.typical.as_ref().map_or_else(String::new, |t| show(t.value)),
            interval: q.typical.as_ref().map_or_else(String::new, |t| {
                let (low, high) = (show(t.interval.low), show(t.interval.high));
                words.with("report.interval", &[("low", &low), ("high", &high)])
            }),
            between_units: q.spread.as_ref().map_or_else(String::new, |s| spread(s.between_units)),
            between_lots: q.spread.as_ref().and_then(|s| s.between_lots).map_or_else(String::new, spread),
            measurement: q.spread.as_ref().map_or_else(String::new, |s| spread(s.measurement)),
            bound_true: bound_text(q, SheetOf::True, words),
            bound_measured: bound_text(q, SheetOf::Measured, words),
            bounds: q.bounds.iter().map(|b| bound_view(q, b, words)).collect(),
            method: match q.bounds.first() {
                Some(b) if q.bounds.iter().all(|o| o.method == b.method) => {
                    words.name("datasheet.method", &b.method)
                }
                _ => String::new(),
            },
            reading: q.reading.as_ref().map_or_else(String::new, |how| words.name("how", how)),
            largest: q.largest.as_ref().map_or_else(String::new, |l| show(l.value)),
            largest_of: q.largest.as_ref().map_or_else(String::new, |l| l.serial.clone()),
            limit: limit_text(q, words),
            meaning: meaning(q, &show, words),
            notes: footnote.into_iter().chain(q.notes.iter().map(|n| n.say(words.lang))).collect(),
            figure: figure.map(|f| FigureView { title, ..f }),
        }
    }
}

/// The name of a quantity: that of the sheet file, or its own.
fn title(q: &SheetQuantity, words: Translator) -> String {
    q.name.as_ref().map_or_else(|| words.name("measurand", &q.id), |name| words.local(name))
}

/// A spread: of logarithms as a factor in percent, else with the unit.
fn spread_text(q: &SheetQuantity, value: f64, words: Translator) -> String {
    match q.scale {
        SheetScale::Log => format!("{}\u{202f}%", limit_digits(100.0 * value.exp_m1(), 2, words.lang)),
        SheetScale::Linear => words.quantity(&limit_digits(value, 2, words.lang), &q.unit),
    }
}

fn one(b: &SheetBound, words: Translator) -> String {
    let upper = b.side == SheetSide::Upper;
    let sign = if upper { '≤' } else { '≥' };
    format!("{sign}\u{202f}{}", bound(b.value, upper, words.lang))
}

/// The bounds of a kind, lower before upper.
fn bound_text(q: &SheetQuantity, of: SheetOf, words: Translator) -> String {
    let on = |side: SheetSide| q.bounds.iter().find(|b| b.of == of && b.side == side);
    let both = [on(SheetSide::Lower), on(SheetSide::Upper)];
    both.into_iter().flatten().map(|b| one(b, words)).collect::<Vec<_>>().join("; ")
}

fn bound_view(q: &SheetQuantity, b: &SheetBound, words: Translator) -> BoundView {
    let key = match (b.of, b.side) {
        (SheetOf::True, SheetSide::Upper) => "datasheet.meaning.true_upper",
        (SheetOf::True, SheetSide::Lower) => "datasheet.meaning.true_lower",
        (SheetOf::Measured, SheetSide::Upper) => "datasheet.meaning.measured_upper",
        (SheetOf::Measured, SheetSide::Lower) => "datasheet.meaning.measured_lower",
    };
    let percent = |p: f64| limit_digits(100.0 * p, 4, words.lang);
    let value = words.quantity(&bound(b.value, b.side == SheetSide::Upper, words.lang), &q.unit);
    BoundView {
        value: one(b, words),
        method: words.name("datasheet.method", &b.method),
        meaning: words.with(
            key,
            &[
                ("value", &value),
                ("proportion", &percent(b.proportion)),
                ("confidence", &percent(b.confidence)),
            ],
        ),
    }
}

fn limit_text(q: &SheetQuantity, words: Translator) -> String {
    let Some(limit) = q.limit else { return String::new() };
    let shown = |v: f64| crate::report::number::limit(v, words.lang);
    match (limit.min, limit.max) {
        (Some(min), Some(max)) if max > 0.0 && (min + max).abs() <= 1e-9 * max => {
            format!("±\u{202f}{}", shown(max))
        }
        (Some(min), Some(max)) => {
            words.with("report.interval", &[("low", &shown(min)), ("high", &shown(max))])
        }
        (Some(min), None) => format!("≥\u{202f}{}", shown(min)),
        (None, Some(max)) => format!("≤\u{202f}{}", shown(max)),
        (None, None) => String::new(),
    }
}

/// What the numbers of the quantity mean.
fn meaning(q: &SheetQuantity, show: &impl Fn(f64) -> String, words: Translator) -> Vec<String> {
    let (Some(typical), Some(spread)) = (&q.typical, &q.spread) else { return vec![] };
    let unit = |v: f64| words.quantity(&show(v), &q.unit);
    let mut out = vec![words.with(
        "datasheet.meaning.typical",
        &[
            ("value", &unit(typical.value)),
            ("low", &show(typical.interval.low)),
            ("high", &unit(typical.interval.high)),
            ("coverage", &limit_digits(100.0 * typical.interval.coverage, 3, words.lang)),
        ],
    )];
    out.push(words.with(
        "datasheet.meaning.spread",
        &[
            ("units", &spread_text(q, spread.between_units, words)),
            ("measurement", &spread_text(q, spread.measurement, words)),
        ],
    ));
    if let Some((max, share)) = q.limit.and_then(|l| Some((l.max?, l.share_above?))) {
        let limit = words.quantity(&crate::report::number::limit(max, words.lang), &q.unit);
        out.push(share_of("datasheet.meaning.limit", &limit, share, words));
    }
    let upper = q.bounds.iter().find(|b| b.of == SheetOf::Measured && b.side == SheetSide::Upper);
    if let Some(b) = upper {
        if let Some(max) = q.limit.and_then(|l| l.max).filter(|m| *m > 0.0 && b.value > 0.0) {
            out.push(words.with(
                "datasheet.meaning.limit_ratio",
                &[("times", &limit_digits(max / b.value, 3, words.lang))],
            ));
        }
        if let Some(share) = q.share_above_bound {
            let limit = words.quantity(&bound(b.value, true, words.lang), &q.unit);
            out.push(share_of("datasheet.meaning.proposal", &limit, share, words));
        }
    }
    for more in &q.outlook {
        let value = bound(more.value, more.side == SheetSide::Upper, words.lang);
        let value = words.quantity(&value, &q.unit);
        let n = count(more.units as u64, words.lang);
        out.push(words.with("datasheet.meaning.outlook", &[("n", &n), ("value", &value)]));
    }
    out.extend(q.risks.iter().map(|r| risk(r, words)));
    out
}

fn share_of(key: &str, limit: &str, share: SheetShare, words: Translator) -> String {
    let percent = |p: f64| crate::report::number::percent(p, words.lang);
    words.with(
        key,
        &[
            ("limit", limit),
            ("share", &percent(share.value)),
            ("low", &percent(share.interval.low)),
            ("high", &percent(share.interval.high)),
        ],
    )
}

/// The risks of the present limit, for the present test or a shorter one.
fn risk(risk: &SheetRisk, words: Translator) -> String {
    let percent = |p: f64| crate::report::number::percent(p, words.lang);
    let both = [("consumer", percent(risk.consumer)), ("producer", percent(risk.producer))];
    let [consumer, producer] = &both;
    let both = [(consumer.0, consumer.1.as_str()), (producer.0, producer.1.as_str())];
    if risk.length >= 1.0 {
        return words.with("datasheet.meaning.risk", &both);
    }
    let length = percent(risk.length);
    words.with("datasheet.meaning.risk_shorter", &[both[0], both[1], ("length", &length)])
}
