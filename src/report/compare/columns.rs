//! Everything that is shown of the units of a comparison, as the columns of one table: pages and the terminal pick some, the table for
//! programs has them all.

use crate::acceptance::compare::{Origin, ReadOutRule, RuleRow, Unit};
use crate::estimate::{Interval, UpperLimit};
use crate::measurand;
use crate::record::{
    Agreement, ComparisonRecord, FloorRecord, MeasurandRecord, MinimumRecord, ShareRecord, WindowRecord,
};
use crate::report::number::{Rounding, bound, count, digits, duration, limit_digits};
use crate::report::page::{Column, Joined, OnTerminal, Quantity, Table, Value};
use crate::report::translator::Translator;

/// The units, a row each.
pub(super) fn table(units: &[Unit], words: Translator) -> Table {
    let rows: Vec<Row<'_>> = units.iter().map(|unit| Row { unit, words }).collect();
    let columns = Columns { table: Table::new("ratios cards", rows.len()), rows: &rows, words };
    let columns = of_explanation(of_walk(of_bias(of_drift(of_unit(columns)))));
    columns.table
}

/// A unit of which values are printed.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub unit: &'a Unit,
    pub words: Translator,
}

impl<'a> Row<'a> {
    fn detail(&self) -> Option<&'a ComparisonRecord> {
        self.unit.detail.as_ref()
    }

    pub fn window(&self, window_s: f64) -> Option<&'a WindowRecord> {
        self.detail()?.windows.iter().find(|w| w.window_s == window_s)
    }

    pub fn minimum(&self) -> Option<&'a MinimumRecord> {
        self.detail()?.minimum.as_ref()
    }

    fn floor(&self) -> Option<&'a FloorRecord> {
        self.detail()?.floor.as_ref()
    }

    /// The part that has most of the variance.
    fn largest_share(&self) -> Option<&'a ShareRecord> {
        self.window(100.0)?.shares.first()
    }

    fn null(&self) -> Option<[f64; 3]> {
        self.minimum()?.null_ratio
    }

    fn rule(&self, rule: ReadOutRule) -> Option<&'a RuleRow> {
        self.unit.rules.iter().find(|row| row.rule == rule)
    }

    fn low(&self, id: &str) -> Option<f64> {
        Some(self.unit.quantity(id)?.interval?.low)
    }

    fn high(&self, id: &str) -> Option<f64> {
        Some(self.unit.quantity(id)?.interval?.high)
    }

    /// A measured quantity with its interval.
    fn quantity(&self, id: &str) -> Value {
        self.unit.quantity(id).map_or(Value::Empty, |q| of_record(q, self.words).value())
    }

    /// Bias instability by a rule, with the ratio to it.
    fn by_rule(&self, rule: ReadOutRule) -> Value {
        let words = self.words;
        let Some(row) = self.rule(rule) else { return Value::Empty };
        let figure = Printed::new(row.value, row.interval, row.upper_limit, words).value();
        let ratio = ratio(row, words);
        let line = |key: &str, printed: &str| {
            if printed.is_empty() { String::new() } else { words.with(key, &[("ratio", printed)]) }
        };
        let inverse = row.inverse.map(|v| digits(v, 3, words.lang)).unwrap_or_default();
        figure
            .detail(Joined::Further, line("compare.ratio_line", &ratio.printed))
            .detail(Joined::Interval, ratio.interval)
            .detail(Joined::Further, line("compare.inverse_line", &inverse))
    }

    /// The verdict on the prediction.
    fn agreement(&self) -> Value {
        let words = self.words;
        let (id, word) = match self.window(100.0).and_then(|w| w.agreement) {
            Some(Agreement::Consistent) => ("ok", words.t("compare.agreement.consistent")),
            Some(Agreement::Above) => ("remark", words.t("compare.agreement.above")),
            Some(Agreement::Below) => ("remark", words.t("compare.agreement.below")),
            None => return Value::state("none", ""),
        };
        if self.unit.indicative {
            return Value::state("remark", words.with("compare.more.indicative", &[("verdict", &word)]));
        }
        Value::state(id, word)
    }
}

/// A table in the making.
struct Columns<'a> {
    table: Table,
    rows: &'a [Row<'a>],
    words: Translator,
}

impl<'a> Columns<'a> {
    fn with<V: Into<Value>>(self, column: Column, of: impl Fn(&Row<'a>) -> V) -> Columns<'a> {
        Columns { table: self.table.column(column, self.rows.iter().map(of)), ..self }
    }

    /// A number for programs alone.
    fn number(self, name: &str, of: impl Fn(&Row<'a>) -> Option<f64>) -> Columns<'a> {
        self.with(Column::number(name, ""), of)
    }

    /// A text for programs alone.
    fn text(self, name: &str, of: impl Fn(&Row<'a>) -> String) -> Columns<'a> {
        self.with(Column::text(name, ""), of)
    }

    /// The ends of the interval of a measurand, for programs alone.
    fn ends(self, name: &str, id: &'static str) -> Columns<'a> {
        let low = self.number(&format!("{name}_low"), |r| r.low(id));
        low.number(&format!("{name}_high"), |r| r.high(id))
    }

    /// A number with a head.
    fn shown(self, name: &str, head: &str, of: impl Fn(&Row<'a>) -> Value) -> Columns<'a> {
        let head = self.words.t(head);
        self.with(Column::number(name, head), of)
    }
}

/// A column of numbers with its heads on pages and on a terminal.
fn column(name: &str, on_pages: &str, on_terminal: &str, words: Translator) -> Column {
    Column::number(name, words.t(on_pages)).short(words.t(on_terminal))
}

/// The same, left out first on a terminal where the columns do not fit.
fn optional(name: &str, on_pages: &str, on_terminal: &str, words: Translator) -> Column {
    column(name, on_pages, on_terminal, words).on_terminal(OnTerminal::Optional)
}

/// How many windows of a length there are, printed.
fn windows(row: &Row<'_>, window_s: f64) -> String {
    row.window(window_s).map(|w| count(w.n, row.words.lang)).unwrap_or_default()
}

fn of_unit(columns: Columns<'_>) -> Columns<'_> {
    let words = columns.words;
    let label = |name: &str| Column::text(name, words.t("compare.column.unit")).for_pages();
    let origin = move |r: &Row<'_>| {
        let origin = match r.unit.origin {
            Origin::Recording => "compare.origin.recording",
            Origin::Result => "compare.origin.result",
        };
        Value::Text(r.unit.label()).detail(Joined::Remark, words.t(origin))
    };
    let length = move |r: &Row<'_>| {
        let printed = r.unit.length_s.map(|t| duration(t, words.lang)).unwrap_or_default();
        Value::from(Quantity { number: r.unit.length_s, printed, unit: String::new() })
    };
    columns
        .text("unit", |r| r.unit.name.clone())
        .text("channel", |r| r.unit.channel.clone())
        .text("path", |r| r.unit.path.clone())
        .with(label("label"), |r| r.unit.label())
        .with(label("label_and_origin"), origin)
        .with(optional("length_s", "compare.column.length", "compare.column.length", words), length)
        .text("n_100s", |r| r.window(100.0).map(|w| w.n.to_string()).unwrap_or_default())
        .with(optional("n", "compare.column.n", "compare.column.n", words).for_pages(), |r| windows(r, 100.0))
        .text("detrend", |r| r.detail().map(|d| d.detrend.clone()).unwrap_or_default())
}

fn of_drift(columns: Columns<'_>) -> Columns<'_> {
    let (drift, three_sigma) = (measurand::RUSSIAN_DRIFT_100S.id, measurand::RUSSIAN_DRIFT_100S_3SIGMA.id);
    let head = column("sigma100_deg_h", "compare.sigma100", "compare.column.sigma100", columns.words);
    columns.with(head, |r| r.quantity(drift)).ends("sigma100", drift).shown(
        "sigma100_3sigma_deg_h",
        "compare.sigma3",
        |r| r.quantity(three_sigma),
    )
}

fn of_bias(columns: Columns<'_>) -> Columns<'_> {
    let words = columns.words;
    let minimum = column("minimum_deg_h", "compare.rule.a", "compare.column.minimum", words);
    let ratio_of_minimum = column("ratio_minimum", "compare.ratio", "compare.column.ratio", words);
    let null = optional("null", "compare.null", "compare.column.null", words).for_pages();
    let b_limit = |r: &Row<'_>| {
        let b = r.unit.quantity(measurand::BIAS_INSTABILITY.id).filter(|b| b.value.is_none());
        Some(b?.upper_limit?.value)
    };
    let of_minimum =
        |r: &Row<'_>| r.rule(ReadOutRule::Minimum).map_or(Value::Empty, |row| ratio(row, words).value());
    let between = |r: &Row<'_>| {
        let ends = r.null().map(|[low, _, high]| [low, high].map(|v| digits(v, 2, words.lang)));
        ends.map_or_else(String::new, |[low, high]| {
            words.with("report.interval", &[("low", &low), ("high", &high)])
        })
    };
    let median = |r: &Row<'_>| {
        let number = r.null().map(|[_, median, _]| median);
        let printed = number.map(|v| digits(v, 2, words.lang)).unwrap_or_default();
        Value::from(Quantity { number, printed, unit: String::new() })
    };
    columns
        .with(minimum, |r| r.by_rule(ReadOutRule::Minimum))
        .ends("minimum", measurand::BIAS_INSTABILITY_MINIMUM.id)
        .number("minimum_tau_s", |r| Some(r.minimum()?.tau_s))
        .number("largest_tau_s", |r| Some(r.minimum()?.largest_tau_s))
        .shown("minimum_scaled_deg_h", "compare.rule.b", |r| r.by_rule(ReadOutRule::ScaledMinimum))
        .shown("b_deg_h", "compare.rule.c", |r| r.by_rule(ReadOutRule::FittedB))
        .ends("b", measurand::BIAS_INSTABILITY.id)
        .number("b_upper_limit", b_limit)
        .shown("floor_deg_h", "compare.rule.d", |r| r.by_rule(ReadOutRule::FittedFloor))
        .with(ratio_of_minimum, of_minimum)
        .number("ratio_minimum_low", |r| Some(r.rule(ReadOutRule::Minimum)?.ratio_interval?.low))
        .number("ratio_minimum_high", |r| Some(r.rule(ReadOutRule::Minimum)?.ratio_interval?.high))
        .number("ratio_minimum_inverse", |r| r.rule(ReadOutRule::Minimum)?.inverse)
        .number("ratio_b", |r| r.rule(ReadOutRule::FittedB).filter(|b| b.value.is_some())?.ratio)
        .number("null_05", |r| r.null().map(|[low, ..]| low))
        .shown("null_50", "compare.null_median", median)
        .number("null_95", |r| r.null().map(|[.., high]| high))
        .with(null, between)
}

fn of_walk(columns: Columns<'_>) -> Columns<'_> {
    let words = columns.words;
    let (arw, n) = (measurand::RUSSIAN_ARW_10S.id, measurand::ANGLE_RANDOM_WALK.id);
    let ratio = measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id;
    let n10 = Column::number("n10", words.t("compare.column.n10")).for_pages();
    let inverse = Column::number("arw_inverse", words.t("compare.arw_inverse")).for_pages();
    columns
        .shown("sigma10_deg_h", "compare.sigma10", |r| r.quantity(measurand::RUSSIAN_SIGMA_10S.id))
        .text("n_10s", |r| r.window(10.0).map(|w| w.n.to_string()).unwrap_or_default())
        .with(n10, |r| windows(r, 10.0))
        .with(optional("arw10_deg_rt_h", "compare.arw10", "compare.column.arw", words), |r| r.quantity(arw))
        .ends("arw10", arw)
        .with(column("n_deg_rt_h", "compare.n_fitted", "compare.column.n_allan", words), |r| r.quantity(n))
        .ends("n", n)
        .with(optional("ratio_arw", "compare.arw_ratio", "compare.column.ratio", words), |r| {
            r.quantity(ratio)
        })
        .ends("ratio_arw", ratio)
        .with(inverse, |r| r.unit.value(ratio).map(|v| digits(1.0 / v, 3, words.lang)).unwrap_or_default())
}

fn of_explanation(columns: Columns<'_>) -> Columns<'_> {
    let words = columns.words;
    let over = optional("observed_over_predicted", "compare.over", "compare.column.over", words);
    let verdict = Column::text("verdict", words.t("compare.column.verdict")).for_pages();
    let predicted = |r: &Row<'_>| {
        let window = r.window(100.0);
        window.map_or(Value::Empty, |w| Printed::new(w.predicted, w.predicted_interval, None, words).value())
    };
    let observed = |r: &Row<'_>| {
        let window = r.window(100.0);
        window.map_or(Value::Empty, |w| Printed::new(w.ratio, w.ratio_interval, None, words).value())
    };
    let agreement = |r: &Row<'_>| {
        let agreement = r.window(100.0).and_then(|w| w.agreement);
        agreement.map_or_else(String::new, |a| a.id().to_owned())
    };
    columns
        .shown("predicted_deg_h", "compare.predicted", predicted)
        .number("predicted_low", |r| Some(r.window(100.0)?.predicted_interval?.low))
        .number("predicted_high", |r| Some(r.window(100.0)?.predicted_interval?.high))
        .with(over, observed)
        .number("observed_over_predicted_low", |r| Some(r.window(100.0)?.ratio_interval?.low))
        .number("observed_over_predicted_high", |r| Some(r.window(100.0)?.ratio_interval?.high))
        .text("agreement", agreement)
        .with(verdict, Row::agreement)
        .text("largest_part", |r| r.largest_share().map(|s| s.part.clone()).unwrap_or_default())
        .number("largest_share", |r| Some(r.largest_share()?.share))
        .number("crossover_s", |r| Some(r.floor()?.crossover_s))
        .number("identifiable_h", |r| r.floor()?.identifiable_h)
}

/// A value and its interval, printed. The units stand above the table.
#[derive(Default)]
pub(super) struct Printed {
    number: Option<f64>,
    pub printed: String,
    interval: String,
}

impl Printed {
    fn new(
        value: Option<f64>,
        interval: Option<Interval>,
        upper: Option<UpperLimit>,
        words: Translator,
    ) -> Printed {
        match (value, upper) {
            (Some(v), _) => {
                let rounding = Rounding::of(v, interval.map(|i| (i.low, i.high)));
                let interval = interval.map(|i| between(i, rounding, words)).unwrap_or_default();
                Printed { number: value, printed: rounding.show(v, words.lang), interval }
            }
            (None, Some(u)) => {
                let coverage = limit_digits(100.0 * u.coverage, 3, words.lang);
                let value = bound(u.value, true, words.lang);
                let printed = words.with("report.at_most", &[("value", &value), ("coverage", &coverage)]);
                Printed { printed, ..Printed::default() }
            }
            (None, None) => Printed::default(),
        }
    }

    pub fn value(self) -> Value {
        let quantity = Quantity { number: self.number, printed: self.printed, unit: String::new() };
        Value::from(quantity).strong().detail(Joined::Interval, self.interval)
    }
}

/// A row of a result, printed.
pub(super) fn of_record(q: &MeasurandRecord, words: Translator) -> Printed {
    Printed::new(q.value, q.interval, q.upper_limit, words)
}

fn between(i: Interval, rounding: Rounding, words: Translator) -> String {
    let show = |v: f64| rounding.show(v, words.lang);
    words.with("report.interval", &[("low", &show(i.low)), ("high", &show(i.high))])
}

/// The ratio to bias instability by a rule; where that is only bounded, the least that the ratio can be.
fn ratio(row: &RuleRow, words: Translator) -> Printed {
    let mut ratio = Printed::new(row.ratio, row.ratio_interval, None, words);
    if row.ratio_interval.is_none() {
        ratio.printed = row.ratio.map(|r| digits(r, 3, words.lang)).unwrap_or_default();
    }
    if row.value.is_none() && !ratio.printed.is_empty() {
        ratio.printed = format!("≥\u{202f}{}", ratio.printed);
    }
    ratio
}
