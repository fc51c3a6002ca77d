//! The verdict of a result, decided anew from the numbers of its record.

use super::finding::Finding;
use crate::acceptance::verdict::whole;
use crate::estimate::{Rule, Verdict};
use crate::i18n::{Arg, Note, note};
use crate::record::{LimitRecord, MeasurandRecord, RunRecord};

/// Relative difference of numbers that went through decimal digits within which they are equal.
const ROUNDING_TOLERANCE: f64 = 1e-9;

/// Decides every row of a record anew, and the whole by its rows, conditions and errors.
pub fn verdict(record: &RunRecord) -> Vec<Finding> {
    let mut findings = vec![];
    let judged: Vec<(&MeasurandRecord, &LimitRecord)> =
        record.measurands.iter().filter_map(|row| Some((row, row.limit.as_ref()?))).collect();
    for (row, limit) in &judged {
        let contradicted = !row.objections.is_empty() && row.verdict == Verdict::Indeterminate;
        if !contradicted && !allowed(row, limit).contains(&row.verdict) {
            findings.push(Finding::Differs(note!(
                "verify.row_verdict",
                measurand = row.id.as_str(),
                channel = row.channel.as_str(),
                verdict = spoken(row.verdict)
            )));
        }
        if let (Some(value), Some(margin)) = (row.value, row.margin) {
            let nearest = [limit.max.map(|max| max - value), limit.min.map(|min| value - min)];
            let nearest = nearest.into_iter().flatten().reduce(f64::min);
            if nearest.is_none_or(|n| (n - margin).abs() > ROUNDING_TOLERANCE * (value.abs() + n.abs())) {
                findings.push(Finding::Differs(note!(
                    "verify.row_margin",
                    measurand = row.id.as_str(),
                    channel = row.channel.as_str()
                )));
            }
        }
    }
    for row in record.measurands.iter().filter(|r| r.limit.is_none() && r.verdict != Verdict::None) {
        let note = note!("verify.row_without_limit", measurand = row.id.as_str());
        findings.push(Finding::Differs(note));
    }
    let errors: Vec<Note> = record.errors.iter().map(|e| e.0.clone()).collect();
    let (whole, _) = whole(&record.measurands, &record.conditions, &errors);
    // Limits that decide nothing, a phase that was not recorded: what leaves a verdict open is in the sentences, not in the rows.
    let left_open =
        record.verdict == Verdict::Indeterminate && matches!(whole, Verdict::Pass | Verdict::None);
    let phases = record.phases.iter().map(|p| p.verdict).max();
    let of_phases = phases.is_some_and(|worst| worst == record.verdict);
    if whole != record.verdict && !left_open && !of_phases {
        let (stated, found) = (spoken(record.verdict), spoken(whole));
        findings.push(Finding::Differs(note!("verify.verdict_differs", stated, found)));
    }
    if findings.is_empty() {
        let note = note!("verify.verdict", verdict = spoken(record.verdict), n = judged.len());
        findings.push(Finding::Agrees(note));
    }
    findings
}

/// The verdicts that the numbers of a row allow.
fn allowed(row: &MeasurandRecord, limit: &LimitRecord) -> Vec<Verdict> {
    let inside = |value: f64, low: Option<f64>, high: Option<f64>| {
        let slack = ROUNDING_TOLERANCE * value.abs();
        low.is_none_or(|low| value >= low - slack) && high.is_none_or(|high| value <= high + slack)
    };
    let Some(value) = row.value else {
        let shown = 1.0 - limit.risk - ROUNDING_TOLERANCE;
        let upper = row.upper_limit.filter(|b| b.coverage >= shown).map(|b| b.value);
        let lower = row.lower_limit.filter(|b| b.coverage >= shown).map(|b| b.value);
        let above = limit.max.zip(lower).is_some_and(|(max, least)| least > max);
        let beyond = above || limit.min.zip(upper).is_some_and(|(min, most)| most < min);
        let within = limit.max.is_none_or(|max| upper.is_some_and(|most| most <= max))
            && limit.min.is_none_or(|min| min <= lower.unwrap_or(0.0).max(0.0));
        return match (beyond, within) {
            (true, _) => vec![Verdict::Fail, Verdict::Indeterminate],
            (false, true) => vec![Verdict::Pass, Verdict::Indeterminate],
            (false, false) => vec![Verdict::Indeterminate],
        };
    };
    let accepted = limit.acceptance_min.is_some() || limit.acceptance_max.is_some();
    match limit.rule {
        // A value that is contradicted has no region of acceptance and decides nothing.
        _ if !accepted => vec![Verdict::Indeterminate],
        Rule::Simple if inside(value, limit.min, limit.max) => vec![Verdict::Pass],
        Rule::Simple => vec![Verdict::Fail],
        Rule::GuardBand if inside(value, limit.acceptance_min, limit.acceptance_max) => vec![Verdict::Pass],
        Rule::GuardBand if inside(value, limit.min, limit.max) => vec![Verdict::Indeterminate],
        Rule::GuardBand => vec![Verdict::Fail, Verdict::Indeterminate],
    }
}

/// A verdict in the words of the reader's language.
fn spoken(verdict: Verdict) -> Arg {
    Arg::key("verdict", verdict.id())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_judged_by_the_region_of_acceptance() {
        let limit = |rule| LimitRecord {
            max: Some(10.0),
            unit: "deg/h".into(),
            rule,
            risk: 0.05,
            acceptance_max: Some(if rule == Rule::Simple { 10.0 } else { 8.0 }),
            ..LimitRecord::default()
        };
        let verdicts = |value: f64, rule| {
            let row = MeasurandRecord {
                id: "static_bias".into(),
                channel: "rate".into(),
                value: Some(value),
                unit: "deg/h".into(),
                identifiable: true,
                method: "mean".into(),
                verdict: Verdict::Pass,
                ..MeasurandRecord::default()
            };
            allowed(&row, &limit(rule))
        };
        assert_eq!(verdicts(7.9, Rule::GuardBand), [Verdict::Pass]);
        assert_eq!(verdicts(8.1, Rule::GuardBand), [Verdict::Indeterminate]);
        assert_eq!(verdicts(13.0, Rule::GuardBand), [Verdict::Fail, Verdict::Indeterminate]);
        assert_eq!(verdicts(9.9, Rule::Simple), [Verdict::Pass]);
        assert_eq!(verdicts(10.1, Rule::Simple), [Verdict::Fail]);
    }
}
