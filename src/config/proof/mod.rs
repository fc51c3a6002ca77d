//! Proof files: what is concealed of a recording, what is known of it, and the rules by which the answer is judged.

mod read;
pub mod tables;

pub use read::{load, parse};

use crate::effect::Domain;
use crate::i18n::LocalText;
use crate::recording::Channel;
use crate::units::Unit;
use std::path::PathBuf;

/// A proof.
#[derive(Debug, Clone)]
pub struct ProofFile {
    /// Title.
    pub title: LocalText,
    /// What is asked.
    pub question: LocalText,
    /// Where the rows come from.
    pub source: Source,
    /// Seed of the simulation and of added effects.
    pub seed: u64,
    /// Declared columns; empty: found by their names.
    pub channels: Vec<Channel>,
    /// Gyro output.
    pub rate: Option<String>,
    /// Unit of the output where no channels are declared.
    pub unit: Option<String>,
    /// Sample rate, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Consecutive rows of which the mean is taken.
    pub average: usize,
    /// The part of the recording that is used.
    pub part: Part,
    /// Columns that are taken out.
    pub hidden_columns: Vec<String>,
    /// Model whose effects are added to the rate.
    pub added: Option<PathBuf>,
    /// Columns that drive nothing.
    pub decoys: Vec<Decoy>,
    /// The claim.
    pub claim: ClaimSource,
    /// What is known from elsewhere.
    pub references: Vec<Reference>,
    /// The rules.
    pub rules: Vec<Rule>,
}

/// Where the rows come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A file, relative to the folder of data, with its hash.
    File {
        /// Path as written.
        path: String,
        /// SHA-256, hexadecimal.
        sha256: String,
    },
    /// A simulation of what is true.
    Simulated {
        /// Model.
        model: PathBuf,
        /// Length, s.
        duration_s: f64,
    },
}

/// A part of a recording, seconds after its first row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Part {
    /// Beginning, s.
    pub from_s: Option<f64>,
    /// End, s.
    pub to_s: Option<f64>,
}

/// A column that drives nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoy {
    /// Name under which it is shown.
    pub name: String,
    /// Column that it is made from.
    pub of: String,
    /// Shift, s.
    pub shift_s: f64,
}

/// The claim.
#[derive(Debug, Clone, PartialEq)]
pub enum ClaimSource {
    /// A model.
    Model(PathBuf),
    /// What the program identifies.
    Identified {
        /// From which part.
        part: Part,
        /// From which output, where not from the one that is explained.
        rate: Option<String>,
    },
}

/// What is known from elsewhere.
#[derive(Debug, Clone)]
pub struct Reference {
    /// Id.
    pub id: String,
    /// What it is.
    pub what: LocalText,
    /// Interval with its unit.
    pub interval: Option<([f64; 2], Unit)>,
    /// Where it comes from.
    pub source: LocalText,
}

/// Which explanation a rule speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// That of what is shown while something is concealed.
    Concealed,
    /// That with the concealed columns among the decoys.
    Unveiled,
}

impl Shown {
    /// Its word in files.
    pub fn id(self) -> &'static str {
        match self {
            Shown::Concealed => "concealed",
            Shown::Unveiled => "unveiled",
        }
    }
}

/// A rule.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Which explanation it speaks of.
    pub when: Shown,
    /// What must hold.
    pub must: Must,
}

/// What must hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Must {
    /// The verdict is one of these ids.
    Verdict(Vec<&'static str>),
    /// An effect is one of these kinds, or has one of them among its equivalents.
    Name(Vec<String>),
    /// No effect is one of these kinds.
    NotName(Vec<String>),
    /// An effect follows one of these columns.
    Follow(Vec<String>),
    /// No effect follows any of these columns.
    NotFollow(Vec<String>),
    /// A parameter of an effect of these kinds lies in the interval of a reference, by its place among the references.
    Parameter {
        /// Kinds.
        kinds: Vec<String>,
        /// Parameter.
        parameter: String,
        /// Place of the reference.
        reference: usize,
    },
    /// An effect is located in a domain within an interval.
    Locate {
        /// Domain.
        domain: Domain,
        /// Low end.
        low: f64,
        /// High end.
        high: f64,
    },
    /// The inferred course correlates with one of these columns.
    Course {
        /// Columns.
        columns: Vec<String>,
        /// Least correlation, by size.
        at_least: f64,
    },
    /// The mean square of the held-out residual falls by at least this share.
    Improve(f64),
    /// The inferred course holds at least this share of the mean square of what was added.
    Recover(f64),
}
