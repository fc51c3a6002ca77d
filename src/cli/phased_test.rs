//! A procedure of several phases, ready to be run on manifests: each phase on its files.

use super::finish::{not_run, with_progress};
use super::inputs::{Inputs, Serial, completed};
use super::place;
use super::procedures::say_which;
use super::progress::Progress;
use super::run_args::RunArgs;
use super::single_test::kept_texts;
use crate::acceptance::phases::{Done, combine};
use crate::acceptance::{Outcome, Request, session};
use crate::config::manifest::{Manifest, ManifestFile};
use crate::config::procedure::missing_columns::missing_columns;
use crate::config::procedure::phases::{Phase, Phased, load_phased};
use crate::config::procedure::{EffectiveLimits, effective};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::unit_data::UnitData;
use crate::ingest::{IngestError, ReadOptions, Source, open_files};
use crate::noise::tau_grid::TauGrid;
use crate::record::{RunKind, Session, UnitUnderTest};
use crate::report::RunResults;
use chrono::{DateTime, SecondsFormat, Utc};
use std::path::PathBuf;

/// A procedure of several phases.
pub struct PhasedTest<'a> {
    args: &'a RunArgs,
    pub phased: Phased,
    limits: Vec<EffectiveLimits>,
    taus: Option<TauGrid>,
    units: UnitData,
    now: DateTime<Utc>,
}

impl<'a> PhasedTest<'a> {
    /// Reads the procedures of all phases, and says what is to be known of them.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn load(args: &'a RunArgs, now: DateTime<Utc>, lang: Lang) -> Result<PhasedTest<'a>, String> {
        let error = |note: Note| place::error(&note, lang);
        say_which(&[&args.procedure], lang);
        let phased = load_phased(&args.procedure).map_err(|p| p.say(lang))?;
        if args.limits.is_some() {
            return Err(error(Note::new("phases.limits")));
        }
        if let Some(odd) = phased.phases.iter().find(|p| p.procedure.value.explain.is_some()) {
            return Err(error(Note::new("phases.explain").with("id", odd.id.as_str())));
        }
        let taus = args.grid.grid(lang)?;
        let limits: Vec<EffectiveLimits> =
            phased.phases.iter().map(|p| effective(&p.procedure, p.limits.as_ref())).collect();
        for (phase, limits) in phased.phases.iter().zip(&limits) {
            for warning in phase.procedure.warnings.iter().chain(&limits.warnings) {
                place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
            }
        }
        let units = args.units(lang)?;
        Ok(PhasedTest { args, phased, limits, taus, units, now })
    }

    /// What a result of this test is made from, but for the recording and its unit.
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
        Inputs::new(self.args.output.force)
            .files("procedure", &procedures)
            .files("limits", &limits)
            .files("layout", &layouts)
            .file("unit_data", self.args.unit_data.as_deref())
            .options(&(&self.args.grid.taus, self.args.grid.exact))
            .beside(self.args.output.templates.as_deref())
    }

    /// What the result of a recording is made from.
    pub fn inputs(&self, recording: &[PathBuf], serial: Option<&str>) -> Inputs {
        self.common_inputs().recording(recording, &ReadOptions::default()).text("unit", serial)
    }

    /// Runs every phase on its files.
    pub fn evaluate(&self, manifest: &Manifest, serial: Serial, progress: &mut Progress) -> PhasesEvaluated {
        let of_recording = serial.of_recording;
        let unit = self.unit(serial.number, Some(manifest));
        let mut done: Vec<Done<'_>> = Vec::new();
        let mut who = None;
        let mut explained = vec![];
        for (phase, limits) in self.phased.phases.iter().zip(&self.limits) {
            let files = files(phase, manifest);
            let outcome = (!files.is_empty()).then(|| {
                self.run(
                    phase,
                    limits,
                    manifest,
                    &files,
                    (&unit, of_recording, &mut who, &mut explained),
                    progress,
                )
            });
            done.push(Done { phase, outcome });
        }
        let record = combine(&self.phased, &done, unit, who.unwrap_or_default());
        let phases = done.into_iter().map(|d| d.outcome).collect();
        let outcome = Outcome { record, figures: vec![], tables: vec![] };
        PhasesEvaluated { results: RunResults { outcome, phases, explanation: None }, explained }
    }

    /// The results where no phase could be run, with the reason.
    pub fn not_run(&self, why: Note, serial: Option<String>) -> RunResults {
        let done: Vec<Done<'_>> =
            self.phased.phases.iter().map(|phase| Done { phase, outcome: None }).collect();
        let session = Session {
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            evaluated_at: self.now.to_rfc3339_opts(SecondsFormat::Secs, true),
        };
        let mut record = combine(&self.phased, &done, self.unit(serial, None), session);
        record.verdict = Verdict::Error;
        record.errors.push(Note::new("error.not_evaluated").with("reason", why).into());
        record.summary = record.errors.clone();
        let phases = done.into_iter().map(|d| d.outcome).collect();
        RunResults { outcome: Outcome { record, figures: vec![], tables: vec![] }, phases, explanation: None }
    }

    /// What is known of the unit: from the command line, else the manifest, else the table of units.
    fn unit(&self, serial: Option<String>, manifest: Option<&Manifest>) -> UnitUnderTest {
        let unit = UnitUnderTest {
            serial,
            family: self.phased.family.clone(),
            part: self.phased.part.clone(),
            revision: self.phased.part_revision.clone(),
            lot: self.args.lot.clone(),
            ..UnitUnderTest::default()
        };
        completed(unit, manifest, &self.units)
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

    /// Runs one phase on its files; `who` gets who evaluates, by the first, and `explained` the phase whose missing columns were
    /// printed.
    fn run(
        &self,
        phase: &Phase,
        limits: &EffectiveLimits,
        manifest: &Manifest,
        files: &[ManifestFile],
        (unit, of_recording, who, explained): (&UnitUnderTest, bool, &mut Option<Session>, &mut Vec<String>),
        progress: &mut Progress,
    ) -> Outcome {
        let options = manifest.options_over(&phase.procedure.value.recording.read);
        let name = files.first().map_or_else(|| manifest.path.clone(), |f| f.path.clone());
        let (source, refused) = match open_files(&name, files, manifest.contiguous, &options) {
            Ok(source) => (source, None),
            Err(e) => (Source::unopened(&name), Some(e)),
        };
        let request = Request {
            kind: RunKind::Run,
            procedure: &phase.procedure.value,
            procedure_record: Some(phase.procedure.record(phase.limits.as_ref())),
            limits,
            source: &source,
            use_stamps: true,
            unit: unit.clone(),
            serial_of_recording: of_recording,
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            now: self.now,
            taus: self.taus.clone(),
            exact: self.args.grid.exact,
        };
        who.get_or_insert_with(|| session(&request));
        let lang = progress.lang();
        let label = format!("{}: {}", phase.title.say(lang), Note::new("cli.reading").say(lang));
        let missing = if refused.is_none() { missing_column(phase, &source, progress) } else { None };
        explained.extend(missing.as_ref().map(|_| phase.id.clone()));
        let mut outcome = match refused.or(missing) {
            Some(e) => not_run(&request, &e.into()),
            None => with_progress(&request, &label, progress).unwrap_or_else(|e| not_run(&request, &e)),
        };
        outcome.tables.extend(kept_texts(&phase.procedure, phase.limits.as_ref()));
        outcome
    }
}

/// What came of all phases.
pub struct PhasesEvaluated {
    /// Record, figures and tables.
    pub results: RunResults,
    /// Ids of the phases whose failure was printed with all its reasons.
    pub explained: Vec<String>,
}

/// The first column that the recording of a phase lacks; all of them are printed.
fn missing_column(phase: &Phase, source: &Source, progress: &mut Progress) -> Option<IngestError> {
    let (problems, first) = missing_columns(&phase.procedure, source)?;
    let lang = progress.lang();
    progress.beside(|| place::eprint_diagnostic(&problems.say(lang)));
    Some(first)
}

/// What a file's phase leaves when the id of a phase is taken off; `None` when it is not of that phase.
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
            Some(of) => Note::new("phases.unknown").with("phase", of.as_str()),
            None => Note::new("phases.no_phase"),
        };
        return Err(note.with("path", file.path.display().to_string()).with("phases", known.join(", ")));
    }
    Ok(())
}
