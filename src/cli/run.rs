//! `sagnac run`: a procedure on a recording.

use super::follow;
use super::inputs::Serial;
use super::job::{Frame, Job, Made, execute};
use super::keep::Keeper;
use super::next_step;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::run_args::RunArgs;
use super::single_test::SingleTest;
use crate::config::shipped::find;
use crate::estimate::Verdict;
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::{Recording, RecordingError};
use crate::moment;
use crate::output::{Kind, StagedFolder};
use crate::report::Results;
use std::path::Path;

/// Runs the test and writes its folder; gives the exit code.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    if !args.follow.follow {
        return execute(&args.output, lang, |frame| {
            args.join.check(&args.recording, "join.help.run", lang)?;
            let test = SingleTest::load(args, frame.now, lang)?;
            Run::load(args, test, frame)
        });
    }
    let mut test = SingleTest::load(args, moment::now(), lang)?;
    follow::until_complete(args, &test, lang)?;
    execute(&args.output, lang, |frame| {
        test.setup.now = frame.now;
        Run::load(args, test, frame)
    })
}

/// A test of one recording.
struct Run<'a> {
    args: &'a RunArgs,
    test: SingleTest<'a>,
    keeper: Keeper,
    opened: Result<Recording, RecordingError>,
    serial: Option<String>,
}

impl<'a> Run<'a> {
    fn load(args: &'a RunArgs, test: SingleTest<'a>, frame: &mut Frame<'_>) -> Result<Run<'a>, String> {
        let lang = frame.lang;
        let keeper = Keeper::new(&args.store, lang)?;
        frame.progress.stage("progress.inputs");
        // A recording that is there and cannot be opened still gets its report: the verdict is an error, and says why. A
        // name that is no file is a slip of the pen, which must not cost an earlier result.
        let opened = test.open(&args.recording);
        let serial = match &opened {
            Ok(opened) => {
                Serial::of(args.serial.as_deref(), opened.manifest.as_ref(), &[&opened.source])
                    .map_err(|note| place::error(&note, lang))?
                    .number
            }
            Err(error) if !args.recording.iter().all(|r| r.exists()) => return Err(error.say(lang)),
            Err(_) => args.serial.clone(),
        };
        Ok(Run { args, test, keeper, opened, serial })
    }
}

impl Job for Run<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let Run { args, test, serial, .. } = self;
        let id = &test.procedure.value.id;
        let out = OutputPlace::new(args.out.as_deref(), id, serial.as_deref(), frame.now);
        test.inputs(&args.recording, args.serial.as_deref()).begin(&out, Kind::Result, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let (args, lang) = (self.args, frame.lang);
        if let Err(RecordingError::Manifest(problems)) = &self.opened {
            // Every problem of a manifest is printed; the report holds the first.
            frame.progress.beside(|| place::eprint_diagnostic(&problems.say(lang)));
        }
        let given = args.serial.as_deref();
        let mut evaluated = self.test.evaluate(&args.recording, &self.opened, given, &mut frame.progress);
        self.keeper.place_among_others(&mut evaluated.results.outcome.record)?;
        // A shipped procedure cannot be edited: one of its own suits the recording.
        let lacks = evaluated.problems.is_some() && find(&args.procedure).is_some();
        let own = next_step::init(&args.recording, "").filter(|_| lacks);
        let mut made = evaluated.made(lang);
        if let (Some(refusal), Some(own)) = (&mut made.refusal, own) {
            refusal.advice = format!("{}\n", own.say(lang));
        }
        Ok(made)
    }

    fn keep(&self, place: &Path, printer: Printer) -> Result<(), String> {
        self.keeper.keep(place, printer)
    }

    fn exit_code(&self, results: &Results) -> u8 {
        self.args.exit_code(results)
    }

    fn next_step(&self, results: &Results, _: &Path) -> Option<Note> {
        let Results::Run(run) = results else { return None };
        let failed = run.outcome.record.verdict == Verdict::Fail;
        next_step::after_fail(&self.args.recording, &self.test.procedure.value).filter(|_| failed)
    }
}
