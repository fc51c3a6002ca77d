//! Criticism of a fit: checks of what was fitted to a record against that record, by means that share no assumption with the
//! fit. What a check contradicts decides nothing.
//!
//! Every kind of test has one list of checks here. A [`Check`] looks at the evidence of one channel and gives a
//! [`Finding`] for each contradiction: which measurands rest on what was contradicted, what was found with its numbers, and
//! what to do. The evaluation of every measurand puts the findings on its estimates as objections, and an estimate with an
//! objection neither passes nor fails; so no command states what another refuses. A new check is one file and one line.

mod affected;
mod allan_curve;
mod copied_run;
mod late_output;
mod long_process;
mod rate_rounding;
mod rejected_model;
mod response;
mod slow_part_removed;
mod smoothed_output;
mod step;
pub mod temperature;
mod warm_up;
mod white_floor;

#[cfg(test)]
pub(crate) use affected::{NOISE_MEASURANDS, SLOW_NOISE};

use crate::estimate::{Estimate, Finding, Objection};
use crate::evidence::{ComparisonEvidence, GyroEvidence, TableEvidence};
use crate::influence::repeatability::Repeatability;

/// A check of the evidence of one channel; `F` takes the evidence and gives what it contradicts.
#[derive(Debug, Clone, Copy)]
pub struct Check<F> {
    /// Id in results; `criticism.<id>` is its name in the locale tables.
    pub id: &'static str,
    /// The examination.
    pub examine: F,
}

/// Examination of a gyro at rest, over temperature, or from switching on.
pub type OfGyro = fn(&GyroEvidence) -> Vec<Finding>;

/// Examination of a comparison without and with an influence.
pub type OfComparison = for<'a> fn(&ComparisonEvidence<'a>) -> Vec<Finding>;

/// Examination of the steps of a rate table.
pub type OfTable = for<'a> fn(&TableEvidence<'a>) -> Vec<Finding>;

/// Examination of a series of switchings-on.
pub type OfRuns = fn(&Repeatability) -> Vec<Finding>;

/// Checks of a gyro at rest, over temperature and from switching on, in the order of their reports.
pub static OF_GYRO: &[Check<OfGyro>] = &[
    Check { id: temperature::CHECK_ID, examine: temperature::examine },
    Check { id: "rate_rounding", examine: rate_rounding::examine },
    Check { id: "slow_part_removed", examine: slow_part_removed::examine },
    Check { id: "smoothed_output", examine: smoothed_output::examine },
    Check { id: "rejected_model", examine: rejected_model::examine },
    Check { id: "white_floor", examine: white_floor::examine },
    Check { id: "allan_curve", examine: allan_curve::examine },
    Check { id: "step", examine: step::examine },
    Check { id: "long_process", examine: long_process::examine },
    Check { id: "warm_up", examine: warm_up::examine },
];

/// Checks of a comparison without and with an influence.
pub static OF_COMPARISON: &[Check<OfComparison>] = &[Check { id: "response", examine: response::examine }];

/// Checks of the steps of a rate table.
pub static OF_TABLE: &[Check<OfTable>] = &[Check { id: "late_output", examine: late_output::examine }];

/// Checks of a series of switchings-on.
pub static OF_RUNS: &[Check<OfRuns>] = &[Check { id: "copied_run", examine: copied_run::examine }];

/// Objections of all checks; `ask` hands the evidence to one of them.
pub fn objections<F: Copy>(checks: &[Check<F>], ask: impl Fn(F) -> Vec<Finding>) -> Vec<Objection> {
    let of = |check: &Check<F>| {
        let id = check.id;
        ask(check.examine).into_iter().map(move |finding| Objection { check: id, finding })
    };
    checks.iter().flat_map(of).collect()
}

/// Objections to a gyro at rest, over temperature or from switching on. Examined once, when all evidence is there.
pub fn of_gyro(gyro: &GyroEvidence) -> &[Objection] {
    gyro.objections.get_or_init(|| objections(OF_GYRO, |examine| examine(gyro)))
}

/// The estimates, each with the objections to it.
pub fn raise(objections: &[Objection], mut estimates: Vec<Estimate>) -> Vec<Estimate> {
    for estimate in &mut estimates {
        let to = objections.iter().filter(|o| o.finding.measurands.contains(&estimate.id));
        estimate.objections.extend(to.cloned());
    }
    estimates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Holds;
    use crate::evidence::test_evidence::gyro;
    use crate::message::note;

    #[test]
    fn an_objection_reaches_the_estimates_that_rest_on_it_alone() {
        let finding = || Finding {
            measurands: vec!["angle_random_walk"],
            holds: Holds::Nothing,
            found: note!("found"),
            advice: note!("advice"),
        };
        let checks: &[Check<bool>] =
            &[Check { id: "one", examine: true }, Check { id: "other", examine: false }];
        let found = objections(checks, |holds| if holds { vec![finding()] } else { vec![] });
        let none = |id| Estimate::not_identifiable(id, "rate", None, "", "");
        let rows = raise(&found, vec![none("angle_random_walk"), none("rate_random_walk")]);
        assert_eq!(rows[0].objections.iter().map(|o| o.check).collect::<Vec<_>>(), ["one"]);
        assert!(rows[1].objections.is_empty());
    }

    #[test]
    fn nothing_is_contradicted_where_nothing_was_recorded() {
        assert_eq!(of_gyro(&gyro()), []);
    }
}
