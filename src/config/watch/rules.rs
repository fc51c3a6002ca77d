//! Rules of a watched folder after reading.

use crate::recording::ColumnRef;
use std::path::PathBuf;
use std::time::Duration;

/// Place of the serial number in a pattern.
pub const SERIAL_PLACE: &str = "{serial}";

/// Pause between two looks at a folder without rules.
pub const DEFAULT_POLL: Duration = Duration::from_secs(5);

/// Rules of a watched folder.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchRules {
    /// Pause between two looks at the folder.
    pub poll: Duration,
    /// The rules. The first whose pattern fits a file holds for it.
    pub rules: Vec<WatchRule>,
}

/// A rule: recordings that are tested alike.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchRule {
    /// Pattern of the path of a file below the watched folder.
    pub pattern: String,
    /// Procedure.
    pub procedure: PathBuf,
    /// Limits file.
    pub limits: Option<PathBuf>,
    /// Column of the recording that has the serial number.
    pub serial_column: Option<ColumnRef>,
    /// What tells that a file is complete.
    pub complete: Completeness,
    /// Ending of the name of a marker file.
    pub marker: String,
    /// How long a file stands still that is complete.
    pub after: Duration,
    /// Store that results are kept in.
    pub store: Option<PathBuf>,
    /// Table of units.
    pub unit_data: Option<PathBuf>,
    /// Test station of the recordings.
    pub station: Option<String>,
    /// Command that is told of each verdict, with its arguments; empty without one.
    pub hook: Vec<String>,
}

/// What tells that a file is complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Completeness {
    /// It does not change for a stated time, and its end is not cut off.
    #[default]
    Still,
    /// A marker file stands beside it.
    Marker,
    /// Its format ends with a footer, which is there.
    Footer,
    /// Its name is there: the writer renames a file when it is complete.
    Name,
}

impl WatchRule {
    /// True where the pattern selects the serial number.
    pub fn names_serial(&self) -> bool {
        self.pattern.contains(SERIAL_PLACE)
    }
}
