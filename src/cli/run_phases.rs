//! `sagnac run` with a procedure of several phases: each on its files of a manifest, one report over all.

use super::finish::finish;
use super::keep::Keeper;
use super::phased_test::{PhasedTest, PhasesEvaluated, belong};
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::run_args::RunArgs;
use crate::acceptance::phases::failure;
use crate::config::manifest::{self, is_manifest};
use crate::i18n::{Lang, Note};
use crate::moment;
use crate::output::Kind;

/// Runs every phase and writes the folder of the whole.
pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    let error = |note: Note| place::error(&note, lang);
    let now = moment::now();
    let test = PhasedTest::load(args, now, lang)?;
    let path = match args.recording.as_slice() {
        [one] if is_manifest(one) || one.extension().is_some_and(|e| e == "toml") => one,
        _ => {
            let needed =
                error(Note::new("phases.needs_manifest").with("id", test.phased.identity.id.as_str()));
            return Err(format!("{needed}\n{}", test.phased.example_manifest()));
        }
    };
    let manifest = manifest::load(path).map_err(|p| p.say(lang))?;
    belong(&test.phased, &manifest).map_err(error)?;
    let writer = args.output.writer(lang)?;
    let keeper = Keeper::new(&args.store, lang)?;
    let serial = test.serial(args.serial.as_deref(), &manifest).map_err(error)?;
    let id = &test.phased.identity.id;
    let out = OutputPlace::new(args.out.as_deref(), id, serial.number.as_deref(), now);
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = test.inputs(&args.recording, args.serial.as_deref()).begin(&out, Kind::Result, lang)?;
    let PhasesEvaluated { results, explained } = test.evaluate(&manifest, serial, &mut progress);
    for phase in results.outcome.record.phases.iter().filter(|p| !explained.contains(&p.id)) {
        if let Some(why) = failure(phase) {
            let note = Note::new("phases.error").with("title", phase.title.clone()).with("why", why.clone());
            progress.beside(|| place::eprint_diagnostic(&place::error(&note, lang)));
        }
    }
    finish(results, folder, &keeper, &writer, printer, progress)
}
