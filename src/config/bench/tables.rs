//! The tables of a file of a bench.

use crate::config::section::Section;
use crate::config::spec::{Kind, TableSpec, Word};
use crate::config::table::{Table, words};

/// A file of a bench as a whole.
pub static BENCH_FILE: TableSpec = *BenchTables::SPEC;

/// A bench: the devices that `sagnac record` records, and what a schedule may ask of them.
#[derive(Table)]
#[table("", format = "bench/1")]
pub(super) struct BenchTables {
    /// Length of a part of the recording; at most one part is lost by a loss of power.
    #[key(quantity = "s", above = 0, max = 60, default = "60 s", example = "30 s")]
    pub part_s: f64,
    /// The devices, one table each.
    #[key(name = "device", required)]
    pub devices: Vec<DeviceKeys>,
}

/// How a device is reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum LinkWord {
    #[default]
    Command,
    Tcp,
    Udp,
    File,
}

const LINK_WORDS: &[Word] = &[
    ("command", "A program is started: its standard input and output"),
    ("tcp", "A connection to `address`"),
    ("udp", "Datagrams that arrive at `address`"),
    ("file", "Lines that another program appends to the file `path`"),
];

words!(LinkWord, LINK_WORDS, |word: &str| match word {
    "command" => Some(LinkWord::Command),
    "tcp" => Some(LinkWord::Tcp),
    "udp" => Some(LinkWord::Udp),
    "file" => Some(LinkWord::File),
    _ => None,
});

/// What a device speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum LanguageWord {
    #[default]
    Json,
    Text,
}

const LANGUAGE_WORDS: &[Word] = &[
    ("json", "Lines of JSON of the protocol `bench/1`"),
    ("text", "Lines of numbers, as many as there are `columns`, between commas, semicolons or spaces"),
];

words!(LanguageWord, LANGUAGE_WORDS, |word: &str| match word {
    "json" => Some(LanguageWord::Json),
    "text" => Some(LanguageWord::Text),
    _ => None,
});

/// A device.
#[derive(Table)]
#[table("device")]
pub(super) struct DeviceKeys {
    /// Id; the names of its files begin with it.
    #[key(id, example = "table")]
    pub id: String,
    /// True of the unit under test; exactly one device is.
    #[key(default = false, example = true)]
    pub unit_under_test: bool,
    /// How it is reached.
    #[key(default = "command", example = "tcp")]
    pub link: LinkWord,
    /// Host and port: of `tcp`, those of the device; of `udp`, those of this computer.
    #[key(example = "192.168.53.1:9878")]
    pub address: Option<String>,
    /// File of the link `file`, relative to this file.
    #[key(example = "/data/chamber.log")]
    pub path: Option<String>,
    /// Program of the link `command`, with its arguments. It runs in the folder of this file.
    #[key(kind = Kind::Command, example = ["python3", "gyro.py"])]
    pub command: Vec<String>,
    /// What it speaks.
    #[key(default = "json", example = "text")]
    pub language: LanguageWord,
    /// Names of the numbers of a line of text, with their units; `-` leaves one out.
    #[key(example = ["table_angle_deg", "table_rate_deg_s"])]
    pub columns: Vec<String>,
    /// The one of `columns` that is the time by the clock of the device, s.
    #[key(example = "uptime")]
    pub device_time: Option<String>,
    /// Question that a device that speaks text answers with a line of numbers. Default: it speaks unasked.
    #[key(example = ":READ:POS? 1;RATE? 1")]
    pub poll: Option<String>,
    /// How often it is asked.
    #[key(quantity = "s", min = 0.001, max = 3600, default = "1 s", example = "100 ms")]
    pub period_s: f64,
    /// Beginning of the line by which a device that speaks text answers a command. Default: it answers none.
    #[key(example = "OK")]
    pub answer: Option<String>,
    /// Commands that bring a device that speaks text into its safe state. Needed where it moves anything.
    #[key(kind = Kind::Command, example = [":DEM:RATE 1,0", ":MODE:OFF 1"])]
    pub safe: Vec<String>,
    /// Longest silence; a longer one is a fault.
    #[key(quantity = "s", above = 0, max = 86_400, default = "5 s", example = "2 s")]
    pub heartbeat_s: f64,
    /// Longest time until it is there, until it answers, and until it is safe.
    #[key(quantity = "s", above = 0, max = 600, default = "5 s", example = "10 s")]
    pub patience_s: f64,
    /// Change between its clock and that of this computer that is a step.
    #[key(quantity = "s", above = 0, max = 3600, default = "1 s", example = "0.5 s")]
    pub clock_step_s: f64,
    /// What it moves, one table each.
    #[key(name = "move")]
    pub moves: Vec<MoveKeys>,
    #[key(section)]
    pub section: Section,
}

/// Quantities that a bench moves, as schedules name them.
const QUANTITIES: &[Word] = &[
    ("temp_degC", "Temperature of the chamber, degC"),
    ("table_rate_deg_s", "Rate of the table, deg/s"),
    ("table_angle_deg", "Angle of the table, deg"),
    ("supply_v", "Voltage of the supply, V"),
];

/// A quantity that a device moves, and how far. A schedule beyond these limits is refused before anything moves.
#[derive(Table)]
#[table("device.move")]
pub(super) struct MoveKeys {
    /// The quantity.
    #[key(choice = QUANTITIES, required, example = "table_rate_deg_s")]
    pub quantity: Option<&'static str>,
    /// Command of a device that speaks text, with `{value}`.
    #[key(example = ":DEM:RATE 1,{value}")]
    pub send: Option<String>,
    /// Column that tells where it is. Default: the one with the name of the quantity.
    #[key(example = "chamber_temp_degC")]
    pub reads: Option<String>,
    /// Lowest value that may be asked for or read, in the unit of the quantity.
    #[key(example = -200.0)]
    pub lowest: f64,
    /// Highest value.
    #[key(example = 200.0)]
    pub highest: f64,
    /// Largest difference between what is asked for and what is read.
    #[key(above = 0, example = 0.05)]
    pub tolerance: f64,
    /// Longest time with a larger difference; a longer one is a fault.
    #[key(quantity = "s", above = 0, max = 604_800, example = "20 s")]
    pub within_s: f64,
    /// Fastest change that may be asked for, in the unit of the quantity an hour.
    #[key(above = 0, example = 120.0)]
    pub fastest_per_h: Option<f64>,
    /// Value that is set before a schedule begins.
    #[key(example = 5.0)]
    pub begin: Option<f64>,
    #[key(section)]
    pub section: Section,
}
