//! What happened: a line of JSON for each event, written at once.

use crate::fault::Fault;
use serde::Serialize;
use std::fs::File;
use std::io::{Result, Write};
use std::path::Path;

/// File of the events.
pub(crate) const EVENTS_FILE: &str = "events.jsonl";

/// An event.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub(crate) enum Event<'a> {
    /// The recording began.
    Begin {
        /// Date and time of the computer, RFC 3339: the only one in a recording.
        at: &'a str,
    },
    /// A device is there.
    Device {
        /// The device.
        device: &'a str,
        /// Name, model and serial number, as far as it tells them.
        name: &'a str,
        /// Model.
        model: &'a str,
        /// Serial number.
        serial: &'a str,
    },
    /// Something was asked for.
    Set {
        /// The device.
        device: &'a str,
        /// The quantity.
        quantity: &'a str,
        /// The value.
        value: f64,
    },
    /// It was reached.
    Reached {
        /// The device.
        device: &'a str,
        /// The quantity.
        quantity: &'a str,
        /// What was asked for.
        value: f64,
    },
    /// A leg of the schedule runs.
    Leg {
        /// Its number.
        number: usize,
        /// Its length, s.
        seconds: f64,
    },
    /// A device told something.
    Told {
        /// The device.
        device: &'a str,
        /// What it is called.
        name: &'a str,
        /// In words.
        text: &'a str,
    },
    /// A line of a device could not be read.
    Unreadable {
        /// The device.
        device: &'a str,
        /// Beginning of the line.
        line: &'a str,
    },
    /// Something went wrong.
    Wrong(&'a Fault),
    /// A device was brought into its safe state, or not.
    Safe {
        /// The device.
        device: &'a str,
        /// What came of it.
        state: &'a str,
    },
    /// The recording ended.
    End {
        /// How.
        how: &'a str,
    },
}

/// The events of a recording.
#[derive(Debug)]
pub(crate) struct Journal(File);

/// An event with its time.
#[derive(Serialize)]
struct Line<'a> {
    t_s: f64,
    #[serde(flatten)]
    event: Event<'a>,
}

impl Journal {
    /// Begins it in a folder.
    ///
    /// # Errors
    /// A file that is there, or a folder that cannot be written.
    pub fn begin(folder: &Path) -> Result<Journal> {
        File::create_new(folder.join(EVENTS_FILE)).map(Journal)
    }

    /// Adds an event, with its time after the beginning, s.
    ///
    /// # Errors
    /// A disk that is full or gone.
    pub fn add(&mut self, t_s: f64, event: Event<'_>) -> Result<()> {
        let mut line = serde_json::to_vec(&Line { t_s, event })?;
        line.push(b'\n');
        self.0.write_all(&line)
    }

    /// Waits until it is on the disk.
    ///
    /// # Errors
    /// A disk that is full or gone.
    pub fn sync(&mut self) -> Result<()> {
        self.0.sync_data()
    }
}
