//! Looks at a growing test, fixed beforehand, and what each has spent of the risk.

use serde::{Deserialize, Serialize};

/// A test by a plan of looks: how far it has come, and which rows are decided.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct InterimRecord {
    /// Spending function: `lan_demets_obrien_fleming`, 2 - 2 Φ(z / √t) with Φ(z) = 1 - risk / 2 at a share t of the information.
    pub spending: String,
    /// `one_sided`: the risk is that of each side of each limit, and the function is used with it.
    pub sides: String,
    /// Time evaluated at each look, s after the warm-up; the last is the full duration.
    pub looks_s: Vec<f64>,
    /// Number of the look that was evaluated, from 1; 0 before the first.
    pub look: usize,
    /// Length of the recording after the warm-up, s. What lies behind the look is not evaluated.
    pub recorded_s: f64,
    /// Where the test stands.
    pub state: InterimState,
    /// The next look at which an open row can be decided, s after the warm-up; absent where none is open.
    pub next_look_s: Option<f64>,
    /// Largest risk that a row has spent.
    pub spent_risk: f64,
    /// The rows with a limit.
    pub rows: Vec<InterimRow>,
}

/// Where a growing test, or a row of it, stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum InterimState {
    /// Not decided; a later look can decide it.
    #[default]
    Open,
    /// Decided at the stated risk.
    Decided,
    /// Not decided, and so far from its limit that it can hardly pass at the full duration.
    CannotPass,
    /// Not decided at the full duration.
    Undecided,
}

impl InterimState {
    /// The id used in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            InterimState::Open => "open",
            InterimState::Decided => "decided",
            InterimState::CannotPass => "cannot_pass",
            InterimState::Undecided => "undecided",
        }
    }
}

/// A row of a growing test.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct InterimRow {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Risk over all looks.
    pub risk: f64,
    /// Predicted share of the information at each look; empty where no variance is predicted, and the row is decided at the full
    /// duration only.
    pub information: Vec<f64>,
    /// True where the gains of information between looks are independent, so that the bounds are exact; false where the looks
    /// share the risk.
    pub exact: bool,
    /// Normal score inside or outside the limit that decides at each look; `null` where a look can decide nothing.
    pub scores: Vec<Option<f64>>,
    /// Risk spent so far.
    pub spent_risk: f64,
    /// Where the row stands.
    pub state: InterimState,
    /// The next look that can decide it, s after the warm-up; absent where it is not open.
    pub decidable_s: Option<f64>,
}
