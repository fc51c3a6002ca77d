//! What goes wrong while a bench is recorded.

use sagnac_base::message::{Arg, Note, note};
use serde::Serialize;

/// What went wrong. Each ends the recording but a step of a clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "fault", rename_all = "snake_case")]
pub enum Fault {
    /// A device cannot be reached.
    Unreachable {
        /// The device.
        device: String,
        /// Why.
        reason: String,
    },
    /// A device did not introduce itself, or not as the file of the bench describes it.
    NoHello {
        /// The device.
        device: String,
        /// What is wrong.
        reason: String,
    },
    /// The connection to a device ended.
    Lost {
        /// The device.
        device: String,
        /// Why.
        reason: String,
    },
    /// A device says nothing.
    Silent {
        /// The device.
        device: String,
        /// Silence, s.
        seconds: f64,
    },
    /// A command was refused or not answered.
    Refused {
        /// The device.
        device: String,
        /// The command.
        command: String,
        /// The answer.
        answer: String,
    },
    /// What was asked for was not reached, or left again.
    NotReached {
        /// The device.
        device: String,
        /// The quantity.
        quantity: String,
        /// What was asked for.
        wanted: f64,
        /// What was read.
        found: f64,
        /// For how long, s.
        seconds: f64,
    },
    /// A reading is beyond the limits.
    BeyondLimit {
        /// The device.
        device: String,
        /// The quantity.
        quantity: String,
        /// What was read.
        found: f64,
        /// The limits.
        limits: [f64; 2],
    },
    /// A device reported a fault.
    Reported {
        /// The device.
        device: String,
        /// What it said.
        text: String,
    },
    /// The recording cannot be written.
    Disk {
        /// The file.
        path: String,
        /// Why.
        reason: String,
    },
    /// The clock of an emulated bench cannot be reached.
    Twin {
        /// Why.
        reason: String,
    },
    /// The clock of a device made a step. The recording goes on by the clock of this computer.
    ClockStep {
        /// The device.
        device: String,
        /// Size, s.
        seconds: f64,
    },
}

impl Fault {
    /// True where it ends the recording.
    pub fn ends(&self) -> bool {
        !matches!(self, Fault::ClockStep { .. })
    }

    /// The fault in words.
    pub fn note(&self) -> Note {
        let seconds_of = |s: &f64| Arg::decimals(*s, 1);
        match self {
            Fault::Unreachable { device, reason } => {
                note!("bench_fault.unreachable", device = device.as_str(), reason = reason.as_str())
            }
            Fault::NoHello { device, reason } => {
                note!("bench_fault.no_hello", device = device.as_str(), reason = reason.as_str())
            }
            Fault::Lost { device, reason } => {
                note!("bench_fault.lost", device = device.as_str(), reason = reason.as_str())
            }
            Fault::Silent { device, seconds } => {
                note!("bench_fault.silent", device = device.as_str(), seconds = seconds_of(seconds))
            }
            Fault::Refused { device, command, answer } => note!(
                "bench_fault.refused",
                device = device.as_str(),
                command = command.as_str(),
                answer = answer.as_str()
            ),
            Fault::NotReached { device, quantity, wanted, found, seconds } => note!(
                "bench_fault.not_reached",
                device = device.as_str(),
                quantity = quantity.as_str(),
                wanted = *wanted,
                found = *found,
                seconds = seconds_of(seconds)
            ),
            Fault::BeyondLimit { device, quantity, found, limits: [low, high] } => note!(
                "bench_fault.beyond_limit",
                device = device.as_str(),
                quantity = quantity.as_str(),
                found = *found,
                low = Arg::Stated(*low),
                high = Arg::Stated(*high)
            ),
            Fault::Reported { device, text } => {
                note!("bench_fault.reported", device = device.as_str(), text = text.as_str())
            }
            Fault::Disk { path, reason } => {
                note!("bench_fault.disk", path = path.as_str(), reason = reason.as_str())
            }
            Fault::Twin { reason } => note!("bench_fault.twin", reason = reason.as_str()),
            Fault::ClockStep { device, seconds } => {
                note!(
                    "bench_fault.clock_step",
                    device = device.as_str(),
                    seconds = Arg::decimals(*seconds, 3)
                )
            }
        }
    }
}
