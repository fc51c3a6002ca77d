//! One unit of a comparison, printed.

use crate::acceptance::compare::{Origin, RuleRow, Unit, part_name};
use crate::estimate::{Interval, UpperLimit, Verdict};
use crate::measurand;
use crate::record::{Agreement, MeasurandRecord, ModelRecord, ShareRecord, WindowRecord};
use crate::report::number::{Rounding, bound, digits, duration, limit, limit_digits, percent};
use crate::report::translator::Translator;
use crate::report::view::FigureView;
use serde::Serialize;

/// A value and its interval, printed; empty where there is none.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Cell {
    /// Value, or the bound.
    pub value: String,
    /// 95 % interval.
    pub interval: String,
}

/// Bias instability by one rule with the ratio to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuleCell {
    /// The rule in words.
    pub name: String,
    /// The figure.
    pub figure: Cell,
    /// σ of 100-s means over it.
    pub ratio: Cell,
    /// The ratio the other way.
    pub inverse: String,
}

/// One part of the predicted variance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShareView {
    /// Part, in words.
    pub part: String,
    /// Share, %.
    pub share: String,
    /// What it alone would give.
    pub alone: String,
}

/// A limit and the figure it names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitView {
    /// Unit.
    pub unit: String,
    /// The quantity that the limit names.
    pub quantity: String,
    /// Its value with unit.
    pub value: String,
    /// The limit.
    pub limit: String,
    /// Id of the verdict.
    pub verdict: Verdict,
    /// The verdict in words.
    pub verdict_word: String,
    /// File the limit stands in.
    pub source: String,
}

/// One unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitView {
    /// Name with channel.
    pub label: String,
    /// Where it comes from.
    pub path: String,
    /// Analysed now or read from a result.
    pub origin: String,
    /// Record length.
    pub length: String,
    /// 100-s windows.
    pub n: String,
    /// 10-s windows.
    pub n10: String,
    /// σ over 100 s, 1σ.
    pub sigma100: Cell,
    /// The same, 3σ.
    pub sigma3: Cell,
    /// σ over 10 s.
    pub sigma10: Cell,
    /// Bias instability by each rule, a to d.
    pub rules: Vec<RuleCell>,
    /// Where the minimum stands, and the longest averaging time read.
    pub minimum_at: String,
    /// Angle random walk from 10-s means.
    pub arw: Cell,
    /// N.
    pub n_allan: Cell,
    /// Ratio of the two.
    pub arw_ratio: Cell,
    /// The ratio the other way.
    pub arw_inverse: String,
    /// Predicted σ over 100 s.
    pub predicted: Cell,
    /// Observed over predicted.
    pub over: Cell,
    /// The verdict on it, in words.
    pub agreement: String,
    /// Its class for colours.
    pub agreement_class: &'static str,
    /// What angle random walk alone would give: 5 to 95 %.
    pub null: String,
    /// Its median.
    pub null_median: String,
    /// Parts of the prediction.
    pub shares: Vec<ShareView>,
    /// The findings in sentences.
    pub summary: Vec<String>,
    /// What could not be compared.
    pub missing: Vec<String>,
    /// The octave identity.
    pub figure: Option<FigureView>,
}

fn between(i: Interval, rounding: Rounding, words: Translator) -> String {
    let show = |v: f64| rounding.show(v, words.lang);
    words.with("report.interval", &[("low", &show(i.low)), ("high", &show(i.high))])
}

fn cell(
    value: Option<f64>,
    interval: Option<Interval>,
    upper: Option<UpperLimit>,
    words: Translator,
) -> Cell {
    match (value, upper) {
        (Some(v), _) => {
            let rounding = Rounding::of(v, interval.map(|i| (i.low, i.high)));
            Cell {
                value: rounding.show(v, words.lang),
                interval: interval.map(|i| between(i, rounding, words)).unwrap_or_default(),
            }
        }
        (None, Some(u)) => {
            let coverage = limit_digits(100.0 * u.coverage, 3, words.lang);
            let value = bound(u.value, true, words.lang);
            Cell {
                value: words.with("report.at_most", &[("value", &value), ("coverage", &coverage)]),
                interval: String::new(),
            }
        }
        (None, None) => Cell::default(),
    }
}

fn quantity(q: Option<&MeasurandRecord>, words: Translator) -> Cell {
    q.map_or_else(Cell::default, |q| cell(q.value, q.interval, q.upper_limit, words))
}

/// Smallest share that has a row of its own.
const LEAST_SHOWN: f64 = 0.001;

/// Bias instability by one rule, printed.
fn rule_cell(row: &RuleRow, words: Translator) -> RuleCell {
    let mut ratio = cell(row.ratio, row.ratio_interval, None, words);
    if row.ratio_interval.is_none() {
        ratio.value = row.ratio.map(|r| digits(r, 3, words.lang)).unwrap_or_default();
    }
    if row.value.is_none() && !ratio.value.is_empty() {
        ratio.value = format!("≥\u{202f}{}", ratio.value);
    }
    RuleCell {
        name: words.t(&format!("compare.rule.{}", row.rule.id())),
        figure: cell(row.value, row.interval, row.upper_limit, words),
        ratio,
        inverse: row.inverse.map(|v| digits(v, 3, words.lang)).unwrap_or_default(),
    }
}

/// The verdict on the prediction in words, with its class for colours.
fn agreement(unit: &Unit, window: Option<&WindowRecord>, words: Translator) -> (String, &'static str) {
    let (verdict, class) = match window.and_then(|w| w.agreement) {
        Some(Agreement::Consistent) => (words.t("compare.agreement.consistent"), "ok"),
        Some(Agreement::Above) => (words.t("compare.agreement.above"), "remark"),
        Some(Agreement::Below) => (words.t("compare.agreement.below"), "remark"),
        None => return (String::new(), "none"),
    };
    if unit.indicative {
        (words.with("compare.more.indicative", &[("verdict", &verdict)]), "remark")
    } else {
        (verdict, class)
    }
}

impl UnitView {
    /// Prints a unit.
    pub(super) fn new(unit: &Unit, figure: Option<FigureView>, words: Translator) -> UnitView {
        let lang = words.lang;
        let of = |id: &str| quantity(unit.quantity(id), words);
        let detail = unit.detail.as_ref();
        let window = |s: f64| detail.and_then(|d| d.windows.iter().find(|w| w.window_s == s));
        let (w100, w10) = (window(100.0), window(10.0));
        let minimum = detail.and_then(|d| d.minimum.as_ref());
        let count = |n: Option<u64>| n.map(|n| crate::report::number::count(n, lang)).unwrap_or_default();
        let null = minimum.and_then(|m| m.null_ratio);
        let three = |v: f64| limit_digits(v, 3, lang);
        let (agreement, agreement_class) = agreement(unit, w100, words);
        let arw_ratio = unit.quantity(measurand::RATIO_RUSSIAN_TO_ALLAN_ARW.id);
        UnitView {
            label: unit.label(),
            path: unit.path.clone(),
            origin: words.t(match unit.origin {
                Origin::Recording => "compare.origin.recording",
                Origin::Result => "compare.origin.result",
            }),
            length: unit.length_s.map(|t| duration(t, lang)).unwrap_or_default(),
            n: count(w100.map(|w| w.n)),
            n10: count(w10.map(|w| w.n)),
            sigma100: of(measurand::RUSSIAN_DRIFT_100S.id),
            sigma3: of(measurand::RUSSIAN_DRIFT_100S_3SIGMA.id),
            sigma10: of(measurand::RUSSIAN_SIGMA_10S.id),
            rules: unit.rules.iter().map(|row| rule_cell(row, words)).collect(),
            minimum_at: minimum
                .map(|m| {
                    let (tau, largest) = (three(m.tau_s), three(m.largest_tau_s));
                    words.with("compare.minimum_at", &[("tau", &tau), ("largest", &largest)])
                })
                .unwrap_or_default(),
            arw: of(measurand::RUSSIAN_ARW_10S.id),
            n_allan: of(measurand::ANGLE_RANDOM_WALK.id),
            arw_ratio: quantity(arw_ratio, words),
            arw_inverse: arw_ratio
                .and_then(|q| q.value)
                .map(|v| digits(1.0 / v, 3, lang))
                .unwrap_or_default(),
            predicted: w100.map(|w| cell(w.predicted, w.predicted_interval, None, words)).unwrap_or_default(),
            over: w100.map(|w| cell(w.ratio, w.ratio_interval, None, words)).unwrap_or_default(),
            agreement,
            agreement_class,
            null: null
                .map(|[low, _, high]| {
                    let (low, high) = (digits(low, 2, lang), digits(high, 2, lang));
                    words.with("report.interval", &[("low", &low), ("high", &high)])
                })
                .unwrap_or_default(),
            null_median: null.map(|n| digits(n[1], 2, lang)).unwrap_or_default(),
            shares: detail.zip(w100).map(|(d, w)| shares(w, &d.model, words)).unwrap_or_default(),
            summary: unit.summary.iter().map(|n| words.say(n)).collect(),
            missing: unit.missing.iter().map(|n| words.say(n)).collect(),
            figure,
        }
    }
}

/// The parts of a prediction that are worth a row; the small ones stand together in the last.
fn shares(window: &WindowRecord, model: &ModelRecord, words: Translator) -> Vec<ShareView> {
    let (shown, small): (Vec<&ShareRecord>, Vec<&ShareRecord>) =
        window.shares.iter().partition(|s| s.share >= LEAST_SHOWN);
    let row = |part: String, share: f64, alone: f64| ShareView {
        part,
        share: percent(share, words.lang),
        alone: digits(alone, 3, words.lang),
    };
    let mut rows: Vec<ShareView> =
        shown.iter().map(|s| row(words.say(&part_name(s, model)), s.share, s.deviation_deg_h)).collect();
    if !small.is_empty() {
        let share = small.iter().map(|s| s.share).sum();
        let alone = small.iter().map(|s| s.deviation_deg_h.powi(2)).sum::<f64>().sqrt();
        rows.push(row(words.t("compare.more.rest"), share, alone));
    }
    rows
}

/// The limits of a unit, each with the figure that it names.
pub(super) fn limits(unit: &Unit, words: Translator) -> Vec<LimitView> {
    unit.quantities
        .iter()
        .filter_map(|q| {
            let l = q.limit.as_ref()?;
            let shown = |v: f64| limit(v, words.lang);
            let text = match (l.min, l.max) {
                (Some(a), Some(b)) => {
                    words.with("report.interval", &[("low", &shown(a)), ("high", &shown(b))])
                }
                (Some(a), None) => format!("≥\u{202f}{}", shown(a)),
                (None, Some(b)) => format!("≤\u{202f}{}", shown(b)),
                (None, None) => String::new(),
            };
            let value = cell(q.value, q.interval, q.upper_limit, words).value;
            Some(LimitView {
                unit: unit.label(),
                quantity: words.name("measurand", &q.id),
                value: words.quantity(&value, &q.unit),
                limit: words.quantity(&text, &l.unit),
                verdict: q.verdict,
                verdict_word: words.name("verdict", q.verdict.id()),
                source: l.source.clone(),
            })
        })
        .collect()
}
