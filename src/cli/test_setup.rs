//! The part of a test that the command line gives: people, unit, averaging times, limits.

use super::evaluate::{Against, Evaluated, evaluate};
use super::inputs::{Inputs, completed};
use super::progress::Progress;
use super::run_args::RunArgs;
use crate::acceptance::bench::BenchCheck;
use crate::acceptance::{Request, RunError, Table};
use crate::config::manifest::Manifest;
use crate::config::procedure::missing_columns::missing_columns;
use crate::config::procedure::{EffectiveLimits, LimitsFile, Loaded, Procedure};
use crate::i18n::Lang;
use crate::ingest::Source;
use crate::ingest::unit_data::UnitData;
use crate::noise::tau_grid::TauGrid;
use crate::output::{LIMITS_FILE, PROCEDURE_FILE};
use crate::record::{ProcedureRecord, RunKind, Session, UnitUnderTest};
use chrono::{DateTime, SecondsFormat, Utc};

/// A procedure with the limits that hold for it.
#[derive(Clone, Copy)]
pub struct ProcedureWithLimits<'a> {
    /// The procedure.
    pub procedure: &'a Loaded<Procedure>,
    /// The limits file, where there is one.
    pub limits: Option<&'a Loaded<LimitsFile>>,
    /// The limits of both.
    pub effective: &'a EffectiveLimits,
}

impl ProcedureWithLimits<'_> {
    /// The identity of both in a record.
    pub fn record(self) -> ProcedureRecord {
        self.procedure.record(self.limits)
    }

    /// The texts of both, as files of the result.
    fn texts(self) -> impl Iterator<Item = Table> {
        let procedure = (PROCEDURE_FILE.to_owned(), self.procedure.text());
        let limits = self.limits.map(|limits| (LIMITS_FILE.to_owned(), limits.text()));
        std::iter::once(procedure).chain(limits)
    }
}

/// A test of one recording.
pub struct Test<'a> {
    /// The procedure and its limits.
    pub by: ProcedureWithLimits<'a>,
    /// The recording.
    pub source: &'a Source,
    /// The reason why it cannot be evaluated.
    pub refused: Option<RunError>,
    /// The unit.
    pub unit: UnitUnderTest,
    /// True when only the recording states the serial number of the unit.
    pub serial_of_recording: bool,
    /// The model that the recording is explained against.
    pub against: Option<Against<'a>>,
    /// The label of the progress while the recording is read.
    pub label: &'a str,
}

/// The options of a test that are the same for every recording.
pub struct Setup<'a> {
    args: &'a RunArgs,
    taus: Option<TauGrid>,
    units: UnitData,
    /// The checks of benches that were found; `None` where none is demanded, or nobody says where to look.
    pub bench_checks: Option<Vec<BenchCheck>>,
    /// When the evaluation runs.
    pub now: DateTime<Utc>,
}

impl<'a> Setup<'a> {
    /// Reads the options and the table of units.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn load(args: &'a RunArgs, now: DateTime<Utc>, lang: Lang) -> Result<Setup<'a>, String> {
        let (taus, units) = (args.grid.grid(lang)?, args.units(lang)?);
        Ok(Setup { args, taus, units, bench_checks: None, now })
    }

    /// The inputs of every result, so far without procedure, recording and unit.
    pub fn inputs(&self) -> Inputs {
        Inputs::new(self.args.output.force)
            .file("unit_data", self.args.unit_data.as_deref())
            .options(&(&self.args.grid.taus, self.args.grid.exact))
            .beside(self.args.output.forms.templates.as_deref())
    }

    /// The people, the station and the moment.
    pub fn session(&self) -> Session {
        Session {
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            protocol: None,
            evaluated_at: self.now.to_rfc3339_opts(SecondsFormat::Secs, true),
        }
    }

    /// A unit by its serial number: as the procedure describes it, the command line, else the manifest, else the table of units.
    pub fn unit(
        &self,
        described: UnitUnderTest,
        serial: Option<String>,
        manifest: Option<&Manifest>,
    ) -> UnitUnderTest {
        let unit = UnitUnderTest { serial, lot: self.args.lot.clone(), ..described };
        completed(unit, manifest, &self.units)
    }

    /// Makes a test, and keeps the procedure and the limits with its results. A recording that cannot be evaluated, or lacks columns,
    /// gives a record that says so.
    pub fn evaluate(&self, test: Test<'_>, progress: &mut Progress) -> Evaluated {
        let Test { by, source, refused, unit, serial_of_recording, against, label } = test;
        let request = Request {
            kind: RunKind::Run,
            procedure: &by.procedure.value,
            procedure_record: Some(by.record()),
            limits: by.effective,
            source,
            use_stamps: true,
            unit,
            serial_of_recording,
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            now: self.now,
            taus: self.taus.clone(),
            exact: self.args.grid.exact,
            bench_checks: self.bench_checks.as_deref(),
        };
        let mut evaluated = if let Some(error) = refused {
            Evaluated::refused(&request, &error)
        } else if let Some((problems, first)) = missing_columns(by.procedure, source) {
            Evaluated { problems: Some(problems), ..Evaluated::refused(&request, &first.into()) }
        } else {
            evaluate(&request, against, label, progress)
        };
        evaluated.results.outcome.tables.extend(by.texts());
        evaluated
    }
}
