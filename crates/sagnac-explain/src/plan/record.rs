//! What a plan says, as `plan.json` has it.

use crate::schedule::Schedule;
use serde::{Deserialize, Serialize};

/// Version of `plan.json`.
pub const PLAN_FORMAT: &str = "plan/1";

/// The document `plan.json`. Format `plan/1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// `plan/1`
    pub format: String,
    /// The case that the claim names.
    pub case: String,
    /// What it comes to.
    pub outcome: PlanOutcome,
    /// Probability of deciding that was asked for.
    pub asked: f64,
    /// Time at hand, h.
    pub budget_h: f64,
    /// The causes with more than one explanation, each with its alternatives.
    pub causes: Vec<CausePlan>,
    /// What to do; `None` where nothing is to be told apart or nothing tells it apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub schedule: Option<PlannedSchedule>,
    /// Schedules that were compared, the best first; the first is the one that was chosen.
    pub candidates: Vec<CandidateSchedule>,
    /// Length, h, at which the schedule, repeated, decides; where the budget is too small and some length will do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub needed_h: Option<f64>,
    /// Columns that were not recorded and could be what an explanation follows.
    pub to_record: Vec<String>,
}

/// What a plan comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PlanOutcome {
    /// The schedule tells every pair apart with the probability asked for.
    Decides,
    /// The schedule is the best within the budget, and decides with a smaller probability.
    TooShort,
    /// No schedule within the limits tells the alternatives apart.
    Undecidable,
    /// There is one explanation of each cause.
    NothingToDecide,
}

impl PlanOutcome {
    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            PlanOutcome::Decides => "decides",
            PlanOutcome::TooShort => "too_short",
            PlanOutcome::Undecidable => "undecidable",
            PlanOutcome::NothingToDecide => "nothing_to_decide",
        }
    }
}

/// A cause with more than one explanation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CausePlan {
    /// Its place among the effects of the explanation, counted from 1.
    pub cause: usize,
    /// Its explanations, the chosen one first.
    pub alternatives: Vec<AlternativePlan>,
    /// Every pair under the schedule.
    pub pairs: Vec<PairPlan>,
}

/// An explanation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AlternativePlan {
    /// Its effect.
    pub kind: String,
    /// The effect that a later recording shows of it, if it is true; `None` where it shows nothing.
    pub shows_as: Option<String>,
    /// Probability that an explanation of the planned recording names it, and it alone, if it is true.
    pub probability: f64,
    /// Probability that it is found at all, if it is true.
    pub found: f64,
}

/// Two explanations under the schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairPlan {
    /// The one that is true.
    pub truth: String,
    /// The other.
    pub against: String,
    /// Squared distance of the two in deviations of the noise.
    pub squared_distance: f64,
    /// Probability that ΔBIC is at least 6 in favour of the true one.
    pub probability: f64,
    /// What decides.
    pub contrast: Contrast,
}

/// What of a schedule tells two explanations apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Contrast {
    /// Heating against cooling at one rate, °C/h.
    HeatingAndCooling {
        /// Rate, °C/h.
        #[serde(rename = "rate_degC_per_h")]
        rate_degc_per_h: f64,
    },
    /// Ramps of several rates, °C/h.
    RampRates {
        /// The slowest.
        #[serde(rename = "slowest_degC_per_h")]
        slowest_degc_per_h: f64,
        /// The fastest.
        #[serde(rename = "fastest_degC_per_h")]
        fastest_degc_per_h: f64,
    },
    /// Ramps against the soaks after them.
    RampAndSoak {
        /// Rate of the ramps, °C/h.
        #[serde(rename = "rate_degC_per_h")]
        rate_degc_per_h: f64,
    },
    /// Rates of the table of both signs.
    SignsOfRate {
        /// The largest, deg/s.
        largest_deg_s: f64,
    },
    /// Rates of the table of several sizes.
    SizesOfRate {
        /// The smallest, deg/s.
        smallest_deg_s: f64,
        /// The largest, deg/s.
        largest_deg_s: f64,
    },
    /// Angles of the table.
    Headings {
        /// How many.
        count: usize,
    },
    /// The length of the record alone.
    Length {
        /// h.
        hours: f64,
    },
    /// Nothing in it tells them apart.
    Nothing,
}

impl Contrast {
    /// Its id in files.
    pub fn id(&self) -> &'static str {
        match self {
            Contrast::HeatingAndCooling { .. } => "heating_and_cooling",
            Contrast::RampRates { .. } => "ramp_rates",
            Contrast::RampAndSoak { .. } => "ramp_and_soak",
            Contrast::SignsOfRate { .. } => "signs_of_rate",
            Contrast::SizesOfRate { .. } => "sizes_of_rate",
            Contrast::Headings { .. } => "headings",
            Contrast::Length { .. } => "length",
            Contrast::Nothing => "nothing",
        }
    }
}

/// The schedule that was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlannedSchedule {
    /// What to do.
    pub schedule: Schedule,
    /// Length, h.
    pub duration_h: f64,
    /// Smallest probability of naming the true explanation alone, over all of them.
    pub probability: f64,
}

/// A schedule that was compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CandidateSchedule {
    /// What to do.
    pub schedule: Schedule,
    /// Length, h.
    pub duration_h: f64,
    /// For each alternative of each cause, in their order, the probability of naming it alone if it is true.
    pub probabilities: Vec<f64>,
}
