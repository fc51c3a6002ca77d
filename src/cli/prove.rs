//! `sagnac prove`: what the engine says of a recording of which something is concealed, judged by rules fixed before.

use super::job::{Frame, Job, Made, execute};
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use crate::config::contained_files::folder_of;
use crate::config::proof::{self, ClaimSource, ProofFile, Source};
use crate::config::text_file;
use crate::executable;
use crate::i18n::{Lang, Note};
use crate::output::{Kind, StagedFolder, sha256};
use crate::prove::{CLAIM_FILE, ProofOrder, prove};
use crate::report::Results;
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
    execute(&args.output, lang, |_| {
        let file = proof::load(&args.proof).map_err(|p| p.say(lang))?;
        let data = args.data.clone().unwrap_or_else(|| folder_of(&args.proof).to_owned());
        Ok(Proving { args, file, data })
    })
}

/// The proof of a file.
struct Proving<'a> {
    args: &'a ProveArgs,
    file: ProofFile,
    /// Folder of the recordings.
    data: PathBuf,
}

impl Job for Proving<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let Proving { args, file, data } = self;
        let stem = args.proof.file_stem().map(|s| s.to_string_lossy().into_owned());
        let out = OutputPlace::new(args.out.as_deref(), "proof", stem.as_deref(), frame.now);
        let mut read: Vec<PathBuf> = file.added.clone().into_iter().collect();
        read.push(match &file.source {
            Source::File { path, .. } => data.join(path),
            Source::Simulated { model, .. } => model.clone(),
        });
        if let ClaimSource::Model(model) = &file.claim {
            read.push(model.clone());
        }
        let inputs = frame.inputs().file("proof", Some(&args.proof)).files("recording", &read);
        inputs.begin(&out, Kind::Proof, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let say = |note: Note| place::error(&note, frame.lang);
        let program = executable::path().map_err(|_| say("prove.error.no_room".into()))?;
        let bytes = text_file::read(&self.args.proof).unwrap_or_default();
        let order = ProofOrder {
            proof: &self.file,
            path: &place::shown(&self.args.proof),
            sha256: &sha256(&bytes),
            data: &self.data,
            program: &program,
            proved_at: &frame.stamp(),
        };
        let proved = prove(&order, &mut |doing| frame.progress.stage(doing)).map_err(say)?;
        let claim = vec![(CLAIM_FILE.to_owned(), proved.claim)];
        Ok(Results::of(proved.record, proved.figures, claim).into())
    }
}
