//! The tables of a procedure of several phases.

use super::{ClauseKeys, Identity};
use crate::config::procedure::model::UnitSpec;
use crate::config::procedure::section::Section;
use crate::config::spec::TableSpec;
use crate::config::table::Table;
use crate::i18n::LocalText;

/// A procedure of several phases as a whole.
pub static PHASES_FILE: TableSpec = *PhasesFile::SPEC;

/// A procedure of several phases, each with its own procedure and its own recordings, named by a manifest. One report
/// covers them all.
#[derive(Table)]
#[table("", format = "procedure/1")]
pub(in crate::config::procedure) struct PhasesFile {
    /// Identity of the whole.
    pub procedure: Identity,
    /// The unit that all phases are for.
    #[key(optional)]
    pub unit_under_test: UnitSpec,
    /// The phases, one table each, in the order of the report.
    #[key(name = "phase", required)]
    pub phases: Vec<PhaseKeys>,
    /// Clauses of the standard and where each is covered.
    #[key(name = "clause")]
    pub clauses: Vec<ClauseKeys>,
}

/// One phase.
#[derive(Table)]
#[table("phase")]
pub(in crate::config::procedure) struct PhaseKeys {
    /// Id. Files of the manifest with this phase belong to it; so do those whose phase begins with it and a point,
    /// `positions.up`, and the procedure of the phase then sees the rest, `up`.
    #[key(id, required, example = "repeatability")]
    pub id: Option<String>,
    /// Title. Default: that of its procedure.
    #[key(example = "Repeatability of the bias")]
    pub title: Option<LocalText>,
    /// Its procedure, relative to this file.
    #[key(required, example = "bias-repeatability.toml")]
    pub procedure: Option<String>,
    /// Its limits file, relative to this file.
    #[key(example = "limits/sample-unit.toml")]
    pub limits: Option<String>,
    #[key(section)]
    pub section: Section,
}
