//! `sagnac prove`: what the engine says of a recording of which something is concealed, judged by rules fixed before.

use super::exit;
use super::inputs::Inputs;
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use crate::config::contained_files::folder_of;
use crate::config::proof::{self, ClaimSource, Source};
use crate::config::text_file;
use crate::i18n::{Lang, Note};
use crate::moment;
use crate::output::{Kind, sha256};
use crate::prove::{CLAIM_FILE, ProofOrder, prove};
use crate::record::ProofOutcome;
use crate::report::{Documented, Results, page};
use chrono::SecondsFormat;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct ProveArgs {
    /// Proof file (TOML)
    #[arg(value_name = "FILE")]
    proof: PathBuf,
    /// Folder of the recordings [default: that of the proof file]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Output folder [default: named after the proof file and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn main(args: &ProveArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    let writer = args.output.writer(lang)?;
    let file = proof::load(&args.proof).map_err(|p| p.say(lang))?;
    let now = moment::now();
    let stem = args.proof.file_stem().map(|s| s.to_string_lossy().into_owned());
    let out = OutputPlace::new(args.out.as_deref(), "proof", stem.as_deref(), now);
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    let data = args.data.clone().unwrap_or_else(|| folder_of(&args.proof).to_owned());
    let mut read: Vec<PathBuf> = file.added.clone().into_iter().collect();
    read.push(match &file.source {
        Source::File { path, .. } => data.join(path),
        Source::Simulated { model, .. } => model.clone(),
    });
    if let ClaimSource::Model(model) = &file.claim {
        read.push(model.clone());
    }
    let folder = Inputs::new(args.output.force)
        .file("proof", Some(&args.proof))
        .files("recording", &read)
        .beside(args.output.templates.as_deref())
        .begin(&out, Kind::Proof, lang)?;
    let program = std::env::current_exe().map_err(|_| say("prove.error.no_room".into()))?;
    let bytes = text_file::read(&args.proof).unwrap_or_default();
    let order = ProofOrder {
        proof: &file,
        path: &place::shown(&args.proof),
        sha256: &sha256(&bytes),
        data: &data,
        program: &program,
        proved_at: &now.to_rfc3339_opts(SecondsFormat::Secs, true),
    };
    let proved = prove(&order, &mut |doing| progress.stage(doing)).map_err(say)?;
    progress.stage("progress.writing");
    let told = proved.record.on_terminal(lang);
    let outcome = proved.record.outcome;
    let claim = vec![(CLAIM_FILE.to_owned(), proved.claim)];
    let results = Results::of(proved.record, proved.figures, claim);
    let folder = writer.publish(&results, folder)?;
    drop(progress);
    printer.outcome(&folder, Kind::Proof, |t| page::terminal(&told, t))?;
    Ok(match outcome {
        ProofOutcome::Holds => exit::PASS,
        ProofOutcome::Fails => exit::FAIL,
    })
}
