//! `sagnac run`: a procedure on a recording.

use super::explain::Watch;
use super::inputs::{self, Inputs};
use super::progress::Progress;
use super::{GridArgs, RunArgs, exit, place};
use crate::acceptance::run::{Outcome, Request, RunError, execute, explained, failed};
use crate::config::manifest::Manifest;
use crate::config::model::Claim;
use crate::config::procedure::phases::is_phased;
use crate::config::procedure::{effective, load, load_limits};
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize, Note, lookup};
use crate::ingest::{RecordingError, Source, open_recording};
use crate::noise::tau_grid::TauGrid;
use crate::output::{Kind, StagedFolder};
use crate::record::{Evidence, ExplainedRecord, RunKind, RunRecord, UnitUnderTest};
use crate::report::explain::{Context, ExplainView, explained_says};
use crate::report::{Renderer, render_html, render_markdown, svg};
use chrono::{SecondsFormat, Utc};
use std::path::{Path, PathBuf};

pub fn main(args: &RunArgs, lang: Lang) -> u8 {
    match attempt(args, lang) {
        Ok(code) => code,
        Err(message) => {
            place::complain(&message);
            exit::ERROR
        }
    }
}

fn attempt(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    if is_phased(&args.procedure) {
        return super::run_phases::attempt(args, lang);
    }
    let grid = grid(&args.grid, lang)?;
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
    let renderer = renderer(args.templates.as_deref(), lang)?;
    let effective = effective(&procedure, limits.as_ref());
    for warning in procedure.warnings.iter().chain(&effective.warnings) {
        place::complain(&format!("{}\n", warning.say(lang)));
    }
    let now = Utc::now();
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| place::default_folder(&procedure.value.id, args.serial.as_deref(), now));
    let folder = Inputs::new(args.force)
        .recording(&args.recording, &procedure.value.recording.read)
        .file("procedure", Some(&args.procedure))
        .file("limits", args.limits.as_deref())
        .file("model", procedure.value.explain.as_ref().map(|e| e.model.as_path()))
        .text("unit", args.serial.as_deref())
        .options(&(&args.grid.taus, args.grid.exact))
        .beside(args.templates.as_deref())
        .begin(&out, Kind::Result, lang)?;
    // A recording that is there and cannot be opened still gets its report: the verdict is an error, and says why. A
    // name that is no file is a slip of the pen, which must not cost an earlier result.
    let name = args.recording.first().map_or(Path::new(""), PathBuf::as_path);
    let (source, manifest, refused) = match open_recording(&args.recording, &procedure.value.recording.read) {
        Ok(recording) => (recording.source, recording.manifest, None),
        Err(error) if !args.recording.iter().all(|r| r.exists()) => return Err(error.say(lang)),
        Err(error) => {
            // Of a manifest every problem is told; the report holds the first.
            if let RecordingError::Manifest(problems) = &error {
                place::complain(&problems.say(lang));
            }
            (Source::unopened(name), None, Some(error.into_ingest(name)))
        }
    };
    let serial = serial(args.serial.as_deref(), manifest.as_ref(), lang)?;
    let family = limits.as_ref().and_then(|l| l.value.family.clone());
    let request = Request {
        kind: RunKind::Run,
        procedure: &procedure.value,
        procedure_record: Some(procedure.record(limits.as_ref())),
        limits: &effective,
        source: &source,
        use_stamps: true,
        unit: UnitUnderTest {
            serial,
            family: procedure.value.unit_under_test.family.clone().or(family),
            part: procedure.value.unit_under_test.part.clone(),
            revision: procedure.value.unit_under_test.revision.clone(),
            lot: None,
        },
        operator: args.operator.clone(),
        station: args.station.clone(),
        now,
        taus: grid,
        exact: args.grid.exact,
    };
    match refused {
        None => {
            let against = model.map(|claim| Against { claim, recording: &args.recording });
            finish(&request, against, folder, &renderer, lang)
        }
        Some(error) => Err(report_failure(&request, &error.into(), folder, &renderer, lang)?),
    }
}

/// The serial number given; the manifest's where none is. Two that differ are an error: this is another unit's recording.
pub(super) fn serial(
    given: Option<&str>,
    manifest: Option<&Manifest>,
    lang: Lang,
) -> Result<Option<String>, String> {
    let stated = manifest.and_then(|m| m.serial.as_deref());
    match (given, stated) {
        (Some(given), Some(stated)) if given.trim() != stated.trim() => {
            let path = manifest.map(|m| m.path.display().to_string()).unwrap_or_default();
            let note =
                Note::new("manifest.serial").with("path", path).with("stated", stated).with("given", given);
            Err(place::error(&note, lang))
        }
        _ => Ok(given.or(stated).map(str::to_owned)),
    }
}

/// A model that a recording is explained against.
pub struct Against<'a> {
    /// The model.
    pub claim: Claim,
    /// The recording as named.
    pub recording: &'a [PathBuf],
}

/// Explains a recording against the model of its procedure and writes what came of it beside the report.
fn explain(
    request: &Request<'_>,
    against: Against<'_>,
    folder: &StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<Option<ExplainedRecord>, String> {
    let Some(spec) = &request.procedure.explain else { return Ok(None) };
    let mut watch = Watch::new(lang);
    let Against { claim, recording } = against;
    let out = explained::explain(spec, claim, request.procedure, recording, &mut |p| watch.of(p));
    watch.finish();
    if let Some((claim, notes, outcome)) = &out.outcome {
        let names: Vec<String> = recording.iter().map(|p| p.display().to_string()).collect();
        let context = Context {
            recording: names.join(", "),
            claim: out.record.model.clone(),
            identified: false,
            description: claim.description.clone(),
            explained_at: request.now.to_rfc3339_opts(SecondsFormat::Secs, true),
            correction: outcome.correction.is_some(),
            notes: notes.clone(),
        };
        let view = ExplainView::new(&outcome.explanation, &outcome.figures, &context, lang);
        super::explain::write(outcome, &view, folder, "explain/", renderer, lang)?;
        let json = serde_json::to_vec_pretty(&outcome.explanation)
            .map_err(|e| place::error(&Note::new("system.other").with("reason", e.to_string()), lang))?;
        folder.write("explain/explain.json", &json).map_err(|e| place::error(&e.note(), lang))?;
    }
    Ok(Some(out.record))
}

/// Runs a request, writes its folder and says what came out; also used by `analyze`.
pub fn finish(
    request: &Request<'_>,
    against: Option<Against<'_>>,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<u8, String> {
    let mut progress = Progress::new();
    let reading = Note::new("cli.reading").say(lang);
    let outcome = execute(request, &mut |done, total| progress.update(&reading, done, total));
    progress.finish();
    let mut outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) => return Err(report_failure(request, &error, folder, renderer, lang)?),
    };
    if let Some(against) = against {
        outcome.record.explained = explain(request, against, &folder, renderer, lang)?;
    }
    let place = publish(&outcome, folder, renderer, lang)?;
    place::print(&summary(&outcome.record, &place, lang));
    Ok(code(outcome.record.verdict))
}

/// The exit code of a verdict.
pub(super) fn code(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::None | Verdict::Pass => exit::PASS,
        Verdict::Fail => exit::FAIL,
        Verdict::Indeterminate => exit::INDETERMINATE,
        Verdict::Error => exit::ERROR,
    }
}

/// Writes the report of a run that could not be carried out, and gives the message for the terminal.
fn report_failure(
    request: &Request<'_>,
    error: &RunError,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<String, String> {
    let outcome = Outcome { record: failed(request, error), figures: vec![], tables: vec![] };
    let place = publish(&outcome, folder, renderer, lang)?;
    let report = Note::new("cli.report_says_so").with("place", place.display().to_string());
    Ok(format!("{}{}\n", place::error(&error.note(), lang), report.say(lang)))
}

fn publish(
    outcome: &Outcome,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<PathBuf, String> {
    write_results(outcome, &folder, "", renderer, lang)?;
    inputs::publish(folder, &outcome.record, lang)
}

/// Writes everything that a run gives under a prefix of a folder, but for its record.
pub(super) fn write_results(
    outcome: &Outcome,
    folder: &StagedFolder,
    prefix: &str,
    renderer: &Renderer,
    lang: Lang,
) -> Result<(), String> {
    let say = |note: Note| place::error(&note, lang);
    let html = render_html(&outcome.record, &outcome.figures, lang, renderer).map_err(|e| say(e.note()))?;
    let markdown =
        render_markdown(&outcome.record, &outcome.figures, lang, renderer).map_err(|e| say(e.note()))?;
    let write =
        |name: &str, bytes: &[u8]| folder.write(&format!("{prefix}{name}"), bytes).map_err(|e| say(e.note()));
    write("report.html", html.as_bytes())?;
    write("report.md", markdown.as_bytes())?;
    for (name, table) in &outcome.tables {
        write(name, table.as_bytes())?;
    }
    for figure in &outcome.figures {
        write(&format!("figures/{}.svg", figure.id), svg::render(figure, lang).as_bytes())?;
    }
    Ok(())
}

/// The outcome in a few lines for the terminal.
pub(super) fn summary(record: &RunRecord, folder: &Path, lang: Lang) -> String {
    let word = |key: String| lookup(lang, &key).map_or(key.clone(), str::to_owned);
    let mut out = format!("{}\n", word(format!("verdict.{}", record.verdict.id())).to_uppercase());
    for note in &record.summary {
        out.push_str(&format!("  {}\n", note.say(lang)));
    }
    let mut declared: Vec<&str> = record
        .conditions
        .iter()
        .filter(|c| c.evidence == Some(Evidence::Declared))
        .map(|c| c.id.split('.').next().unwrap_or(&c.id))
        .collect();
    declared.sort_unstable();
    declared.dedup();
    if !declared.is_empty() {
        let names: Vec<String> = declared.iter().map(|id| word(format!("condition.{id}"))).collect();
        let note = Note::new("cli.declared").with("names", names.join(", "));
        out.push_str(&format!("  {}\n", note.say(lang)));
    }
    for sentence in record.explained.iter().flat_map(|e| explained_says(e, lang)) {
        out.push_str(&format!("  {sentence}\n"));
    }
    out.push_str(&format!("{}\n", place::shown(&folder.join("report.html"))));
    out
}

/// The averaging times asked for on the command line.
pub fn grid(args: &GridArgs, lang: Lang) -> Result<Option<TauGrid>, String> {
    args.taus.as_deref().map(str::parse::<TauGrid>).transpose().map_err(|e| {
        let note = Note::new("cli.of_option").with("option", "--taus").with("what", e.note());
        place::error(&note, lang)
    })
}

/// The renderer with the user's templates, if any.
pub fn renderer(templates: Option<&Path>, lang: Lang) -> Result<Renderer, String> {
    templates
        .map_or_else(|| Ok(Renderer::new()), Renderer::with_overrides)
        .map_err(|e| place::error(&e.note(), lang))
}
