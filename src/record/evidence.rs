//! How it is known that something was as it is said to have been.

use serde::{Deserialize, Serialize};

/// What stands behind a condition or a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// A channel, a stamp or a field of the recording tells it.
    Recorded,
    /// It is inferred from what it did to the output.
    Inferred,
    /// The procedure, or who ran the test, states it; nothing in the recording shows it.
    Declared,
}

impl Evidence {
    /// Id, as in a result.
    pub fn id(self) -> &'static str {
        match self {
            Evidence::Recorded => "recorded",
            Evidence::Inferred => "inferred",
            Evidence::Declared => "declared",
        }
    }
}
