//! What devices say, in the order of arrival.

use crate::clock::{Clock, Kind, Stamps, ns};
use crate::fault::Fault;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// Most lines that wait to be taken; a device that is faster waits.
const MAX_WAITING: usize = 1 << 16;
/// Most lines that are taken at once.
const MAX_AT_ONCE: usize = 1 << 12;
/// Longest pause, so that a request to end is heard soon.
const LONGEST_PAUSE: Duration = Duration::from_millis(50);
/// Longest time by the clock of this computer that an emulated bench is waited for.
const TWIN_GRACE: Duration = Duration::from_millis(500);

/// Something that came from a device.
#[derive(Debug)]
pub(crate) struct Item {
    /// Position of the device.
    pub device: usize,
    /// When it arrived, ns.
    pub at_ns: i64,
    /// What it is.
    pub what: What,
}

/// What came.
#[derive(Debug)]
pub(crate) enum What {
    /// A line.
    Line(String),
    /// The link has ended.
    Ended(String),
}

/// A thread's way into the inbox.
#[derive(Debug, Clone)]
pub(crate) struct Sender {
    device: usize,
    stamps: Stamps,
    out: SyncSender<Item>,
}

impl Sender {
    /// Puts something in with the time that it is; false where nobody listens any more.
    pub fn put(&self, what: What) -> bool {
        self.out.send(Item { device: self.device, at_ns: self.stamps.now_ns(), what }).is_ok()
    }
}

/// What devices said and was not taken yet.
#[derive(Debug)]
pub(crate) struct Inbox {
    items: Receiver<Item>,
    out: SyncSender<Item>,
    stamps: Stamps,
    /// Lines of each device so far, and whether it has ended.
    heard: Vec<(String, u64, bool)>,
}

impl Inbox {
    /// An inbox for devices with these ids.
    pub fn new(clock: &Clock, ids: impl Iterator<Item = String>) -> Inbox {
        let (out, items) = sync_channel(MAX_WAITING);
        Inbox { items, out, stamps: clock.stamps(), heard: ids.map(|id| (id, 0, false)).collect() }
    }

    /// The way in for a device.
    pub fn sender(&self, device: usize) -> Sender {
        Sender { device, stamps: self.stamps.clone(), out: self.out.clone() }
    }

    /// The time, ns.
    pub fn now_ns(&self) -> i64 {
        self.stamps.now_ns()
    }

    /// What arrives until a time, or what arrived first. `is_asked`: answers are outstanding, for which the time of an emulated bench
    /// stands still.
    ///
    /// # Errors
    /// An emulated bench that is gone.
    pub fn until(&mut self, clock: &mut Clock, until_ns: i64, is_asked: bool) -> Result<Vec<Item>, Fault> {
        let mut found = vec![];
        match &mut clock.0 {
            Kind::Own(_) => {
                let left = u64::try_from(until_ns.saturating_sub(self.now_ns())).unwrap_or(0);
                self.take(&mut found, Duration::from_nanos(left).min(LONGEST_PAUSE));
            }
            Kind::Twin(_) if is_asked && self.take(&mut found, TWIN_GRACE) => {}
            Kind::Twin(twin) => {
                let to = until_ns.max(self.stamps.now_ns());
                let sent = twin.advance(to).map_err(|e| Fault::Twin { reason: e.to_string() })?;
                let began = Instant::now();
                let lacks = |heard: &[(String, u64, bool)]| {
                    heard.iter().any(|(id, lines, ended)| !ended && sent.get(id).is_some_and(|s| s > lines))
                };
                while lacks(&self.heard) && began.elapsed() < TWIN_GRACE {
                    self.take(&mut found, LONGEST_PAUSE);
                }
            }
        }
        Ok(found)
    }

    /// Waits for something by the clock of this computer alone.
    pub fn within(&mut self, patience: Duration) -> Vec<Item> {
        let mut found = vec![];
        self.take(&mut found, patience);
        found
    }

    /// Takes what there is; false where nothing came in time.
    fn take(&mut self, found: &mut Vec<Item>, patience: Duration) -> bool {
        let first = match self.items.recv_timeout(patience) {
            Ok(item) => item,
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return false,
        };
        let more = std::iter::from_fn(|| self.items.try_recv().ok()).take(MAX_AT_ONCE);
        for item in std::iter::once(first).chain(more) {
            if let Some((_, lines, ended)) = self.heard.get_mut(item.device) {
                match item.what {
                    What::Line(_) => *lines += 1,
                    What::Ended(_) => *ended = true,
                }
            }
            found.push(item);
        }
        true
    }
}

/// A moment that lies a length after another.
pub(crate) fn after(at_ns: i64, length: Duration) -> i64 {
    at_ns.saturating_add(ns(length))
}
