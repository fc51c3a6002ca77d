//! The phases of a test of several: each with a view of its own.

use super::{View, Words};
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::record::{PhaseRecord, RunRecord};
use serde::Serialize;

/// A phase as the report needs it.
pub struct PhasePart<'a> {
    /// The phase in the record of the whole.
    pub phase: &'a PhaseRecord,
    /// Its own record; `None` when it was not recorded.
    pub record: Option<&'a RunRecord>,
    /// Its figures, under the names that they have in the record of the whole.
    pub figures: &'a [Figure],
}

/// One phase, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseView {
    /// Id.
    pub id: String,
    /// Title.
    pub title: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// Why.
    pub summary: Vec<String>,
    /// Procedure with its revision, and its limits.
    pub procedure: String,
    /// Files that were read.
    pub files: Vec<String>,
    /// Folder of its own report, empty without one.
    pub folder: String,
    /// What it found; empty when it was not recorded.
    pub view: Vec<View>,
}

impl View {
    /// The view of a test of several phases.
    pub fn of_phases(record: &RunRecord, parts: &[PhasePart<'_>], lang: Lang) -> View {
        let mut whole = View::new(record, &[], lang);
        // Each phase shows its own.
        whole.figures_missing = String::new();
        whole.phases = parts.iter().map(|p| one(p, lang)).collect();
        whole
    }
}

fn one(part: &PhasePart<'_>, lang: Lang) -> PhaseView {
    let words = Words { lang };
    let phase = part.phase;
    let procedure = phase.procedure.as_ref().map_or_else(String::new, |p| {
        let id = words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]);
        let limits = p
            .limits
            .as_ref()
            .map(|l| words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]));
        limits.map_or_else(|| id.clone(), |l| format!("{id}; {l}"))
    });
    PhaseView {
        id: phase.id.clone(),
        title: phase.title.clone(),
        verdict: phase.verdict.id(),
        verdict_word: super::verdict_word(phase.verdict, words),
        summary: phase.summary.iter().map(|n| words.say(n)).collect(),
        procedure,
        files: phase.recording.iter().map(|f| f.path.clone()).collect(),
        folder: phase.folder.clone().unwrap_or_default(),
        view: part
            .record
            .map(|r| {
                let own = RunRecord { figures: phase.figures.clone(), ..r.clone() };
                View { anchor: format!("{}-", phase.id), ..View::new(&own, part.figures, lang) }
            })
            .into_iter()
            .collect(),
    }
}
