//! Long work: without the lock of the interpreter, with progress, and ended by Ctrl-C.

use crate::errors::raised;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use sagnac::Error;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How often signals are looked at.
const SIGNAL_POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Shortest time between two calls of the user's function.
const BETWEEN_CALLS: Duration = Duration::from_millis(50);

/// How far the work is: what is being done, and how much of it, 0 to 1.
struct Told {
    doing: &'static str,
    share: f64,
}

/// What ends the work when the user interrupts it.
struct Interrupted;

/// Tells how far the work is; it ends there when the user has interrupted it.
pub struct Teller {
    to: Sender<Told>,
    interrupted: Arc<AtomicBool>,
    last: Option<Instant>,
}

impl Teller {
    /// Parts done of parts in all.
    pub fn tell(&mut self, doing: &'static str, done: u64, total: u64) {
        if self.interrupted.load(Ordering::Relaxed) {
            // No error leads out of every loop of the analysis; unwinding does, and frees what it holds.
            resume_unwind(Box::new(Interrupted));
        }
        let due = self.last.is_none_or(|last| last.elapsed() >= BETWEEN_CALLS) || done >= total;
        if due {
            self.last = Some(Instant::now());
            let share = if total > 0 { done as f64 / total as f64 } else { 0.0 };
            // Nobody listens where the caller was interrupted: the next call ends the work.
            let _ = self.to.send(Told { doing, share: share.clamp(0.0, 1.0) });
        }
    }
}

/// Does work on a thread of its own. Meanwhile other Python threads run, the function `progress` is called with what is being done
/// and with a share from 0 to 1, and signals are looked at ten times a second: Ctrl-C raises at once, and the work ends where it
/// next tells how far it is.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut Teller) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let (to, from) = channel();
    let interrupted = Arc::new(AtomicBool::new(false));
    let mut teller = Teller { to, interrupted: Arc::clone(&interrupted), last: None };
    let worker = thread::Builder::new()
        .name("sagnac".to_owned())
        .spawn(move || catch_unwind(AssertUnwindSafe(move || work(&mut teller))))?;
    let mut from = from;
    loop {
        let told;
        (told, from) = py.detach(move || (from.recv_timeout(SIGNAL_POLL_INTERVAL), from));
        let stop = |e: PyErr| {
            interrupted.store(true, Ordering::Relaxed);
            e
        };
        match told {
            Ok(told) => {
                if let Some(progress) = &progress {
                    progress.call1(py, (told.doing, told.share)).map_err(stop)?;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        py.check_signals().map_err(stop)?;
    }
    match py.detach(|| worker.join()) {
        Ok(Ok(Ok(value))) => Ok(value),
        Ok(Ok(Err(error))) => Err(raised(py, &error)),
        Ok(Err(_)) | Err(_) => {
            Err(PyRuntimeError::new_err("internal error of sagnac: the analysis ended early"))
        }
    }
}
