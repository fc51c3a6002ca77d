//! `sagnac run` with a procedure of several phases: each on its files of a manifest, one report over all.

use super::finish::{finish, not_run, with_progress};
use super::inputs::{Inputs, serial};
use super::place;
use super::printer::Printer;
use super::procedures::say_which;
use super::run::RunArgs;
use crate::acceptance::phases::{Done, combine, failure};
use crate::acceptance::{Outcome, Request, session};
use crate::config::manifest::{self, Manifest, ManifestFile, is_manifest};
use crate::config::procedure::effective;
use crate::config::procedure::missing_columns::missing_columns;
use crate::config::procedure::phases::{Phase, Phased, load_phased};
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{IngestError, ReadOptions, Source, open_files};
use crate::noise::tau_grid::TauGrid;
use crate::output::{Kind, StagedFolder};
use crate::record::{RunKind, Session, UnitUnderTest};
use crate::report::RunResults;
use chrono::{DateTime, Utc};
use std::path::PathBuf;

/// Runs every phase and writes the folder of the whole.
pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    let (phased, manifest) = load(args, lang)?;
    let taus = args.grid.grid(lang)?;
    let renderer = args.output.renderer(lang)?;
    let now = Utc::now();
    let unit = UnitUnderTest {
        serial: serial(args.serial.as_deref(), Some(&manifest), lang)?,
        family: phased.family.clone(),
        part: phased.part.clone(),
        revision: phased.part_revision.clone(),
        lot: None,
    };
    let folder = begin(args, &phased, unit.serial.as_deref(), now, lang)?;
    let order = Order { args, manifest: &manifest, unit: &unit, taus, now, lang };
    let mut done: Vec<Done<'_>> = Vec::new();
    let mut told: Vec<&str> = Vec::new();
    let mut who = None;
    for phase in &phased.phases {
        let files = files(phase, &manifest);
        let outcome = (!files.is_empty()).then(|| order.evaluate(phase, &files, &mut who, &mut told));
        done.push(Done { phase, outcome });
    }
    let record = combine(&phased, &done, unit, who.unwrap_or_default());
    for phase in record.phases.iter().filter(|p| !told.contains(&p.id.as_str())) {
        if let Some(why) = failure(phase) {
            let note = Note::new("phases.error").with("title", phase.title.as_str()).with("why", why.clone());
            place::eprint_diagnostic(&place::error(&note, lang));
        }
    }
    let phases = done.into_iter().map(|d| d.outcome).collect();
    let outcome = Outcome { record, figures: vec![], tables: vec![] };
    finish(
        RunResults { outcome, phases, explanation: None },
        folder,
        &renderer,
        Printer::new(&args.output, lang),
    )
}

/// The procedure and the manifest, which fit each other.
fn load(args: &RunArgs, lang: Lang) -> Result<(Phased, Manifest), String> {
    let error = |note: Note| place::error(&note, lang);
    say_which(&[&args.procedure], lang);
    let phased = load_phased(&args.procedure).map_err(|p| p.say(lang))?;
    if args.limits.is_some() {
        return Err(error(Note::new("phases.limits")));
    }
    if let Some(odd) = phased.phases.iter().find(|p| p.procedure.value.explain.is_some()) {
        return Err(error(Note::new("phases.explain").with("id", odd.id.as_str())));
    }
    let path = match args.recording.as_slice() {
        [one] if is_manifest(one) || one.extension().is_some_and(|e| e == "toml") => one,
        _ => {
            let needed = error(Note::new("phases.needs_manifest").with("id", phased.identity.id.as_str()));
            return Err(format!("{needed}\n{}", phased.example_manifest()));
        }
    };
    let manifest = manifest::load(path).map_err(|p| p.say(lang))?;
    belong(&phased, &manifest, lang)?;
    Ok((phased, manifest))
}

/// Begins the folder of the results.
fn begin(
    args: &RunArgs,
    phased: &Phased,
    serial: Option<&str>,
    now: DateTime<Utc>,
    lang: Lang,
) -> Result<StagedFolder, String> {
    let out = args.out.clone().unwrap_or_else(|| place::default_folder(&phased.identity.id, serial, now));
    let phases = || phased.phases.iter();
    let procedures = phases().map(|p| PathBuf::from(&p.procedure.path));
    let procedures: Vec<PathBuf> = std::iter::once(args.procedure.clone()).chain(procedures).collect();
    let limits: Vec<PathBuf> =
        phases().filter_map(|p| Some(PathBuf::from(&p.limits.as_ref()?.path))).collect();
    let layouts: Vec<PathBuf> = phases()
        .filter_map(|p| p.procedure.value.recording.read.layout.as_ref().map(|l| l.path.clone()))
        .collect();
    Inputs::new(args.output.force)
        .recording(&args.recording, &ReadOptions::default())
        .files("procedure", &procedures)
        .files("limits", &limits)
        .files("layout", &layouts)
        .text("unit", args.serial.as_deref())
        .options(&(&args.grid.taus, args.grid.exact))
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Result, lang)
}

/// What all phases have in common.
struct Order<'a> {
    args: &'a RunArgs,
    manifest: &'a Manifest,
    unit: &'a UnitUnderTest,
    taus: Option<TauGrid>,
    now: DateTime<Utc>,
    lang: Lang,
}

impl Order<'_> {
    /// Runs one phase on its files; `who` gets who evaluates, by the first, and `told` the phase whose error was printed.
    fn evaluate<'p>(
        &self,
        phase: &'p Phase,
        files: &[ManifestFile],
        who: &mut Option<Session>,
        told: &mut Vec<&'p str>,
    ) -> Outcome {
        let limits = effective(&phase.procedure, phase.limits.as_ref());
        for warning in phase.procedure.warnings.iter().chain(&limits.warnings) {
            place::eprint_diagnostic(&format!("{}\n", warning.say(self.lang)));
        }
        let options = self.manifest.options_over(&phase.procedure.value.recording.read);
        let name = files.first().map_or_else(|| self.manifest.path.clone(), |f| f.path.clone());
        let (source, refused) = match open_files(&name, files, self.manifest.contiguous, &options) {
            Ok(source) => (source, None),
            Err(e) => (Source::unopened(&name), Some(e)),
        };
        let request = Request {
            kind: RunKind::Run,
            procedure: &phase.procedure.value,
            procedure_record: Some(phase.procedure.record(phase.limits.as_ref())),
            limits: &limits,
            source: &source,
            use_stamps: true,
            unit: self.unit.clone(),
            operator: self.args.operator.clone(),
            station: self.args.station.clone(),
            now: self.now,
            taus: self.taus.clone(),
            exact: self.args.grid.exact,
        };
        who.get_or_insert_with(|| session(&request));
        let label = format!("{}: {}", phase.title, Note::new("cli.reading").say(self.lang));
        match refused.or_else(|| self.missing_column(phase, &source, told)) {
            Some(e) => not_run(&request, &e.into()),
            None => with_progress(&request, &label).unwrap_or_else(|e| not_run(&request, &e)),
        }
    }

    /// The first column that the recording of a phase lacks; all of them are printed.
    fn missing_column<'p>(
        &self,
        phase: &'p Phase,
        source: &Source,
        told: &mut Vec<&'p str>,
    ) -> Option<IngestError> {
        let (problems, first) = missing_columns(&phase.procedure, source)?;
        place::eprint_diagnostic(&problems.say(self.lang));
        told.push(&phase.id);
        Some(first)
    }
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

/// Every file of the manifest belongs to a phase.
fn belong(phased: &Phased, manifest: &Manifest, lang: Lang) -> Result<(), String> {
    let known: Vec<&str> = phased.phases.iter().map(|p| p.id.as_str()).collect();
    for file in &manifest.files {
        let note = match &file.phase {
            Some(of) if phased.phases.iter().any(|p| rest(p, of).is_some()) => continue,
            Some(of) => Note::new("phases.unknown").with("phase", of.as_str()),
            None => Note::new("phases.no_phase"),
        };
        let note = note.with("path", file.path.display().to_string()).with("phases", known.join(", "));
        return Err(place::error(&note, lang));
    }
    Ok(())
}
