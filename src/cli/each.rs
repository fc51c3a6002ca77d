//! `sagnac run --each`: every recording is a unit of its own.

use super::inputs::Inputs;
use super::job::{Frame, Job, Made, execute};
use super::keep::Keeper;
use super::phased_test::{PhasedTest, belong};
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::progress::{Measure, Progress};
use super::run_args::RunArgs;
use super::single_test::SingleTest;
use super::writer::Writer;
use crate::acceptance::lot;
use crate::config::diagnostics::Problems;
use crate::config::manifest::{self, is_manifest};
use crate::config::procedure::phases::is_phased;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::lot::{LotError, Member, members};
use crate::ingest::serial::SerialPattern;
use crate::ingest::{ReadOptions, RecordingError, files_read};
use crate::output::{Kind, StagedFolder, StagedPart};
use crate::record::{LotUnit, ProcedureRecord, SerialSource, Session};
use crate::report::export::{EXPORTERS, export};
use crate::report::lot::unit_done;
use crate::report::{Results, RunResults, page};
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;

/// Most diagnostics of units without a serial number that are printed.
const MAX_PRINTED_DIAGNOSTICS: usize = 5;

/// A test that is run on one unit after another.
trait UnitTest: Sync {
    /// Id of the procedure, for the name of the folder.
    fn procedure(&self) -> ProcedureRecord;

    /// The people, the station and the moment.
    fn session(&self) -> Session;

    /// The inputs of the whole lot, so far without the recordings.
    fn common_inputs(&self) -> Inputs;

    /// The inputs of the result of one unit.
    fn inputs(&self, member: &Member) -> Inputs;

    /// The options by which recordings are read.
    fn options(&self) -> &ReadOptions;

    /// Tests one unit. What keeps it from being tested is in the result; what is to be said of it at the lines of the
    /// procedure stands beside it.
    fn run(&self, member: &Member, progress: &mut Progress) -> (RunResults, Option<Problems>);
}

/// The serial number that a user would give on the command line: none where the manifest or the recording states it.
fn given(member: &Member) -> Option<&str> {
    let is_stated = matches!(member.serial_from, SerialSource::Manifest | SerialSource::Recording);
    (!is_stated).then_some(member.serial.as_str())
}

impl UnitTest for SingleTest<'_> {
    fn procedure(&self) -> ProcedureRecord {
        self.by().record()
    }

    fn session(&self) -> Session {
        self.setup.session()
    }

    fn common_inputs(&self) -> Inputs {
        SingleTest::common_inputs(self)
    }

    fn inputs(&self, member: &Member) -> Inputs {
        SingleTest::inputs(self, std::slice::from_ref(&member.recording), given(member))
    }

    fn options(&self) -> &ReadOptions {
        &self.procedure.value.recording.read
    }

    fn run(&self, member: &Member, progress: &mut Progress) -> (RunResults, Option<Problems>) {
        let recording = std::slice::from_ref(&member.recording);
        let evaluated = self.evaluate(recording, &self.open(recording), given(member), progress);
        (evaluated.results, evaluated.problems)
    }
}

/// A test of several phases with the options of recordings whose procedures decide them.
struct PhasedUnits<'a> {
    test: PhasedTest<'a>,
    options: ReadOptions,
}

impl UnitTest for PhasedUnits<'_> {
    fn procedure(&self) -> ProcedureRecord {
        self.test.phased.identity.clone()
    }

    fn session(&self) -> Session {
        self.test.setup.session()
    }

    fn common_inputs(&self) -> Inputs {
        self.test.common_inputs()
    }

    fn inputs(&self, member: &Member) -> Inputs {
        self.test.inputs(std::slice::from_ref(&member.recording), given(member))
    }

    fn options(&self) -> &ReadOptions {
        &self.options
    }

    fn run(&self, member: &Member, progress: &mut Progress) -> (RunResults, Option<Problems>) {
        let loaded = manifest::load(&member.recording)
            .map_err(|problems| RecordingError::Manifest(problems).into_ingest(&member.recording).note());
        let checked = loaded.and_then(|manifest| {
            belong(&self.test.phased, &manifest)?;
            self.test.serial(given(member), &manifest).map(|serial| (manifest, serial))
        });
        let results = match checked {
            Ok((manifest, serial)) => self.test.evaluate(&manifest, serial, progress).results,
            Err(why) => self.test.not_run(why, Some(member.serial.clone())),
        };
        (results, None)
    }
}

/// Tests every unit, writes the folder of the lot and prints the outcome; gives the exit code of the worst verdict.
///
/// # Errors
/// The diagnostic, in words, where the lot as a whole cannot be tested or written.
pub fn main(args: &RunArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |frame| {
        let test: Box<dyn UnitTest + '_> = if is_phased(&args.procedure) {
            let test = PhasedTest::load(args, frame.now, lang)?;
            if let Some(odd) = args.recording.iter().find(|r| !is_manifest(r) && r.exists()) {
                let note = note!("lot.needs_manifests", path = odd.display().to_string());
                return Err(place::error(&note, lang));
            }
            Box::new(PhasedUnits { test, options: ReadOptions::default() })
        } else {
            Box::new(SingleTest::load(args, frame.now, lang)?)
        };
        LotRun::load(args, test, frame)
    })
}

/// A test of every unit of a lot.
struct LotRun<'a> {
    args: &'a RunArgs,
    test: Box<dyn UnitTest + 'a>,
    keeper: Keeper,
    members: Vec<Member>,
    /// The inputs of the result of each unit, by their names.
    inputs: Vec<BTreeMap<String, String>>,
}

impl<'a> LotRun<'a> {
    fn load(
        args: &'a RunArgs,
        test: Box<dyn UnitTest + 'a>,
        frame: &mut Frame<'_>,
    ) -> Result<LotRun<'a>, String> {
        let lang = frame.lang;
        let error = |note: Note| place::error(&note, lang);
        let keeper = Keeper::new(&args.store, lang)?;
        // A fault of a template is said before the first unit is tested.
        let none = Results::of_lot(lot::lot(test.procedure(), test.session(), vec![]));
        export(&none.whole(lang), EXPORTERS, &frame.writer.renderer).map_err(|e| error(e.note()))?;
        frame.progress.stage("progress.inputs");
        let pattern =
            args.each.serial_from.as_deref().map(SerialPattern::parse).transpose().map_err(error)?;
        let members =
            members(&args.recording, test.options(), pattern.as_ref()).map_err(|e| refused(&e, lang))?;
        let inputs = members.iter().map(|m| test.inputs(m).identities()).collect();
        Ok(LotRun { args, test, keeper, members, inputs })
    }
}

impl Job for LotRun<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let recordings: Vec<PathBuf> = self.members.iter().map(|m| m.recording.clone()).collect();
        let read = files_read(&recordings, self.test.options());
        let id = self.test.procedure().id;
        let out = OutputPlace::new(self.args.out.as_deref(), &id, Some("lot"), frame.now);
        self.test.common_inputs().lot(&self.inputs, read).begin(&out, Kind::Lot, frame.lang)
    }

    fn run(&self, folder: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let jobs = self.args.each.jobs.or_else(|| std::thread::available_parallelism().ok());
        let work = Work { lot: self, folder, writer: &frame.writer, lang: frame.lang };
        let units = work.run(jobs.map_or(1, NonZeroUsize::get), frame.printer, &mut frame.progress)?;
        Ok(Results::of_lot(lot::lot(self.test.procedure(), self.test.session(), units)).into())
    }

    fn exit_code(&self, results: &Results) -> u8 {
        self.args.exit_code(results)
    }

    fn keep(&self, place: &Path, printer: Printer) -> Result<(), String> {
        self.members.iter().try_for_each(|member| self.keeper.keep(&place.join(&member.folder), printer))
    }
}

/// The diagnostic of units that cannot be identified.
fn refused(error: &LotError, lang: Lang) -> String {
    match error {
        LotError::Recording(e) => e.say(lang),
        LotError::Serial { notes, help } => {
            let mut said: String =
                notes.iter().take(MAX_PRINTED_DIAGNOSTICS).map(|note| place::error(note, lang)).collect();
            if notes.len() > MAX_PRINTED_DIAGNOSTICS {
                let more = note!("lot.more", n = notes.len() - MAX_PRINTED_DIAGNOSTICS).say(lang);
                said.push_str(&format!("  {more}\n"));
            }
            format!("{said}  {}: {}\n", note!("diagnostic.help").say(lang), help.say(lang))
        }
    }
}

/// The problems that were not said of another unit at the same place of the procedure, with the same advice. `None` where all
/// were.
fn unsaid(problems: Problems, said: &mut BTreeSet<(String, usize, String)>) -> Option<Problems> {
    let mut new = problems;
    new.list.retain(|p| {
        let help = p.help.as_ref().map(|h| h.say(Lang::En)).unwrap_or_default();
        said.insert((p.file.clone(), p.span.start, help))
    });
    (!new.list.is_empty()).then_some(new)
}

/// The units of a lot in work, and the folder that their results go to.
struct Work<'a> {
    lot: &'a LotRun<'a>,
    folder: &'a StagedFolder,
    writer: &'a Writer,
    lang: Lang,
}

impl Work<'_> {
    /// Tests all units, `jobs` at a time; gives them in their order.
    ///
    /// The threads are not those of the pool that the analysis computes with: one of these that waits for a part of its
    /// own unit would begin another unit meanwhile, and the number of units in memory would have no bound.
    fn run(&self, jobs: usize, printer: Printer, progress: &mut Progress) -> Result<Vec<LotUnit>, String> {
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (send, receive) = channel();
        let testing = note!("progress.testing").say(self.lang);
        let total = self.lot.members.len() as u64;
        let mut units: BTreeMap<usize, LotUnit> = BTreeMap::new();
        let mut failed = None;
        let mut said = BTreeSet::new();
        std::thread::scope(|scope| {
            for _ in 0..jobs.min(self.lot.members.len()) {
                let send = send.clone();
                scope.spawn(|| {
                    let send = send;
                    while !stop.load(Ordering::Relaxed) {
                        let i = next.fetch_add(1, Ordering::Relaxed);
                        let Some(done) = self.unit(i) else { break };
                        stop.fetch_or(done.is_err(), Ordering::Relaxed);
                        let _ = send.send((i, done));
                    }
                });
            }
            drop(send);
            progress.update(&testing, Measure::Units, 0, total);
            for (i, done) in receive {
                match done {
                    Ok((unit, problems)) => {
                        let done = unit_done(&unit, self.lang);
                        progress.beside(|| printer.line(|t| page::terminal(&done, t)));
                        if let Some(new) = problems.and_then(|p| unsaid(p, &mut said)) {
                            progress.beside(|| place::eprint_diagnostic(&new.say(self.lang)));
                        }
                        units.insert(i, unit);
                    }
                    Err(why) => failed = failed.take().or(Some(why)),
                }
                progress.update(&testing, Measure::Units, units.len() as u64, total);
            }
        });
        failed.map_or_else(|| Ok(units.into_values().collect()), Err)
    }

    /// Tests one unit and writes its folder; `None` after the last.
    fn unit(&self, i: usize) -> Option<Result<(LotUnit, Option<Problems>), String>> {
        let (member, inputs) = (self.lot.members.get(i)?, self.lot.inputs.get(i)?);
        let (mut results, problems) = self.lot.test.run(member, &mut Progress::silent(self.lang));
        if let Err(why) = self.lot.keeper.place_among_others(&mut results.outcome.record) {
            return Some(Err(why));
        }
        let unit = lot::unit(member, &results.outcome.record);
        let results = Results::Run(Box::new(results));
        let part = StagedPart::begin(self.folder, &member.folder, inputs.clone());
        let written = self.writer.files(&results, &part);
        Some(written.and_then(|()| {
            part.finish(results.whole(self.lang).record()).map_err(|e| place::error(&e.note(), self.lang))?;
            Ok((unit, problems))
        }))
    }
}
