//! What a bench consists of.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

/// A bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// Length of a part of the recording.
    pub part: Duration,
    /// The devices. Exactly one is the unit.
    pub devices: Vec<Device>,
}

/// A device.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// Its id, which names its files.
    pub id: String,
    /// True of the unit under test, whose rows are those of the recording.
    pub is_unit: bool,
    /// How it is reached.
    pub link: Link,
    /// What it speaks.
    pub language: Language,
    /// Longest silence.
    pub heartbeat: Duration,
    /// Longest time until it is there, and until it answers a command.
    pub patience: Duration,
    /// Change between its clock and that of this computer that is a step.
    pub clock_step: Duration,
    /// What it can be asked to move.
    pub demands: Vec<Demand>,
    /// True where it can be brought into a safe state.
    pub has_safe_state: bool,
}

/// How a device is reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Link {
    /// A connection to `host:port`.
    Tcp(String),
    /// Datagrams that arrive at an address of this computer.
    Udp(String),
    /// Lines that are appended to a file.
    File(PathBuf),
    /// A program that is started: its standard input and output.
    Command {
        /// The program with its arguments.
        words: Vec<String>,
        /// Folder that it runs in.
        folder: PathBuf,
    },
}

/// What a device speaks.
#[derive(Debug, Clone, PartialEq)]
pub enum Language {
    /// JSON of the protocol `bench/1`; the device says what it has.
    Json,
    /// Lines with numbers.
    Text(Text),
}

/// A device that speaks lines with numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text {
    /// Names of the columns of a line, `-` for one that is left out.
    pub columns: Vec<String>,
    /// The column that is the time of the device, s.
    pub device_time: Option<String>,
    /// What is asked for a line; empty for a device that speaks unasked.
    pub poll: String,
    /// How often it is asked.
    pub period: Duration,
    /// Beginning of the answer to a command; `None`: commands are not answered.
    pub answer: Option<String>,
    /// Commands that bring it into a safe state.
    pub safe: Vec<String>,
}

/// Place of the value in a command.
pub const VALUE_PLACE: &str = "{value}";

/// A quantity that a device moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// Name with its unit, as a schedule has it: `temp_degC`, `table_rate_deg_s`, `table_angle_deg`, `supply_v`.
    pub quantity: String,
    /// Command with [`VALUE_PLACE`]; of a device that speaks JSON, empty.
    pub send: String,
    /// Column that says where it is.
    pub reads: String,
    /// Lowest and highest value that may be asked for, and that may be read.
    pub limits: [f64; 2],
    /// Largest difference between what is asked for and what is read.
    pub tolerance: f64,
    /// Longest time beyond it.
    pub within: Duration,
    /// Fastest change that may be asked for, in the unit of the quantity an hour.
    pub fastest_per_h: Option<f64>,
    /// Value that is set before anything else.
    pub begin: Option<f64>,
    /// True of an angle that repeats after 360 degrees.
    pub is_angle: bool,
}

impl Demand {
    /// Distance between what is asked for and what is read.
    pub fn distance(&self, wanted: f64, found: f64) -> f64 {
        let straight = (wanted - found).abs();
        if self.is_angle {
            let turned = straight.rem_euclid(360.0);
            return turned.min(360.0 - turned);
        }
        straight
    }

    /// True where a value is within the limits.
    pub fn allows(&self, value: f64) -> bool {
        let [low, high] = self.limits;
        (low..=high).contains(&value)
    }

    /// True where a reading is within the limits, or beyond them by no more than the tolerance.
    pub fn tolerates(&self, found: f64) -> bool {
        let [low, high] = self.limits;
        // An angle is read as 0 to 360 deg, whatever was asked for.
        self.is_angle || (low - self.tolerance..=high + self.tolerance).contains(&found)
    }
}

impl Bench {
    /// The device and the demand of each quantity that can be moved.
    pub fn demands(&self) -> BTreeMap<&str, (&Device, &Demand)> {
        self.devices
            .iter()
            .flat_map(|device| {
                device.demands.iter().map(move |demand| (demand.quantity.as_str(), (device, demand)))
            })
            .collect()
    }

    /// What is set before a schedule begins.
    pub fn begin(&self) -> BTreeMap<String, f64> {
        let demands = self.devices.iter().flat_map(|device| &device.demands);
        demands.filter_map(|demand| Some((demand.quantity.clone(), demand.begin?))).collect()
    }
}
