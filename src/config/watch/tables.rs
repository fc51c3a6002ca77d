//! The tables of a file of watch rules.

use super::rules::{Completeness, WatchRule};
use crate::config::section::Section;
use crate::config::spec::{Kind, TableSpec, Word};
use crate::config::table::{Table, empty, words};
use crate::recording::ColumnRef;
use std::path::PathBuf;
use std::time::Duration;

/// A file of watch rules as a whole.
pub static WATCH_FILE: TableSpec = *WatchTables::SPEC;

/// Pattern of every file of a folder.
pub(super) const EVERY_FILE: &str = "*";

/// What may tell that a file is complete.
const COMPLETENESS_WORDS: &[Word] = &[
    ("still", "Size and time of change stand still for `after`, and the end of the recording is not cut off"),
    ("marker", "A file of the same name with the ending `marker` stands beside it"),
    ("footer", "The format ends with a footer (Parquet, MCAP), and it is there"),
    ("name", "The name is there: the writer gives it to the complete file"),
];

words!(Completeness, COMPLETENESS_WORDS, |word: &str| match word {
    "still" => Some(Completeness::Still),
    "marker" => Some(Completeness::Marker),
    "footer" => Some(Completeness::Footer),
    "name" => Some(Completeness::Name),
    _ => None,
});

/// Rules of a watched folder: which files are recordings of which test. `sagnac watch` tests each once.
#[derive(Table)]
#[table("", format = "watch/1")]
pub(super) struct WatchTables {
    /// Pause between two looks at the folder.
    #[key(quantity = "s", above = 0, max = 86_400, default = "5 s", example = "5 s")]
    pub poll_s: f64,
    /// The rules, one table each. The first whose pattern fits a file holds for it.
    #[key(name = "rule", required)]
    pub rules: Vec<RuleKeys>,
}

/// Recordings that are tested alike.
#[derive(Table)]
#[table("rule")]
pub(super) struct RuleKeys {
    /// Pattern of the path below the folder: `*` is any characters but `/`, `?` a single one, `{serial}` the serial number.
    #[key(example = "*_{serial}_*.csv")]
    pub pattern: String,
    /// Procedure: a file relative to this one, or the name of a shipped one.
    #[key(example = "static-bias")]
    pub procedure: String,
    /// Limits: a file relative to this one, or the name of a shipped one.
    #[key(example = "sample-unit")]
    pub limits: Option<String>,
    /// Column that has the serial number. Default: what the manifest or the recording states, else the file name.
    #[key(example = "unit_sn")]
    pub serial_column: Option<ColumnRef>,
    /// What tells that a file is complete.
    #[key(default = "still", example = "marker")]
    pub complete: Completeness,
    /// Ending of the name of a marker file: `unit.csv.done` beside `unit.csv`.
    #[key(default = ".done", example = ".done")]
    pub marker: String,
    /// How long a complete file stands still.
    #[key(quantity = "s", above = 0, max = 604_800, default = "60 s", example = "60 s")]
    pub after_s: f64,
    /// Store that results are kept in, relative to this file. Default: as `sagnac run`.
    #[key(example = "/srv/sagnac")]
    pub store: Option<String>,
    /// Table of units (CSV), relative to this file.
    #[key(example = "units.csv")]
    pub unit_data: Option<String>,
    /// Test station of the recordings.
    #[key(example = "bench 2")]
    pub station: Option<String>,
    /// Command that is told of each verdict, with its arguments: it gets JSON on its standard input.
    #[key(kind = Kind::Command, example = ["python3", "to_mes.py"])]
    pub hook: Vec<String>,
    #[key(section)]
    pub section: Section,
}

/// A rule of which no key is given.
pub(super) fn default_rule() -> WatchRule {
    let keys: RuleKeys = empty();
    WatchRule {
        pattern: keys.pattern,
        procedure: keys.procedure.into(),
        limits: None,
        serial_column: None,
        complete: keys.complete,
        marker: keys.marker,
        after: Duration::from_secs_f64(keys.after_s),
        store: None,
        unit_data: None,
        station: None,
        hook: vec![],
    }
}

impl WatchRule {
    /// The rule of every file of a folder by one procedure.
    pub fn of_every_file(procedure: PathBuf, limits: Option<PathBuf>) -> WatchRule {
        WatchRule { pattern: EVERY_FILE.to_owned(), procedure, limits, ..default_rule() }
    }
}
