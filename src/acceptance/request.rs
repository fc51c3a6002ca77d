//! A request, its outcome, and the reasons why there may be none.

use super::bench::{BenchCheck, OnBench};
use crate::config::procedure::model::Taus;
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{IngestError, Source};
use crate::noise::tau_grid::{TauGrid, TauGridError};
use crate::record::{ProcedureRecord, RecordingFile, RunKind, RunRecord, Session, UnitUnderTest};
use chrono::{DateTime, Utc};
use std::fmt;

/// Request for a run. Clock, host and people are passed in: the outcome is a pure function of a request.
#[derive(Clone)]
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
    /// True when nobody gave its serial number, and the one that the recording states is used.
    pub serial_of_recording: bool,
    /// Who tests.
    pub operator: Option<String>,
    /// Station of the test.
    pub station: Option<String>,
    /// When the evaluation runs.
    pub now: DateTime<Utc>,
    /// Averaging times; `None`: those of the procedure.
    pub taus: Option<TauGrid>,
    /// Sum every term at any length.
    pub exact: bool,
    /// The checks of benches that were found; `None` where nobody looked for any.
    pub bench_checks: Option<&'a [BenchCheck]>,
}

impl Request<'_> {
    /// True for a run of a procedure; false for an analysis, which asks nothing of a recording and judges no unit.
    pub fn is_run(&self) -> bool {
        self.kind == RunKind::Run
    }

    /// The averaging times of the Allan family.
    pub fn tau_grid(&self) -> TauGrid {
        self.taus.clone().unwrap_or_else(|| match &self.procedure.analysis.taus {
            Taus::Octave => TauGrid::Octave,
            Taus::Decade => TauGrid::Decade,
            Taus::All => TauGrid::All,
            Taus::List(taus) => TauGrid::List(taus.clone()),
        })
    }

    /// The test on its bench, where the procedure states one; an analysis has none.
    pub(super) fn on_bench<'f>(&'f self, files: &'f [RecordingFile]) -> Option<OnBench<'f>> {
        let bench = self.procedure.bench.as_ref().filter(|_| self.is_run())?;
        Some(OnBench { bench, station: self.station.as_deref(), files, now: self.now })
    }

    /// A sentence about the recording, with its path.
    pub(super) fn about(&self, key: &'static str) -> Note {
        Note::new(key).with("path", self.source.path().display().to_string())
    }
}

/// Who evaluated, where and when.
pub fn session(request: &Request<'_>) -> Session {
    let day = request.now.date_naive().to_string();
    let serial = request.unit.serial.as_deref();
    Session {
        operator: request.operator.clone(),
        station: request.station.clone(),
        protocol: request.procedure.protocol_number(serial, &day).filter(|_| request.is_run()),
        evaluated_at: request.now.to_rfc3339_opts(chrono::SecondsFormat::Secs, true),
    }
}

/// A table beside the result: file name and contents.
pub type Table = (String, String);

/// What a run gives.
pub struct Outcome {
    /// The result.
    pub record: RunRecord,
    /// Figures in the order of the report.
    pub figures: Vec<Figure>,
    /// Tables beside the result.
    pub tables: Vec<Table>,
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
    /// The error as a note.
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
