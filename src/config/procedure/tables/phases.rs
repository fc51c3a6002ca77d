//! The tables of a procedure of several phases.

use super::{ClauseKeys, Identity};
use crate::config::procedure::model::UnitSpec;
use crate::config::procedure::section::Section;
use crate::config::spec::TableSpec;
use crate::config::table::Table;
use crate::estimate::Rule;
use crate::i18n::LocalText;
use crate::measurand::Measurand;

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
    /// Changes from one phase to another, one table each.
    #[key(name = "compare")]
    pub compares: Vec<CompareKeys>,
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

/// The change of a quantity from one phase to another: before and after shock, vibration, storage, cycling, radiation. What the
/// same instruments at the same site have in common drops out of its uncertainty.
#[derive(Table)]
#[table("compare")]
pub(in crate::config::procedure) struct CompareKeys {
    /// Id of the measurand; both phases determine it.
    #[key(required, example = "static_bias")]
    pub measurand: Option<&'static Measurand>,
    /// Phase before.
    #[key(id, required, example = "before")]
    pub before: Option<String>,
    /// Phase after.
    #[key(id, required, example = "after")]
    pub after: Option<String>,
    /// Largest magnitude of the change that is allowed. Default: the change is stated and not judged.
    #[key(unit_of = "measurand", example = "0.05 deg/h")]
    pub max_change: Option<f64>,
    /// Decision rule.
    #[key(default = "guard_band", example = "guard_band")]
    pub rule: Rule,
    /// Risk of a wrong acceptance, and of a wrong rejection, that the guard band is set for.
    #[key(above = 0, max = 0.5, default = 0.05, example = 0.05)]
    pub risk: f64,
    #[key(section)]
    pub section: Section,
}
