//! What a procedure states of such a test.

use crate::recording::Role;

/// A stretch of the recording: the files of a phase, or a span of time, or both.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stated {
    /// Phase of a manifest.
    pub phase: Option<String>,
    /// Start, s from the start of the recording.
    pub from_s: Option<f64>,
    /// End, s from the start of the recording.
    pub to_s: Option<f64>,
}

/// A series of switching off and on.
#[derive(Debug, Clone, PartialEq)]
pub struct RepeatabilityTest {
    /// Time after switching on that is left out of every run, s.
    pub settling_s: f64,
    /// Least length of a run without its settling, s.
    pub minimum_run_s: f64,
    /// Least time without output that divides two runs of one file, s.
    pub off_s: f64,
    /// Runs that there must be at least.
    pub fewest: usize,
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// The runs; empty: every file is one, or every stretch between times without output.
    pub runs: Vec<Stated>,
}

/// The influence that is changed on purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Influence {
    /// Magnetic field, mT.
    MagneticField,
    /// Supply voltage, V.
    Supply,
    /// Vibration, rms acceleration, g.
    Vibration,
}

impl Influence {
    /// Every influence.
    pub const ALL: [Influence; 3] = [Influence::MagneticField, Influence::Supply, Influence::Vibration];

    /// Id; also that of the role of its channels.
    pub fn id(self) -> &'static str {
        self.role().id()
    }

    /// Role of the channels that tell its level.
    pub fn role(self) -> Role {
        match self {
            Influence::MagneticField => Role::MagneticField,
            Influence::Supply => Role::Supply,
            Influence::Vibration => Role::Vibration,
        }
    }

    /// Table of a procedure that asks for the test.
    pub fn table(self) -> &'static str {
        match self {
            Influence::MagneticField => "magnetic_test",
            Influence::Supply => "supply_test",
            Influence::Vibration => "vibration_test",
        }
    }

    /// Unit of its level.
    pub fn unit(self) -> &'static str {
        match self {
            Influence::MagneticField => "mT",
            Influence::Supply => "V",
            Influence::Vibration => "g",
        }
    }

    /// The quantity that the bias is proportional to: the level itself, or its square for vibration, which is rectified.
    pub fn drive(self, level: f64) -> f64 {
        if self == Influence::Vibration { level * level } else { level }
    }

    /// Relative uncertainty of the drive per relative uncertainty of the level.
    pub fn degree(self) -> f64 {
        if self == Influence::Vibration { 2.0 } else { 1.0 }
    }
}

/// An interval at a level.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedLevel {
    /// Where it stands in the recording.
    pub stretch: Stated,
    /// Level, unit of the influence.
    pub level: f64,
    /// Axis that it acts along, where several are tested.
    pub axis: Option<String>,
}

/// A comparison without and with an influence.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonTest {
    /// The influence that is changed.
    pub influence: Influence,
    /// Level that counts as without.
    pub reference: f64,
    /// Time after a change of level that is left out, s.
    pub settling_s: f64,
    /// Least length of an interval without its settling, s.
    pub minimum_interval_s: f64,
    /// Intervals with the influence, each between two without, that there must be at least.
    pub alternations: usize,
    /// Standard uncertainty of the level, relative.
    pub level_uncertainty: f64,
    /// Largest difference of temperature between without and with, degC.
    pub temperature_difference_deg_c: f64,
    /// Largest temperature coefficient that the bias may have, deg/h/degC; `None`: not stated.
    pub temperature_coefficient: Option<f64>,
    /// True where the procedure takes it for granted that the influence acted as stated.
    pub declared: bool,
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// The intervals; empty: found from the channels of the influence's role.
    pub intervals: Vec<StatedLevel>,
}
