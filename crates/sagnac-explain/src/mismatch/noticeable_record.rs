//! The sizes that would have been noticed, as `explain.json` has them.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The size from which an effect of one kind would have been noticed with a probability of 95 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoticeableSize {
    /// Kind.
    pub kind: String,
    /// Column that it would follow, for a kind that any column can drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// Parameter that says how large.
    pub parameter: String,
    /// Its unit; empty for a pure number and for a coefficient a unit of a column, which is in deg/h a unit of it.
    pub unit: String,
    /// The size, what the claim states taken off. For an effect that is searched: at the typical place, half of the places
    /// ask for less.
    pub size: f64,
    /// What the claim states of the parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub claimed: Option<f64>,
    /// True where the effect is the larger, the smaller the parameter is.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub below: bool,
    /// What such an effect adds to the rate, rms over the record, deg/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_deg_h: Option<f64>,
    /// Other parameters of the typical place, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub at: BTreeMap<String, f64>,
    /// The same at the place that asks for most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<WorstPlace>,
    /// How it was computed.
    pub basis: Basis,
}

/// The place at which an effect must be largest to be noticed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WorstPlace {
    /// The size there.
    pub size: f64,
    /// Parameters of the place, by name.
    pub at: BTreeMap<String, f64>,
}

/// How a size was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// Likelihood of a course in the noise of the record.
    Course,
    /// Expected likelihood of the spectrum.
    Spectrum,
    /// Likelihood of the level of the noise, in single samples.
    Level,
    /// The grid of the values.
    Values,
    /// Counted in the timestamps.
    Timestamps,
}

impl Basis {
    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            Basis::Course => "course",
            Basis::Spectrum => "spectrum",
            Basis::Level => "level",
            Basis::Values => "values",
            Basis::Timestamps => "timestamps",
        }
    }
}

/// A kind whose size that would have been noticed was not computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NotComputed {
    /// Kind.
    pub kind: String,
    /// Why.
    pub reason: WhyNot,
}

/// Why a size was not computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum WhyNot {
    /// It is found in single samples, by a search without a closed form.
    SingleSamples,
    /// No single number tells how large it is.
    NoSingleSize,
    /// Within the values that are possible none is large enough.
    NeverLargeEnough,
}

impl WhyNot {
    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            WhyNot::SingleSamples => "single_samples",
            WhyNot::NoSingleSize => "no_single_size",
            WhyNot::NeverLargeEnough => "never_large_enough",
        }
    }
}
