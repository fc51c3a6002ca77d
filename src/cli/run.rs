//! `sagnac run`: a procedure on a recording.

use super::finish::settle;
use super::inputs::Serial;
use super::keep::Keeper;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::run_args::RunArgs;
use super::single_test::SingleTest;
use super::{exit, next_step};
use crate::config::shipped::find;
use crate::i18n::{Lang, Localize};
use crate::ingest::RecordingError;
use crate::moment;
use crate::output::Kind;

pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    args.join.check(&args.recording, "join.help.run", lang)?;
    let now = moment::now();
    let test = SingleTest::load(args, now, lang)?;
    let writer = args.output.writer(lang)?;
    let keeper = Keeper::new(&args.store, lang)?;
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    progress.stage("progress.inputs");
    // A recording that is there and cannot be opened still gets its report: the verdict is an error, and says why. A
    // name that is no file is a slip of the pen, which must not cost an earlier result.
    let given = args.serial.as_deref();
    let opened = test.open(&args.recording);
    let serial = match &opened {
        Ok(opened) => {
            Serial::of(given, opened.manifest.as_ref(), &[&opened.source])
                .map_err(|note| place::error(&note, lang))?
                .number
        }
        Err(error) if !args.recording.iter().all(|r| r.exists()) => return Err(error.say(lang)),
        Err(_) => args.serial.clone(),
    };
    let id = &test.procedure.value.id;
    let out = OutputPlace::new(args.out.as_deref(), id, serial.as_deref(), now);
    let folder = test.inputs(&args.recording, given).begin(&out, Kind::Result, lang)?;
    if let Err(RecordingError::Manifest(problems)) = &opened {
        // Every problem of a manifest is printed; the report holds the first.
        progress.beside(|| place::eprint_diagnostic(&problems.say(lang)));
    }
    let evaluated = test.evaluate(&args.recording, opened, given, &mut progress);
    // A shipped procedure cannot be edited: one of its own suits the recording.
    let lacks = evaluated.problems.is_some() && find(&args.procedure).is_some();
    let own = next_step::init(&args.recording, "").filter(|_| lacks);
    let own = own.map(|step| format!("{}\n", step.say(lang))).unwrap_or_default();
    let code = settle(evaluated, folder, &keeper, &writer, printer, progress)
        .map_err(|message| format!("{message}{own}"))?;
    let step = next_step::after_fail(&args.recording, &test.procedure.value);
    printer.next_step(step.filter(|_| code == exit::FAIL).as_ref());
    Ok(code)
}
