//! A case of the table: a place where a truth is hard, the recording that shows it, and what is true of it.

use serde::Deserialize;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

/// Places where a truth can lie at its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Edge {
    /// The effect is exactly zero, and so is every other of its family.
    Zero,
    /// The truth lies at or between the points of the schedule.
    Grid,
    /// The effect is smaller than what the noise shows.
    BelowNoise,
    /// Present, with every other effect of its family at zero.
    Alone,
    /// Present or zero, beside a large other effect of its family.
    BesideLarge,
    /// Another influence follows the stimulus.
    Nuisance,
    /// The shortest recording that `check` accepts.
    Shortest,
    /// The coarsest schedule that `check` accepts.
    Coarsest,
}

impl Edge {
    /// Every edge, in the order of the table.
    pub const ALL: [Edge; 8] = [
        Edge::Zero,
        Edge::Grid,
        Edge::BelowNoise,
        Edge::Alone,
        Edge::BesideLarge,
        Edge::Nuisance,
        Edge::Shortest,
        Edge::Coarsest,
    ];
}

/// Key of a limit in a limits file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitKey {
    /// `max`
    Max,
    /// `min`
    Min,
    /// `max_abs`
    MaxAbs,
}

/// A limit with its unit, as it is written into the limits file.
#[derive(Debug, Clone)]
pub struct Limit {
    /// Which end it bounds.
    pub key: LimitKey,
    /// Bound, in the unit of the measurand.
    pub value: f64,
}

/// What is true of one measurand of a simulated unit.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Id of the measurand.
    pub id: String,
    /// Channel of its row; `None`: the only row of this id.
    pub channel: Option<String>,
    /// True value, in the unit of the measurand.
    pub value: f64,
    /// Limit it is judged against. Exactly at the truth: the rate of passes and of failures is at most the risk.
    pub limit: Option<Limit>,
    /// Half width of the 95 % interval of an oracle that knows everything but this value.
    pub oracle: Option<f64>,
    /// The recording shows this value or more: an upper bound may lie anywhere above.
    pub at_least: bool,
    /// Its unit where that of the measurand follows from the recording or the procedure.
    pub unit: Option<&'static str>,
}

impl Truth {
    /// A truth without a limit and without an oracle.
    pub fn new(id: impl Into<String>, value: f64) -> Truth {
        let id = id.into();
        Truth { id, channel: None, value, limit: None, oracle: None, at_least: false, unit: None }
    }

    /// With a limit.
    pub fn limited(self, key: LimitKey, value: f64) -> Truth {
        Truth { limit: Some(Limit { key, value }), ..self }
    }

    /// With the half width of the 95 % interval of an oracle that knows everything else.
    pub fn oracle(self, half_width: f64) -> Truth {
        Truth { oracle: Some(half_width), ..self }
    }

    /// In a unit that follows from the procedure.
    pub fn in_unit(self, unit: &'static str) -> Truth {
        Truth { unit: Some(unit), ..self }
    }

    /// On one of several channels.
    pub fn on(self, channel: impl Into<String>) -> Truth {
        Truth { channel: Some(channel.into()), ..self }
    }

    /// Measurand, and its channel where there are several.
    pub fn name(&self) -> String {
        self.channel.as_ref().map_or_else(|| self.id.clone(), |c| format!("{} {c}", self.id))
    }

    /// Where a unit with this truth stands against its limit.
    pub fn standing(&self) -> Standing {
        let Some(limit) = &self.limit else { return Standing::Unlimited };
        let excess = match limit.key {
            LimitKey::Max => self.value - limit.value,
            LimitKey::Min => limit.value - self.value,
            LimitKey::MaxAbs => self.value.abs() - limit.value,
        };
        let tolerance = 1e-9 * limit.value.abs();
        match excess {
            e if e > tolerance => Standing::Bad,
            e if e < -tolerance => Standing::Good,
            _ if self.at_least => Standing::Bad,
            _ => Standing::AtLimit,
        }
    }
}

/// Where a unit stands against a limit in truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// There is no limit.
    Unlimited,
    /// Within the limit: it may fail at most by the stated risk.
    Good,
    /// Exactly at the limit: it may pass, and may fail, at most by the stated risk.
    AtLimit,
    /// Beyond the limit: it may pass at most by the stated risk.
    Bad,
}

/// One simulated test.
pub struct Simulated {
    /// Text of the recording, CSV.
    pub csv: String,
    /// Text of the procedure.
    pub procedure: String,
    /// What is true of the unit.
    pub truths: Vec<Truth>,
}

impl Simulated {
    /// Writes recording, procedure and limits as `r.csv`, `p.toml` and `l.toml` into a folder.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        fs::write(folder.join("r.csv"), &self.csv)?;
        fs::write(folder.join("p.toml"), &self.procedure)?;
        fs::write(folder.join("l.toml"), limits(&self.truths))
    }

    /// Whether some truth has a limit.
    pub fn is_limited(&self) -> bool {
        self.truths.iter().any(|t| t.limit.is_some())
    }
}

/// Draws the unit and its recording of a seed.
pub type Draw = Box<dyn Fn(u64) -> Simulated + Send + Sync>;

/// One case of the table.
pub struct Case {
    /// What it is, in one line.
    pub name: String,
    /// Edges it stands for.
    pub edges: Vec<Edge>,
    /// Measurands it tells of.
    pub ids: Vec<String>,
    /// Recordings in the full study.
    pub records: usize,
    /// Draws the unit and its recording of a seed. Every draw has a truth for each of `ids`.
    pub draw: Draw,
    /// The program may refuse the recording, and so state nothing.
    pub may_be_refused: bool,
}

/// A reason why an edge does not apply to some measurands.
pub struct Exemption {
    /// The edges.
    pub edges: Vec<Edge>,
    /// The measurands.
    pub ids: Vec<String>,
    /// Why there is no such case.
    pub reason: String,
}

/// Measurands that one kind of test gives.
pub struct Family {
    /// Short name.
    pub name: String,
    /// Every measurand of the family.
    pub ids: Vec<String>,
    /// Its cases.
    pub cases: Vec<Case>,
    /// Edges that do not apply.
    pub exempt: Vec<Exemption>,
}

impl Family {
    /// Pairs of a measurand and an edge that have neither a case nor a reason.
    pub fn gaps(&self) -> Vec<String> {
        let shown = |id: &String, edge: &Edge| {
            let case = self.cases.iter().any(|c| c.ids.contains(id) && c.edges.contains(edge));
            let exempt = |e: &Exemption| e.ids.contains(id) && e.edges.contains(edge) && e.reason.len() > 20;
            case || self.exempt.iter().any(exempt)
        };
        let pairs = self.ids.iter().flat_map(|id| Edge::ALL.map(|edge| (id, edge)));
        pairs.filter(|(id, edge)| !shown(id, edge)).map(|(id, edge)| format!("{id}: {edge:?}")).collect()
    }
}

/// The limits file of the truths.
fn limits(truths: &[Truth]) -> String {
    let mut text = String::from(
        "format = \"limits/1\"\n[limits]\nid = \"edges\"\ntitle = \"Truths\"\nrevision = \"A\"\nfamily = \"SIMULATED\"\n\
         source = \"drawn\"\n",
    );
    let mut written: Vec<(&str, Option<&str>)> = Vec::new();
    for truth in truths {
        let Some(limit) = &truth.limit else { continue };
        // A limit of a channel judges its rows at all levels.
        let channel = truth.channel.as_ref().map(|c| c.split('@').next().unwrap_or(c));
        if written.contains(&(&truth.id, channel)) {
            continue;
        }
        written.push((&truth.id, channel));
        let of_measurand = || sagnac::measurand::find(&truth.id).map_or("", |m| m.unit);
        let unit = truth.unit.unwrap_or_else(of_measurand);
        let key = match limit.key {
            LimitKey::Max => "max",
            LimitKey::Min => "min",
            LimitKey::MaxAbs => "max_abs",
        };
        // Writing to a text cannot fail.
        let _ =
            writeln!(text, "[[limit]]\nmeasurand = \"{}\"\n{key} = \"{:.12} {unit}\"", truth.id, limit.value);
        if let Some(channel) = channel {
            let _ = writeln!(text, "channel = \"{channel}\"");
        }
    }
    text
}
