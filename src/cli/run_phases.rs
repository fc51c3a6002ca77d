//! `sagnac run` with a procedure of several phases: each on its files of a manifest, one report over all.

use super::inputs::{self, Inputs};
use super::progress::Progress;
use super::run::{code, grid, renderer, serial, summary, write_results};
use super::{RunArgs, place};
use crate::acceptance::run::phases::{Done, combine, failure, figures, folder};
use crate::acceptance::run::{Outcome, Request, execute, failed, session};
use crate::config::manifest::{self, Manifest, ManifestFile, is_manifest};
use crate::config::procedure::effective;
use crate::config::procedure::phases::{Phase, Phased, load_phased};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{ReadOptions, Source, open_files};
use crate::output::{Kind, StagedFolder};
use crate::record::{RunKind, RunRecord, UnitUnderTest};
use crate::report::view::PhasePart;
use crate::report::{Renderer, render_phases, svg};
use chrono::Utc;
use std::path::PathBuf;

/// Runs every phase and writes the folder of the whole.
pub fn attempt(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    let error = |note: Note| place::error(&note, lang);
    let phased = load_phased(&args.procedure).map_err(|p| p.say(lang))?;
    if args.limits.is_some() {
        return Err(error(Note::new("phases.limits")));
    }
    if let Some(odd) = phased.phases.iter().find(|p| p.procedure.value.explain.is_some()) {
        return Err(error(Note::new("phases.explain").with("id", odd.id.as_str())));
    }
    let path = match args.recording.as_slice() {
        [one] if is_manifest(one) => one,
        _ => return Err(error(Note::new("phases.needs_manifest"))),
    };
    let manifest = manifest::load(path).map_err(|p| p.say(lang))?;
    belong(&phased, &manifest, lang)?;
    let grid = grid(&args.grid, lang)?;
    let renderer = renderer(args.templates.as_deref(), lang)?;
    let now = Utc::now();
    let serial = serial(args.serial.as_deref(), Some(&manifest), lang)?;
    let unit = UnitUnderTest {
        serial,
        family: phased.family.clone(),
        part: phased.part.clone(),
        revision: phased.part_revision.clone(),
        lot: None,
    };
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| place::default_folder(&phased.identity.id, unit.serial.as_deref(), now));
    let paths = |path: &String| PathBuf::from(path);
    let procedures = phased.phases.iter().map(|p| paths(&p.procedure.path));
    let procedures: Vec<PathBuf> = std::iter::once(args.procedure.clone()).chain(procedures).collect();
    let limits: Vec<PathBuf> =
        phased.phases.iter().filter_map(|p| Some(paths(&p.limits.as_ref()?.path))).collect();
    let layouts: Vec<PathBuf> = phased
        .phases
        .iter()
        .filter_map(|p| p.procedure.value.recording.read.layout.as_ref().map(|l| l.path.clone()))
        .collect();
    let staged = Inputs::new(args.force)
        .recording(&args.recording, &ReadOptions::default())
        .files("procedure", &procedures)
        .files("limits", &limits)
        .files("layout", &layouts)
        .text("unit", args.serial.as_deref())
        .options(&(&args.grid.taus, args.grid.exact))
        .beside(args.templates.as_deref())
        .begin(&out, Kind::Result, lang)?;
    let mut done: Vec<Done<'_>> = Vec::new();
    let mut who = None;
    for phase in &phased.phases {
        let files = files(phase, &manifest);
        if files.is_empty() {
            done.push(Done { phase, outcome: None });
            continue;
        }
        let limits = effective(&phase.procedure, phase.limits.as_ref());
        for warning in phase.procedure.warnings.iter().chain(&limits.warnings) {
            place::complain(&format!("{}\n", warning.say(lang)));
        }
        let options = manifest.options_over(&phase.procedure.value.recording.read);
        let name = files.first().map_or_else(|| manifest.path.clone(), |f| f.path.clone());
        let (source, refused) = match open_files(&name, &files, manifest.contiguous, &options) {
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
            unit: unit.clone(),
            operator: args.operator.clone(),
            station: args.station.clone(),
            now,
            taus: grid.clone(),
            exact: args.grid.exact,
        };
        who.get_or_insert_with(|| session(&request));
        let outcome = match refused {
            None => evaluate(&request, phase, lang),
            Some(e) => nothing(&request, &e.into()),
        };
        let prefix = format!("{}/", folder(phase));
        write_results(&outcome, &staged, &prefix, &renderer, lang)?;
        let json = serde_json::to_vec_pretty(&outcome.record)
            .map_err(|e| error(Note::new("system.other").with("reason", e.to_string())))?;
        staged.write(&format!("{prefix}result.json"), &json).map_err(|e| error(e.note()))?;
        done.push(Done { phase, outcome: Some(outcome) });
    }
    let who = who.unwrap_or_default();
    let record = combine(&phased, &done, unit, who);
    write_whole(&record, &done, &staged, &renderer, lang)?;
    for phase in &record.phases {
        if let Some(why) = failure(phase) {
            let note = Note::new("phases.error").with("title", phase.title.as_str()).with("why", why.clone());
            place::complain(&place::error(&note, lang));
        }
    }
    let place = inputs::publish(staged, &record, lang)?;
    place::print(&summary(&record, &place, lang));
    Ok(code(record.verdict))
}

fn evaluate(request: &Request<'_>, phase: &Phase, lang: Lang) -> Outcome {
    let mut progress = Progress::new();
    let reading = format!("{}: {}", phase.title, Note::new("cli.reading").say(lang));
    let outcome = execute(request, &mut |done, total| progress.update(&reading, done, total));
    progress.finish();
    outcome.unwrap_or_else(|e| nothing(request, &e))
}

fn nothing(request: &Request<'_>, error: &crate::acceptance::run::RunError) -> Outcome {
    Outcome { record: failed(request, error), figures: vec![], tables: vec![] }
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

fn write_whole(
    record: &RunRecord,
    done: &[Done<'_>],
    staged: &StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<(), String> {
    let say = |note: Note| place::error(&note, lang);
    let drawn: Vec<Vec<Figure>> = done.iter().map(figures).collect();
    let parts: Vec<PhasePart<'_>> = record
        .phases
        .iter()
        .zip(done)
        .zip(&drawn)
        .map(|((phase, done), figures)| PhasePart {
            phase,
            record: done.outcome.as_ref().map(|o| &o.record),
            figures,
        })
        .collect();
    let (html, markdown) = render_phases(record, &parts, lang, renderer).map_err(|e| say(e.note()))?;
    let mut all: Vec<(PathBuf, Vec<u8>)> =
        vec![("report.html".into(), html.into_bytes()), ("report.md".into(), markdown.into_bytes())];
    for figure in drawn.iter().flatten() {
        all.push((format!("figures/{}.svg", figure.id).into(), svg::render(figure, lang).into_bytes()));
    }
    for (name, bytes) in all {
        staged.write(&name.to_string_lossy(), &bytes).map_err(|e| say(e.note()))?;
    }
    Ok(())
}
