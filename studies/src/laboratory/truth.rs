//! What is concealed in a case: the truth, as `truth.json` holds it.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The part of the cases that may be looked at, and the part that is looked at only to report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Half {
    /// May be looked at.
    Development,
    /// Only to report.
    HeldOut,
}

impl Half {
    /// Both.
    pub const ALL: [Half; 2] = [Half::Development, Half::HeldOut];

    /// Name in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Half::Development => "development",
            Half::HeldOut => "held-out",
        }
    }
}

/// How much an oracle gains, in nats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// 60 to 300.
    Clear,
    /// 20 to 60.
    Middling,
}

impl Strength {
    /// Both.
    pub const ALL: [Strength; 2] = [Strength::Clear, Strength::Middling];

    /// Name in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Strength::Clear => "clear",
            Strength::Middling => "middling",
        }
    }

    /// Range of the gain.
    pub fn gains(self) -> [f64; 2] {
        match self {
            Strength::Clear => [60.0, 300.0],
            Strength::Middling => [20.0, 60.0],
        }
    }
}

/// Families of subjects, for tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Temperature, with the thermometer in the file.
    Temperature,
    /// Supply and other recorded columns.
    Driver,
    /// What was not recorded, and plain courses of time.
    Unrecorded,
    /// Scale factor, table and clock.
    Table,
    /// Jumps, bursts and lines.
    Event,
    /// Noise levels and processes.
    Noise,
    /// Two or three effects at once.
    Several,
    /// In no catalogue.
    Unknown,
    /// A claim that is right.
    Null,
}

impl Family {
    /// Every family, in the order of tables.
    pub const ALL: [Family; 9] = [
        Family::Temperature,
        Family::Driver,
        Family::Unrecorded,
        Family::Table,
        Family::Event,
        Family::Noise,
        Family::Several,
        Family::Unknown,
        Family::Null,
    ];

    /// Name in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Family::Temperature => "temperature",
            Family::Driver => "driver",
            Family::Unrecorded => "unrecorded",
            Family::Table => "table",
            Family::Event => "event",
            Family::Noise => "noise",
            Family::Several => "several",
            Family::Unknown => "unknown",
            Family::Null => "null",
        }
    }
}

/// Where a contribution lives; ends in the unit of the contract.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Domain of the contract.
    pub domain: String,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

impl Place {
    /// A place.
    pub fn new(domain: &str, from: f64, to: f64) -> Place {
        Place { domain: domain.to_owned(), from: from.min(to), to: from.max(to) }
    }
}

/// One concealed effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Concealed {
    /// Kind of the contract.
    pub kind: String,
    /// What it is in the laboratory.
    pub subject: String,
    /// Kinds that the contract counts as the same thing here, or that describe it as well.
    pub same: Vec<String>,
    /// Kinds of a second entry that the same physics shows, such as the lag of a real thermometer; they are no extra names.
    pub beside: Vec<String>,
    /// Column that drives it.
    pub column: Option<String>,
    /// Law of a driver.
    pub law: Option<String>,
    /// Parameters by the definitions of the contract.
    pub parameters: BTreeMap<String, f64>,
    /// Places that show it; one of them is enough.
    pub places: Vec<Place>,
    /// Gain of the oracle, nats; absent where a gain has no meaning, as for missing rows.
    pub gain: Option<f64>,
    /// Part of the variance of the contribution that can be predicted; absent where nothing can be.
    pub possible: Option<f64>,
    /// True contribution per row, deg/h; empty where nothing is added.
    pub contribution_deg_h: Vec<f64>,
}

/// The truth of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Name of the case.
    pub case: String,
    /// Half.
    pub half: Half,
    /// Family.
    pub family: Family,
    /// Strength; absent for nulls.
    pub strength: Option<Strength>,
    /// Name of the subject.
    pub subject: String,
    /// Columns that drive nothing.
    pub decoys: Vec<String>,
    /// The effects, the stronger first.
    pub concealed: Vec<Concealed>,
}

impl Truth {
    /// Sum of all contributions; empty where nothing is added.
    pub fn contribution(&self) -> Vec<f64> {
        let mut sum: Vec<f64> = vec![];
        for part in &self.concealed {
            if sum.is_empty() {
                sum.clone_from(&part.contribution_deg_h);
            } else {
                sum.iter_mut().zip(&part.contribution_deg_h).for_each(|(s, p)| *s += p);
            }
        }
        sum
    }
}
