//! Exit codes, as the README documents them.

use crate::estimate::Verdict;
use crate::mismatch::finding::MismatchVerdict;
use crate::plan::record::PlanOutcome;
use crate::record::ProofOutcome;
use crate::report::{Record, Results};

/// Every row passed, or there were no limits.
pub const PASS: u8 = 0;
/// At least one row failed.
pub const FAIL: u8 = 1;
/// The test could not be run, or not as required.
pub const ERROR: u8 = 2;
/// Neither pass nor fail; with `--require-limits` also where there were no limits.
pub const INDETERMINATE: u8 = 3;

/// The exit code of results.
pub fn of(results: &Results) -> u8 {
    match results.record().record() {
        Record::Run(run) => of_verdict(run.verdict),
        Record::Lot(lot) => of_verdict(lot.verdict),
        Record::Day(day) => of_verdict(day.verdict),
        Record::Explanation(one) => of_mismatch(one.explanation.verdict),
        Record::Joint(several) => of_mismatch(several.explanation.verdict),
        Record::Plan(file) => match file.plan.outcome {
            PlanOutcome::Decides | PlanOutcome::NothingToDecide => PASS,
            PlanOutcome::TooShort | PlanOutcome::Undecidable => INDETERMINATE,
        },
        Record::Proof(proof) => match proof.outcome {
            ProofOutcome::Holds => PASS,
            ProofOutcome::Fails => FAIL,
        },
        Record::Comparison(_) | Record::DataSheet(_) => PASS,
        Record::Rehearsal(rehearsal) if rehearsal.shortest_h.is_some() => PASS,
        Record::Rehearsal(_) => INDETERMINATE,
    }
}

/// The exit code of a test of which limits are required: nothing decided is no pass.
pub fn where_limits_are_required(results: &Results) -> u8 {
    let verdict = match results.record().record() {
        Record::Run(run) => run.verdict,
        Record::Lot(lot) => lot.verdict,
        _ => return of(results),
    };
    if verdict == Verdict::None { INDETERMINATE } else { of_verdict(verdict) }
}

/// The exit code of a verdict.
pub fn of_verdict(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::None | Verdict::Pass => PASS,
        Verdict::Fail => FAIL,
        Verdict::Indeterminate => INDETERMINATE,
        Verdict::Error => ERROR,
    }
}

fn of_mismatch(verdict: MismatchVerdict) -> u8 {
    match verdict {
        MismatchVerdict::Consistent => PASS,
        MismatchVerdict::Mismatch => FAIL,
        MismatchVerdict::UnknownMismatch => INDETERMINATE,
    }
}
