//! A procedure of several phases, ready to be run on manifests: each phase on its files.

use super::bench_checks::bench_checks;
use super::evaluate::Evaluated;
use super::inputs::{Inputs, Serial};
use super::place;
use super::procedures::say_which;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::test_setup::{ProcedureWithLimits, Setup, Test};
use crate::acceptance::Outcome;
use crate::acceptance::changes;
use crate::acceptance::phases::{Done, combine};
use crate::config::manifest::{Manifest, ManifestFile};
use crate::config::procedure::phases::{Phase, Phased, load_phased};
use crate::config::procedure::{EffectiveLimits, effective};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::{ReadOptions, Source, open_files};
use crate::record::UnitUnderTest;
use crate::report::RunResults;
use chrono::{DateTime, Utc};
use std::path::PathBuf;

/// A procedure of several phases.
pub struct PhasedTest<'a> {
    args: &'a RunArgs,
    /// The procedure.
    pub phased: Phased,
    limits: Vec<EffectiveLimits>,
    /// The options of the command line.
    pub setup: Setup<'a>,
}

impl<'a> PhasedTest<'a> {
    /// Reads the procedures of all phases, and says what is to be known of them.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn load(args: &'a RunArgs, now: DateTime<Utc>, lang: Lang) -> Result<PhasedTest<'a>, String> {
        let error = |note: Note| place::error(&note, lang);
        let mut setup = Setup::load(args, now, lang)?;
        say_which(&[&args.procedure], lang);
        let phased = load_phased(&args.procedure).map_err(|p| p.say(lang))?;
        if args.limits.is_some() {
            return Err(error(note!("phases.limits")));
        }
        if let Some(odd) = phased.phases.iter().find(|p| p.procedure.value.explain.is_some()) {
            return Err(error(note!("phases.explain", id = odd.id.as_str())));
        }
        setup.bench_checks = bench_checks(args, phased.phases.iter().map(|p| &p.procedure.value), lang)?;
        let limits: Vec<EffectiveLimits> =
            phased.phases.iter().map(|p| effective(&p.procedure, p.limits.as_ref())).collect();
        for (phase, limits) in phased.phases.iter().zip(&limits) {
            for warning in phase.procedure.warnings.iter().chain(&limits.warnings) {
                place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
            }
        }
        Ok(PhasedTest { args, phased, limits, setup })
    }

    /// The inputs of a result of this test, so far without the recording and its unit.
    pub fn common_inputs(&self) -> Inputs {
        let phases = || self.phased.phases.iter();
        let procedures = phases().map(|p| PathBuf::from(&p.procedure.path));
        let procedures: Vec<PathBuf> =
            std::iter::once(self.args.procedure.clone()).chain(procedures).collect();
        let limits: Vec<PathBuf> =
            phases().filter_map(|p| Some(PathBuf::from(&p.limits.as_ref()?.path))).collect();
        let layouts: Vec<PathBuf> = phases()
            .filter_map(|p| p.procedure.value.recording.read.layout.as_ref().map(|l| l.path.clone()))
            .collect();
        let inputs = self.setup.inputs().files("procedure", &procedures);
        inputs.files("limits", &limits).files("layout", &layouts)
    }

    /// The inputs of the result of a recording.
    pub fn inputs(&self, recording: &[PathBuf], serial: Option<&str>) -> Inputs {
        self.common_inputs().recording(recording, &ReadOptions::default()).text("unit", serial)
    }

    /// Runs every phase on its files.
    pub fn evaluate(&self, manifest: &Manifest, serial: Serial, progress: &mut Progress) -> PhasesEvaluated {
        let lang = progress.lang();
        let unit = self.unit(serial.number, Some(manifest));
        let mut done: Vec<Done<'_>> = Vec::new();
        let mut explained = vec![];
        for (phase, limits) in self.phased.phases.iter().zip(&self.limits) {
            let files = files(phase, manifest);
            let evaluated = (!files.is_empty()).then(|| {
                let unit = unit.clone();
                self.run(PhaseRun { phase, limits, files, unit }, manifest, serial.of_recording, progress)
            });
            if let Some(problems) = evaluated.as_ref().and_then(|e| e.problems.as_ref()) {
                progress.beside(|| place::eprint_diagnostic(&problems.say(lang)));
                explained.push(phase.id.clone());
            }
            done.push(Done { phase, outcome: evaluated.map(|e| e.results.outcome) });
        }
        PhasesEvaluated { results: self.combined(done, unit), explained }
    }

    /// The results where no phase could be run, with the reason.
    pub fn not_run(&self, why: Note, serial: Option<String>) -> RunResults {
        let done = self.phased.phases.iter().map(|phase| Done { phase, outcome: None }).collect();
        let mut results = self.combined(done, self.unit(serial, None));
        let record = &mut results.outcome.record;
        record.verdict = Verdict::Error;
        record.errors.push(note!("error.not_evaluated", reason = why).into());
        record.summary = record.errors.clone();
        results
    }

    /// The results of the whole from those of the phases.
    fn combined(&self, done: Vec<Done<'_>>, unit: UnitUnderTest) -> RunResults {
        let record = combine(&self.phased, &done, unit, self.setup.session());
        let of_changes = record.phases.iter().filter_map(|p| changes::outcome(p).map(Some));
        let phases = done.into_iter().map(|d| d.outcome).chain(of_changes).collect();
        RunResults { outcome: Outcome { record, figures: vec![], tables: vec![] }, phases, explanation: None }
    }

    fn unit(&self, serial: Option<String>, manifest: Option<&Manifest>) -> UnitUnderTest {
        let described = UnitUnderTest {
            family: self.phased.family.clone(),
            part: self.phased.part.clone(),
            revision: self.phased.part_revision.clone(),
            ..UnitUnderTest::default()
        };
        self.setup.unit(described, serial, manifest)
    }

    /// The serial number of the unit: as given, or else by the manifest, or else by the files of the phases.
    ///
    /// # Errors
    /// A note where the number given is not that of the manifest.
    pub fn serial(&self, given: Option<&str>, manifest: &Manifest) -> Result<Serial, Note> {
        let serial = Serial::of(given, Some(manifest), &[])?;
        if serial.number.is_some() {
            return Ok(serial);
        }
        let open = |phase: &Phase| {
            let files = files(phase, manifest);
            let name = files.first()?.path.clone();
            let options = manifest.options_over(&phase.procedure.value.recording.read);
            open_files(&name, &files, manifest.contiguous, &options).ok()
        };
        let sources: Vec<Source> = self.phased.phases.iter().filter_map(open).collect();
        Serial::of(given, Some(manifest), &sources.iter().collect::<Vec<_>>())
    }

    fn run(
        &self,
        run: PhaseRun<'_>,
        manifest: &Manifest,
        serial_of_recording: bool,
        progress: &mut Progress,
    ) -> Evaluated {
        let PhaseRun { phase, limits, files, unit } = run;
        let options = manifest.options_over(&phase.procedure.value.recording.read);
        let name = files.first().map_or_else(|| manifest.path.clone(), |f| f.path.clone());
        let (source, refused) = match open_files(&name, &files, manifest.contiguous, &options) {
            Ok(source) => (source, None),
            Err(e) => (Source::unopened(&name), Some(e.into())),
        };
        let lang = progress.lang();
        let (procedure, effective) = (&phase.procedure, limits);
        let test = Test {
            by: ProcedureWithLimits { procedure, limits: phase.limits.as_ref(), effective },
            source: &source,
            refused,
            unit,
            serial_of_recording,
            against: None,
            label: &format!("{}: {}", phase.title.say(lang), note!("cli.reading").say(lang)),
        };
        self.setup.evaluate(test, progress)
    }
}

/// A phase with its recording.
struct PhaseRun<'a> {
    phase: &'a Phase,
    limits: &'a EffectiveLimits,
    files: Vec<ManifestFile>,
    unit: UnitUnderTest,
}

/// The results of all phases.
pub struct PhasesEvaluated {
    /// Record, figures and tables.
    pub results: RunResults,
    /// Ids of the phases whose failure was printed with all its reasons.
    pub explained: Vec<String>,
}

/// The rest of a file's phase behind the id of a phase; `None` when it is not of that phase.
fn rest<'a>(phase: &Phase, of: &'a str) -> Option<Option<&'a str>> {
    let rest = of.strip_prefix(phase.id.as_str())?;
    if rest.is_empty() { Some(None) } else { rest.strip_prefix('.').map(Some) }
}

/// The files of a phase, with the phase that its procedure sees.
fn files(phase: &Phase, manifest: &Manifest) -> Vec<ManifestFile> {
    let own = |f: &ManifestFile| {
        let rest = rest(phase, f.phase.as_deref()?)?;
        Some(ManifestFile { phase: rest.map(str::to_owned), ..f.clone() })
    };
    manifest.files.iter().filter_map(own).collect()
}

/// Checks that every file of the manifest belongs to a phase.
///
/// # Errors
/// A note that names the first that does not.
pub fn belong(phased: &Phased, manifest: &Manifest) -> Result<(), Note> {
    let known: Vec<&str> = phased.phases.iter().map(|p| p.id.as_str()).collect();
    for file in &manifest.files {
        let note = match &file.phase {
            Some(of) if phased.phases.iter().any(|p| rest(p, of).is_some()) => continue,
            Some(of) => note!("phases.unknown", phase = of.as_str()),
            None => note!("phases.no_phase"),
        };
        return Err(note.with("path", file.path.display().to_string()).with("phases", known.join(", ")));
    }
    Ok(())
}
