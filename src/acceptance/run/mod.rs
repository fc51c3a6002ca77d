//! A procedure applied to a recording: one pass, then conditions, measurands, verdicts, figures.
//!
//! Clock, host and people are passed in; the outcome is a pure function of the inputs.

pub mod analysis;
mod comparison;
mod described;
mod drawn;
pub(crate) mod evaluate;
pub mod explained;
pub mod figures;
mod goodness;
mod gyro_facts;
mod influence;
mod influence_acted;
mod influence_noise;
mod interval_means;
mod pass;
pub mod phases;
pub mod power;
pub(crate) mod reading;
mod settle;
mod sigma_tau;
mod steadiness;
mod table;
mod table_evidence;
mod table_known;
mod table_steps;
mod thermal;
mod unshown;
mod verdict;
mod warm_up;

use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{IngestError, Source};
use crate::noise::tau_grid::{TauGrid, TauGridError};
use crate::record::{ProcedureRecord, RunKind, RunRecord, Session, UnitUnderTest};
use chrono::{DateTime, Utc};
use std::fmt;

/// What is to be run.
pub struct Request<'a> {
    /// `run` or `analyze`.
    pub kind: RunKind,
    /// The procedure.
    pub procedure: &'a Procedure,
    /// Its identity; `None` for an analysis without a procedure.
    pub procedure_record: Option<ProcedureRecord>,
    /// Limits, references and typical values that hold.
    pub limits: &'a EffectiveLimits,
    /// The recording.
    pub source: &'a Source,
    /// False: go by the declared sample rate and leave the stamps.
    pub use_stamps: bool,
    /// The unit.
    pub unit: UnitUnderTest,
    /// Who and where; when is `now`.
    pub operator: Option<String>,
    /// Station.
    pub station: Option<String>,
    /// When the evaluation runs.
    pub now: DateTime<Utc>,
    /// Averaging times; `None`: those of the procedure.
    pub taus: Option<TauGrid>,
    /// Sum every term at any length.
    pub exact: bool,
}

/// What a run gives.
pub struct Outcome {
    /// The result.
    pub record: RunRecord,
    /// Figures in the order of the report.
    pub figures: Vec<Figure>,
    /// Tables: file name and contents.
    pub tables: Vec<(String, String)>,
}

/// Why a recording could not be evaluated.
#[derive(Debug)]
pub enum RunError {
    /// The recording could not be read.
    Ingest(IngestError),
    /// The averaging times do not suit the sample interval.
    TauGrid(TauGridError),
    /// There is nothing to evaluate.
    Nothing(Note),
}

impl RunError {
    /// What is wrong, as a note.
    pub fn note(&self) -> Note {
        match self {
            RunError::Ingest(e) => e.note(),
            RunError::TauGrid(e) => e.note(),
            RunError::Nothing(note) => note.clone(),
        }
    }
}

impl From<IngestError> for RunError {
    fn from(e: IngestError) -> Self {
        RunError::Ingest(e)
    }
}

impl From<TauGridError> for RunError {
    fn from(e: TauGridError) -> Self {
        RunError::TauGrid(e)
    }
}

impl fmt::Display for RunError {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().say(Lang::En))
    }
}

impl std::error::Error for RunError {}

/// Runs a procedure on a recording. `progress` is told bytes read and bytes in all.
///
/// # Errors
/// [`RunError`] when there is nothing to evaluate. Everything else, a missing serial number included, is a verdict.
pub fn execute(request: &Request<'_>, progress: &mut dyn FnMut(u64, u64)) -> Result<Outcome, RunError> {
    let procedure = request.procedure;
    match (&procedure.rate_table, &procedure.repeatability_test, &procedure.comparison_test) {
        (Some(setup), _, _) if request.kind == RunKind::Run => table::execute(request, setup, progress),
        (_, Some(test), _) if request.kind == RunKind::Run => {
            influence::repeatability(request, test, progress)
        }
        (_, _, Some(test)) if request.kind == RunKind::Run => influence::comparison(request, test, progress),
        _ => evaluate::execute(request, progress),
    }
}

/// The record of a run whose recording could not be evaluated: the verdict is `error`, and the reason stands in it, so
/// that no earlier report survives a failed run.
pub fn failed(request: &Request<'_>, error: &RunError) -> RunRecord {
    settle::failed(request, error)
}

/// Who evaluated, where and when.
pub fn session(request: &Request<'_>) -> Session {
    Session {
        operator: request.operator.clone(),
        station: request.station.clone(),
        evaluated_at: request.now.to_rfc3339_opts(chrono::SecondsFormat::Secs, true),
    }
}
