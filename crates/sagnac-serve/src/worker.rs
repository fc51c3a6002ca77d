//! Workers: each takes a test after another and carries it out as a process of the program.
//!
//! The process holds a lock as its standard input. Where the server is killed and the process goes on, the next server waits for
//! its end and takes its result, so that no test is made twice at a time. What it says goes to a file, which outlives the server.

use crate::harness::Harness;
use crate::order::{End, Test};
use crate::queue::{Queue, Task, now};
use crate::refusal::shown;
use crate::setup::Setup;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Result, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Pause between two looks at a process.
const POLL: Duration = Duration::from_millis(20);
/// Time between the request to a process to end and its kill.
const PATIENCE: Duration = Duration::from_secs(5);
/// Most of what a process said that is read at once, bytes.
const MAX_SAID_BYTES: u64 = 16 << 10;
/// Most characters of what a process said that are kept with its end.
const MAX_KEPT_CHARACTERS: usize = 1000;

/// Folder of results below the data.
pub const RESULTS_FOLDER: &str = "results";
/// Folder of processes below the data.
pub const RUNNING_FOLDER: &str = "running";
/// File of a finished result.
const RESULT_FILE: &str = "result.json";

/// What workers share.
pub struct Bench {
    /// What the server was started with.
    pub setup: Setup,
    /// The queue.
    pub queue: Queue,
    /// The program, where it understands results.
    pub harness: Box<dyn Harness>,
}

impl Bench {
    /// Folder of the result of a test.
    pub fn result(&self, id: &str) -> PathBuf {
        self.setup.data.join(RESULTS_FOLDER).join(id)
    }
}

/// Starts the workers.
///
/// # Errors
/// A thread that cannot be started.
pub fn start(bench: &Arc<Bench>) -> Result<Vec<JoinHandle<()>>> {
    let worker = |number: usize| {
        let bench = Arc::clone(bench);
        std::thread::Builder::new().name(format!("worker-{number}")).spawn(move || work(&bench))
    };
    (1..=bench.setup.jobs.max(1)).map(worker).collect()
}

fn work(bench: &Bench) {
    while let Some(task) = bench.queue.take() {
        let id = &task.order.id;
        let end = match carry_out(bench, &task) {
            Ok(Some(end)) => end,
            // The server ends: the test is made again.
            Ok(None) => return,
            Err(e) => End::Failed { said: e.to_string() },
        };
        if let Err(e) = bench.queue.end(id, end, now()) {
            bench.harness.log(&format!("queue.jsonl: {e}"));
        }
        // Nothing is in it that anybody needs: the end has what was said.
        let _ = std::fs::remove_dir_all(bench.setup.data.join(RUNNING_FOLDER).join(id));
    }
}

/// Carries out a test; `None` where the server ends before it.
fn carry_out(bench: &Bench, task: &Task) -> Result<Option<End>> {
    let folder = bench.setup.data.join(RUNNING_FOLDER).join(&task.order.id);
    std::fs::create_dir_all(&folder)?;
    let mut said = Said::of(&folder.join("said"))?;
    let lock = loop {
        if let Some(lock) = take(&folder.join("lock"))? {
            break lock;
        }
        if bench.queue.stops() {
            return Ok(None);
        }
        said.tell(task)?;
        std::thread::sleep(POLL);
    };
    let place = bench.result(&task.order.id);
    if let Some(outcome) = finished(bench, &place) {
        keep(bench, &place);
        return Ok(Some(End::Done(outcome)));
    }
    if task.is_cancelled() {
        return Ok(Some(End::Cancelled));
    }
    let mut command = command(&bench.setup, &task.order.test, &place);
    command.stdin(Stdio::from(lock)).stdout(Stdio::null()).stderr(said.writer()?);
    let mut child = command.spawn()?;
    // The copies of the lock in this process.
    drop(command);
    let mut asked: Option<Instant> = None;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        said.tell(task)?;
        if task.is_cancelled() || bench.queue.stops() {
            match asked {
                None => {
                    ask_to_end(&mut child)?;
                    asked = Some(Instant::now());
                }
                Some(since) if since.elapsed() > PATIENCE => child.kill()?,
                Some(_) => {}
            }
        }
        std::thread::sleep(POLL);
    };
    said.tell(task)?;
    if let Some(outcome) = finished(bench, &place) {
        return Ok(Some(End::Done(outcome)));
    }
    if task.is_cancelled() {
        return Ok(Some(End::Cancelled));
    }
    if bench.queue.stops() {
        return Ok(None);
    }
    let text = said.all()?;
    Ok(Some(End::Failed { said: if text.is_empty() { status.to_string() } else { text } }))
}

fn finished(bench: &Bench, place: &Path) -> Option<crate::harness::Outcome> {
    if place.join(RESULT_FILE).is_file() { bench.harness.outcome(place) } else { None }
}

/// Keeps a result whose process was killed, perhaps before it was in the store: what is there is left as it is.
fn keep(bench: &Bench, place: &Path) {
    let Some(store) = &bench.setup.store else { return };
    let mut import = Command::new(&bench.setup.program);
    import.args(["store", "import"]).arg(store).arg(place);
    let done = import.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !done.as_ref().is_ok_and(std::process::ExitStatus::success) {
        bench.harness.log(&format!("store import {}: {done:?}", place.display()));
    }
}

/// The command line of a test. What follows `--` is no option, whatever its name.
fn command(setup: &Setup, test: &Test, place: &Path) -> Command {
    let mut command = Command::new(&setup.program);
    command.arg("run").args(["--lang", setup.lang.code()]).arg("--out").arg(place);
    command.arg(format!("--serial={}", test.serial));
    if let Some(limits) = &test.limits {
        command.arg("--limits").arg(limits);
    }
    match &setup.store {
        Some(store) => command.arg("--store").arg(store),
        None => command.arg("--no-store"),
    };
    let texts = [("lot", &test.lot), ("operator", &test.operator), ("station", &setup.station)];
    for (name, text) in texts {
        if let Some(text) = text {
            command.arg(format!("--{name}={text}"));
        }
    }
    command.arg("--").arg(&test.procedure).arg(&test.path);
    command.env("SAGNAC_PROGRESS", "always");
    // A request to end that a terminal sends to the server does not reach it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// Takes a lock; `None` where another process holds it. It ends with the file and every copy of it.
///
/// # Errors
/// A file that cannot be made or locked.
pub fn take(path: &Path) -> Result<Option<File>> {
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => Ok(Some(file)),
        Err(TryLockError::Error(e)) => Err(e),
    }
}

/// Asks a process to end, so that it removes what is unfinished.
#[cfg(unix)]
fn ask_to_end(child: &mut Child) -> Result<()> {
    let id = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw);
    match id {
        Some(id) => {
            rustix::process::kill_process(id, rustix::process::Signal::TERM).map_err(std::io::Error::from)
        }
        None => child.kill(),
    }
}

#[cfg(not(unix))]
fn ask_to_end(child: &mut Child) -> Result<()> {
    child.kill()
}

/// A line of progress without the sign that turns while nothing else changes.
fn without_spinner(line: &str) -> String {
    let is_word = |word: &&str| !word.chars().all(|c| ('\u{2800}'..='\u{28ff}').contains(&c));
    line.split_whitespace().filter(is_word).collect::<Vec<_>>().join(" ")
}

/// What a process says, as a file.
struct Said {
    path: PathBuf,
    file: File,
    rest: Vec<u8>,
}

impl Said {
    fn of(path: &Path) -> Result<Said> {
        let file = OpenOptions::new().create(true).append(true).read(true).open(path)?;
        Ok(Said { path: path.to_owned(), file, rest: vec![] })
    }

    /// Where the process writes.
    fn writer(&self) -> Result<File> {
        OpenOptions::new().append(true).open(&self.path)
    }

    /// Tells every whole line that is new.
    fn tell(&mut self, task: &Task) -> Result<()> {
        let mut new = vec![];
        (&mut self.file).take(MAX_SAID_BYTES).read_to_end(&mut new)?;
        self.rest.extend(new);
        while let Some(end) = self.rest.iter().position(|b| *b == b'\n') {
            let line: Vec<u8> = self.rest.drain(..=end).collect();
            let line = without_spinner(&shown(&String::from_utf8_lossy(&line)));
            if !line.is_empty() && task.events.last_progress().as_ref() != Some(&line) {
                task.events.progress(&line);
            }
        }
        // A line without an end is no message.
        if self.rest.len() > MAX_SAID_BYTES as usize {
            self.rest.clear();
        }
        Ok(())
    }

    /// The end of all that was said.
    fn all(&mut self) -> Result<String> {
        let length = self.file.metadata()?.len();
        self.file.seek(SeekFrom::Start(length.saturating_sub(MAX_SAID_BYTES)))?;
        let mut bytes = vec![];
        (&mut self.file).take(MAX_SAID_BYTES).read_to_end(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let lines: Vec<String> = text.lines().map(shown).collect();
        // A diagnostic ends what is said, and progress stands before it.
        let from = lines.iter().rposition(|line| line.starts_with("error") || line.starts_with("ошибка"));
        let told = lines.get(from.unwrap_or(0)..).unwrap_or_default().join("\n");
        let skipped = told.trim().chars().count().saturating_sub(MAX_KEPT_CHARACTERS);
        Ok(told.trim().chars().skip(skipped).collect())
    }
}
