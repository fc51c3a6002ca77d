//! Faults of a recording, as a result holds them.

use super::Message;
use crate::i18n::{Lang, Localize, Note};
use sagnac_core::recording::integrity::{Fault, Integrity as OfCore};
use serde::{Deserialize, Serialize};

/// Faults of the recording, counted; the first of each kind listed with row and time.
pub type Integrity = OfCore<FaultText>;

/// One fault.
pub type FaultRecord = Fault<FaultText>;

/// The sentence of a fault.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct FaultText {
    /// What was seen, English.
    pub note: String,
    /// The same sentence by name, for other languages.
    #[cfg_attr(feature = "schema", schemars(with = "serde_json::Value"))]
    pub message: Option<Message>,
}

impl From<Note> for FaultText {
    fn from(note: Note) -> FaultText {
        FaultText { note: note.say(Lang::En), message: Some(note.into()) }
    }
}
