//! A proof: what was concealed of a recording, what the engine said of the rest, what is true, and which rules held.

use super::explanation::Explanation;
use super::{Message, Program};
use crate::i18n::LocalText;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the format of a proof.
pub const PROOF_FORMAT: &str = "proof-result/1";

/// A whole proof, as `proof.json` holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProofRecord {
    /// Always `proof-result/1`.
    pub format: String,
    /// The program that wrote this; the engine is the same program in a process of its own.
    pub program: Program,
    /// The proof file, as named.
    pub path: String,
    /// SHA-256 of the proof file.
    pub sha256: String,
    /// Title.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<String>"))]
    pub title: LocalText,
    /// What is asked.
    #[serde(flatten, with = "super::local::description")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::description::Members<String>"))]
    pub question: LocalText,
    /// When the proof was made, RFC 3339.
    pub proved_at: String,
    /// What it comes to.
    pub outcome: ProofOutcome,
    /// The recording.
    pub recording: ProofRecording,
    /// What was concealed.
    pub hidden: Vec<Hidden>,
    /// Where the claim comes from.
    pub claim: ClaimOrigin,
    /// True where the kernel kept the engine from opening anything but its folder and the libraries of the system; else it was
    /// only started in an empty folder.
    pub confined: bool,
    /// What was done, in its order.
    pub protocol: Vec<ProtocolStep>,
    /// What the engine said while something was concealed.
    pub concealed: Explanation,
    /// What it said with the concealed columns shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unveiled: Option<Explanation>,
    /// The inferred course against everything that was concealed.
    pub courses: Vec<CourseRecord>,
    /// What is known from elsewhere.
    pub references: Vec<KnownRecord>,
    /// The rules of the proof file, in their order.
    pub rules: Vec<RuleRecord>,
}

/// What a proof comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ProofOutcome {
    /// Every rule holds.
    Holds,
    /// A rule does not hold.
    Fails,
}

/// The recording of a proof.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProofRecording {
    /// File, as named in the proof; for a simulation, its model.
    pub path: String,
    /// SHA-256 of that file.
    pub sha256: String,
    /// True for a simulation of what is true.
    pub simulated: bool,
    /// Rows that are used.
    pub rows: usize,
    /// Their sample interval, s.
    pub sample_interval_s: f64,
    /// Columns that stayed beside time and rate.
    pub shown: Vec<String>,
    /// Columns that drive nothing, shown with the concealed ones.
    pub decoys: Vec<String>,
}

/// Something that was concealed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Hidden {
    /// Name of the column, or the kinds of the effects.
    pub name: String,
    /// What it is.
    pub what: HiddenKind,
    /// SHA-256 of its values, written one a line with the shortest digits that give the number; of a simulation, of its model.
    pub sha256: String,
}

/// What was concealed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HiddenKind {
    /// A column of the recording.
    Column,
    /// Effects that were added to its rate.
    Added,
    /// The effects of a simulation.
    Simulated,
}

/// Where a claim comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ClaimOrigin {
    /// A model that the proof names.
    Model,
    /// The program, from a part of what is shown.
    Part,
    /// The program, from another output.
    OtherOutput,
}

/// A step of a proof.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProtocolStep {
    /// What was done: `concealed`, `shown`, `claim`, `explained`, `unveiled`, `explained_again`.
    pub step: String,
    /// SHA-256 by what it is of: concealed values, files in the folder of the engine, files that it wrote.
    pub sha256: BTreeMap<String, String>,
    /// SHA-256 of the step before, as one line of JSON; empty for the first.
    pub previous: String,
}

/// An inferred course against something that was concealed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CourseRecord {
    /// What it is held against.
    pub name: String,
    /// Correlation.
    pub correlation: f64,
    /// Lag at which the correlation is largest by size, s; positive where the inferred course comes later.
    pub lag_s: f64,
    /// Correlation at that lag.
    pub correlation_at_lag: f64,
    /// Of effects that were added: the share of their mean square that is in the inferred course.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recovered_share: Option<f64>,
}

/// Something known from elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct KnownRecord {
    /// Id.
    pub id: String,
    /// What it is.
    #[serde(flatten, with = "super::local::name")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::name::Members<String>"))]
    pub what: LocalText,
    /// Interval.
    pub interval: Option<[f64; 2]>,
    /// Unit of the interval.
    pub unit: Option<String>,
    /// Where it comes from.
    #[serde(flatten, with = "super::local::source")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::source::Members<String>"))]
    pub source: LocalText,
    /// What was found for it, in its unit.
    pub found: Option<FoundValue>,
}

/// A value that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FoundValue {
    /// Explanation in which it was found: `concealed` or `unveiled`.
    pub when: String,
    /// Effect.
    pub kind: String,
    /// Value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// A rule and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RuleRecord {
    /// Explanation that it speaks of: `concealed` or `unveiled`.
    pub when: String,
    /// What must hold, in words.
    pub must: Message,
    /// What was found, in words.
    pub found: Message,
    /// Whether it holds.
    pub holds: bool,
}
