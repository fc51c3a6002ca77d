//! Checks that a kind of test could make, and whether they were made.

use super::Message;
use serde::{Deserialize, Serialize};

/// Whether a check was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum CheckStatus {
    /// It was carried out; what it found stands in the conditions.
    Made,
    /// It was not, and `reason` says why.
    NotMade,
}

/// One check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CheckRecord {
    /// Id, for example `earth_rate`.
    pub id: String,
    /// Channel it was to be made on, where it is made channel by channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// Phase that it is of, in a test of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Whether it was made.
    pub status: CheckStatus,
    /// Why it was not made.
    pub reason: Option<Message>,
    /// Where its finding stands: the id of a condition, or `integrity`.
    pub evidence: Option<String>,
}
