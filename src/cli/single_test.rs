//! A procedure with its limits, ready to be run on recordings.

use super::bench_checks::bench_checks;
use super::evaluate::{Against, Evaluated};
use super::inputs::{Inputs, Serial};
use super::place;
use super::procedures::say_which;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::test_setup::{ProcedureWithLimits, Setup, Test};
use crate::acceptance::{RunError, explained};
use crate::config::model::Claim;
use crate::config::procedure::{
    EffectiveLimits, LimitsFile, Loaded, Procedure, effective, load, load_limits,
};
use crate::i18n::{Lang, Localize, note};
use crate::ingest::{ReadOptions, Recording, RecordingError, Source, open_recording};
use crate::record::UnitUnderTest;
use chrono::{DateTime, Utc};
use std::path::{Path, PathBuf};

/// A procedure of one phase, with its limits and the model that it names.
pub struct SingleTest<'a> {
    args: &'a RunArgs,
    /// The procedure.
    pub procedure: Loaded<Procedure>,
    limits: Option<Loaded<LimitsFile>>,
    effective: EffectiveLimits,
    model: Option<Claim>,
    /// The options of the command line.
    pub setup: Setup<'a>,
}

impl<'a> SingleTest<'a> {
    /// Reads the files, and says what is to be known of them.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn load(args: &'a RunArgs, now: DateTime<Utc>, lang: Lang) -> Result<SingleTest<'a>, String> {
        let mut setup = Setup::load(args, now, lang)?;
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
        setup.bench_checks = bench_checks(args, std::iter::once(&procedure.value), lang)?;
        let effective = effective(&procedure, limits.as_ref());
        for warning in procedure.warnings.iter().chain(&effective.warnings) {
            place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
        }
        Ok(SingleTest { args, procedure, limits, effective, model, setup })
    }

    /// The procedure and its limits.
    pub fn by(&self) -> ProcedureWithLimits<'_> {
        let SingleTest { procedure, limits, effective, .. } = self;
        ProcedureWithLimits { procedure, limits: limits.as_ref(), effective }
    }

    /// The inputs of a result of this test, so far without the recording and its unit.
    pub fn common_inputs(&self) -> Inputs {
        self.setup
            .inputs()
            .file("procedure", Some(&self.args.procedure))
            .file("limits", self.args.limits.as_deref())
            .file("model", self.procedure.value.explain.as_ref().map(|e| e.model.as_path()))
    }

    /// The inputs of the result of a recording.
    pub fn inputs(&self, recording: &[PathBuf], serial: Option<&str>) -> Inputs {
        let read = self.read_options();
        let sources = (!read.sources.is_empty()).then(|| format!("{:?}", read.sources));
        let inputs = self.common_inputs().recording_as_read(recording, &read).text("unit", serial);
        inputs.text("sources", sources.as_deref())
    }

    /// Opens a recording as the procedure says.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn open(&self, recording: &[PathBuf]) -> Result<Recording, RecordingError> {
        open_recording(recording, &self.read_options())
    }

    /// How a recording is read: as the procedure says, with the files beside it that the command line names.
    fn read_options(&self) -> ReadOptions {
        let sources = self.args.sources.sources();
        ReadOptions { sources, ..self.procedure.value.recording.read.clone() }
    }

    /// The unit as procedure and limits describe it.
    fn described(&self) -> UnitUnderTest {
        let spec = &self.procedure.value.unit_under_test;
        let family = self.limits.as_ref().and_then(|l| l.value.family.clone());
        UnitUnderTest {
            family: spec.family.clone().or(family),
            part: spec.part.clone(),
            revision: spec.revision.clone(),
            ..UnitUnderTest::default()
        }
    }

    /// Runs the test. A recording that could not be opened gives a record that says so.
    pub fn evaluate(
        &self,
        recording: &[PathBuf],
        opened: &Result<Recording, RecordingError>,
        given: Option<&str>,
        progress: &mut Progress,
    ) -> Evaluated {
        let name = recording.first().map_or(Path::new(""), PathBuf::as_path);
        let unopened = Source::unopened(name);
        let (source, manifest, mut refused) = match opened {
            Ok(opened) => (&opened.source, opened.manifest.as_ref(), None),
            Err(error) => (&unopened, None, Some(RunError::from(error.clone().into_ingest(name)))),
        };
        let serial = Serial::of(given, manifest, &[source]).unwrap_or_else(|note| {
            refused = Some(RunError::Nothing(note));
            Serial { number: given.map(str::to_owned), of_recording: false }
        });
        let test = Test {
            by: self.by(),
            source,
            refused,
            unit: self.setup.unit(self.described(), serial.number, manifest),
            serial_of_recording: serial.of_recording,
            against: self.model.clone().map(|claim| Against { claim, recording }),
            label: &note!("cli.reading").say(progress.lang()),
        };
        self.setup.evaluate(test, progress)
    }
}
