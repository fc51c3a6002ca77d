//! A quantity of a data sheet: its row, and what the row means.

use crate::i18n::Localize;
use crate::record::{
    DataSheet, SheetBound, SheetOf, SheetQuantity, SheetRisk, SheetScale, SheetShare, SheetSide,
};
use crate::report::number::{NOTHING, Rounding, bound, count, limit_digits};
use crate::report::page::{Block, Joined, OnTerminal, Quantity, Table, Value};
use crate::report::translator::Translator;
use crate::report::view::FigureView;

/// A quantity over the lot, with how its numbers are printed.
pub(super) struct Printed<'a> {
    /// The quantity.
    pub quantity: &'a SheetQuantity,
    /// Name, with its phase, and its channel where there are several.
    name: String,
    /// Rounding by the interval of the median; absent without a median.
    rounding: Option<Rounding>,
    words: Translator,
}

/// The quantities, a row each.
pub(super) fn table(all: &[Printed<'_>], words: Translator) -> Table {
    let column = |key: &str| words.number_column(&format!("datasheet.column.{key}"));
    let optional = |key: &str| column(key).on_terminal(OnTerminal::Optional);
    Table::new("sheet cards", all.len())
        .units_in_names()
        .column(words.column("datasheet.column.quantity"), all.iter().map(Printed::named))
        .column(optional("units"), all.iter().map(Printed::units))
        .column(column("typical"), all.iter().map(Printed::typical))
        .column(column("spread"), all.iter().map(Printed::spread))
        .column(column("bound_true"), all.iter().map(|p| p.bounds(SheetOf::True).strong()))
        .column(optional("bound_measured"), all.iter().map(|p| p.bounds(SheetOf::Measured)))
        .column(optional("largest"), all.iter().map(Printed::largest))
        .column(words.number_column("report.limit"), all.iter().map(Printed::limit))
}

impl<'a> Printed<'a> {
    /// The quantities of a sheet.
    pub(super) fn all(sheet: &'a DataSheet, words: Translator) -> Vec<Printed<'a>> {
        let several = several_channels(sheet);
        let printed = |quantity: &'a SheetQuantity| {
            let channel = several.then(|| words.channel(&quantity.channel, &quantity.id));
            let parts = [Some(title(quantity, words)), quantity.phase.clone(), channel];
            let typical = quantity.typical.as_ref();
            Printed {
                quantity,
                name: parts.into_iter().flatten().collect::<Vec<_>>().join(" · "),
                rounding: typical.map(|t| Rounding::of(t.value, Some((t.interval.low, t.interval.high)))),
                words,
            }
        };
        sheet.quantities.iter().map(printed).collect()
    }

    /// The name without the phase, which is a condition, and with the channel where there are several.
    pub(super) fn parameter(&self) -> String {
        let phase = self.quantity.phase.as_ref().map(|phase| format!(" · {phase}"));
        phase.map_or_else(|| self.name.clone(), |phase| self.name.replacen(&phase, "", 1))
    }

    /// A number as the median is rounded.
    pub(super) fn show(&self, value: f64) -> String {
        let lang = self.words.lang;
        self.rounding.map_or_else(|| limit_digits(value, 4, lang), |r| r.show(value, lang))
    }

    /// What is printed in the unit of the quantity; a dash where nothing is.
    fn in_unit(&self, number: Option<f64>, printed: String) -> Value {
        if printed.is_empty() {
            return NOTHING.into();
        }
        Quantity { number, printed, unit: self.words.unit(&self.quantity.unit) }.into()
    }

    fn named(&self) -> Value {
        Value::Sentence(self.name.clone()).detail(Joined::Unit, self.words.unit(&self.quantity.unit))
    }

    fn units(&self) -> Value {
        let count = |n: usize| count(n as u64, self.words.lang);
        let bounded = match self.quantity.bounded {
            0 => String::new(),
            n => self.words.with("datasheet.units_bounded", &[("bounded", &count(n))]),
        };
        Value::Text(count(self.quantity.units)).detail(Joined::Remark, bounded)
    }

    fn typical(&self) -> Value {
        let Some(typical) = &self.quantity.typical else { return NOTHING.into() };
        let (low, high) = (self.show(typical.interval.low), self.show(typical.interval.high));
        let interval = self.words.with("report.interval", &[("low", &low), ("high", &high)]);
        let value = self.in_unit(Some(typical.value), self.show(typical.value));
        value.strong().detail(Joined::Interval, interval)
    }

    /// Spread between units; of logarithms in percent.
    fn spread(&self) -> Value {
        let Some(spread) = &self.quantity.spread else { return NOTHING.into() };
        let printed = |v: f64| match self.quantity.scale {
            SheetScale::Log => spread_text(self.quantity, v, self.words),
            SheetScale::Linear => limit_digits(v, 2, self.words.lang),
        };
        let lots = spread.between_lots.map(|v| {
            let between = self.words.t("datasheet.column.between_lots");
            format!("{between} {}", printed(v))
        });
        Value::Text(printed(spread.between_units)).detail(Joined::Remark, lots.unwrap_or_default())
    }

    /// The bounds of a kind, lower before upper.
    fn bounds(&self, of: SheetOf) -> Value {
        let bounds = &self.quantity.bounds;
        let on = |side: SheetSide| bounds.iter().find(|b| b.of == of && b.side == side);
        let both = [on(SheetSide::Lower), on(SheetSide::Upper)].into_iter().flatten();
        self.in_unit(None, both.map(|b| one(b, self.words)).collect::<Vec<_>>().join("; "))
    }

    /// The largest value, and the unit that has it.
    fn largest(&self) -> Value {
        let Some(largest) = &self.quantity.largest else { return NOTHING.into() };
        self.in_unit(Some(largest.value), self.show(largest.value))
            .detail(Joined::Remark, largest.serial.clone())
    }

    fn limit(&self) -> Value {
        let limit = limit_text(self.quantity, self.words);
        if limit.is_empty() { NOTHING.into() } else { limit.into() }
    }

    /// What the numbers mean and what must be known, with the values of all units.
    pub(super) fn section(&self, figure: Option<FigureView>) -> Block {
        let (q, words) = (self.quantity, self.words);
        let meaning = meaning(q, &|v| self.show(v), words);
        let details = if meaning.is_empty() { vec![] } else { self.how_obtained() };
        let footnote = q.footnote.as_ref().map(|f| words.local(f));
        let notes = footnote.into_iter().chain(q.notes.iter().map(|n| n.say(words.lang)));
        let drawn = figure.map(|f| {
            let title = format!("{}. {}", self.name, words.t("datasheet.figure.units"));
            Block::Figure(Box::new(FigureView { title, caption: String::new(), is_titled: true, ..f }))
        });
        let below = Block::remarks(meaning.into_iter().chain(details));
        let below = below.into_iter().chain(Block::remarks(notes)).chain(drawn);
        Block::section("figures quantity", Value::Sentence(self.name.clone()), below.collect())
    }

    /// What each bound promises, and how bounds and quantity were obtained.
    fn how_obtained(&self) -> Vec<String> {
        let (q, words) = (self.quantity, self.words);
        let method = |b: &SheetBound| words.name("datasheet.method", &b.method);
        let of_all = q.bounds.first().filter(|b| q.bounds.iter().all(|o| o.method == b.method)).map(method);
        let bound = |b: &SheetBound| match &of_all {
            Some(_) => promised(q, b, words),
            None => format!("{} {}.", promised(q, b, words), method(b)),
        };
        let bounds: Vec<String> = q.bounds.iter().map(bound).collect();
        let by = of_all.map(|m| words.with("datasheet.bounds_by", &[("method", &m)]));
        let reading = q.reading.as_ref().map(|how| words.name("how", how));
        let read = reading.map(|r| words.with("datasheet.read_by", &[("reading", &r)]));
        bounds.into_iter().chain(by).chain(read).collect()
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

/// A sentence on what a bound promises.
fn promised(q: &SheetQuantity, b: &SheetBound, words: Translator) -> String {
    let key = match (b.of, b.side) {
        (SheetOf::True, SheetSide::Upper) => "datasheet.meaning.true_upper",
        (SheetOf::True, SheetSide::Lower) => "datasheet.meaning.true_lower",
        (SheetOf::Measured, SheetSide::Upper) => "datasheet.meaning.measured_upper",
        (SheetOf::Measured, SheetSide::Lower) => "datasheet.meaning.measured_lower",
    };
    let percent = |p: f64| limit_digits(100.0 * p, 4, words.lang);
    let value = words.quantity(&bound(b.value, b.side == SheetSide::Upper, words.lang), &q.unit);
    let (proportion, confidence) = (percent(b.proportion), percent(b.confidence));
    words.with(key, &[("value", &value), ("proportion", &proportion), ("confidence", &confidence)])
}

pub(super) fn limit_text(q: &SheetQuantity, words: Translator) -> String {
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

/// True where rows must name their channel.
pub(super) fn several_channels(sheet: &DataSheet) -> bool {
    sheet.quantities.iter().any(|q| Some(&q.channel) != sheet.quantities.first().map(|f| &f.channel))
}
