//! The queue of tests. It is on the disk before an order is answered, so that a restart loses and doubles nothing: what has no
//! end in the journal is tested again, unless its result is there.

use crate::events::Events;
use crate::harness::Outcome;
use crate::journal::{Journal, Line};
use crate::order::{End, Order, State, Test};
use crate::token::random_name;
use chrono::{DateTime, SecondsFormat, Utc};
use serde_json::json;
use std::collections::{BTreeMap, VecDeque};
use std::io::Result;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Most tests that wait.
pub const MAX_WAITING: usize = 1000;
/// Tests that have ended of which every event is kept.
const MAX_WHOLE: usize = 64;
/// Random bytes of an id.
const ID_RANDOM_BYTES: usize = 4;

/// A test in the queue.
#[derive(Debug, Clone)]
pub struct Job {
    /// What was ordered.
    pub order: Order,
    /// Where it is.
    pub state: State,
    /// Its end and when that was, RFC 3339.
    pub end: Option<(String, End)>,
    /// What is told of it.
    pub events: Arc<Events>,
    cancel: Arc<AtomicBool>,
}

impl Job {
    fn new(order: Order) -> Job {
        let events = Arc::new(Events::default());
        events.state(State::Queued.id());
        Job { order, state: State::Queued, end: None, events, cancel: Arc::default() }
    }

    /// Its result.
    pub fn outcome(&self) -> Option<&Outcome> {
        match &self.end {
            Some((_, End::Done(outcome))) => Some(outcome),
            _ => None,
        }
    }

    /// The day of its end, or else of its order, by UTC.
    pub fn day(&self) -> &str {
        let at = self.end.as_ref().map_or(&self.order.ordered_at, |(at, _)| at);
        at.get(..10).unwrap_or(at)
    }
}

/// A test that a worker took.
#[derive(Debug, Clone)]
pub struct Task {
    /// What is to be done.
    pub order: Order,
    /// Where progress is told.
    pub events: Arc<Events>,
    cancel: Arc<AtomicBool>,
}

impl Task {
    /// True where it is to be ended.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::SeqCst)
    }
}

#[derive(Debug, Default)]
struct Jobs {
    jobs: BTreeMap<String, Job>,
    waiting: VecDeque<String>,
    ordered: u64,
    ended: VecDeque<String>,
}

/// The queue.
#[derive(Debug)]
pub struct Queue {
    journal: Mutex<Journal>,
    jobs: Mutex<Jobs>,
    changed: Condvar,
    stops: AtomicBool,
}

/// Why an order is not taken.
#[derive(Debug)]
pub enum NotTaken {
    /// Too many wait.
    Full,
    /// The journal cannot be written.
    NotWritten(std::io::Error),
}

/// The moment by the clock of the computer, which may be set to a time before 1970.
pub fn now() -> DateTime<Utc> {
    std::time::SystemTime::now().into()
}

/// A moment as it is kept.
pub fn moment(at: DateTime<Utc>) -> String {
    at.to_rfc3339_opts(SecondsFormat::Secs, true)
}

impl Queue {
    /// Opens the queue of a journal. Tests that have not ended wait again.
    ///
    /// # Errors
    /// As [`Journal::open`].
    pub fn open(path: &Path) -> Result<Queue> {
        let (journal, lines) = Journal::open(path)?;
        let mut jobs = Jobs::default();
        for line in lines {
            match line {
                Line::Ordered(order) => {
                    jobs.ordered += 1;
                    jobs.jobs.insert(order.id.clone(), Job::new(order));
                }
                Line::Ended { id, at, end } => jobs.end(&id, at, end),
            }
        }
        let active = jobs.jobs.values().filter(|job| job.state.is_active());
        jobs.waiting = active.map(|job| job.order.id.clone()).collect();
        Ok(Queue {
            journal: Mutex::new(journal),
            jobs: Mutex::new(jobs),
            changed: Condvar::new(),
            stops: AtomicBool::new(false),
        })
    }

    fn jobs(&self) -> MutexGuard<'_, Jobs> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self, line: &Line) -> Result<()> {
        self.journal.lock().unwrap_or_else(PoisonError::into_inner).add(line)
    }

    /// Takes an order. It is on the disk when this returns.
    ///
    /// # Errors
    /// A queue that is full, or a journal that cannot be written.
    pub fn order(&self, test: Test, now: DateTime<Utc>) -> std::result::Result<Job, NotTaken> {
        let random = random_name(ID_RANDOM_BYTES).map_err(|e| NotTaken::NotWritten(e.into()))?;
        let number = {
            let mut jobs = self.jobs();
            if jobs.waiting.len() >= MAX_WAITING {
                return Err(NotTaken::Full);
            }
            jobs.ordered += 1;
            jobs.ordered
        };
        let order = Order { id: format!("{number:06}-{random}"), ordered_at: moment(now), test };
        self.write(&Line::Ordered(order.clone())).map_err(NotTaken::NotWritten)?;
        let job = Job::new(order);
        let mut jobs = self.jobs();
        jobs.waiting.push_back(job.order.id.clone());
        jobs.jobs.insert(job.order.id.clone(), job.clone());
        drop(jobs);
        self.changed.notify_one();
        Ok(job)
    }

    /// Waits for a test to be made; `None` where the server ends.
    pub fn take(&self) -> Option<Task> {
        let mut jobs = self.jobs();
        loop {
            if self.stops() {
                return None;
            }
            if let Some(id) = jobs.waiting.pop_front() {
                let Some(job) = jobs.jobs.get_mut(&id) else { continue };
                job.state = State::Running;
                job.events.state(State::Running.id());
                return Some(Task {
                    order: job.order.clone(),
                    events: job.events.clone(),
                    cancel: job.cancel.clone(),
                });
            }
            jobs = self.changed.wait(jobs).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Enters the end of a test.
    ///
    /// # Errors
    /// A journal that cannot be written. The test has ended all the same, and is found by its result after a restart.
    pub fn end(&self, id: &str, end: End, now: DateTime<Utc>) -> Result<()> {
        let at = moment(now);
        let written = self.write(&Line::Ended { id: id.to_owned(), at: at.clone(), end: end.clone() });
        self.jobs().end(id, at, end);
        written
    }

    /// Cancels a test: one that waits at once, one that runs by its process. `None` for one that is not known, `false` for one
    /// that has ended.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn cancel(&self, id: &str, now: DateTime<Utc>) -> Result<Option<bool>> {
        let waited = {
            let mut jobs = self.jobs();
            let Some(job) = jobs.jobs.get(id) else { return Ok(None) };
            if !job.state.is_active() {
                return Ok(Some(false));
            }
            job.cancel.store(true, Ordering::SeqCst);
            let before = jobs.waiting.len();
            jobs.waiting.retain(|waiting| waiting != id);
            jobs.waiting.len() < before
        };
        if waited {
            self.end(id, End::Cancelled, now)?;
        }
        Ok(Some(true))
    }

    /// A test.
    pub fn get(&self, id: &str) -> Option<Job> {
        self.jobs().jobs.get(id).cloned()
    }

    /// The tests that are wanted, the last one first, at the most so many.
    pub fn list(&self, most: usize, wanted: impl Fn(&Job) -> bool) -> Vec<Job> {
        self.jobs().jobs.values().rev().filter(|job| wanted(job)).take(most).cloned().collect()
    }

    /// What is asked of every test, the first one first.
    pub fn read<T>(&self, ask: impl FnOnce(std::collections::btree_map::Values<'_, String, Job>) -> T) -> T {
        ask(self.jobs().jobs.values())
    }

    /// The place of a test among those that wait, from 1.
    pub fn place(&self, id: &str) -> Option<usize> {
        Some(self.jobs().waiting.iter().position(|waiting| waiting == id)? + 1)
    }

    /// Ends the workers. Tests that run are ended and made again at the next start.
    pub fn stop(&self) {
        self.stops.store(true, Ordering::SeqCst);
        self.changed.notify_all();
    }

    /// True where the server ends.
    pub fn stops(&self) -> bool {
        self.stops.load(Ordering::SeqCst)
    }
}

impl Jobs {
    fn end(&mut self, id: &str, at: String, end: End) {
        let Some(job) = self.jobs.get_mut(id).filter(|job| job.end.is_none()) else { return };
        job.state = State::after(&end);
        let verdict = match &end {
            End::Done(outcome) => Some(outcome.verdict.id()),
            _ => None,
        };
        job.events.ended(json!({ "state": job.state.id(), "verdict": verdict }));
        job.end = Some((at, end));
        self.ended.push_back(id.to_owned());
        if self.ended.len() > MAX_WHOLE
            && let Some(job) = self.ended.pop_front().and_then(|id| self.jobs.get(&id))
        {
            job.events.shorten();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(serial: &str) -> Test {
        Test { serial: serial.to_owned(), ..Test::default() }
    }

    #[test]
    fn a_restart_loses_and_doubles_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("queue.jsonl");
        let now = DateTime::UNIX_EPOCH;
        let queue = Queue::open(&path).unwrap();
        let ids: Vec<String> =
            ["a", "b", "c", "d"].map(|serial| queue.order(test(serial), now).unwrap().order.id).into();
        assert_eq!(queue.take().unwrap().order.id, ids[0]);
        queue.end(&ids[0], End::Failed { said: "no".to_owned() }, now).unwrap();
        // Taken and not ended, as at a kill.
        assert_eq!(queue.take().unwrap().order.id, ids[1]);
        assert_eq!(queue.cancel(&ids[2], now).unwrap(), Some(true));
        assert_eq!(queue.cancel(&ids[2], now).unwrap(), Some(false));
        assert_eq!(queue.cancel("other", now).unwrap(), None);
        drop(queue);
        let queue = Queue::open(&path).unwrap();
        let states: Vec<State> = ids.iter().map(|id| queue.get(id).unwrap().state).collect();
        assert_eq!(states, [State::Failed, State::Queued, State::Cancelled, State::Queued]);
        assert_eq!(queue.place(&ids[3]), Some(2));
        assert_eq!(queue.take().unwrap().order.id, ids[1]);
        // A second end of a test changes nothing.
        queue.end(&ids[0], End::Cancelled, now).unwrap();
        assert_eq!(queue.get(&ids[0]).unwrap().state, State::Failed);
        assert!(queue.order(test("e"), now).unwrap().order.id.starts_with("000005-"));
        queue.stop();
        assert!(queue.take().is_none());
    }

    #[test]
    fn a_running_test_is_cancelled_by_its_worker() {
        let folder = tempfile::tempdir().unwrap();
        let queue = Queue::open(&folder.path().join("queue.jsonl")).unwrap();
        queue.order(test("a"), DateTime::UNIX_EPOCH).unwrap();
        let task = queue.take().unwrap();
        assert!(!task.is_cancelled());
        assert_eq!(queue.cancel(&task.order.id, DateTime::UNIX_EPOCH).unwrap(), Some(true));
        assert!(task.is_cancelled());
        assert_eq!(queue.get(&task.order.id).unwrap().state, State::Running);
    }
}
