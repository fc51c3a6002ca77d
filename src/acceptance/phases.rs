//! The results of the phases of a test as one.

use super::build_record::clauses;
use super::changes::{self, PhaseRows};
use super::condition::checks::none_made;
use super::kinds;
use super::request::Outcome;
use crate::config::procedure::Procedure;
use crate::config::procedure::phases::{CHANGES, Phase, Phased};
use crate::config::procedure::unit_facts::unknown;
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::{Arg, Lang, LocalText, Localize, Note, note};
use crate::record::{
    CheckRecord, ClauseRecord, ConditionStatus, FigureRecord, Integrity, Message, PhaseRecord, Program,
    RESULT_FORMAT, RunKind, RunRecord, Session, UnitUnderTest, Window,
};

/// A phase that was run, or why it was not.
pub struct Done<'a> {
    /// The phase.
    pub phase: &'a Phase,
    /// What came of it; `None` when no file of the recording belongs to it.
    pub outcome: Option<Outcome>,
}

/// The folder of a phase beside the result of the whole.
pub fn folder(phase: &Phase) -> String {
    format!("phases/{}", phase.id)
}

/// One record that covers all phases. Its conditions and measurands are those of all of them, each with its phase.
pub fn combine(phased: &Phased, done: &[Done<'_>], unit: UnitUnderTest, session: Session) -> RunRecord {
    let rows: Vec<PhaseRows<'_>> =
        done.iter().map(|d| PhaseRows::of(&d.phase.id, d.outcome.as_ref())).collect();
    let changes = changes::part(&phased.changes, &rows, title_of_changes());
    let phases: Vec<PhaseRecord> = done.iter().map(of).chain(changes).collect();
    let worst = worst(&phases);
    let errors: Vec<Note> = unknown(&unit, phased.serial_required, &phased.requires);
    let of_phase = |p: &PhaseRecord| {
        let verdict = Arg::key("verdict", p.verdict.id());
        match failure(p) {
            Some(why) => note!("phases.failed", verdict, why = why.clone()),
            None => note!("phases.verdict", verdict),
        }
        .with("title", p.title.clone())
    };
    let declared = note!("summary.influence_declared");
    let said = phases.iter().any(|p| p.summary.iter().any(|s| **s == declared)).then_some(declared);
    let summary =
        errors.iter().cloned().chain(phases.iter().map(of_phase)).chain(said).map(Into::into).collect();
    let records: Vec<&RunRecord> =
        done.iter().filter_map(|d| d.outcome.as_ref()).map(|o| &o.record).collect();
    let mut instruments = Vec::new();
    for instrument in records.iter().flat_map(|r| &r.instruments) {
        if !instruments.contains(instrument) {
            instruments.push(instrument.clone());
        }
    }
    let evaluated = records.iter().filter(|r| r.recording.iter().any(|f| f.samples > 0)).count();
    let declared = clauses_with_rows(phased, done);
    let clauses = match evaluated {
        0 => clauses(&declared, "not_done"),
        n if n < done.len() => clauses(&declared, "partly"),
        _ => declared,
    };
    RunRecord {
        format: RESULT_FORMAT.to_owned(),
        program: Program::this(),
        kind: RunKind::Run,
        procedure: Some(phased.identity.clone()),
        unit_under_test: unit,
        session,
        recording: phases.iter().flat_map(|p| p.recording.clone()).collect(),
        verdict: if errors.is_empty() { worst } else { Verdict::Error },
        summary,
        conditions: phases.iter().flat_map(|p| p.conditions.clone()).collect(),
        checks: checks(done),
        integrity: together(&records),
        window: Window {
            from_s: 0.0,
            to_s: records.iter().map(|r| r.window.to_s - r.window.from_s).sum(),
            usable_s: records.iter().map(|r| r.window.usable_s).sum(),
            excluded: vec![],
        },
        measurands: phases.iter().flat_map(|p| p.measurands.clone()).collect(),
        instruments,
        waivers: records.iter().flat_map(|r| r.waivers.clone()).collect(),
        clauses,
        figures: phases.iter().flat_map(|p| p.figures.clone()).collect(),
        phases,
        errors: errors.into_iter().map(Into::into).collect(),
        ..RunRecord::default()
    }
}

/// The clauses of the whole, each with the rows of the phases that deal with it by their own procedures.
fn clauses_with_rows(phased: &Phased, done: &[Done<'_>]) -> Vec<ClauseRecord> {
    let of = |c: &ClauseRecord| {
        let deals = |p: &&Procedure| p.clauses.iter().any(|own| own.clause == c.clause && own.is_here());
        let mut rows: Vec<String> = vec![];
        for spec in done.iter().map(|d| &d.phase.procedure.value).filter(deals).flat_map(|p| &p.measurands) {
            if !rows.iter().any(|id| id == spec.measurand.id) {
                rows.push(spec.measurand.id.to_owned());
            }
        }
        ClauseRecord { rows, ..c.clone() }
    };
    phased.clauses.iter().map(of).collect()
}

/// The worst verdict. A phase that is open for want of any limit, and for nothing else, leaves it to the limits on changes, where there
/// are some.
fn worst(phases: &[PhaseRecord]) -> Verdict {
    let judges_changes = phases.iter().any(|p| p.id == CHANGES && p.verdict != Verdict::None);
    let without_limits = |p: &&PhaseRecord| {
        let none = p.measurands.iter().all(|m| m.limit.is_none());
        let valid = p.conditions.iter().all(|c| c.status != ConditionStatus::Invalid);
        judges_changes && none && valid && p.verdict == Verdict::Indeterminate
    };
    phases.iter().filter(|p| !without_limits(p)).map(|p| p.verdict).max().unwrap_or(Verdict::None)
}

/// Title of the changes between phases, in every language.
fn title_of_changes() -> LocalText {
    let text = |lang: &Lang| (lang.code().to_owned(), note!("compare_phases.title").say(*lang));
    LocalText::in_languages(Lang::ALL.iter().map(text).collect(), Lang::En.code())
}

/// The checks of all phases, each with its phase.
fn checks(done: &[Done<'_>]) -> Vec<CheckRecord> {
    let of = |d: &Done<'_>| {
        let id = d.phase.id.clone();
        let own = d.outcome.as_ref().map(|o| o.record.checks.clone());
        let own = own.unwrap_or_else(|| none_made(kinds::of_procedure(&d.phase.procedure.value).checks()));
        own.into_iter().map(move |c| CheckRecord { phase: Some(id.clone()), ..c })
    };
    done.iter().flat_map(of).collect()
}

/// Why a phase could not be carried out; `None` of one that was.
pub fn failure(phase: &PhaseRecord) -> Option<&Message> {
    phase.summary.first().filter(|_| phase.verdict == Verdict::Error)
}

fn of(done: &Done<'_>) -> PhaseRecord {
    let phase = done.phase;
    let Some(outcome) = &done.outcome else {
        return PhaseRecord {
            id: phase.id.clone(),
            title: phase.title.clone(),
            procedure: Some(phase.procedure.record(phase.limits.as_ref())),
            verdict: Verdict::Error,
            summary: vec![note!("phases.not_recorded", id = phase.id.as_str()).into()],
            ..PhaseRecord::default()
        };
    };
    let r = &outcome.record;
    let own = || Some(phase.id.clone());
    PhaseRecord {
        id: phase.id.clone(),
        title: phase.title.clone(),
        folder: Some(folder(phase)),
        procedure: r.procedure.clone(),
        recording: r
            .recording
            .iter()
            .map(|f| {
                let sub = f.phase.as_ref().map(|s| format!("{}.{s}", phase.id));
                crate::record::RecordingFile { phase: sub.or_else(own), ..f.clone() }
            })
            .collect(),
        verdict: r.verdict,
        summary: r.summary.clone(),
        conditions: r
            .conditions
            .iter()
            .map(|c| crate::record::ConditionRecord { phase: own(), ..c.clone() })
            .collect(),
        integrity: r.integrity.clone(),
        measurands: r
            .measurands
            .iter()
            .map(|m| crate::record::MeasurandRecord { phase: own(), ..m.clone() })
            .collect(),
        figures: figures(&phase.id, Some(outcome))
            .iter()
            .map(|f| FigureRecord { id: f.id.clone(), file: format!("figures/{}.svg", f.id) })
            .collect(),
    }
}

/// The figures of a phase under names that no other phase has.
pub fn figures(phase: &str, outcome: Option<&Outcome>) -> Vec<Figure> {
    let of = |f: &Figure| Figure { id: format!("{phase}-{}", f.id), ..f.clone() };
    outcome.map(|o| o.figures.iter().map(of).collect()).unwrap_or_default()
}

/// Faults of all phases.
fn together(records: &[&RunRecord]) -> Integrity {
    let sum = |of: fn(&Integrity) -> u64| records.iter().map(|r| of(&r.integrity)).sum();
    Integrity {
        gaps: sum(|i| i.gaps),
        missing_samples: sum(|i| i.missing_samples),
        duplicate_timestamps: sum(|i| i.duplicate_timestamps),
        backward_timestamps: sum(|i| i.backward_timestamps),
        non_finite: sum(|i| i.non_finite),
        unparsable: sum(|i| i.unparsable),
        outliers: sum(|i| i.outliers),
        saturated: sum(|i| i.saturated),
        stuck: sum(|i| i.stuck),
        repeated: sum(|i| i.repeated),
        implausible: sum(|i| i.implausible),
        cut_off: sum(|i| i.cut_off),
        // Examined in the whole is what was examined in each part.
        examined: Integrity::all_examined()
            .into_iter()
            .filter(|id| !records.is_empty() && records.iter().all(|r| r.integrity.has_examined(id)))
            .collect(),
        faults: records.iter().flat_map(|r| r.integrity.faults.clone()).collect(),
        ..Integrity::default()
    }
}
