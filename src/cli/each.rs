//! `sagnac run --each`: every recording is a unit of its own.

use super::exit;
use super::inputs::{Inputs, publish};
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
use crate::i18n::{Lang, Localize, Note};
use crate::ingest::lot::{LotError, Member, members};
use crate::ingest::serial::SerialPattern;
use crate::ingest::{ReadOptions, RecordingError, files_read};
use crate::moment;
use crate::output::{Kind, StagedFolder, StagedPart};
use crate::record::{LotUnit, ProcedureRecord, SerialSource, Session};
use crate::report::export::{EXPORTERS, export};
use crate::report::lot::unit_done;
use crate::report::{Documented, Results, RunResults, page};
use chrono::{DateTime, SecondsFormat, Utc};
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;

/// Most complaints of one kind that are said.
const SAID: usize = 5;

/// A test that is run on one unit after another.
trait UnitTest: Sync {
    /// Id of the procedure, for the name of the folder.
    fn procedure(&self) -> ProcedureRecord;

    /// What the whole lot is made from, but for the recordings.
    fn common_inputs(&self) -> Inputs;

    /// What the result of one unit is made from.
    fn inputs(&self, member: &Member) -> Inputs;

    /// How recordings are read.
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
        self.procedure.record(self.limits.as_ref())
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
        let evaluated = self.evaluate(recording, self.open(recording), given(member), progress);
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
    let now = moment::now();
    if is_phased(&args.procedure) {
        let test = PhasedTest::load(args, now, lang)?;
        if let Some(odd) = args.recording.iter().find(|r| !is_manifest(r) && r.exists()) {
            let note = Note::new("lot.needs_manifests").with("path", odd.display().to_string());
            return Err(place::error(&note, lang));
        }
        test_lot(args, &PhasedUnits { test, options: ReadOptions::default() }, now, lang)
    } else {
        test_lot(args, &SingleTest::load(args, now, lang)?, now, lang)
    }
}

fn test_lot(args: &RunArgs, test: &dyn UnitTest, now: DateTime<Utc>, lang: Lang) -> Result<u8, String> {
    let error = |note: Note| place::error(&note, lang);
    let writer = args.output.writer(lang)?;
    let keeper = Keeper::new(&args.store, lang)?;
    let printer = Printer::new(&args.output, lang);
    let mut progress = printer.progress();
    let session = Session {
        operator: args.operator.clone(),
        station: args.station.clone(),
        evaluated_at: now.to_rfc3339_opts(SecondsFormat::Secs, true),
    };
    // What is wrong with a template is said before the first unit is tested.
    let none = Results::of_lot(lot::lot(test.procedure(), session.clone(), vec![]));
    export(&none.whole(lang), EXPORTERS, &writer.renderer).map_err(|e| error(e.note()))?;
    progress.stage("progress.inputs");
    let pattern = args.each.serial_from.as_deref().map(SerialPattern::parse).transpose().map_err(error)?;
    let members =
        members(&args.recording, test.options(), pattern.as_ref()).map_err(|e| refused(&e, lang))?;
    let inputs: Vec<BTreeMap<String, String>> = members.iter().map(|m| test.inputs(m).identities()).collect();
    let recordings: Vec<PathBuf> = members.iter().map(|m| m.recording.clone()).collect();
    let out = OutputPlace::new(args.out.as_deref(), &test.procedure().id, Some("lot"), now);
    let folder = test.common_inputs().lot(&inputs, files_read(&recordings, test.options())).begin(
        &out,
        Kind::Lot,
        lang,
    )?;
    let work = Work {
        test,
        members: &members,
        inputs: &inputs,
        folder: &folder,
        keeper: &keeper,
        writer: &writer,
        lang,
    };
    let jobs =
        args.each.jobs.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    let units = work.run(jobs, printer, &mut progress)?;
    progress.stage("progress.writing");
    let record = lot::lot(test.procedure(), session, units);
    let code = exit::code(record.verdict);
    let outcome = record.on_terminal(lang);
    let results = Results::of_lot(record);
    writer.files(&results, &folder)?;
    let place = publish(folder, results.whole(lang).record(), lang)?;
    drop(progress);
    printer.outcome(&place, Kind::Lot, |t| format!("\n{}", page::terminal(&outcome, t)))?;
    for member in &members {
        keeper.keep(&place.join(&member.folder), printer)?;
    }
    Ok(code)
}

/// The diagnostic of units that cannot be identified.
fn refused(error: &LotError, lang: Lang) -> String {
    match error {
        LotError::Recording(e) => e.say(lang),
        LotError::Serial { notes, help } => {
            let mut said: String = notes.iter().take(SAID).map(|note| place::error(note, lang)).collect();
            if notes.len() > SAID {
                let more = Note::new("lot.more").with("n", notes.len() - SAID).say(lang);
                said.push_str(&format!("  {more}\n"));
            }
            format!("{said}  {}: {}\n", Note::new("diagnostic.help").say(lang), help.say(lang))
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

/// The units of a lot and where their results go.
struct Work<'a> {
    test: &'a dyn UnitTest,
    members: &'a [Member],
    inputs: &'a [BTreeMap<String, String>],
    folder: &'a StagedFolder,
    keeper: &'a Keeper,
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
        let testing = Note::new("progress.testing").say(self.lang);
        let total = self.members.len() as u64;
        let mut units: BTreeMap<usize, LotUnit> = BTreeMap::new();
        let mut failed = None;
        let mut said = BTreeSet::new();
        std::thread::scope(|scope| {
            for _ in 0..jobs.min(self.members.len()) {
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
        let (member, inputs) = (self.members.get(i)?, self.inputs.get(i)?);
        let (mut results, problems) = self.test.run(member, &mut Progress::silent(self.lang));
        if let Err(why) = self.keeper.place_among_others(&mut results.outcome.record) {
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
