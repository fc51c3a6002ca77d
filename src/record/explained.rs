//! A recording against the model of its family.

use super::Message;
use super::explanation::Explanation;
use serde::{Deserialize, Serialize};

/// A recording against the model of its family.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExplainedRecord {
    /// The model.
    pub model: String,
    /// What came of it.
    pub explanation: Option<Explanation>,
    /// Why nothing came of it.
    pub error: Option<Message>,
}
