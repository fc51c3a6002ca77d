//! Rows with their limits, and the verdict of the whole.

use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::estimate::{Estimate, Holds, Limit, Verdict, judge};
use crate::i18n::{Arg, Note, note};
use crate::record::{
    ConditionRecord, ConditionStatus, Evidence, LimitRecord, MeasurandRecord, ObjectionRecord,
    ReferenceRecord,
};

/// Judges one estimate by the limits that hold.
pub fn row(estimate: &Estimate, limits: &EffectiveLimits, procedure: &Procedure) -> MeasurandRecord {
    let spec = limits.limit(estimate.id, &estimate.channel);
    let limit = spec.map(|l| &l.limit);
    // A limit in another unit than the value decides nothing.
    let other = spec.and_then(|l| l.recorded_unit).filter(|unit| *unit != estimate.unit);
    let reference = limits
        .reference(estimate.id, &estimate.channel)
        .filter(|_| procedure.report.show_reference)
        .map(|r| r.record.clone());
    // Of what can be negative and is not shown, no lower limit is known to be met.
    let signed = crate::measurand::find(estimate.id).is_some_and(|m| m.signed);
    judged(estimate, Against { limit, unit: estimate.unit, other_unit: other, signed, reference })
}

/// What a row is judged by and shown beside.
pub struct Against<'a> {
    /// The limit.
    pub limit: Option<&'a Limit>,
    /// Unit of the row.
    pub unit: &'a str,
    /// Unit of the limit where it measures something else than the row: it decides nothing.
    pub other_unit: Option<&'a str>,
    /// Whether the quantity can be negative.
    pub signed: bool,
    /// Published value.
    pub reference: Option<ReferenceRecord>,
}

/// The row of an estimate, judged.
pub fn judged(estimate: &Estimate, against: Against<'_>) -> MeasurandRecord {
    let Against { limit, unit, other_unit, signed, reference } = against;
    let nothing = Estimate::not_identifiable(estimate.id, "", None, estimate.unit, "");
    let judgement = limit.map(|l| {
        let contradicted = estimate.contradicted();
        let undecided = other_unit.is_some() || contradicted == Some(Holds::Nothing);
        let mut judged = judge(if undecided { &nothing } else { estimate }, l);
        let only_bounded = contradicted.is_some() && (judged.verdict == Verdict::Fail || l.min.is_some());
        if undecided || only_bounded || estimate.value.is_none() && signed && l.min.is_some() {
            judged.verdict = Verdict::Indeterminate;
        }
        judged
    });
    let mut notes = estimate.notes.clone();
    notes.extend(other_unit.map(|given| note!("note.limit_other_unit", given, unit)));
    MeasurandRecord {
        id: estimate.id.to_owned(),
        channel: estimate.channel.clone(),
        phase: None,
        value: estimate.value,
        unit: unit.to_owned(),
        interval: estimate.interval95(),
        common_standard_uncertainty: estimate.value.map(|_| estimate.common()),
        budget: estimate.budget(),
        identifiable: estimate.value.is_some(),
        upper_limit: estimate.upper_limit,
        most_likely: estimate.most_likely,
        lower_limit: estimate.lower_limit,
        method: estimate.method.to_owned(),
        limit: limit.zip(judgement.as_ref()).map(|(l, j)| LimitRecord::new(l, other_unit.unwrap_or(unit), j)),
        reference,
        verdict: judgement.as_ref().map_or(Verdict::None, |j| j.verdict),
        margin: judgement.as_ref().and_then(|j| j.margin),
        specific_risk: judgement.as_ref().and_then(|j| j.specific_risk),
        notes: notes.into_iter().map(Into::into).collect(),
        objections: estimate.objections.iter().map(Into::into).collect(),
    }
}

/// The verdict of the whole and the reasons for it.
///
/// Worst wins; an invalid condition makes the whole indeterminate, whatever the rows say, for a test that was not done
/// right neither passes nor fails a unit; an error stays an error.
pub fn whole(
    rows: &[MeasurandRecord],
    conditions: &[ConditionRecord],
    errors: &[Note],
) -> (Verdict, Vec<Note>) {
    if !errors.is_empty() {
        return (Verdict::Error, errors.to_vec());
    }
    let invalid: Vec<&ConditionRecord> =
        conditions.iter().filter(|c| c.status == ConditionStatus::Invalid).collect();
    let judged = rows.iter().filter(|r| r.verdict != Verdict::None).count();
    let of = |v: Verdict| rows.iter().filter(move |r| r.verdict == v);
    let mut reasons = contradicted(rows);
    if !invalid.is_empty() {
        reasons.push(match invalid.len() {
            1 => note!("summary.one_condition_invalid", n = 1_usize),
            n => note!("summary.conditions_invalid", n),
        });
    }
    reasons.extend(invalid.iter().map(|c| {
        let why = c.message.clone().map_or_else(|| Arg::Text(c.note.clone()), Arg::from);
        note!(
            "summary.condition_invalid",
            condition = Arg::key("condition", c.id.split('.').next().unwrap_or(&c.id)),
            why
        )
    }));
    let several = rows.iter().any(|r| Some(&r.channel) != rows.first().map(|f| &f.channel));
    for verdict in [Verdict::Fail, Verdict::Indeterminate] {
        for r in of(verdict).filter(|r| r.objections.is_empty()) {
            let key = match (verdict, r.value.is_none(), several) {
                (Verdict::Fail, _, false) => "summary.row_failed",
                (Verdict::Fail, _, true) => "summary.row_failed_of",
                (_, true, false) => "summary.row_not_shown",
                (_, true, true) => "summary.row_not_shown_of",
                (_, false, false) => "summary.row_indeterminate",
                (_, false, true) => "summary.row_indeterminate_of",
            };
            reasons.push(
                Note::new(key)
                    .with("measurand", Arg::key("measurand", &r.id))
                    .with("channel", r.channel.clone()),
            );
        }
    }
    let bounded = of(Verdict::Pass).filter(|r| r.value.is_none()).count();
    let worst = rows.iter().map(|r| r.verdict).max().unwrap_or(Verdict::None);
    let verdict = if invalid.is_empty() { worst } else { Verdict::Indeterminate };
    match verdict {
        Verdict::Pass if judged == 1 && bounded == 1 => reasons.push("summary.one_passed_by_limit".into()),
        Verdict::Pass if judged == 1 => reasons.push(note!("summary.one_passed", n = judged)),
        Verdict::Pass if bounded > 0 => {
            reasons.push(note!("summary.passed_by_limits", n = judged, bounded));
        }
        Verdict::Pass => reasons.push(note!("summary.all_passed", n = judged)),
        Verdict::None => reasons.push(note!("summary.no_limits")),
        _ => {}
    }
    let declared = |c: &&ConditionRecord| c.id == "influence_acted" && c.evidence == Some(Evidence::Declared);
    if judged > 0 && conditions.iter().any(|c| declared(&c)) {
        reasons.push(note!("summary.influence_declared"));
    }
    (verdict, reasons)
}

/// What checks contradict, first of all reasons: each with the rows that it leaves open.
pub fn contradicted<'a>(rows: impl IntoIterator<Item = &'a MeasurandRecord>) -> Vec<Note> {
    let open: Vec<&MeasurandRecord> = rows.into_iter().filter(|r| r.verdict != Verdict::Pass).collect();
    let mut told: Vec<&ObjectionRecord> = vec![];
    for objection in open.iter().flat_map(|r| &r.objections) {
        if !told.contains(&objection) {
            told.push(objection);
        }
    }
    let note = |objection: &ObjectionRecord| {
        let mut names: Vec<Arg> = vec![];
        for row in open.iter().filter(|r| r.objections.contains(objection)) {
            let name = Arg::key("measurand", &row.id);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        note!(
            "summary.contradicted",
            check = Arg::key("criticism", &objection.check),
            found = objection.found.clone(),
            advice = objection.advice.clone(),
            measurands = Arg::Several(names, "; ".into())
        )
    };
    told.into_iter().map(note).collect()
}

/// The verdict where a limits file was given: one that decides nothing leaves open what was to be judged by it.
pub fn with_idle_limits(
    (verdict, mut reasons): (Verdict, Vec<Note>),
    idle: Option<&Note>,
) -> (Verdict, Vec<Note>) {
    let Some(why) = idle else { return (verdict, reasons) };
    if verdict == Verdict::None {
        reasons.clear();
    }
    reasons.insert(0, why.clone());
    let open = matches!(verdict, Verdict::None | Verdict::Pass);
    (if open { Verdict::Indeterminate } else { verdict }, reasons)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(verdict: Verdict) -> MeasurandRecord {
        MeasurandRecord {
            id: "static_bias".into(),
            channel: "rate".into(),
            value: Some(1.0),
            unit: "deg/h".into(),
            identifiable: true,
            method: "mean".into(),
            verdict,
            ..MeasurandRecord::default()
        }
    }

    fn condition(status: ConditionStatus) -> ConditionRecord {
        ConditionRecord { id: "temperature".into(), status, ..ConditionRecord::default() }
    }

    #[test]
    fn worst_wins_and_an_invalid_condition_neither_passes_nor_fails() {
        let ok = [condition(ConditionStatus::Ok), condition(ConditionStatus::Remark)];
        let bad = [condition(ConditionStatus::Invalid)];
        let rows = |v: &[Verdict]| v.iter().map(|v| row(*v)).collect::<Vec<_>>();
        use Verdict::{Error, Fail, Indeterminate, None, Pass};
        assert_eq!(whole(&rows(&[Pass, None]), &ok, &[]).0, Pass);
        assert_eq!(whole(&rows(&[Pass, Indeterminate]), &ok, &[]).0, Indeterminate);
        assert_eq!(whole(&rows(&[Pass, Indeterminate, Fail]), &ok, &[]).0, Fail);
        assert_eq!(whole(&rows(&[None]), &ok, &[]).0, None);
        assert_eq!(whole(&rows(&[Pass]), &bad, &[]).0, Indeterminate);
        assert_eq!(whole(&rows(&[Fail]), &bad, &[]).0, Indeterminate);
        assert_eq!(whole(&rows(&[Pass]), &ok, &[note!("error.serial_missing")]).0, Error);
    }
}
