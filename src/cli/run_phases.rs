//! `sagnac run` with a procedure of several phases: each on its files of a manifest, one report over all.

use super::inputs::Serial;
use super::job::{Frame, Job, Made, execute};
use super::keep::Keeper;
use super::phased_test::{PhasedTest, PhasesEvaluated, belong};
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::run_args::RunArgs;
use crate::acceptance::phases::failure;
use crate::config::manifest::{self, Manifest, is_manifest};
use crate::i18n::{Lang, Note, note};
use crate::output::{Kind, StagedFolder};
use crate::report::Results;
use std::path::Path;

/// Runs every phase and writes the folder of the whole; gives the exit code.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    if args.follow.follow {
        return Err(place::error(&note!("follow.phases"), lang));
    }
    execute(&args.output, lang, |frame| RunOfPhases::load(args, frame))
}

/// A test of several phases on the recordings of a manifest.
struct RunOfPhases<'a> {
    args: &'a RunArgs,
    test: PhasedTest<'a>,
    manifest: Manifest,
    keeper: Keeper,
    serial: Serial,
}

impl<'a> RunOfPhases<'a> {
    fn load(args: &'a RunArgs, frame: &Frame<'_>) -> Result<RunOfPhases<'a>, String> {
        let lang = frame.lang;
        let error = |note: Note| place::error(&note, lang);
        let test = PhasedTest::load(args, frame.now, lang)?;
        let path = match args.recording.as_slice() {
            [one] if is_manifest(one) || one.extension().is_some_and(|e| e == "toml") => one,
            _ => {
                let id = test.phased.identity.id.as_str();
                let needed = error(note!("phases.needs_manifest", id));
                return Err(format!("{needed}\n{}", test.phased.example_manifest()));
            }
        };
        let manifest = manifest::load(path).map_err(|p| p.say(lang))?;
        belong(&test.phased, &manifest).map_err(error)?;
        let keeper = Keeper::new(&args.store, lang)?;
        let serial = test.serial(args.serial.as_deref(), &manifest).map_err(error)?;
        Ok(RunOfPhases { args, test, manifest, keeper, serial })
    }
}

impl Job for RunOfPhases<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let RunOfPhases { args, test, serial, .. } = self;
        let id = &test.phased.identity.id;
        let out = OutputPlace::new(args.out.as_deref(), id, serial.number.as_deref(), frame.now);
        test.inputs(&args.recording, args.serial.as_deref()).begin(&out, Kind::Result, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let PhasesEvaluated { mut results, explained } =
            self.test.evaluate(&self.manifest, self.serial.clone(), &mut frame.progress);
        let record = &mut results.outcome.record;
        for phase in record.phases.iter().filter(|p| !explained.contains(&p.id)) {
            if let Some(why) = failure(phase) {
                let title = phase.title.clone();
                let note = note!("phases.error", title, why = why.clone());
                frame.progress.beside(|| place::eprint_diagnostic(&place::error(&note, frame.lang)));
            }
        }
        self.keeper.place_among_others(record)?;
        Ok(Results::Run(Box::new(results)).into())
    }

    fn exit_code(&self, results: &Results) -> u8 {
        self.args.exit_code(results)
    }

    fn keep(&self, place: &Path, printer: Printer) -> Result<(), String> {
        self.keeper.keep(place, printer)
    }
}
