//! A test that was ordered, and its end.

use crate::harness::Outcome;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A test that was ordered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Id: a number that grows, and random digits.
    pub id: String,
    /// When it was ordered, RFC 3339.
    pub ordered_at: String,
    /// What is tested by what.
    #[serde(flatten)]
    pub test: Test,
}

/// What is tested by what.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Serial number.
    pub serial: String,
    /// Part number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Lot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lot: Option<String>,
    /// Operator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operator: Option<String>,
    /// Why the unit is tested again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The recording, where it really is.
    pub path: PathBuf,
    /// The recording as it was named.
    pub recording: String,
    /// Procedure: a path, or the name of a shipped one.
    pub procedure: PathBuf,
    /// Limits: a path, or the name of shipped ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<PathBuf>,
}

impl Test {
    /// The procedure as a page names it.
    pub fn procedure_name(&self) -> String {
        stem(&self.procedure)
    }

    /// The limits as a page names them; empty without any.
    pub fn limits_name(&self) -> String {
        self.limits.as_deref().map(stem).unwrap_or_default()
    }
}

fn stem(path: &std::path::Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The end of a test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// There is a result.
    Done(Outcome),
    /// There is none: what the process said.
    Failed {
        /// The end of its messages.
        said: String,
    },
    /// It was cancelled.
    Cancelled,
}

/// Where a test is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Waits for a process.
    Queued,
    /// Has a process.
    Running,
    /// Has a result.
    Done,
    /// Ended without a result.
    Failed,
    /// Was cancelled.
    Cancelled,
}

impl State {
    /// Its id in answers and texts.
    pub fn id(self) -> &'static str {
        match self {
            State::Queued => "queued",
            State::Running => "running",
            State::Done => "done",
            State::Failed => "failed",
            State::Cancelled => "cancelled",
        }
    }

    /// True for a test that has not ended.
    pub fn is_active(self) -> bool {
        matches!(self, State::Queued | State::Running)
    }

    /// The state after an end.
    pub fn after(end: &End) -> State {
        match end {
            End::Done(_) => State::Done,
            End::Failed { .. } => State::Failed,
            End::Cancelled => State::Cancelled,
        }
    }
}
