//! One look at a watched folder: the tests of what is complete, and the page of the day.

use super::job::{Frame, Job, Made};
use super::place::OutputPlace;
use super::printer::Printer;
use super::watch::{Ready, Watch, day};
use super::{ending, exit};
use crate::acceptance::lot;
use crate::estimate::Verdict;
use crate::i18n::{Lang, Note, io_reason, note};
use crate::output::{Kind, StagedFolder};
use crate::record::read::{self, MAX_BYTES};
use crate::record::{
    DAY_FORMAT, DayRecord, DayTest, EVENT_FORMAT, HookState, Program, RunRecord, Untested, VerdictCounts,
    WatchEvent,
};
use crate::report::lot::unit_done;
use crate::report::{Results, page};
use crate::watch::identity::{VERSION, hash_of};
use crate::watch::journal::{Seen, Tested};
use crate::watch::lock::{TEST_LOCK, take};
use crate::watch::process::Process;
use crate::watch::recording::{identified, is_unchanged, whole};
use crate::watch::{DAYS_FOLDER, FOLDER_DIGITS, RESULTS_FOLDER, hook};
use std::cell::{Cell, RefCell};
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Pause between two attempts to begin a test while one that a killed watcher left is running.
const LOCK_POLL: Duration = Duration::from_millis(50);
/// Most characters of what a test says that are shown.
const MAX_SHOWN_CHARACTERS: usize = 500;

/// What came of a pass.
#[derive(Debug, Default)]
pub struct PassOutcome {
    worst: Cell<Verdict>,
    failed: Cell<bool>,
}

/// A pass: recordings that are ready, and those that are not.
pub struct Pass<'p, 'a> {
    watch: RefCell<&'p mut Watch<'a>>,
    ready: RefCell<Vec<Ready>>,
    untested: RefCell<Vec<Untested>>,
    outcome: &'p PassOutcome,
}

impl<'p, 'a> Pass<'p, 'a> {
    /// A pass that is to be carried out.
    pub fn new(
        watch: &'p mut Watch<'a>,
        ready: Vec<Ready>,
        untested: Vec<Untested>,
        outcome: &'p PassOutcome,
    ) -> Pass<'p, 'a> {
        Pass {
            watch: RefCell::new(watch),
            ready: RefCell::new(ready),
            untested: RefCell::new(untested),
            outcome,
        }
    }
}

impl Job for Pass<'_, '_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let day = day(frame.now);
        let place = self.watch.borrow().args.out.join(DAYS_FOLDER).join(&day);
        let inputs = frame.inputs().text("day", Some(&day));
        inputs.begin(&OutputPlace::Named(place), Kind::Day, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let mut watch = self.watch.borrow_mut();
        let (watch, today) = (&mut **watch, day(frame.now));
        let mut untested = self.untested.take();
        watch.journal.tests_of(&today);
        for ready in self.ready.take() {
            if ending::is_asked() {
                break;
            }
            frame.progress.stage("progress.testing");
            if let Err(why) = one(watch, &ready, self.outcome, frame) {
                watch.put_off(&ready.found.name, &why);
                let place = ready.found.path.display().to_string();
                frame.warn(&note!("watch.untested", path = place, why = why.clone()));
                untested.push(Untested { recording: ready.found.name, why: why.into() });
            }
            tell(watch, self.outcome, frame);
        }
        tell(watch, self.outcome, frame);
        let watched = watch.folder().display().to_string();
        let tests = watch.journal.tests_of(&today).to_vec();
        Ok(Results::of(record(today, watched, frame.stamp(), tests, untested), vec![], vec![]).into())
    }

    fn exit_code(&self, _: &Results) -> u8 {
        if self.outcome.failed.get() { exit::ERROR } else { exit::of_verdict(self.outcome.worst.get()) }
    }
}

fn record(
    day: String,
    watched: String,
    made_at: String,
    tests: Vec<DayTest>,
    untested: Vec<Untested>,
) -> DayRecord {
    DayRecord {
        format: DAY_FORMAT.to_owned(),
        program: Program { name: "sagnac".to_owned(), version: VERSION.to_owned() },
        day,
        watched,
        made_at,
        verdict: tests.iter().map(|t| t.unit.verdict).max().unwrap_or(Verdict::None),
        counts: VerdictCounts::of(tests.iter().map(|t| t.unit.verdict)),
        tests,
        untested,
    }
}

/// Tests a recording, unless its contents were tested before, and enters it.
fn one(
    watch: &mut Watch<'_>,
    ready: &Ready,
    outcome: &PassOutcome,
    frame: &mut Frame<'_>,
) -> Result<(), Note> {
    let Ready { found, files, stamp } = ready;
    let Some(active) = watch.rules.get(found.rule) else { return Ok(()) };
    let rule = &active.rule;
    let source = whole(rule, &found.path, &active.options)?;
    let unit = identified(rule, &found.name, &found.path, source.as_ref(), &active.options)?;
    drop(source);
    let sha256 = hash_of(files);
    if !is_unchanged(files, *stamp) {
        return Err("watch.changed".into());
    }
    let id = active.by.test_of(&sha256);
    let seen = Seen::new(&found.name, *stamp, &active.digest, &id);
    if watch.journal.has(&id) {
        frame.warn(&note!("watch.same", path = found.path.display().to_string()));
        return watch.journal.same(seen);
    }
    let folder = format!("{}/{}", unit.folder, id.get(..FOLDER_DIGITS).unwrap_or(&id));
    let place = watch.out.join(RESULTS_FOLDER).join(&folder);
    let made = |place: &Path| made(place).filter(|(record, inputs)| active.by.made(record, inputs, &sha256));
    let lock = test_lock(&watch.out)?;
    let (record, is_kept) = match made(&place) {
        Some((record, _)) => (record, false),
        None => {
            let mut command = command(watch, found.rule, ready, &unit.serial, &place, frame.lang);
            let failed = |e: std::io::Error| note!("watch.not_run", reason = io_reason(&e));
            let process = Process::start(command.stdin(Stdio::from(lock))).map_err(failed)?;
            drop(command);
            let ended = process.wait(None, ending::is_urgent).map_err(failed)?;
            let said: String = ended.said.chars().take(MAX_SHOWN_CHARACTERS).collect();
            let (record, _) = made(&place).ok_or_else(|| note!("watch.not_run", reason = said))?;
            let code = ended.status.and_then(|s| s.code());
            (record, code.is_some_and(|code| code != i32::from(exit::ERROR)))
        }
    };
    if !is_kept {
        let kept = active.keeper.keep(&place, frame.printer);
        kept.map_err(|reason| note!("watch.not_kept", reason = reason.trim()))?;
    }
    let unit = lot::of_record(&record, unit.from, found.name.clone(), folder);
    let hook = if rule.hook.is_empty() { HookState::None } else { HookState::Pending };
    outcome.worst.set(outcome.worst.get().max(record.verdict));
    let done = unit_done(&unit, frame.lang);
    let test = DayTest {
        id,
        sha256,
        procedure: active.procedure_id.clone(),
        tested_at: record.session.evaluated_at,
        hook,
        unit,
    };
    let tested = Tested { day: day(frame.now), rule: rule.pattern.clone(), seen, test };
    watch.journal.tested(tested)?;
    watch.succeeded(&found.name);
    let printer: Printer = frame.printer;
    frame.progress.beside(|| printer.line(|terminal| page::terminal(&done, terminal)));
    Ok(())
}

/// The result in a folder with what it states as its inputs; `None` without one.
fn made(place: &Path) -> Option<(RunRecord, serde_json::Value)> {
    let file = place.join(Kind::Result.record_file());
    let bytes = sagnac_ingest::read_file(&file, MAX_BYTES as u64).ok()?;
    let inputs = serde_json::from_slice::<serde_json::Value>(&bytes).ok()?.get("inputs")?.clone();
    Some((read::from_slice(&bytes).ok()?, inputs))
}

/// The lock of the test, once no other one holds it: a test that a killed watcher left is waited for.
fn test_lock(out: &Path) -> Result<File, Note> {
    let path = out.join(TEST_LOCK);
    loop {
        let taken = take(&path).map_err(|e| {
            note!("watch.unreadable", path = path.display().to_string(), reason = io_reason(&e))
        })?;
        match taken {
            Some(lock) => return Ok(lock),
            None if ending::is_asked() => return Err("watch.ending".into()),
            None => std::thread::sleep(LOCK_POLL),
        }
    }
}

/// The command line of a test. What follows `--` is no option, whatever its name.
fn command(watch: &Watch<'_>, rule: usize, ready: &Ready, serial: &str, place: &Path, lang: Lang) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap_or_else(|_| "sagnac".into()));
    command.arg("run").args(["--lang", lang.code()]).args(watch.args.output.forms.arguments());
    command.arg("--out").arg(place).arg(format!("--serial={serial}"));
    // Something else stands there: a result of a file that was changed while it was read.
    if place.exists() {
        command.arg("--force");
    }
    let Some(active) = watch.rules.get(rule) else { return command };
    let rule = &active.rule;
    for (option, path) in
        [("--limits", &rule.limits), ("--store", &rule.store), ("--unit-data", &rule.unit_data)]
    {
        if let Some(path) = path {
            command.arg(option).arg(path);
        }
    }
    if let Some(station) = &rule.station {
        command.arg(format!("--station={station}"));
    }
    command.arg("--").arg(&rule.procedure).arg(&ready.found.path);
    command
}

/// Tells hook commands of the tests that they were not told of yet.
fn tell(watch: &mut Watch<'_>, outcome: &PassOutcome, frame: &Frame<'_>) {
    for Tested { rule, test, .. } in watch.due() {
        let Some(active) = watch.rules.iter().find(|r| r.rule.pattern == rule) else { continue };
        let folder = watch.out.join(RESULTS_FOLDER).join(&test.unit.folder);
        let below = |name: &str| folder.join(name).display().to_string();
        let event = WatchEvent {
            format: EVENT_FORMAT,
            id: &test.id,
            serial: test.unit.serial(),
            verdict: test.unit.verdict,
            recording: &test.unit.recording,
            sha256: &test.sha256,
            procedure: &test.procedure,
            tested_at: &test.tested_at,
            folder: folder.display().to_string(),
            result: below(Kind::Result.record_file()),
            report: below("report.html"),
        };
        let told = hook::tell(&active.rule.hook, &watch.hook_folder, &event);
        match told.and_then(|()| watch.journal.told(&test.id)) {
            Ok(()) => watch.succeeded(&test.id),
            Err(why) => {
                outcome.failed.set(true);
                frame.warn(&note!("watch.not_told", serial = test.unit.serial(), why = why.clone()));
                watch.put_off(&test.id, &why);
            }
        }
    }
}
