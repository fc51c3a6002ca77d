//! `sagnac run`: a procedure on a recording.

use super::finish::{Against, report_failure, run_and_finish, write_failure};
use super::inputs::{Inputs, serial};
use super::options::{GridArgs, OutputArgs};
use super::printer::Printer;
use super::procedures::say_which;
use super::{exit, next_step, place};
use crate::acceptance::{Request, explained};
use crate::config::model::Claim;
use crate::config::procedure::missing_columns::missing_columns;
use crate::config::procedure::{Loaded, Procedure, effective, load, load_limits};
use crate::config::shipped::find;
use crate::i18n::{Lang, Localize};
use crate::ingest::{RecordingError, Source, open_recording};
use crate::output::{Kind, StagedFolder};
use crate::record::{RunKind, UnitUnderTest};
use crate::report::Renderer;
use chrono::Utc;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct RunArgs {
    /// Procedure (TOML)
    pub procedure: PathBuf,
    /// Recording: a file of any supported format, several files in sequence, a quoted pattern, or a manifest
    #[arg(required = true)]
    pub recording: Vec<PathBuf>,
    /// Limits file; overrides the procedure's limits for the same measurand
    #[arg(long, value_name = "FILE")]
    pub limits: Option<PathBuf>,
    /// Serial number of the unit under test
    #[arg(long, value_name = "SN")]
    pub serial: Option<String>,
    /// Name of the operator
    #[arg(long, value_name = "NAME")]
    pub operator: Option<String>,
    /// Test station where the recording was made
    #[arg(long, value_name = "NAME")]
    pub station: Option<String>,
    /// Output folder [default: named after procedure, serial number and UTC time]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub output: OutputArgs,
    #[command(flatten)]
    pub grid: GridArgs,
}

pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    let grid = args.grid.grid(lang)?;
    let named: Vec<&Path> = std::iter::once(args.procedure.as_path()).chain(args.limits.as_deref()).collect();
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
    let renderer = args.output.renderer(lang)?;
    let effective = effective(&procedure, limits.as_ref());
    for warning in procedure.warnings.iter().chain(&effective.warnings) {
        place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
    }
    let now = Utc::now();
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| place::default_folder(&procedure.value.id, args.serial.as_deref(), now));
    let folder = Inputs::new(args.output.force)
        .recording(&args.recording, &procedure.value.recording.read)
        .file("procedure", Some(&args.procedure))
        .file("limits", args.limits.as_deref())
        .file("model", procedure.value.explain.as_ref().map(|e| e.model.as_path()))
        .text("unit", args.serial.as_deref())
        .options(&(&args.grid.taus, args.grid.exact))
        .beside(args.output.templates.as_deref())
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
                place::eprint_diagnostic(&problems.say(lang));
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
        None => run_opened(args, &procedure, &request, model, folder, &renderer, lang),
        Some(error) => Err(report_failure(&request, &error.into(), folder, &renderer, lang)?),
    }
}

/// Runs a request on a recording that could be opened. Columns that it lacks are told at the lines that ask for them.
fn run_opened(
    args: &RunArgs,
    procedure: &Loaded<Procedure>,
    request: &Request<'_>,
    model: Option<Claim>,
    folder: StagedFolder,
    renderer: &Renderer,
    lang: Lang,
) -> Result<u8, String> {
    if let Some((problems, first)) = missing_columns(procedure, request.source) {
        let report = write_failure(request, &first.into(), folder, renderer, lang)?;
        // A shipped procedure cannot be edited: one of its own suits the recording.
        let own = find(&args.procedure).and_then(|_| next_step::init(&args.recording, ""));
        let own = own.map(|step| format!("{}\n", step.say(lang))).unwrap_or_default();
        return Err(format!("{}\n{report}{own}", problems.say(lang)));
    }
    let against = model.map(|claim| Against { claim, recording: &args.recording });
    let printer = Printer::new(&args.output, lang);
    let code = run_and_finish(request, against, folder, renderer, printer)?;
    let step = next_step::after_fail(&args.recording, &procedure.value);
    printer.next_step(step.filter(|_| code == exit::FAIL).as_ref());
    Ok(code)
}
