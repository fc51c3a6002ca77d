//! A procedure with its limits, ready to be run on recordings.

use super::finish::{Against, Evaluated, evaluate};
use super::inputs::{Inputs, Serial, completed};
use super::place;
use super::procedures::say_which;
use super::progress::Progress;
use super::run_args::RunArgs;
use crate::acceptance::{Request, RunError, Table, explained};
use crate::config::manifest::Manifest;
use crate::config::model::Claim;
use crate::config::procedure::missing_columns::missing_columns;
use crate::config::procedure::{
    EffectiveLimits, LimitsFile, Loaded, Procedure, effective, load, load_limits,
};
use crate::i18n::Lang;
use crate::ingest::unit_data::UnitData;
use crate::ingest::{Recording, RecordingError, Source, open_recording};
use crate::noise::tau_grid::TauGrid;
use crate::output::{LIMITS_FILE, PROCEDURE_FILE};
use crate::record::{RunKind, UnitUnderTest};
use chrono::{DateTime, Utc};
use std::path::{Path, PathBuf};

/// The texts that a test was made by, as files of its result.
pub fn kept_texts(procedure: &Loaded<Procedure>, limits: Option<&Loaded<LimitsFile>>) -> Vec<Table> {
    let procedure = (PROCEDURE_FILE.to_owned(), procedure.text());
    let limits = limits.map(|limits| (LIMITS_FILE.to_owned(), limits.text()));
    std::iter::once(procedure).chain(limits).collect()
}

/// A procedure of one phase, with its limits and the model that it names.
pub struct SingleTest<'a> {
    args: &'a RunArgs,
    pub procedure: Loaded<Procedure>,
    pub limits: Option<Loaded<LimitsFile>>,
    effective: EffectiveLimits,
    model: Option<Claim>,
    taus: Option<TauGrid>,
    units: UnitData,
    now: DateTime<Utc>,
}

impl<'a> SingleTest<'a> {
    /// Reads the files, and says what is to be known of them.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn load(args: &'a RunArgs, now: DateTime<Utc>, lang: Lang) -> Result<SingleTest<'a>, String> {
        let taus = args.grid.grid(lang)?;
        let named: Vec<&Path> =
            std::iter::once(args.procedure.as_path()).chain(args.limits.as_deref()).collect();
        say_which(&named, lang);
        // Both files are read before either complains, so that all problems are seen at once.
        let procedure = load(&args.procedure);
        let limits = args.limits.as_deref().map(load_limits).transpose();
        let (procedure, limits) = match (procedure, limits) {
            (Ok(p), Ok(l)) => (p, l),
            (p, l) => {
                let complaints: Vec<String> =
                    [p.err(), l.err()].into_iter().flatten().map(|e| e.say(lang)).collect();
                return Err(complaints.join("\n"));
            }
        };
        let model = procedure.value.explain.as_ref().map(|spec| explained::model(spec, lang)).transpose()?;
        let effective = effective(&procedure, limits.as_ref());
        for warning in procedure.warnings.iter().chain(&effective.warnings) {
            place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
        }
        let units = args.units(lang)?;
        Ok(SingleTest { args, procedure, limits, effective, model, taus, units, now })
    }

    /// What a result of this test is made from, but for the recording and its unit.
    pub fn common_inputs(&self) -> Inputs {
        Inputs::new(self.args.output.force)
            .file("procedure", Some(&self.args.procedure))
            .file("limits", self.args.limits.as_deref())
            .file("unit_data", self.args.unit_data.as_deref())
            .file("model", self.procedure.value.explain.as_ref().map(|e| e.model.as_path()))
            .options(&(&self.args.grid.taus, self.args.grid.exact))
            .beside(self.args.output.templates.as_deref())
    }

    /// What the result of a recording is made from.
    pub fn inputs(&self, recording: &[PathBuf], serial: Option<&str>) -> Inputs {
        let read = &self.procedure.value.recording.read;
        self.common_inputs().recording_as_read(recording, read).text("unit", serial)
    }

    /// Opens a recording as the procedure says.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn open(&self, recording: &[PathBuf]) -> Result<Recording, RecordingError> {
        open_recording(recording, &self.procedure.value.recording.read)
    }

    /// What is known of the unit: from the command line, else the manifest, else the table of units.
    fn unit(&self, serial: Option<String>, manifest: Option<&Manifest>) -> UnitUnderTest {
        let spec = &self.procedure.value.unit_under_test;
        let family = self.limits.as_ref().and_then(|l| l.value.family.clone());
        let unit = UnitUnderTest {
            serial,
            family: spec.family.clone().or(family),
            part: spec.part.clone(),
            revision: spec.revision.clone(),
            lot: self.args.lot.clone(),
            ..UnitUnderTest::default()
        };
        completed(unit, manifest, &self.units)
    }

    /// Runs the test, and keeps the procedure and the limits with its results. A recording that could not be opened gives a
    /// record that says so.
    pub fn evaluate(
        &self,
        recording: &[PathBuf],
        opened: Result<Recording, RecordingError>,
        given: Option<&str>,
        progress: &mut Progress,
    ) -> Evaluated {
        let mut evaluated = self.run(recording, opened, given, progress);
        evaluated.results.outcome.tables.extend(kept_texts(&self.procedure, self.limits.as_ref()));
        evaluated
    }

    fn run(
        &self,
        recording: &[PathBuf],
        opened: Result<Recording, RecordingError>,
        given: Option<&str>,
        progress: &mut Progress,
    ) -> Evaluated {
        let name = recording.first().map_or(Path::new(""), PathBuf::as_path);
        let (source, manifest, mut refused) = match opened {
            Ok(opened) => (opened.source, opened.manifest, None),
            Err(error) => (Source::unopened(name), None, Some(RunError::from(error.into_ingest(name)))),
        };
        let serial = Serial::of(given, manifest.as_ref(), &[&source]).unwrap_or_else(|note| {
            refused = Some(RunError::Nothing(note));
            Serial { number: given.map(str::to_owned), of_recording: false }
        });
        let procedure = &self.procedure.value;
        let request = Request {
            kind: RunKind::Run,
            procedure,
            procedure_record: Some(self.procedure.record(self.limits.as_ref())),
            limits: &self.effective,
            source: &source,
            use_stamps: true,
            unit: self.unit(serial.number, manifest.as_ref()),
            serial_of_recording: serial.of_recording,
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            now: self.now,
            taus: self.taus.clone(),
            exact: self.args.grid.exact,
        };
        if refused.is_none()
            && let Some((problems, first)) = missing_columns(&self.procedure, &source)
        {
            return Evaluated { problems: Some(problems), ..Evaluated::refused(&request, &first.into()) };
        }
        match refused {
            None => {
                let against = self.model.clone().map(|claim| Against { claim, recording });
                evaluate(&request, against, progress)
            }
            Some(error) => Evaluated::refused(&request, &error),
        }
    }
}
