//! The parts of a whole: the units of a lot and the phases of a test. Each is checked as a result on its own, and the whole against what
//! their records say.

use super::finding::Finding;
use super::folder::{Folder, run_of};
use super::pages::FROM_RECORDING;
use super::verdict::verdict;
use crate::acceptance::lot::of_record;
use crate::i18n::{Note, note};
use crate::output::{Kind, is_plain};
use crate::record::{
    ConditionRecord, LOT_FORMAT, LotRecord, LotUnit, MeasurandRecord, PhaseRecord, RunRecord, VerdictCounts,
    read,
};
use std::path::Path;

/// Says that the units have files which only their recordings give.
const UNITS_FROM_RECORDINGS: &str = "verify.units_from_recordings";

/// Checks every unit by `contents`, and the index of the lot against them.
pub(super) fn units(folder: &Folder, contents: &dyn Fn(&Folder) -> Vec<Finding>) -> Vec<Finding> {
    let lot = match record(folder) {
        Ok(lot) => lot,
        Err(note) => return vec![Finding::Differs(note)],
    };
    let (mut findings, mut from_recording) = (vec![], false);
    for unit in &lot.units {
        let Some(at) = folder_of(folder, unit) else {
            findings.push(Finding::Differs(note!("verify.outside", name = unit.folder.as_str())));
            continue;
        };
        let Some(run) = run_of(&at) else {
            findings.push(Finding::Differs(note!("verify.no_unit", name = unit.folder.as_str())));
            continue;
        };
        let mut of_unit = contents(&at);
        let all = of_unit.len();
        of_unit.retain(|f| f.note().id != FROM_RECORDING);
        from_recording |= of_unit.len() < all;
        of_unit.retain(|f| !matches!(f, Finding::Agrees(_)));
        findings.extend(of_unit.into_iter().map(|finding| below(&unit.folder, finding)));
        if !says(unit, &run) {
            findings.push(Finding::Differs(note!("verify.unit_differs", name = unit.folder.as_str())));
        }
    }
    let verdicts = || lot.units.iter().map(|u| u.verdict);
    let worst = verdicts().max().unwrap_or(lot.verdict);
    if worst != lot.verdict || VerdictCounts::of(verdicts()) != lot.counts {
        findings.push(Finding::Differs("verify.lot_differs".into()));
    }
    if !findings.iter().any(Finding::differs) {
        findings.push(Finding::Agrees(note!("verify.units", n = lot.units.len())));
    }
    if from_recording {
        findings.push(Finding::Unchecked(UNITS_FROM_RECORDINGS.into()));
    }
    findings
}

/// True for what says that files were compared by their hashes only, since they come from a recording.
pub fn waits_for_recording(finding: &Finding) -> bool {
    [FROM_RECORDING, UNITS_FROM_RECORDINGS].contains(&finding.note().id.as_ref())
}

/// The record of a lot.
///
/// # Errors
/// A note that says what is wrong with the file.
pub(super) fn record(folder: &Folder) -> Result<LotRecord, Note> {
    let path = folder.record_file();
    let bytes = read::bytes(&path).map_err(|e| e.note(&path))?;
    read::of_format(&bytes, LOT_FORMAT).map_err(|e| e.note(&path))
}

/// The folder of a unit; `None` for a name that leads elsewhere.
pub(super) fn folder_of(lot: &Folder, unit: &LotUnit) -> Option<Folder> {
    let is_name = is_plain(&unit.folder) && Path::new(&unit.folder).components().count() == 1;
    is_name.then(|| Folder { path: lot.path.join(&unit.folder), kind: Kind::Result })
}

/// Findings of a unit, with its folder.
pub(super) fn below(unit: &str, finding: Finding) -> Finding {
    let of = |note: Note| note!("verify.of_unit", name = unit, what = note);
    match finding {
        Finding::Agrees(note) => Finding::Agrees(of(note)),
        Finding::Differs(note) => Finding::Differs(of(note)),
        Finding::Undone(note) => Finding::Undone(of(note)),
        Finding::Unchecked(note) => Finding::Unchecked(of(note)),
    }
}

/// True where the index says of a unit what its record says.
fn says(unit: &LotUnit, run: &RunRecord) -> bool {
    *unit == of_record(run, unit.serial_from, unit.recording.clone(), unit.folder.clone())
}

/// Checks every phase of a test of several, and the whole against them.
pub(super) fn phases(folder: &Folder, whole: &RunRecord) -> Vec<Finding> {
    let differs =
        |phase: &PhaseRecord| Finding::Differs(note!("verify.phase_differs", name = phase.id.as_str()));
    let mut findings = vec![];
    for phase in &whole.phases {
        // A phase that was not recorded has no folder.
        let Some(below) = &phase.folder else { continue };
        let at = Folder { path: folder.path.join(below), kind: Kind::Result };
        let Some(run) = run_of(&at).filter(|_| is_plain(below)) else {
            findings.push(differs(phase));
            continue;
        };
        let of_phase = verdict(&run).into_iter().filter(Finding::differs);
        findings.extend(of_phase.map(|finding| self::below(&phase.id, finding)));
        let own = Some(phase.id.clone());
        let measurands: Vec<MeasurandRecord> =
            run.measurands.iter().map(|m| MeasurandRecord { phase: own.clone(), ..m.clone() }).collect();
        let conditions: Vec<ConditionRecord> =
            run.conditions.iter().map(|c| ConditionRecord { phase: own.clone(), ..c.clone() }).collect();
        let same = (phase.verdict, &phase.summary, &phase.integrity)
            == (run.verdict, &run.summary, &run.integrity)
            && (&phase.measurands, &phase.conditions) == (&measurands, &conditions);
        if !same {
            findings.push(differs(phase));
        }
    }
    let all = || whole.phases.iter();
    let measurands: Vec<&MeasurandRecord> = all().flat_map(|p| &p.measurands).collect();
    let conditions: Vec<&ConditionRecord> = all().flat_map(|p| &p.conditions).collect();
    let is_sum = measurands == whole.measurands.iter().collect::<Vec<_>>()
        && conditions == whole.conditions.iter().collect::<Vec<_>>();
    if !whole.phases.is_empty() && !is_sum {
        findings.push(Finding::Differs("verify.whole_differs".into()));
    }
    findings
}
