//! The bench of a test: what checks it, for how long a check releases it, and how recent a release a test demands.

use crate::config::table::Table;

/// The bench that a recording is made on. A check of the bench states `releases_for`; a test that demands a bench released by such a
/// check states `released_within`.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("bench")]
pub struct Bench {
    /// Name or serial number of the bench or its table. Default: the station of the run (`--station`).
    #[key(example = "TABLE-3")]
    pub name: Option<String>,
    /// For how long a pass releases the bench, from the end of the recording: the procedure is a check of the bench.
    #[key(quantity = "s", above = 0, example = "24 h")]
    pub releases_for_s: Option<f64>,
    /// Longest time from the end of the check that released the bench to the beginning of this recording. Without such a check
    /// the test is not valid.
    #[key(quantity = "s", above = 0, example = "24 h")]
    pub released_within_s: Option<f64>,
    /// Id of the procedure whose results release the bench.
    #[key(default = "bench-check", example = "bench-check")]
    pub check: String,
}

impl Bench {
    /// The name of the bench: as stated, or else the station of the run.
    pub fn name<'a>(&'a self, station: Option<&'a str>) -> Option<&'a str> {
        self.name.as_deref().or(station).map(str::trim).filter(|name| !name.is_empty())
    }
}
