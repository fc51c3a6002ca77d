//! The next experiment: the shortest schedule that tells the surviving explanations of a recording apart.
//!
//! | file | what it has |
//! |---|---|
//! | `limits` | what a laboratory can do |
//! | `library` | patterns that a schedule is made of |
//! | `trial` | a schedule as the record that it would give |
//! | `power` | noncentral χ² |
//! | `separation` | the distance of two explanations in a trial, and the probability that it decides |
//! | `search` | the shortest schedule that decides |
//! | `why` | which contrast of it decides |
//! | `record` | what a plan says |

mod library;
mod limits;
mod power;
pub mod record;
mod search;
mod separation;
mod trial;
mod why;

pub use limits::Limits;
pub use record::Plan;
pub use search::ASKED;

use crate::claim::{Claim, Stated};
use crate::effect::{Column, Effect, Model};
use crate::mismatch::Alternative;
use record::{
    AlternativePlan, CandidateSchedule, CausePlan, PLAN_FORMAT, PairPlan, PlanOutcome, PlannedSchedule,
};
use search::{Evaluated, Question, Search};
use std::collections::BTreeSet;

/// Smallest probability of deciding that is worth a schedule.
const HOPELESS: f64 = 0.01;
/// Schedules that a plan lists.
const LISTED: usize = 8;

/// The explanations of one cause, the chosen one first.
struct Cause<'a> {
    number: usize,
    stated: Vec<&'a Stated>,
}

/// Plans the test that tells alternatives apart: what an explanation leaves as [`crate::mismatch::Outcome::alternatives`].
/// `claim` is the simulation that the next recording will be explained against.
pub fn plan(
    claim: &Claim,
    alternatives: &[Alternative],
    limits: &Limits,
    progress: &mut dyn FnMut(u64, u64),
) -> Plan {
    let causes = causes(alternatives);
    let mut plan = Plan {
        format: PLAN_FORMAT.to_owned(),
        case: claim.case.clone(),
        outcome: PlanOutcome::NothingToDecide,
        asked: ASKED,
        budget_h: limits.budget_s / 3600.0,
        causes: vec![],
        schedule: None,
        candidates: vec![],
        needed_h: None,
        to_record: to_record(claim, &causes),
    };
    if causes.is_empty() {
        return plan;
    }
    let questions: Vec<Question> = causes
        .iter()
        .map(|c| Question { shown: c.stated.iter().map(|s| separation::later(s, claim)).collect() })
        .collect();
    let needs = follows(&questions);
    let start = library::start(&needs, limits);
    let search = Search { claim, questions: &questions, start, budget_s: limits.budget_s };
    let found = search.best(&library::patterns(&needs, limits), progress);
    let best =
        found.ranked.first().filter(|e| e.decides() || e.least() >= HOPELESS || found.needed_s.is_some());
    plan.outcome = match best {
        Some(e) if e.decides() => PlanOutcome::Decides,
        Some(_) => PlanOutcome::TooShort,
        None => PlanOutcome::Undecidable,
    };
    plan.causes = causes.iter().zip(&questions).enumerate().map(|(i, (c, q))| cause(i, c, q, best)).collect();
    plan.schedule = best.map(|e| PlannedSchedule {
        schedule: e.schedule.clone(),
        duration_h: e.schedule.duration_s() / 3600.0,
        probability: e.least(),
    });
    plan.candidates = found.ranked.iter().take(LISTED).map(candidate).collect();
    plan.needed_h = found.needed_s.map(|s| s / 3600.0);
    plan
}

/// Causes with more than one explanation that can be planned for.
fn causes(alternatives: &[Alternative]) -> Vec<Cause<'_>> {
    let mut out: Vec<Cause<'_>> = vec![];
    for one in alternatives {
        let Some(stated) = one.effects.first() else { continue };
        if matches!(stated.effect.model(), Model::Samples(_)) {
            continue;
        }
        match out.iter_mut().find(|c| c.number == one.cause) {
            Some(cause) if one.chosen => cause.stated.insert(0, stated),
            Some(cause) => cause.stated.push(stated),
            None => out.push(Cause { number: one.cause, stated: vec![stated] }),
        }
    }
    out.retain(|c| c.stated.len() > 1);
    out
}

/// Columns that explanations follow in a later record. A delay of the claimed mean needs no column of its own: it moves
/// with the table.
fn follows(questions: &[Question]) -> BTreeSet<Column> {
    let all = questions.iter().flat_map(|q| &q.shown).flatten();
    let mut out: BTreeSet<Column> = all.clone().flat_map(|s| s.effect.needs()).copied().collect();
    let delays = |e: &dyn Effect| e.needs().is_empty() && e.domain() == crate::effect::Domain::Lag;
    if all.clone().any(|s| delays(s.effect) && matches!(s.effect.model(), Model::Mean(_))) {
        out.insert(Column::TableRate);
    }
    out
}

/// Columns worth recording where an explanation follows something that was not recorded.
fn to_record(claim: &Claim, causes: &[Cause<'_>]) -> Vec<String> {
    let unrecorded = |s: &&Stated| s.effect.claimed_by_course().is_some();
    if !causes.iter().flat_map(|c| &c.stated).any(unrecorded) {
        return vec![];
    }
    let recorded = claim.columns.clone().unwrap_or_default();
    let known = Column::KNOWN.into_iter().filter(|c| !recorded.contains(c)).map(|c| c.name().to_owned());
    known.chain(["pressure_hPa", "field_uT", "humidity_percent"].map(str::to_owned)).collect()
}

fn cause(index: usize, cause: &Cause<'_>, question: &Question, best: Option<&Evaluated>) -> CausePlan {
    let answers = best.and_then(|e| e.causes.get(index));
    let legs = best.map(|e| e.schedule.legs()).unwrap_or_default();
    let kind = |i: usize| cause.stated.get(i).map_or("", |s| s.effect.kind()).to_owned();
    let needs =
        |i: usize| question.shown.get(i).into_iter().flatten().flat_map(|s| s.effect.needs()).copied();
    let alternatives = question.shown.iter().enumerate().map(|(i, shown)| {
        let answer = answers.and_then(|a| a.get(i));
        AlternativePlan {
            kind: kind(i),
            shows_as: shown.as_ref().map(|s| s.effect.kind().to_owned()),
            probability: answer.map_or(0.0, |a| a.alone()),
            found: answer.map_or(0.0, |a| a.found.probability),
        }
    });
    let mut pairs = vec![];
    for (i, answer) in answers.into_iter().flatten().enumerate() {
        for (j, decision) in &answer.pairs {
            let follows: BTreeSet<Column> = needs(i).chain(needs(*j)).collect();
            let told = decision.squared.max(if decision.probability > 0.5 { 1.0 } else { 0.0 });
            pairs.push(PairPlan {
                truth: kind(i),
                against: kind(*j),
                squared_distance: decision.squared,
                probability: decision.probability,
                contrast: why::contrast(&legs, &follows, told),
            });
        }
    }
    CausePlan { cause: cause.number, alternatives: alternatives.collect(), pairs }
}

fn candidate(evaluated: &Evaluated) -> CandidateSchedule {
    CandidateSchedule {
        schedule: evaluated.schedule.clone(),
        duration_h: evaluated.schedule.duration_s() / 3600.0,
        probabilities: evaluated.causes.iter().flatten().map(|a| a.alone()).collect(),
    }
}

#[cfg(test)]
mod tests;
