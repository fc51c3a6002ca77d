//! Measured quantities with their limits.

use super::common::MODEL_NOTES;
use crate::estimate::{Rule, Verdict};
use crate::i18n::Arg;
use crate::measurand;
use crate::record::{LimitRecord, MeasurandRecord, Message};
use crate::report::number::{Rounding, acceptance, bound, digits, limit, limit_digits, percent};
use crate::report::page::Value;
use crate::report::translator::Translator;

/// A measured quantity with the numbers of its footnotes.
#[derive(Debug, Clone, PartialEq)]
pub struct Row<'a> {
    /// The quantity.
    pub of: &'a MeasurandRecord,
    /// Numbers of the footnotes.
    pub footnotes: Vec<usize>,
}

impl<'a> Row<'a> {
    /// The row of a quantity; its footnotes are added to those that there are, equal ones once.
    pub fn new(m: &'a MeasurandRecord, words: Translator, footnotes: &mut Vec<String>) -> Row<'a> {
        let mut numbers = vec![];
        for note in &m.notes {
            // The model of a channel is remarked on once, where it is tabled.
            let sentence = match note.id.as_ref() {
                "note.model_misfit" => words.t("report.misfit_footnote"),
                id if MODEL_NOTES.contains(&id) || (SEARCHED.contains(&id) && searched(m)) => continue,
                _ => words.say(note),
            };
            numbers.push(footnote(sentence, footnotes));
        }
        if out_of_reach(m) {
            numbers.push(footnote(words.t("report.no_value_passes"), footnotes));
        }
        numbers.sort_unstable();
        numbers.dedup();
        Row { of: m, footnotes: numbers }
    }

    /// Name of the quantity.
    pub fn name(&self, words: Translator) -> String {
        words.name("measurand", &self.of.id)
    }

    /// Channel, with the temperature, ramp or level that the row is of.
    pub fn channel(&self, words: Translator) -> String {
        words.channel(&self.of.channel, &self.of.id)
    }

    /// Name, and the channel where there are several.
    pub fn name_in(&self, several_channels: bool, words: Translator) -> String {
        let name = self.name(words);
        if several_channels { words.in_channel(name, &self.of.channel, &self.of.id) } else { name }
    }

    /// The method by which it was obtained, in words.
    pub fn method(&self, words: Translator) -> String {
        words.name("how", &self.of.method)
    }

    /// Why there is no value; empty where there is one, or where the words in its place say why.
    pub fn hint(&self, words: Translator) -> String {
        if self.of.identifiable || searched(self.of) {
            String::new()
        } else {
            words.t("report.not_shown_by_record")
        }
    }

    /// The value, or what bounds it with the reason, which takes the place of the interval too.
    pub fn value(&self, words: Translator) -> Value {
        let value = Value::Text(value(self.of, words));
        if self.of.identifiable {
            return value;
        }
        Value::Wide(Box::new(value.over([Value::Text(self.hint(words))])))
    }

    /// Published or data-sheet value.
    pub fn reference(&self, words: Translator) -> String {
        self.of.reference.as_ref().map_or_else(String::new, |r| limit(r.value, words.lang))
    }

    /// Margin to the nearest limit.
    pub fn margin(&self, words: Translator) -> String {
        self.of.margin.map_or_else(String::new, |margin| match self.of.value {
            Some(_) => margin_digits(margin, words),
            None => bound(margin, false, words.lang),
        })
    }

    /// Limit, with its unit where that is another one than that of the row.
    pub fn limit(&self, words: Translator) -> String {
        self.of.limit.as_ref().map_or_else(String::new, |l| limits(l, &self.of.unit, words))
    }

    /// Acceptance limit.
    pub fn acceptance(&self, words: Translator) -> String {
        match &self.of.limit {
            Some(_) if out_of_reach(self.of) => words.t("report.none_passes"),
            Some(l) => accepted(l, words),
            None => String::new(),
        }
    }

    /// Decision rule.
    pub fn rule(&self, words: Translator) -> String {
        self.of.limit.as_ref().map_or_else(String::new, |l| rule(l, words))
    }

    /// Specific risk.
    pub fn risk(&self, words: Translator) -> String {
        self.of.specific_risk.map_or_else(String::new, |p| percent(p, words.lang))
    }
}

/// Reasons that a record gives for a row; a report states them with their numbers.
const ROW_REASONS: [&str; 6] = [
    "summary.row_failed",
    "summary.row_failed_of",
    "summary.row_not_shown",
    "summary.row_not_shown_of",
    "summary.row_indeterminate",
    "summary.row_indeterminate_of",
];

/// The reasons for the verdict; those of rows with their numbers.
pub fn summary(
    reasons: &[Message],
    rows: &[MeasurandRecord],
    several_channels: bool,
    words: Translator,
) -> Vec<String> {
    let is_row = |id: &str| ROW_REASONS.contains(&id);
    let first_row = reasons.iter().position(|n| is_row(&n.id)).unwrap_or(reasons.len());
    let (before, after) = reasons.split_at(first_row);
    let of = |verdict: Verdict| rows.iter().filter(move |m| m.verdict == verdict);
    // Of a growing test, the plan tells what is open.
    let by_plan = reasons.iter().any(|n| n.id.starts_with("interim."));
    let is_told = |m: &MeasurandRecord| {
        let name = Some(Arg::key("measurand", &m.id));
        after.iter().any(|n| is_row(&n.id) && n.args.get("measurand") == name.as_ref())
    };
    let rows = of(Verdict::Fail)
        .chain(of(Verdict::Indeterminate))
        .filter(|m| m.objections.is_empty() && (!by_plan || is_told(m)));
    let mut out: Vec<String> = before.iter().map(|n| words.say(n)).collect();
    if !after.is_empty() {
        out.extend(rows.filter_map(|m| reason(m, several_channels, words)));
    }
    out.extend(after.iter().filter(|n| !is_row(&n.id)).map(|n| words.say(n)));
    out
}

/// Rounding of a row: by its interval.
pub fn rounding(m: &MeasurandRecord) -> Rounding {
    Rounding::of(m.value.unwrap_or(0.0), m.interval.map(|i| (i.low, i.high)))
}

/// Notes of a row whose quantity was searched for and not found: the search says so in place of a value.
const SEARCHED: [&str; 3] = ["note.no_line", "correlated.no_markov", "correlated.no_periodic"];

fn searched(m: &MeasurandRecord) -> bool {
    m.value.is_none() && m.upper_limit.is_none() && m.notes.iter().any(|n| SEARCHED.contains(&n.id.as_ref()))
}

/// The value as printed: rounded by its uncertainty, or `≤ x (95 %)`, or that nothing can be said.
pub fn value(m: &MeasurandRecord, words: Translator) -> String {
    if let Some(value) = m.value {
        return rounding(m).show(value, words.lang);
    }
    if let (Some(l), Some(u)) = (m.lower_limit, m.upper_limit) {
        return words.with(
            "report.bracketed",
            &[
                ("low", &bound(l.value, false, words.lang)),
                ("high", &bound(u.value, true, words.lang)),
                ("coverage", &limit_digits(100.0 * l.coverage.min(u.coverage), 3, words.lang)),
            ],
        );
    }
    match m.upper_limit {
        Some(u) => {
            let most = words.with(
                "report.at_most",
                &[
                    ("value", &bound(u.value, true, words.lang)),
                    ("coverage", &limit_digits(100.0 * u.coverage, 3, words.lang)),
                ],
            );
            match m.most_likely {
                // What is a hundredth of its bound is nothing.
                Some(likely) if likely > 0.01 * u.value => {
                    let likely = limit_digits(likely, 2, words.lang);
                    words.with("report.most_likely", &[("bound", &most), ("value", &likely)])
                }
                _ => most,
            }
        }
        None if m.lower_limit.is_some() => {
            let least = m.lower_limit.map_or((0.0, 0.0), |l| (l.value, l.coverage));
            words.with(
                "report.at_least",
                &[
                    ("value", &bound(least.0, false, words.lang)),
                    ("coverage", &limit_digits(100.0 * least.1, 3, words.lang)),
                ],
            )
        }
        None if searched(m) => words.t("row_hint.not_found"),
        None => words.t("report.not_identifiable"),
    }
}

/// The interval as printed. One that begins or ends at the value has one side only.
pub fn interval(m: &MeasurandRecord, words: Translator) -> String {
    let (Some(i), Some(value)) = (m.interval, m.value) else { return String::new() };
    let rounding = rounding(m);
    let [low, value, high] = [i.low, value, i.high].map(|v| rounding.show(v, words.lang));
    let (low, high) = match (low == value, high == value) {
        (true, false) => (None, Some(high)),
        (false, true) => (Some(low), None),
        _ => (Some(low), Some(high)),
    };
    between(low, high, false, words)
}

/// The 95 % bound of a quantity without a value.
pub fn bound_alone(m: &MeasurandRecord, words: Translator) -> String {
    match (m.value, m.upper_limit, m.lower_limit) {
        (None, Some(u), Some(l)) => {
            let (low, high) = (bound(l.value, false, words.lang), bound(u.value, true, words.lang));
            format!("{low}\u{202f}…\u{202f}{high}")
        }
        (None, Some(u), None) => format!("≤\u{202f}{}", bound(u.value, true, words.lang)),
        (None, None, Some(l)) => format!("≥\u{202f}{}", bound(l.value, false, words.lang)),
        _ => String::new(),
    }
}

/// The averaging time at which a value was read from σ(τ).
pub fn place(m: &MeasurandRecord, words: Translator) -> String {
    let tau_s = m.notes.iter().find_map(|n| {
        let argument = match n.id.as_ref() {
            "note.minimum_at" => "tau_s",
            "readout.line" => "at_s",
            _ => return None,
        };
        match n.args.get(argument)? {
            Arg::Number(v) | Arg::Stated(v) => Some(*v),
            _ => None,
        }
    });
    let shown = |v: f64| words.with("terminal.at_tau", &[("tau", &limit_digits(v, 4, words.lang))]);
    tau_s.map_or_else(String::new, shown)
}

/// Why a row does not pass, with its numbers: the value, its interval, the limit and the acceptance limit. `None` for a
/// row that passes or has no limit.
pub fn reason(m: &MeasurandRecord, several_channels: bool, words: Translator) -> Option<String> {
    let l = m.limit.as_ref()?;
    let upper = m.value.zip(l.max).is_some_and(|(v, max)| v > max);
    let key = match (m.verdict, m.value) {
        (Verdict::Fail, _) if upper => "reason.exceeds",
        (Verdict::Fail, Some(_)) => "reason.below",
        (Verdict::Fail, None) => "reason.outside",
        (Verdict::Indeterminate, None) if bound_alone(m, words).is_empty() => "reason.unknown",
        (Verdict::Indeterminate, None) => "reason.not_resolved",
        (Verdict::Indeterminate, Some(_)) => "reason.inconclusive",
        _ => return None,
    };
    let name = words.name("measurand", &m.id);
    let name = if several_channels { words.in_channel(name, &m.channel, &m.id) } else { name };
    let value = if m.value.is_some() { value(m, words) } else { bound_alone(m, words) };
    let mut value = if value.is_empty() { value } else { words.quantity(&value, &m.unit) };
    let interval = interval(m, words);
    if !interval.is_empty() {
        value = words.with("reason.with_interval", &[("value", &value), ("interval", &interval)]);
    }
    // A value beyond one end is set against that end; a limit in another unit stands as it was written.
    let ends = match key {
        _ if l.unit != m.unit => None,
        "reason.exceeds" => Some((l.max, l.acceptance_max, true)),
        "reason.below" => Some((l.min, l.acceptance_min, false)),
        _ => None,
    };
    let (limit, accepted) = match ends {
        Some((end, accepted, is_maximum)) => (
            end.map_or_else(String::new, |v| limit(v, words.lang)),
            accepted.map_or_else(String::new, |v| acceptance(v, is_maximum, words.lang)),
        ),
        None => (limits(l, &m.unit, words), accepted(l, words)),
    };
    let limit = if l.unit == m.unit { words.quantity(&limit, &m.unit) } else { limit };
    let mut text = words.with(key, &[("name", &name), ("value", &value), ("limit", &limit)]);
    if out_of_reach(m) {
        text = words.with("reason.no_value_passes", &[("reason", &text)]);
    } else if !accepted.is_empty() && l.rule == Rule::GuardBand {
        let accepted = words.quantity(&accepted, &m.unit);
        text = words.with("reason.with_acceptance", &[("reason", &text), ("acceptance", &accepted)]);
    }
    Some(format!("{text}."))
}

/// True where no measured value could be accepted: the guard bands leave nothing between two limits, or nothing above zero
/// of a quantity that is never negative.
fn out_of_reach(m: &MeasurandRecord) -> bool {
    let Some(l) = m.limit.as_ref().filter(|l| l.rule == Rule::GuardBand) else { return false };
    let is_signed = measurand::find(&m.id).is_none_or(|m| m.signed);
    let crossed = l.acceptance_min.zip(l.acceptance_max).is_some_and(|(low, high)| low > high);
    crossed || !is_signed && l.acceptance_max.is_some_and(|high| high < 0.0)
}

/// The number of a footnote, counted from 1; one that is not there yet is added.
fn footnote(sentence: String, footnotes: &mut Vec<String>) -> usize {
    let found = footnotes.iter().position(|f| *f == sentence);
    found.unwrap_or_else(|| {
        footnotes.push(sentence);
        footnotes.len() - 1
    }) + 1
}

/// The verdict of a row in words. Of a quantity that the record does not resolve, only its bounds are known to be inside.
pub fn verdict_word(m: &MeasurandRecord, words: Translator) -> String {
    match (m.verdict, m.value) {
        (Verdict::Pass, None) => {
            let of_lower = m.limit.as_ref().is_some_and(|l| l.min.is_some()) && m.lower_limit.is_some();
            let of_upper = m.limit.as_ref().is_some_and(|l| l.max.is_some());
            words.t(match (of_lower, of_upper) {
                (true, true) => "verdict.met_by_both_bounds",
                (true, false) => "verdict.met_by_lower_limit",
                (false, _) => "verdict.met_by_upper_limit",
            })
        }
        (verdict, _) => words.verdict(verdict),
    }
}

/// A margin in three digits, with zeros above the units that it is not known to.
fn margin_digits(margin: f64, words: Translator) -> String {
    let above_units = margin.abs().max(1.0).log10().floor() - 2.0;
    let step = 10f64.powf(above_units);
    let rounded = if above_units > 0.0 { (margin / step).round() * step } else { margin };
    digits(rounded, 3, words.lang)
}

/// A range with open ends: `≤ b`, `≥ a`, `± b`, `a … b`.
fn between(min: Option<String>, max: Option<String>, symmetric: bool, words: Translator) -> String {
    match (min, max) {
        (Some(_), Some(b)) if symmetric => format!("±\u{202f}{b}"),
        (Some(a), Some(b)) => words.with("report.interval", &[("low", &a), ("high", &b)]),
        (Some(a), None) => format!("≥\u{202f}{a}"),
        (None, Some(b)) => format!("≤\u{202f}{b}"),
        (None, None) => String::new(),
    }
}

/// The limit of a row with its unit; empty without one.
pub fn limit_text(m: &MeasurandRecord, words: Translator) -> String {
    m.limit.as_ref().map_or_else(String::new, |l| {
        let text = limits(l, &m.unit, words);
        if l.unit == m.unit { words.quantity(&text, &m.unit) } else { text }
    })
}

fn limits(l: &LimitRecord, row_unit: &str, words: Translator) -> String {
    let symmetric = l.min.zip(l.max).is_some_and(|(a, b)| b > 0.0 && (a + b).abs() <= 1e-9 * b);
    let text =
        between(l.min.map(|v| limit(v, words.lang)), l.max.map(|v| limit(v, words.lang)), symmetric, words);
    if l.unit == row_unit { text } else { words.quantity(&text, &l.unit) }
}

fn accepted(l: &LimitRecord, words: Translator) -> String {
    between(
        l.acceptance_min.map(|v| acceptance(v, false, words.lang)),
        l.acceptance_max.map(|v| acceptance(v, true, words.lang)),
        l.acceptance_min.zip(l.acceptance_max).is_some_and(|(a, b)| b > 0.0 && (a + b).abs() <= 1e-9 * b),
        words,
    )
}

fn rule(l: &LimitRecord, words: Translator) -> String {
    match l.rule {
        Rule::Simple => words.t("rule.simple"),
        Rule::GuardBand => words.with("rule.guard_band", &[("risk", &percent(l.risk, words.lang))]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;

    fn judged(id: &str, accepted: [Option<f64>; 2], limits: [Option<f64>; 2]) -> MeasurandRecord {
        MeasurandRecord {
            id: id.into(),
            channel: "rate".into(),
            value: Some(0.4),
            unit: "deg/h".into(),
            identifiable: true,
            method: "mean".into(),
            limit: Some(LimitRecord {
                min: limits[0],
                max: limits[1],
                unit: "deg/h".into(),
                rule: Rule::GuardBand,
                risk: 0.05,
                acceptance_min: accepted[0],
                acceptance_max: accepted[1],
                source: "limits.toml".into(),
            }),
            verdict: Verdict::Indeterminate,
            ..MeasurandRecord::default()
        }
    }

    #[test]
    fn a_margin_has_three_digits() {
        let words = Translator { lang: Lang::En };
        let said = [-3279.05, 152.8, 0.069_57, 123_456.0].map(|m| margin_digits(m, words));
        assert_eq!(said, ["−3280", "153", "0.0696", "123\u{202f}000"]);
    }

    #[test]
    fn an_acceptance_limit_that_no_value_could_meet_is_no_number() {
        let never_negative = judged("dead_zone", [None, Some(-0.2)], [None, Some(0.5)]);
        let crossed = judged("static_bias", [Some(0.3), Some(-0.3)], [Some(-0.5), Some(0.5)]);
        let said = [
            (Lang::En, "none", "no value could pass", "exceeds the limit"),
            (Lang::Ru, "нет", "ни одно значение не могло бы пройти", "больше нормы"),
        ];
        for (lang, none, passes, why) in said {
            let words = Translator { lang };
            for m in [&never_negative, &crossed] {
                let mut footnotes = vec![];
                let shown = Row::new(m, words, &mut footnotes);
                assert_eq!((shown.acceptance(words).as_str(), shown.footnotes.as_slice()), (none, &[1][..]));
                assert!(footnotes.iter().all(|f| f.contains(why)), "{footnotes:?}");
                let reason = reason(m, false, words).unwrap();
                assert!(
                    reason.contains(passes) && !reason.contains("0.2") && !reason.contains("0,2"),
                    "{reason}"
                );
            }
        }
        // A signed quantity may lie below zero.
        let words = Translator { lang: Lang::En };
        let signed = judged("static_bias", [None, Some(-0.2)], [None, Some(0.5)]);
        assert_eq!(Row::new(&signed, words, &mut vec![]).acceptance(words), "≤\u{202f}−0.2");
        let inside = judged("dead_zone", [None, Some(0.2)], [None, Some(0.5)]);
        assert_eq!(Row::new(&inside, words, &mut vec![]).acceptance(words), "≤\u{202f}0.2");
    }
}
