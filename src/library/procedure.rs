//! A test procedure, run on a recording.

use super::{Error, Recording, files};
use crate::acceptance::{Outcome, Request, execute};
use crate::config::model;
use crate::config::procedure::{self, EffectiveLimits, LimitsFile, Loaded, Problem, effective};
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::{Lang, note};
use crate::mismatch;
use crate::moment;
use crate::record::{ExplainedRecord, MeasurandRecord, RESULT_FORMAT, RunKind, RunRecord, UnitUnderTest};
use crate::report::export::Exporter;
use crate::report::{Document, Results, StoredResults};
use crate::series::SeriesOptions;
use chrono::{DateTime, Utc};
use std::path::Path;

/// A test procedure with its limits.
///
/// ```no_run
/// # fn main() -> Result<(), sagnac::Error> {
/// use sagnac::export::{Html, Json};
/// use sagnac::{Lang, Procedure, Recording, UnitUnderTest};
///
/// let result = Procedure::load("procedures/static-bias.toml")?
///     .with_limits("procedures/limits/sample-unit.toml")?
///     .run(&Recording::open("run.csv")?, &UnitUnderTest::with_serial("SN-0042"))?;
/// println!("{:?}", result.verdict());
/// result.write("out", &[&Html, &Json], Lang::En)?;
/// # Ok(())
/// # }
/// ```
pub struct Procedure {
    procedure: Loaded<procedure::Procedure>,
    limits: Option<Loaded<LimitsFile>>,
    operator: Option<String>,
    station: Option<String>,
    evaluated_at: Option<DateTime<Utc>>,
}

impl Procedure {
    /// Reads a procedure (TOML). One of several phases is run by `sagnac run` only.
    ///
    /// # Errors
    /// [`Error::is_configuration`] with every problem of the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Procedure, Error> {
        Ok(Procedure::of(procedure::load(path.as_ref())?))
    }

    /// Reads a procedure from the text of a file; `name` stands for the file in diagnostics and results.
    ///
    /// # Errors
    /// As [`Procedure::load`].
    pub fn parse(name: &str, text: &str) -> Result<Procedure, Error> {
        Ok(Procedure::of(procedure::parse_procedure(name, text.as_bytes())?))
    }

    fn of(procedure: Loaded<procedure::Procedure>) -> Procedure {
        Procedure { procedure, limits: None, operator: None, station: None, evaluated_at: None }
    }

    /// Adds limits from the text of a limits file; `name` stands for the file.
    ///
    /// # Errors
    /// As [`Procedure::with_limits`].
    pub fn with_limits_of(mut self, name: &str, text: &str) -> Result<Procedure, Error> {
        self.limits = Some(procedure::parse_limits(name, text.as_bytes())?);
        Ok(self)
    }

    /// Adds a limits file (TOML). Its limits replace those of the procedure for the same measurand and channel.
    ///
    /// # Errors
    /// [`Error::is_configuration`] with every problem of the file.
    pub fn with_limits(mut self, path: impl AsRef<Path>) -> Result<Procedure, Error> {
        self.limits = Some(procedure::load_limits(path.as_ref())?);
        Ok(self)
    }

    /// States who tests.
    #[must_use]
    pub fn operator(mut self, name: impl Into<String>) -> Procedure {
        self.operator = Some(name.into());
        self
    }

    /// States the station that the recording was made on.
    #[must_use]
    pub fn station(mut self, name: impl Into<String>) -> Procedure {
        self.station = Some(name.into());
        self
    }

    /// States the time of the evaluation, which decides whether calibrations are due; the present time where it is left
    /// out.
    #[must_use]
    pub fn evaluated_at(mut self, time: DateTime<Utc>) -> Procedure {
        self.evaluated_at = Some(time);
        self
    }

    /// Warnings about the procedure and its limits, each with file, line and column.
    pub fn warnings(&self) -> Vec<Problem> {
        let mut warnings = self.procedure.warnings.clone();
        warnings.extend(self.effective().warnings);
        warnings
    }

    fn effective(&self) -> EffectiveLimits {
        effective(&self.procedure, self.limits.as_ref())
    }

    /// Runs the procedure on a recording. An unmet condition or a missed limit is a verdict, not an error.
    ///
    /// # Errors
    /// [`Error::is_recording`] when the recording cannot be read, [`Error::is_not_evaluable`] when too little of it is
    /// left to evaluate, [`Error::is_argument`] when the serial number contradicts the manifest,
    /// [`Error::is_configuration`] when the model that the procedure names is wrong.
    pub fn run(&self, recording: &Recording, unit: &UnitUnderTest) -> Result<RunResult, Error> {
        self.run_watched(recording, unit, &mut |_, _| {})
    }

    /// The same; `progress` gets bytes read and bytes in all.
    ///
    /// # Errors
    /// As [`Procedure::run`].
    pub fn run_watched(
        &self,
        recording: &Recording,
        unit: &UnitUnderTest,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<RunResult, Error> {
        let procedure = &self.procedure.value;
        let anew = recording.read_by(&procedure.recording.read)?;
        let recording = anew.as_ref().unwrap_or(recording);
        let (mut unit, serial_of_recording) = recording.complete(unit)?;
        let family = self.limits.as_ref().and_then(|l| l.value.family.clone());
        unit.family = unit.family.or_else(|| procedure.unit_under_test.family.clone()).or(family);
        unit.part = unit.part.or_else(|| procedure.unit_under_test.part.clone());
        unit.revision = unit.revision.or_else(|| procedure.unit_under_test.revision.clone());
        let limits = self.effective();
        let request = Request {
            kind: RunKind::Run,
            procedure,
            procedure_record: Some(self.procedure.record(self.limits.as_ref())),
            limits: &limits,
            source: recording.source(),
            use_stamps: true,
            unit,
            serial_of_recording,
            operator: self.operator.clone(),
            station: self.station.clone(),
            now: self.evaluated_at.unwrap_or_else(moment::now),
            taus: None,
            exact: false,
            bench_checks: None,
        };
        let mut outcome = execute(&request, progress)?;
        outcome.record.explained = self.explained(recording)?;
        Ok(RunResult { outcome })
    }

    /// The recording against the model that the procedure names, if any.
    fn explained(&self, recording: &Recording) -> Result<Option<ExplainedRecord>, Error> {
        let procedure = &self.procedure.value;
        let Some(spec) = &procedure.explain else { return Ok(None) };
        let claim = model::load(&spec.model)?;
        let series = recording.series(&SeriesOptions {
            channels: procedure.channels.iter().map(|c| c.channel.clone()).collect(),
            sample_rate_hz: Some(claim.sample_rate_hz),
            ..recording.series_options()
        })?;
        let options = mismatch::Options {
            alpha: spec.alpha,
            max_effects: spec.max_effects,
            ..mismatch::Options::default()
        };
        let model = spec.model.display().to_string();
        Ok(Some(match mismatch::explain(series, &claim, &options, &mut |_| {}) {
            Ok(found) => ExplainedRecord { model, explanation: Some(found.explanation), error: None },
            Err(note) => ExplainedRecord { model, explanation: None, error: Some(note.into()) },
        }))
    }
}

/// What a run gives: verdict, measured quantities, conditions, figures.
pub struct RunResult {
    outcome: Outcome,
}

impl RunResult {
    pub(super) fn new(outcome: Outcome) -> RunResult {
        RunResult { outcome }
    }

    /// A result of which only the record is known: no figures, no tables.
    pub fn of_record(record: RunRecord) -> RunResult {
        RunResult { outcome: Outcome { record, figures: vec![], tables: vec![] } }
    }

    /// The same as results of any kind.
    pub fn into_results(self) -> Results {
        Results::Run(Box::new(self.outcome.into()))
    }

    /// Reads a `result.json`, or the folder of one, with the figures and tables that stand beside it. One of several
    /// phases has the record of the whole only.
    ///
    /// # Errors
    /// [`Error::is_argument`] when it is no result that this version reads.
    pub fn open(path: impl AsRef<Path>) -> Result<RunResult, Error> {
        match StoredResults::open(path.as_ref()).map_err(Error::argument)?.results {
            Results::Run(results) => Ok(RunResult { outcome: results.outcome }),
            _ => {
                let note = note!("result_error.foreign", format = RESULT_FORMAT);
                Err(Error::argument(note.with("path", path.as_ref().display().to_string())))
            }
        }
    }

    /// The worst verdict of all limits and conditions.
    pub fn verdict(&self) -> Verdict {
        self.outcome.record.verdict
    }

    /// A measured quantity by its id, for example `static_bias`: the first, where several channels have it.
    pub fn measurand(&self, id: &str) -> Option<&MeasurandRecord> {
        self.outcome.record.measurands.iter().find(|m| m.id == id)
    }

    /// Everything that the report shows.
    pub fn record(&self) -> &RunRecord {
        &self.outcome.record
    }

    /// The figures, in the order of the report.
    pub fn figures(&self) -> &[Figure] {
        &self.outcome.figures
    }

    /// Writes the result in some forms into a folder, which is created where it is missing. Files of the same names are
    /// replaced.
    ///
    /// # Errors
    /// [`Error::is_output`] when a file cannot be written.
    pub fn write(
        &self,
        folder: impl AsRef<Path>,
        exporters: &[&dyn Exporter],
        lang: Lang,
    ) -> Result<(), Error> {
        files::write(folder.as_ref(), &Document::of_run(&self.outcome, lang), exporters)
    }
}

impl UnitUnderTest {
    /// A unit of which only the serial number is stated.
    pub fn with_serial(serial: impl Into<String>) -> UnitUnderTest {
        UnitUnderTest { serial: Some(serial.into()), ..UnitUnderTest::default() }
    }
}
