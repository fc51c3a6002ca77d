//! `sagnac demo`: the main job on a recording that the program carries.

use super::follow_args::FollowArgs;
use super::join::JoinArgs;
use super::keep::StoreArgs;
use super::options::OutputArgs;
use super::printer::Printer;
use super::run;
use super::run_args::{EachArgs, RunArgs};
use super::source::SourceArgs;
use super::{next_step, options::GridArgs, place};
use crate::i18n::{Lang, Localize, note};
use clap::Args;
use sagnac_ingest::read_file;
use std::path::{Path, PathBuf};

/// A synthetic unit, 100 h at rest.
const DEMO_RECORDING: &[u8] = include_bytes!("../../samples/unit-pass.csv");

#[derive(Debug, Args)]
pub struct DemoArgs {
    /// Folder for the recording and its report
    #[arg(long, value_name = "DIR", default_value = "sagnac-demo")]
    out: PathBuf,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn main(args: DemoArgs, lang: Lang) -> Result<u8, String> {
    let recording = args.out.join("unit-pass.csv");
    write(&recording, lang)?;
    let report = args.out.join("report");
    let command = format!(
        "sagnac run static-bias {} --limits sample-unit --serial SN-0001 --out {}",
        place::shown(&recording),
        place::shown(&report)
    );
    place::eprint_diagnostic(&format!("{command}\n"));
    let args = RunArgs {
        procedure: "static-bias".into(),
        recording: vec![recording],
        join: JoinArgs::default(),
        each: EachArgs::default(),
        follow: FollowArgs::default(),
        sources: SourceArgs::default(),
        limits: Some("sample-unit".into()),
        require_limits: false,
        serial: Some("SN-0001".to_owned()),
        lot: None,
        unit_data: None,
        bench_check: None,
        operator: None,
        station: None,
        out: Some(report),
        store: StoreArgs { no_store: true, ..StoreArgs::default() },
        output: args.output,
        grid: GridArgs { taus: None, exact: false },
    };
    let printer = Printer::new(&args.output, lang);
    let code = run::main(&args, lang)?;
    printer.next_step(Some(&next_step::after_demo()));
    Ok(code)
}

/// Writes the recording where none is; another file of its name is not replaced.
fn write(recording: &Path, lang: Lang) -> Result<(), String> {
    let failed = |reason: String| {
        let note = note!("procedures.not_saved", path = place::shown(recording));
        place::error(&note.with("reason", reason), lang)
    };
    match read_file(recording, DEMO_RECORDING.len() as u64) {
        Ok(found) if found == DEMO_RECORDING => return Ok(()),
        Ok(_) => return Err(failed(note!("procedures.other_content").say(lang))),
        Err(_) => {}
    }
    if let Some(folder) = recording.parent() {
        std::fs::create_dir_all(folder).map_err(|e| failed(e.to_string()))?;
    }
    std::fs::write(recording, DEMO_RECORDING).map_err(|e| failed(e.to_string()))
}
