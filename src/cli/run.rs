//! `sagnac run`: a procedure on a recording.

use super::finish::settle;
use super::inputs::serial;
use super::printer::Printer;
use super::run_args::RunArgs;
use super::single_test::SingleTest;
use super::{exit, next_step, place};
use crate::config::shipped::find;
use crate::i18n::{Lang, Localize};
use crate::ingest::RecordingError;
use crate::output::Kind;
use chrono::Utc;

pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    args.join.check(&args.recording, "join.help.run", lang)?;
    let now = Utc::now();
    let test = SingleTest::load(args, now, lang)?;
    let renderer = args.output.renderer(lang)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| place::default_folder(&test.procedure.value.id, args.serial.as_deref(), now));
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    let folder = test.inputs(&args.recording, args.serial.as_deref()).begin(&out, Kind::Result, lang)?;
    // A recording that is there and cannot be opened still gets its report: the verdict is an error, and says why. A
    // name that is no file is a slip of the pen, which must not cost an earlier result.
    let opened = test.open(&args.recording);
    match &opened {
        Ok(opened) => {
            serial(args.serial.as_deref(), opened.manifest.as_ref())
                .map_err(|note| place::error(&note, lang))?;
        }
        Err(error) if !args.recording.iter().all(|r| r.exists()) => return Err(error.say(lang)),
        // Of a manifest every problem is told; the report holds the first.
        Err(RecordingError::Manifest(problems)) => {
            progress.beside(|| place::eprint_diagnostic(&problems.say(lang)));
        }
        Err(RecordingError::File(_)) => {}
    }
    let evaluated = test.evaluate(&args.recording, opened, args.serial.as_deref(), &mut progress);
    // A shipped procedure cannot be edited: one of its own suits the recording.
    let lacks = evaluated.problems.is_some() && find(&args.procedure).is_some();
    let own = next_step::init(&args.recording, "").filter(|_| lacks);
    let own = own.map(|step| format!("{}\n", step.say(lang))).unwrap_or_default();
    let code = settle(evaluated, folder, &renderer, printer, progress)
        .map_err(|message| format!("{message}{own}"))?;
    let step = next_step::after_fail(&args.recording, &test.procedure.value);
    printer.next_step(step.filter(|_| code == exit::FAIL).as_ref());
    Ok(code)
}
