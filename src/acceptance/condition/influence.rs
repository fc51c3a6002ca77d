//! Conditions of a series of switching off and on, and of a comparison without and with an influence.

use super::facts::record;
use crate::i18n::{Arg, Note, note};
use crate::influence::Law;
use crate::influence::nuisance::Following;
use crate::influence::repeatability::factors;
use crate::record::{ConditionRecord, ConditionStatus, Evidence};

/// Findings of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFacts {
    /// Runs that were evaluated.
    pub found: usize,
    /// Runs that there must be.
    pub fewest: usize,
    /// Runs that were too short.
    pub too_short: usize,
    /// Least length, s.
    pub minimum_run_s: f64,
    /// How the runs are known.
    pub evidence: Evidence,
}

/// Judges whether there were runs enough.
pub fn judge_runs(facts: &RunFacts) -> ConditionRecord {
    let enough = facts.found >= facts.fewest;
    let key = match (enough, facts.found) {
        (true, _) => "runs.enough",
        (false, 0) => "runs.none",
        (false, 1) => "runs.one",
        (false, _) => "runs.too_few",
    };
    let (low, high) = factors(facts.found);
    let note = Note::new(key)
        .with("n", facts.found)
        .with("short", facts.too_short)
        .with("least", Arg::figures(facts.minimum_run_s, 3))
        .with("low", Arg::figures(low, 2))
        .with("high", Arg::figures(high, 3));
    let status = match (enough, facts.too_short) {
        (true, 0) => ConditionStatus::Ok,
        (true, _) => ConditionStatus::Remark,
        _ => ConditionStatus::Invalid,
    };
    let required = note!("runs.required", n = facts.fewest);
    let judged = record("runs", status, &[("runs", facts.found as f64)], Some(required), note);
    known(judged, Some(facts.evidence))
}

fn known(condition: ConditionRecord, evidence: Option<Evidence>) -> ConditionRecord {
    ConditionRecord { evidence, ..condition }
}

/// What the recording shows of an influence having acted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Acted {
    /// A channel tells its level.
    Recorded,
    /// The output was louder with it.
    Inferred {
        /// Standard deviation within ten samples against that without, at the level where least is seen.
        ratio: f64,
        /// Standard deviations of what is known of it.
        significance: f64,
    },
    /// Nothing shows it, and the procedure does without.
    Declared,
    /// Nothing shows it.
    NotShown {
        /// Ratio and significance, where the noise was looked at.
        by_noise: Option<(f64, f64)>,
    },
    /// A channel tells other levels than the procedure.
    Contradicted {
        /// Level that is stated.
        stated: f64,
        /// Level that was recorded.
        recorded: f64,
        /// Start of the interval, s from the start of the recording.
        at_s: f64,
    },
}

impl Acted {
    /// Standard deviations from which a louder output counts as seen.
    pub const MIN_SIGNIFICANCE: f64 = 3.0;

    /// How the levels are known.
    pub fn evidence(self) -> Evidence {
        match self {
            Acted::Recorded | Acted::Contradicted { .. } => Evidence::Recorded,
            Acted::Inferred { .. } => Evidence::Inferred,
            Acted::Declared | Acted::NotShown { .. } => Evidence::Declared,
        }
    }

    /// What a row must say of it.
    pub fn remark(self) -> Option<Note> {
        match self {
            Acted::Recorded | Acted::Contradicted { .. } => None,
            Acted::Inferred { .. } => Some(note!("acted.level_declared")),
            Acted::Declared | Acted::NotShown { .. } => Some(note!("acted.only_declared")),
        }
    }
}

fn acted(facts: &ComparedFacts<'_>) -> ConditionRecord {
    let figure = |v: f64| Arg::figures(v, 3);
    let (status, note) = match facts.acted {
        Acted::Recorded => (ConditionStatus::Ok, note!("acted.recorded")),
        Acted::Inferred { ratio, significance } => {
            let note =
                note!("acted.inferred", ratio = figure(ratio), significance = Arg::figures(significance, 2));
            (ConditionStatus::Ok, note)
        }
        Acted::Declared => (ConditionStatus::Remark, note!("acted.declared")),
        Acted::NotShown { by_noise: Some((ratio, significance)) } => {
            let note = note!(
                "acted.not_louder",
                ratio = figure(ratio),
                significance = Arg::decimals(significance, 1),
                table = facts.table
            );
            (ConditionStatus::Invalid, note)
        }
        Acted::NotShown { by_noise: None } => {
            (ConditionStatus::Invalid, note!("acted.not_shown", table = facts.table))
        }
        Acted::Contradicted { stated, recorded, at_s } => {
            let note = note!(
                "acted.contradicted",
                stated = Arg::figures(stated, 4),
                recorded = Arg::figures(recorded, 4),
                unit = Arg::key("unit", facts.level_unit),
                at = Arg::figures(at_s, 5)
            );
            (ConditionStatus::Invalid, note)
        }
    };
    let required = note!("acted.required");
    known(record("influence_acted", status, &[], Some(required), note), Some(facts.acted.evidence()))
}

/// Findings of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedFacts<'a> {
    /// Intervals that were evaluated.
    pub found: usize,
    /// Those with the influence.
    pub with: usize,
    /// Intervals with the influence that stand between two without.
    pub alternations: usize,
    /// How many of these there must be.
    pub asked: usize,
    /// Stretches that were too short.
    pub too_short: usize,
    /// Stated intervals that the recording does not hold.
    pub missing: usize,
    /// Least length, s.
    pub minimum_interval_s: f64,
    /// True when the intervals were found from channels.
    pub recorded: bool,
    /// Unit of the level.
    pub level_unit: &'static str,
    /// Table of the procedure that asks for the test.
    pub table: &'static str,
    /// What shows that the influence acted.
    pub acted: Acted,
    /// How the temperature goes with the levels; `None` without a thermometer.
    pub temperature: Option<&'a Following>,
    /// How further recorded quantities do, of the channel where they do most.
    pub others: Vec<&'a Following>,
    /// How much of a difference of temperature is allowed, degC.
    pub allowed_deg_c: f64,
    /// Probability of levels so far off the law.
    pub line: Option<f64>,
    /// The law.
    pub law: Law,
    /// Rates of a table that differ within the intervals; `None` where the scale factor is not asked for.
    pub rates: Option<usize>,
}

/// Probability below which levels are said to be off the line.
const MIN_LINE_PROBABILITY: f64 = 0.01;

/// Judges a comparison.
pub fn judge_compared(facts: &ComparedFacts<'_>) -> Vec<ConditionRecord> {
    let mut all = vec![intervals(facts), acted(facts), temperature(facts)];
    all.extend(facts.others.iter().map(|o| beside(o, facts)));
    all.extend(facts.rates.map(rates));
    if let Some(p) = facts.line {
        let (status, key) = match (p < MIN_LINE_PROBABILITY, facts.law) {
            (false, Law::LinearQuadratic) => (ConditionStatus::Ok, "compared.on_parabola"),
            (false, _) => (ConditionStatus::Ok, "compared.on_line"),
            (true, Law::LinearQuadratic) => (ConditionStatus::Remark, "compared.off_parabola"),
            (true, Law::Square) => (ConditionStatus::Remark, "compared.off_square"),
            (true, Law::Linear | Law::OnOff) => (ConditionStatus::Remark, "compared.off_line"),
        };
        let note = Note::new(key).with("probability", Arg::figures(100.0 * p, 2));
        all.push(record("influence_line", status, &[("probability", p)], None, note));
    }
    all
}

fn intervals(facts: &ComparedFacts<'_>) -> ConditionRecord {
    let without = facts.found - facts.with;
    let (status, key) = if facts.missing > 0 {
        (ConditionStatus::Invalid, "compared.missing")
    } else if facts.found == 0 {
        (ConditionStatus::Invalid, "compared.none")
    } else if facts.with == 0 {
        let key = if facts.recorded { "compared.never_on" } else { "compared.never_stated" };
        (ConditionStatus::Invalid, key)
    } else if without == 0 {
        (ConditionStatus::Invalid, "compared.never_off")
    } else if facts.alternations == 0 {
        (ConditionStatus::Invalid, "compared.no_return")
    } else if facts.alternations < facts.asked {
        (ConditionStatus::Invalid, "compared.too_few")
    } else {
        (ConditionStatus::Ok, "compared.enough")
    };
    let note = Note::new(key)
        .with("n", facts.alternations)
        .with("with", facts.with)
        .with("without", without)
        .with("short", facts.too_short)
        .with("missing", facts.missing)
        .with("least", Arg::figures(facts.minimum_interval_s, 3));
    let observed = [("alternations", facts.alternations as f64), ("intervals", facts.found as f64)];
    let required = note!("compared.required", n = facts.asked);
    let evidence = if facts.recorded { Evidence::Recorded } else { Evidence::Declared };
    known(record("influence_intervals", status, &observed, Some(required), note), Some(evidence))
}

/// Rates of a table that differ: with fewer than two, scale factor and bias are one.
fn rates(found: usize) -> ConditionRecord {
    let (status, key) = if found < 2 {
        (ConditionStatus::Invalid, "compared.one_rate")
    } else {
        (ConditionStatus::Ok, "compared.rates")
    };
    let required = Some(note!("compared.required_rates"));
    let judged = record(
        "influence_rates",
        status,
        &[("rates", found as f64)],
        required,
        Note::new(key).with("n", found),
    );
    known(judged, Some(Evidence::Recorded))
}

fn temperature(facts: &ComparedFacts<'_>) -> ConditionRecord {
    let id = "influence_temperature";
    let required =
        Some(note!("compared.required_temperature", allowed = Arg::figures(facts.allowed_deg_c, 2)));
    let Some(found) = facts.temperature else {
        return record(id, ConditionStatus::Remark, &[], required, note!("compared.no_temperature"));
    };
    let difference = found.difference().abs();
    let (status, key) = if difference > facts.allowed_deg_c {
        (ConditionStatus::Invalid, "compared.with_temperature")
    } else {
        (ConditionStatus::Ok, "compared.temperature")
    };
    let note = Note::new(key)
        .with("channel", found.what.channel.clone())
        .with("difference", Arg::figures(difference, 2))
        .with("chance", chance(found));
    known(record(id, status, &[("difference", difference)], required, note), Some(Evidence::Recorded))
}

/// The probability of what goes with the levels by chance, %.
fn chance(found: &Following) -> Arg {
    Arg::figures(100.0 * found.by_chance, 2)
}

/// A further recorded quantity: a temperature may differ as that of the unit may, of others no effect on the bias is known.
fn beside(found: &Following, facts: &ComparedFacts<'_>) -> ConditionRecord {
    let warm = found.what.temperature;
    let follows = if warm { found.difference().abs() > facts.allowed_deg_c } else { found.follows() };
    let (status, key) = if follows {
        (ConditionStatus::Invalid, "compared.beside_follows")
    } else {
        (ConditionStatus::Ok, "compared.beside_rests")
    };
    let note = found.note(key).with("chance", chance(found));
    let required = if warm {
        note!("compared.required_temperature", allowed = Arg::figures(facts.allowed_deg_c, 2))
    } else {
        note!("compared.required_beside")
    };
    let id = format!("influence_beside.{}", found.what.channel);
    let judged = record(id, status, &[("difference", found.difference().abs())], Some(required), note);
    known(judged, Some(Evidence::Recorded))
}
