//! Changes of quantities from one phase of a test to another: before and after shock, storage, cycling.

use super::request::Outcome;
use super::verdict::{Against, judged};
use crate::config::procedure::phases::{CHANGES, Change};
use crate::estimate::{
    Estimate, Interval, Limit, LowerLimit, SCORE_TWO_SIDED_95, Spread, UpperLimit, Verdict,
};
use crate::i18n::{LocalText, Note, note};
use crate::record::{InstrumentRecord, MeasurandRecord, PhaseRecord, RunKind, RunRecord};

/// Method of these rows.
const METHOD: &str = "between_phases";

/// What came of a phase.
pub(super) struct PhaseRows<'a> {
    /// Its id.
    pub id: &'a str,
    /// Its rows; none where it was not run.
    pub rows: &'a [MeasurandRecord],
    /// Its instruments.
    pub instruments: &'a [InstrumentRecord],
}

impl<'a> PhaseRows<'a> {
    /// Of a phase and its outcome.
    pub fn of(id: &'a str, outcome: Option<&'a Outcome>) -> PhaseRows<'a> {
        let record = outcome.map(|o| &o.record);
        PhaseRows {
            id,
            rows: record.map_or(&[], |r| &r.measurands),
            instruments: record.map_or(&[], |r| &r.instruments),
        }
    }
}

/// The changes as a part of the test of their own; `None` where the procedure asks for none.
pub(super) fn part(changes: &[Change], phases: &[PhaseRows<'_>], title: LocalText) -> Option<PhaseRecord> {
    if changes.is_empty() {
        return None;
    }
    let measurands: Vec<MeasurandRecord> = changes.iter().flat_map(|c| rows(c, phases)).collect();
    let verdict = measurands.iter().map(|m| m.verdict).max().unwrap_or(Verdict::None);
    let summary: Vec<Note> = match verdict {
        Verdict::Pass => vec![note!("compare_phases.all_met")],
        Verdict::Fail => vec![note!("compare_phases.failed")],
        Verdict::Indeterminate => vec![note!("compare_phases.open")],
        _ => vec![],
    };
    let own = |m: MeasurandRecord| MeasurandRecord { phase: Some(CHANGES.to_owned()), ..m };
    Some(PhaseRecord {
        id: CHANGES.to_owned(),
        title,
        verdict,
        summary: summary.into_iter().map(Into::into).collect(),
        measurands: measurands.into_iter().map(own).collect(),
        ..PhaseRecord::default()
    })
}

/// The changes as an outcome, for the pages that show the outcomes of phases; `None` of any other part of a test.
pub fn outcome(phase: &PhaseRecord) -> Option<Outcome> {
    let record = || RunRecord {
        kind: RunKind::Run,
        verdict: phase.verdict,
        summary: phase.summary.clone(),
        measurands: phase.measurands.clone(),
        ..RunRecord::default()
    };
    (phase.id == CHANGES).then(|| Outcome { record: record(), figures: vec![], tables: vec![] })
}

/// The rows of a change, one for each channel of either phase.
fn rows(change: &Change, phases: &[PhaseRows<'_>]) -> Vec<MeasurandRecord> {
    let phase = |id: &str| phases.iter().find(|p| p.id == id);
    let of = |p: Option<&PhaseRows<'_>>| -> Vec<MeasurandRecord> {
        let own = |p: &PhaseRows<'_>| {
            p.rows.iter().filter(|m| m.id == change.measurand.id).cloned().collect::<Vec<_>>()
        };
        p.map(own).unwrap_or_default()
    };
    let (before, after) = (phase(&change.before), phase(&change.after));
    let same_bench = before
        .zip(after)
        .is_some_and(|(a, b)| !a.instruments.is_empty() && same_instruments(a.instruments, b.instruments));
    let (before, after) = (of(before), of(after));
    let mut channels: Vec<&str> = before.iter().chain(&after).map(|m| m.channel.as_str()).collect();
    channels.dedup();
    let mut seen = std::collections::BTreeSet::new();
    channels.retain(|c| seen.insert(*c));
    if channels.is_empty() {
        channels.push("");
    }
    let one = |channel: &str| {
        let find = |rows: &[MeasurandRecord]| rows.iter().find(|m| m.channel == channel).cloned();
        let estimate = difference(change, channel, find(&before).as_ref(), find(&after).as_ref(), same_bench);
        row(change, &estimate)
    };
    channels.into_iter().map(one).collect()
}

/// True where two tests were recorded with the same instruments.
pub(super) fn same_instruments(a: &[InstrumentRecord], b: &[InstrumentRecord]) -> bool {
    let key = |i: &InstrumentRecord| (i.name.clone(), i.serial.clone());
    let of = |list: &[InstrumentRecord]| list.iter().map(key).collect::<Vec<_>>();
    let (of_a, of_b) = (of(a), of(b));
    of_a.len() == of_b.len() && of_a.iter().all(|i| of_b.contains(i))
}

/// The difference of two rows. What is common to both drops out where they were measured on one bench.
fn difference(
    change: &Change,
    channel: &str,
    before: Option<&MeasurandRecord>,
    after: Option<&MeasurandRecord>,
    same_bench: bool,
) -> Estimate {
    let m = change.measurand;
    let none = |limit| m.not_identifiable(channel, limit, METHOD);
    let told =
        note!("compare_phases.between", before = change.before.as_str(), after = change.after.as_str());
    let (Some(before), Some(after)) = (before, after) else {
        return none(None).note(told).note(note!("compare_phases.lacks_a_phase"));
    };
    let contradicted = [before, after].iter().any(|r| !r.objections.is_empty());
    let (Some(x), Some(y)) = (before.value, after.value) else {
        // Of two magnitudes that are bounded above, the difference is bounded too.
        let most = |r: &MeasurandRecord| r.upper_limit.or(r.interval.map(as_bound));
        let both = most(before).zip(most(after)).filter(|_| !m.signed && !contradicted);
        let limit = both
            .map(|(a, b)| UpperLimit { value: a.value.max(b.value), coverage: a.coverage.min(b.coverage) });
        return none(limit).note(told).note(note!("compare_phases.not_shown"));
    };
    let sides = before.interval.zip(after.interval).filter(|_| !contradicted);
    let spread = match sides {
        Some((a, b)) => {
            let own = |half: f64, r: &MeasurandRecord| {
                if same_bench { half * (1.0 - common_share(half, r)).max(0.0).sqrt() } else { half }
            };
            let up = own(b.high - y, after).hypot(own(x - a.low, before));
            let down = own(y - b.low, after).hypot(own(a.high - x, before));
            Spread::of_interval(y - x - down, y - x, y - x + up)
        }
        None => Spread::Unknown,
    };
    let common =
        if same_bench { note!("compare_phases.common_drops") } else { note!("compare_phases.common_stays") };
    let row = m.measured(channel, y - x, spread, METHOD).note(told).note(common);
    if contradicted { row.note(note!("compare_phases.contradicted")) } else { row }
}

/// Share of the variance of a row that both phases have in common. `half` is half the width of its interval.
fn common_share(half: f64, row: &MeasurandRecord) -> f64 {
    let common = row.common_standard_uncertainty.unwrap_or(0.0);
    let whole: f64 = row.budget.iter().map(|c| c.contribution * c.contribution).sum();
    let variance = if whole > 0.0 { whole } else { (half / SCORE_TWO_SIDED_95).powi(2) };
    if variance > 0.0 { common * common / variance } else { 0.0 }
}

fn as_bound(interval: Interval) -> UpperLimit {
    UpperLimit { value: interval.high.abs().max(interval.low.abs()), coverage: interval.coverage }
}

/// The row, judged by the limit on the change.
fn row(change: &Change, estimate: &Estimate) -> MeasurandRecord {
    // A bound on a magnitude is judged by the upper limit alone.
    let bounded = Estimate {
        lower_limit: estimate.upper_limit.map(|u| LowerLimit { value: -u.value, coverage: u.coverage }),
        ..estimate.clone()
    };
    let magnitude = change.limit.as_ref().map(|l| Limit { min: None, ..l.clone() });
    let (estimate, limit, signed) = match estimate.value {
        None if estimate.upper_limit.is_some() => (&bounded, magnitude.as_ref(), false),
        _ => (estimate, change.limit.as_ref(), true),
    };
    let unit = change.measurand.unit;
    let against = Against { limit, unit, other_unit: None, signed, reference: None };
    MeasurandRecord { id: format!("{}_change", change.measurand.id), ..judged(estimate, against) }
}
