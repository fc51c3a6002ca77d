//! What is told of a test while it runs: a bounded list of numbered events that a client can take up again.

use serde_json::{Value, json};
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use tokio::sync::watch;

/// Most events of a test that are kept.
const MAX_EVENTS: usize = 256;

/// An event.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Number, from 1.
    pub number: u64,
    /// Its kind: `state`, `progress` or `ended`.
    pub name: &'static str,
    /// What it tells.
    pub data: Value,
}

#[derive(Debug, Default)]
struct Kept {
    events: VecDeque<Event>,
    last: u64,
    is_over: bool,
}

/// The events of a test.
#[derive(Debug)]
pub struct Events {
    kept: Mutex<Kept>,
    last: watch::Sender<u64>,
}

impl Default for Events {
    fn default() -> Events {
        Events { kept: Mutex::default(), last: watch::Sender::new(0) }
    }
}

impl Events {
    fn add(&self, name: &'static str, data: Value, is_over: bool) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.last += 1;
        kept.is_over = is_over;
        let event = Event { number: kept.last, name, data };
        kept.events.push_back(event);
        while kept.events.len() > MAX_EVENTS {
            kept.events.pop_front();
        }
        self.last.send_replace(kept.last);
    }

    /// Tells of a state.
    pub fn state(&self, state: &str) {
        self.add("state", json!({ "state": state }), false);
    }

    /// Tells what the process says.
    pub fn progress(&self, text: &str) {
        self.add("progress", json!({ "text": text }), false);
    }

    /// Tells of the end. Nothing follows.
    pub fn ended(&self, data: Value) {
        self.add("ended", data, true);
    }

    /// Forgets all but the last event.
    pub fn shorten(&self) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let more = kept.events.len().saturating_sub(1);
        kept.events.drain(..more);
        kept.events.shrink_to_fit();
    }

    /// The events after a number, and whether nothing follows. A number that was never given, as that of a server before its
    /// restart, gives all.
    pub fn after(&self, number: u64) -> (Vec<Event>, bool) {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let number = if number > kept.last { 0 } else { number };
        (kept.events.iter().filter(|e| e.number > number).cloned().collect(), kept.is_over)
    }

    /// The last line of progress.
    pub fn last_progress(&self) -> Option<String> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let last = kept.events.iter().rev().find(|e| e.name == "progress")?;
        Some(last.data.get("text")?.as_str()?.to_owned())
    }

    /// Tells of further events.
    pub fn follow(&self) -> watch::Receiver<u64> {
        self.last.subscribe()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_numbered_bounded_and_taken_up_again() {
        let events = Events::default();
        for i in 0..300 {
            events.progress(&i.to_string());
        }
        let (all, over) = events.after(0);
        assert_eq!((all.len(), all[0].number, over), (MAX_EVENTS, 45, false));
        assert_eq!(events.after(299).0.len(), 1);
        assert_eq!(events.after(300).0.len(), 0);
        assert_eq!(events.after(5000).0.len(), MAX_EVENTS);
        assert_eq!(events.last_progress().unwrap(), "299");
        events.ended(json!({ "state": "done" }));
        events.shorten();
        let (all, over) = events.after(0);
        assert_eq!((all.len(), all[0].name, all[0].number, over), (1, "ended", 301, true));
    }
}
