//! How every measurand behaves beside what its model lacks: the units of the edges, disturbed.
//!
//! The kinds of disturbances are a table, `studies/cases/disturbances.toml`. A kind says of which measurands the recording
//! shows the truth no longer, and why; of which it shows at least the truth; all others keep theirs.

mod pool;
mod transform;

use crate::bench::noise_source::NoiseSource;
use crate::edges::case::{Case as Unit, Edge, Family, Simulated, Truth};
use crate::edges::tally;
use crate::edges::{FAMILIES, by_the_library};
use crate::study::{Case, Study};
use serde::Deserialize;
use std::sync::LazyLock;
use transform::{Columns, Disturbance, Stimulus};

/// Every measurand beside every disturbance.
pub static STUDY: Study = Study {
    id: "disturbances",
    title: "Every measurand, disturbed",
    method: "What happens to units at their limits beside what no model of their test names: the units that the [edges](edges.md) \
        test alone, each with every disturbance of a kind in turn, pooled by measurand. Limits lie exactly at the truth of the \
        undisturbed unit where the edges have them there. Asked: what is stated holds the truth in .93 to .99 (bounds may hold it \
        always), and a unit at its limit passes, and fails, in at most 5 %. A recording that the program refuses, and a row that a \
        check contradicts, state nothing. Where a disturbance adds to a measurand, the recording shows at least the truth: only \
        passes are wrong. Where it changes what the recording shows, the truth is still that of the undisturbed unit: a moving mean \
        takes out the drift that was to be measured. A lag much longer than the intervals is a straight line within them, which no \
        analysis tells from slow noise. The table of disturbances, and why a measurand has no row: \
        `studies/cases/disturbances.toml`.\n\n\
        For a user: state how the data was filtered, give the unit time to respond, and record steps finer than the noise.",
    records: 2,
    cases,
};

/// Seed of a disturbance beside that of the unit.
const OF_DISTURBANCE: u64 = 0xd157;
/// Seeds of a run of the study, and of each of its units with a disturbance: no two share a recording, so that shares over units
/// can be pooled.
const SEEDS_OF_RUN: u64 = 1_000_000;
const SEEDS_OF_CASE: u64 = 1000;

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    toml::from_str(include_str!("../../cases/disturbances.toml"))
        .unwrap_or_else(|wrong| panic!("the table of disturbances: {wrong}"))
});

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    stimulus: Vec<StimulusOf>,
    kind: Vec<Kind>,
}

/// A stimulus, by the measurand that tells what the output makes of it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StimulusOf {
    /// Any truth of this measurand.
    measurand: String,
    column: String,
    #[serde(default = "first_power")]
    power: i32,
    /// Output per unit of the stimulus where it is not the truth of the measurand, deg/h.
    effect: Option<f64>,
}

fn first_power() -> i32 {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Kind {
    name: String,
    /// Measurands that the disturbance adds to.
    #[serde(default)]
    adds_to: Vec<String>,
    /// Measurands without a row.
    absent: Vec<Absent>,
    /// Units that it is tried on; without it all.
    units: Option<Vec<String>>,
    disturbance: Vec<Disturbance>,
}

/// Measurands whose truth the disturbed recording does not show, or that have nothing to disturb.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Absent {
    measurands: Vec<String>,
    reason: String,
}

impl Kind {
    /// Edge of the units: alone, or beside the other effects of the family where these are the disturbance.
    fn edge(&self) -> Edge {
        let other = self.disturbance.contains(&Disturbance::OtherEffect);
        if other { Edge::BesideLarge } else { Edge::Alone }
    }

    fn absent(&self, id: &str) -> Option<&str> {
        let named = self.absent.iter().find(|a| a.measurands.iter().any(|m| m == id));
        named.map(|a| a.reason.as_str())
    }

    fn tries(&self, unit: &Unit) -> bool {
        let named = self.units.as_ref().is_none_or(|units| units.contains(&unit.name));
        named && unit.edges.contains(&self.edge()) && !self.judged(unit).is_empty()
    }

    fn judged(&self, unit: &Unit) -> Vec<String> {
        unit.ids.iter().filter(|id| self.absent(id).is_none()).cloned().collect()
    }

    fn units(&self) -> impl Iterator<Item = &'static Unit> {
        FAMILIES.iter().flat_map(|f| &f.cases).filter(|unit| self.tries(unit))
    }

    /// Truths of the disturbed recording.
    fn left(&self, truths: Vec<Truth>) -> Vec<Truth> {
        let kept = truths.into_iter().filter(|t| self.absent(&t.id).is_none());
        kept.map(|t| Truth { at_least: self.adds_to.contains(&t.id), oracle: None, ..t }).collect()
    }
}

fn disturbed(kind: &'static Kind, by: Disturbance, unit: &'static Unit) -> Unit {
    let draw = move |seed| {
        let Simulated { csv, procedure, truths } = (unit.draw)(seed);
        let csv = text(csv, by, stimulus(&truths), seed)
            .unwrap_or_else(|| panic!("{}: nothing to disturb by {by:?}", unit.name));
        Simulated { csv, procedure, truths: kind.left(truths) }
    };
    Unit {
        name: format!("{}: {}", named(kind, by), unit.name),
        edges: vec![],
        ids: kind.judged(unit),
        records: unit.records,
        draw: Box::new(draw),
        may_be_refused: true,
    }
}

/// A recording with a disturbance; absent where it has no column to disturb.
fn text(csv: String, by: Disturbance, stimulus: Option<Stimulus<'_>>, seed: u64) -> Option<String> {
    if by == Disturbance::OtherEffect {
        return Some(csv);
    }
    let mut source = NoiseSource::new(seed ^ OF_DISTURBANCE);
    Some(Columns::read(&csv)?.disturbed(by, stimulus, &mut source)?.text())
}

fn stimulus(truths: &[Truth]) -> Option<Stimulus<'static>> {
    TABLE.stimulus.iter().find_map(|s| {
        let truth = truths.iter().find(|t| t.id == s.measurand)?;
        Some(Stimulus { column: &s.column, power: s.power, effect: s.effect.unwrap_or(truth.value) })
    })
}

fn named(kind: &Kind, by: Disturbance) -> String {
    let how = match by {
        Disturbance::OtherEffect => return kind.name.clone(),
        Disturbance::Response { tau_s } => format!("{tau_s} s"),
        Disturbance::Resonance { at, quality } => format!("at {at} of the rate, quality {quality}"),
        Disturbance::Filter { order, cut_off } => format!("order {order}, cut-off {cut_off} of the rate"),
        Disturbance::Rounded { noise_steps } => format!("noise of {noise_steps} steps"),
        Disturbance::Thermometer { step } => format!("{step} degC"),
        Disturbance::Jump { sigmas, .. } => format!("{sigmas} σ of a sample"),
        Disturbance::Telegraph { sigmas, dwell } => format!("{sigmas} σ of a sample, {dwell} samples"),
        Disturbance::DriftRemoved { share } => format!("moving mean over {share} of the record"),
    };
    format!("{}, {how}", kind.name)
}

/// The units of a kind with each of its disturbances; the number of each among those of all kinds.
fn numbered(kind: &'static Kind) -> impl Iterator<Item = (u64, Unit)> {
    let count = |kind: &'static Kind| (kind.disturbance.len() * kind.units().count()) as u64;
    let before = TABLE.kind.iter().take_while(|other| other.name != kind.name).map(count).sum::<u64>();
    let of = move |by: &'static Disturbance| kind.units().map(move |unit| disturbed(kind, *by, unit));
    kind.disturbance.iter().flat_map(of).zip(before..).map(|(unit, at)| (at, unit))
}

fn cases() -> Vec<Case> {
    let case = |kind: &'static Kind| {
        Case::new(&kind.name, move |records, seed| {
            let tallies = numbered(kind).flat_map(|(at, unit)| {
                let records = records.min(unit.records as u64).min(SEEDS_OF_CASE) as usize;
                tally::run(&unit, records, SEEDS_OF_RUN * seed + SEEDS_OF_CASE * at, &by_the_library)
            });
            pool::rows(&tallies.collect::<Vec<_>>())
        })
    };
    TABLE.kind.iter().map(case).collect()
}

/// Pairs of a measurand and a kind of disturbance that have neither a row nor a reason.
pub fn gaps<'a>(measurands: impl Iterator<Item = &'a str>) -> Vec<String> {
    let without = |kind: &Kind, id: &str| {
        let shown = kind.units().any(|unit| kind.judged(unit).iter().any(|judged| judged == id));
        let reason = kind.absent(id).or_else(|| exempt(id, kind.edge()));
        !shown && reason.is_none_or(|reason| reason.len() <= 20)
    };
    let of =
        |id: &'a str| TABLE.kind.iter().filter(move |kind| without(kind, id)).map(move |kind| (id, kind));
    measurands.flat_map(of).map(|(id, kind)| format!("{id}: {}", kind.name)).collect()
}

/// Why the edges have no unit for a measurand.
fn exempt(id: &str, edge: Edge) -> Option<&'static str> {
    let of = |f: &'static Family| {
        f.exempt.iter().find(|e| e.edges.contains(&edge) && e.ids.iter().any(|i| i == id))
    };
    FAMILIES.iter().find_map(of).map(|e| e.reason.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_units_share_a_seed() {
        let all: Vec<u64> = TABLE.kind.iter().flat_map(|kind| numbered(kind).map(|(at, _)| at)).collect();
        assert!(all.iter().copied().eq(0..all.len() as u64));
        assert!(all.len() as u64 * SEEDS_OF_CASE <= SEEDS_OF_RUN, "{}", all.len());
    }

    #[test]
    fn every_kind_disturbs_what_it_is_tried_on() {
        let mut tried = 0;
        for kind in &TABLE.kind {
            for family in FAMILIES.iter() {
                // The units of a family have the same columns.
                let Some(unit) = family.cases.iter().find(|unit| kind.tries(unit)) else { continue };
                let Some(by) = kind.disturbance.first() else { continue };
                let Simulated { csv, truths, .. } = (unit.draw)(1);
                let disturbed = text(csv, *by, stimulus(&truths), 1);
                assert!(disturbed.is_some(), "{}: {}", named(kind, *by), unit.name);
                tried += 1;
            }
        }
        assert!(tried > 20, "{tried}");
    }
}
