//! A recording as the analysis sees it: channels with role and unit, delivered as sample blocks of contiguous samples.
//!
//! A recording is never held as a whole: readers deliver blocks, the time base turns them into [`SampleBlock`]s without a gap
//! inside, and every consumer is a [`Sink`] that takes sample blocks.

pub mod integrity;
pub mod sensor;
pub mod window;

use crate::units::Unit;
use serde::{Deserialize, Serialize};

/// What a channel measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Time stamps.
    Time,
    /// Sample counter: grows by one a sample.
    Counter,
    /// Angular rate about an input axis; inside: deg/h.
    Rate,
    /// Angle turned during the sample interval, or counts of it; inside: turned into deg/h by the sample interval.
    AngleIncrement,
    /// Angle turned since the beginning, as an integrating gyro logs it; inside: differenced into deg/h.
    AccumulatedAngle,
    /// A temperature; inside: degC.
    Temperature,
    /// Rate of the table about the input axis; inside: deg/h.
    TableRate,
    /// Table angle; inside: arcsec.
    TableAngle,
    /// Rate of the table's other axis; inside: deg/h.
    OuterRate,
    /// Supply voltage; inside: V.
    Supply,
    /// Magnetic field; inside: mT.
    MagneticField,
    /// Vibration, rms of the acceleration; inside: g.
    Vibration,
    /// Acceleration along the x axis of the unit; inside: g.
    AccelerationX,
    /// Acceleration along the y axis of the unit; inside: g.
    AccelerationY,
    /// Acceleration along the z axis of the unit; inside: g.
    AccelerationZ,
    /// Pressure around the unit; inside: kPa.
    Pressure,
    /// Relative humidity; inside: %.
    Humidity,
    /// Supply current; inside: A.
    Current,
    /// Status word, of which each bit tells a state; inside: as recorded.
    Status,
    /// Pulse of every second, or a count of them; inside: as recorded.
    Pps,
    /// Anything else that is kept beside; inside: as recorded.
    Auxiliary,
}

impl Role {
    /// The id used in procedures and results.
    pub fn id(self) -> &'static str {
        match self {
            Role::Time => "time",
            Role::Counter => "counter",
            Role::Rate => "rate",
            Role::AngleIncrement => "angle_increment",
            Role::AccumulatedAngle => "accumulated_angle",
            Role::Temperature => "temperature",
            Role::TableRate => "table_rate",
            Role::TableAngle => "table_angle",
            Role::OuterRate => "outer_rate",
            Role::Supply => "supply",
            Role::MagneticField => "magnetic_field",
            Role::Vibration => "vibration",
            Role::AccelerationX => "acceleration_x",
            Role::AccelerationY => "acceleration_y",
            Role::AccelerationZ => "acceleration_z",
            Role::Pressure => "pressure",
            Role::Humidity => "humidity",
            Role::Current => "current",
            Role::Status => "status",
            Role::Pps => "pps",
            Role::Auxiliary => "auxiliary",
        }
    }

    /// Every role, in the order of the documentation.
    pub const ALL: &'static [Role] = &[
        Role::Time,
        Role::Counter,
        Role::Rate,
        Role::AngleIncrement,
        Role::AccumulatedAngle,
        Role::Temperature,
        Role::TableRate,
        Role::TableAngle,
        Role::OuterRate,
        Role::Supply,
        Role::MagneticField,
        Role::Vibration,
        Role::AccelerationX,
        Role::AccelerationY,
        Role::AccelerationZ,
        Role::Pressure,
        Role::Humidity,
        Role::Current,
        Role::Status,
        Role::Pps,
        Role::Auxiliary,
    ];

    /// The unit that values of this role have inside the program; `None`: as recorded.
    pub fn internal_unit(self) -> Option<&'static str> {
        match self {
            Role::Time => Some("s"),
            Role::Rate | Role::TableRate | Role::OuterRate => Some("deg/h"),
            Role::AngleIncrement | Role::AccumulatedAngle | Role::TableAngle => Some("arcsec"),
            Role::Temperature => Some("degC"),
            Role::Supply => Some("V"),
            Role::MagneticField => Some("mT"),
            Role::Vibration | Role::AccelerationX | Role::AccelerationY | Role::AccelerationZ => Some("g"),
            Role::Pressure => Some("kPa"),
            Role::Humidity => Some("%"),
            Role::Current => Some("A"),
            Role::Counter | Role::Status | Role::Pps | Role::Auxiliary => None,
        }
    }

    /// True for the roles that deliver a gyro output.
    pub fn is_gyro(self) -> bool {
        matches!(self, Role::Rate | Role::AngleIncrement | Role::AccumulatedAngle)
    }
}

/// Which column of a file a channel is read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// By the name in the header.
    Name(String),
    /// By position, counted from 1.
    Position(usize),
}

/// One channel of a recording: a column and what it is taken for.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Id in results, for example `rate`, `x`, `housing`.
    pub id: String,
    /// Column it is read from.
    pub column: ColumnRef,
    /// What it measures.
    pub role: Role,
    /// Unit of the numbers in the file (after `scale`).
    pub unit: Unit,
    /// Factor from the number in the file to `unit`: the size of a count, or −1 for a reversed axis. 1 otherwise.
    pub scale: f64,
}

/// Contiguous samples of every channel: no gap inside.
#[derive(Debug, Clone, Copy)]
pub struct SampleBlock<'a> {
    /// Position of the first sample on the uniform grid of the recording (0: first sample; a gap skips positions).
    pub first_index: u64,
    /// Row of the first sample in the file, counted from 1 without header lines.
    pub first_row: u64,
    /// Time of the first sample on the recording's own scale, s.
    pub time_s: f64,
    /// True when this sample block follows the one before without a gap.
    pub continues: bool,
    /// One vector a channel, all of one length, in inside units; NaN where the value cannot be used.
    pub values: &'a [Vec<f64>],
}

impl SampleBlock<'_> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A consumer of sample blocks.
pub trait Sink {
    /// Takes the next sample block.
    fn push(&mut self, block: &SampleBlock<'_>);
}

/// Two sinks that take the same blocks.
impl<A: Sink, B: Sink> Sink for (A, B) {
    fn push(&mut self, block: &SampleBlock<'_>) {
        self.0.push(block);
        self.1.push(block);
    }
}
