//! `sagnac watch`: every recording that appears in a folder is tested once.

use super::job::{Frame, Job, Made, execute};
use super::keep::{Keeper, StoreArgs};
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use super::printer::Printer;
use super::{ending, exit};
use crate::acceptance::lot;
use crate::config::procedure::phases::{is_phased, load_phased};
use crate::config::procedure::{load, load_limits};
use crate::config::watch::{self as rules_file, Completeness, WatchRule, WatchRules};
use crate::estimate::Verdict;
use crate::executable;
use crate::i18n::{Lang, Localize, Note, io_reason, note};
use crate::ingest::{ReadOptions, files_read};
use crate::moment;
use crate::output::{Kind, StagedFolder, outside_stores};
use crate::record::read::{self, MAX_BYTES};
use crate::record::{
    DAY_FORMAT, DayRecord, DayTest, EVENT_FORMAT, HookState, Program, RunRecord, Untested, VerdictCounts,
    WatchEvent,
};
use crate::report::lot::unit_done;
use crate::report::{Results, page};
use crate::watch::folder::{Found, Listing, Stamp, Stillness, age, found};
use crate::watch::identity::{TestedBy, hash_of};
use crate::watch::journal::{Journal, Seen, Tested};
use crate::watch::lock::{TEST_LOCK, WATCHER_LOCK, take};
use crate::watch::process::Process;
use crate::watch::recording::{identified, is_unchanged, stands, whole};
use crate::watch::{DAYS_FOLDER, FOLDER_DIGITS, JOURNAL_FILE, RESULTS_FOLDER, hook};
use clap::Args;
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Pause between two looks for a request to end.
const REQUEST_POLL: Duration = Duration::from_millis(50);
/// Pause after a pass in the time that writing its page took: the page of a day with thousands of tests may not take the time of
/// the tests.
const PAUSE_IN_WRITINGS: u32 = 9;

#[derive(Debug, Args)]
pub struct WatchArgs {
    /// Folder in which recordings appear
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Rules (TOML): which files are recordings of which test
    #[arg(long, value_name = "FILE", conflicts_with_all = ["procedure", "limits"])]
    rules: Option<PathBuf>,
    /// Procedure (TOML) for every file of the folder
    #[arg(long, value_name = "FILE", required_unless_present = "rules")]
    procedure: Option<PathBuf>,
    /// Limits file for every file of the folder
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Folder for results, pages of days and the journal
    #[arg(long, value_name = "DIR", default_value = "watched")]
    pub out: PathBuf,
    /// Look once, test what is complete, and end
    #[arg(long)]
    pub once: bool,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Watches until it is asked to end, or looks once; gives the exit code: after a single look, of the worst verdict.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &WatchArgs, lang: Lang) -> Result<u8, String> {
    ending::defer();
    let mut watch = Watch::begin(args, lang)?;
    loop {
        let looked = Instant::now();
        let done = watch.look_and_test();
        if args.once {
            return done;
        }
        // A disk that is full or a share that is gone now may be there again at the next look.
        if let Err(message) = done {
            place::eprint_diagnostic(&message);
        }
        let ended = Instant::now();
        let waits = || looked.elapsed() < watch.poll || ended.elapsed() < watch.writing * PAUSE_IN_WRITINGS;
        while !ending::is_asked() && waits() {
            std::thread::sleep(REQUEST_POLL.min(watch.poll));
        }
        if ending::is_asked() {
            return Ok(super::exit::PASS);
        }
    }
}

/// A rule with what it needs at work.
pub struct ActiveRule {
    /// The rule.
    pub rule: WatchRule,
    /// Contents of procedure and limits.
    pub by: TestedBy,
    /// Digest of them.
    pub digest: String,
    /// Options by which recordings are read.
    pub options: ReadOptions,
    /// Id of the procedure.
    pub procedure_id: String,
    /// Keeps results in the store of the rule.
    pub keeper: Keeper,
}

impl ActiveRule {
    fn load(rule: WatchRule, lang: Lang) -> Result<ActiveRule, String> {
        let by = TestedBy::now(&rule.procedure, rule.limits.as_deref());
        let (procedure_id, options) = if is_phased(&rule.procedure) {
            let phased = load_phased(&rule.procedure).map_err(|p| p.say(lang))?;
            (phased.identity.id, ReadOptions::default())
        } else {
            let procedure = load(&rule.procedure).map_err(|p| p.say(lang))?.value;
            (procedure.id, procedure.recording.read)
        };
        if let Some(limits) = &rule.limits {
            load_limits(limits).map_err(|p| p.say(lang))?;
        }
        let store = StoreArgs { store: rule.store.clone(), ..StoreArgs::default() };
        let keeper = Keeper::new(&store, lang)?;
        Ok(ActiveRule { digest: by.digest(), rule, by, options, procedure_id, keeper })
    }

    /// Reads procedure and limits again where they were changed.
    fn refresh(&mut self, lang: Lang) -> Result<(), String> {
        let by = TestedBy::now(&self.rule.procedure, self.rule.limits.as_deref());
        if by != self.by {
            *self = ActiveRule::load(self.rule.clone(), lang)?;
        }
        Ok(())
    }
}

/// A recording that is ready to be tested.
pub struct Ready {
    /// The file.
    pub found: Found,
    /// Every file that is read.
    pub files: Vec<PathBuf>,
    /// Their stamp.
    pub stamp: Stamp,
}

/// Something that is tried again later.
struct PutOff {
    failures: u32,
    until: Instant,
    why: Note,
}

/// A watched folder.
pub struct Watch<'a> {
    /// The options.
    pub args: &'a WatchArgs,
    /// The rules.
    pub rules: Vec<ActiveRule>,
    /// Folder that hook commands run in.
    pub hook_folder: PathBuf,
    /// Folder of results, absolute.
    pub out: PathBuf,
    /// The journal.
    pub journal: Journal,
    lang: Lang,
    poll: Duration,
    /// Time that the last look spent on the page of the day.
    writing: Duration,
    still: Stillness,
    put_off: BTreeMap<String, PutOff>,
    shown: Option<BTreeSet<(String, String)>>,
    _lock: File,
}

impl<'a> Watch<'a> {
    fn begin(args: &'a WatchArgs, lang: Lang) -> Result<Watch<'a>, String> {
        let error = |note: Note| place::error(&note, lang);
        let (WatchRules { poll, rules }, hook_folder) = args.rules(lang)?;
        let rules = rules.into_iter().map(|rule| ActiveRule::load(rule, lang));
        let rules = rules.collect::<Result<Vec<_>, _>>()?;
        let refused = |path: &Path, e: &std::io::Error| {
            error(note!("watch.unreadable", path = place::shown(path), reason = io_reason(e)))
        };
        let folder = args.folder.canonicalize().map_err(|e| refused(&args.folder, &e))?;
        if !folder.is_dir() {
            return Err(error(note!("watch.not_a_folder", path = place::shown(&args.folder))));
        }
        outside_stores(&args.out.join(JOURNAL_FILE)).map_err(|e| error(e.note()))?;
        // Asked before anything is made: the nearest folder that exists tells where the others would lie.
        let absolute = std::path::absolute(&args.out).map_err(|e| refused(&args.out, &e))?;
        let existing = absolute.ancestors().find_map(|path| path.canonicalize().ok());
        if existing.is_some_and(|path| path.starts_with(&folder)) {
            return Err(error(note!("watch.out_inside", path = place::shown(&args.out))));
        }
        std::fs::create_dir_all(&args.out).map_err(|e| refused(&args.out, &e))?;
        let out = args.out.canonicalize().map_err(|e| refused(&args.out, &e))?;
        let lock = take(&out.join(WATCHER_LOCK)).map_err(|e| refused(&out, &e))?;
        let lock = lock.ok_or_else(|| error(note!("watch.taken", path = place::shown(&args.out))))?;
        let today = day(moment::now());
        let journal = Journal::open(&out.join(JOURNAL_FILE), &today).map_err(error)?;
        Ok(Watch {
            args,
            rules,
            hook_folder,
            out,
            journal,
            lang,
            poll,
            writing: Duration::ZERO,
            still: Stillness::default(),
            put_off: BTreeMap::new(),
            shown: None,
            _lock: lock,
        })
    }

    /// The watched folder, as it was named.
    pub fn folder(&self) -> &'a Path {
        &self.args.folder
    }

    /// Looks at the folder, tests what is complete, and writes the page of the day where there is anything new; gives the exit
    /// code of the worst verdict.
    fn look_and_test(&mut self) -> Result<u8, String> {
        let (args, lang) = (self.args, self.lang);
        let (ready, untested) = self.look()?;
        let shown: BTreeSet<(String, String)> =
            untested.iter().map(|u| (u.recording.clone(), u.why.0.say(Lang::En))).collect();
        let is_new = self.shown.as_ref() != Some(&shown);
        self.writing = Duration::ZERO;
        if ready.is_empty() && self.due().is_empty() && !is_new {
            return Ok(super::exit::PASS);
        }
        let (outcome, begun) = (&PassOutcome::default(), Instant::now());
        let watch = &mut *self;
        let code = execute(&args.output, lang, move |_| Ok(Pass::new(watch, ready, untested, outcome)))?;
        self.writing = begun.elapsed().saturating_sub(outcome.testing.get());
        self.shown = Some(shown);
        Ok(code)
    }

    /// The recordings that are ready, and those that are not with the reasons.
    fn look(&mut self) -> Result<(Vec<Ready>, Vec<Untested>), String> {
        for rule in &mut self.rules {
            rule.refresh(self.lang)?;
        }
        let rules: Vec<WatchRule> = self.rules.iter().map(|active| active.rule.clone()).collect();
        let Listing { files, refused } =
            found(self.folder(), &rules).map_err(|note| place::error(&note, self.lang))?;
        let now = Instant::now();
        self.still.keep(&files.iter().map(|f| f.path.as_path()).collect());
        let mut untested: Vec<Untested> =
            refused.into_iter().map(|(recording, why)| Untested { recording, why: why.into() }).collect();
        let mut ready = vec![];
        for found in files {
            match self.state(found, now) {
                Ok(found) => ready.extend(found),
                Err(why) => untested.push(why),
            }
        }
        Ok((ready, untested))
    }

    /// A file that is ready; `None` for one that was tested, or is none to be tested.
    fn state(&mut self, found: Found, now: Instant) -> Result<Option<Ready>, Untested> {
        let Some(active) = self.rules.get(found.rule) else { return Ok(None) };
        let rule = &active.rule;
        if rule.complete == Completeness::Marker && found.name.ends_with(&rule.marker) {
            return Ok(None);
        }
        let untested = |why: Note| Untested { recording: found.name.clone(), why: why.into() };
        let files = files_read(std::slice::from_ref(&found.path), &active.options);
        let stamp = Stamp::of_all(&files).map_err(untested)?;
        if self.journal.knows(&found.name, stamp, &active.digest) {
            return Ok(None);
        }
        let seen = self.still.since(&found.path, stamp, now);
        let still = if self.args.once { age(stamp) } else { Some(seen) };
        stands(rule, &found.path, still).map_err(untested)?;
        match self.put_off.get(&found.name) {
            // What was changed since is another recording.
            Some(later) if now < later.until && seen > Duration::ZERO => Err(untested(later.why.clone())),
            _ => Ok(Some(Ready { found, files, stamp })),
        }
    }

    /// The tests of which a hook command is to be told now.
    pub fn due(&self) -> Vec<Tested> {
        let now = Instant::now();
        let mut pending = self.journal.pending();
        pending.retain(|p| {
            let is_later = self.put_off.get(&p.test.id).is_some_and(|later| now < later.until);
            !is_later && self.rules.iter().any(|r| r.rule.pattern == p.rule && !r.rule.hook.is_empty())
        });
        pending
    }

    /// Tries something again later: a recording by its name, a hook command by the id of the test.
    pub fn put_off(&mut self, what: &str, why: &Note) {
        let failures = self.put_off.get(what).map_or(0, |later| later.failures) + 1;
        let until = Instant::now() + hook::pause(failures);
        self.put_off.insert(what.to_owned(), PutOff { failures, until, why: why.clone() });
    }

    /// Forgets that something failed.
    pub fn succeeded(&mut self, what: &str) {
        self.put_off.remove(what);
    }
}

impl WatchArgs {
    /// The rules, and the folder that their hook commands run in.
    fn rules(&self, lang: Lang) -> Result<(WatchRules, PathBuf), String> {
        let here = PathBuf::from(".");
        if let Some(path) = &self.rules {
            let rules = rules_file::load(path).map_err(|p| p.say(lang))?;
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).map_or(here, Path::to_owned);
            return Ok((rules, folder));
        }
        let procedure = self.procedure.clone().unwrap_or_default();
        let rule = WatchRule::of_every_file(procedure, self.limits.clone());
        Ok((WatchRules { poll: rules_file::DEFAULT_POLL, rules: vec![rule] }, here))
    }
}

/// A day by UTC.
pub fn day(moment: chrono::DateTime<chrono::Utc>) -> String {
    moment.format("%Y-%m-%d").to_string()
}

/// Pause between two attempts to begin a test while one that a killed watcher left is running.
const LOCK_POLL: Duration = Duration::from_millis(50);
/// Most characters of what a test says that are shown.
const MAX_SHOWN_CHARACTERS: usize = 500;

/// What came of a pass.
#[derive(Debug, Default)]
pub struct PassOutcome {
    worst: Cell<Verdict>,
    failed: Cell<bool>,
    /// Time until all tests were made and told.
    testing: Cell<Duration>,
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
        let begun = Instant::now();
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
        self.outcome.testing.set(begun.elapsed());
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
        program: Program::this(),
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
    let mut unit = lot::of_record(&record, unit.from, found.name.clone(), folder);
    // A day keeps all its tests in memory; their budgets stand in their results.
    unit.measurands.iter_mut().for_each(|row| row.budget.clear());
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
    let mut command = Command::new(executable::path().unwrap_or_else(|_| "sagnac".into()));
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
