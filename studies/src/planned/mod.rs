//! Planned tests carried out: the schedule of `sagnac plan` for ambiguous explanations, recorded with each of them as the
//! truth, and explained.

pub mod ambiguous;
mod physics;
mod run;

pub use run::{Carried, carried_out};

use crate::study::{Asked, Case, Row, Study};
use ambiguous::{AMBIGUOUS, Ambiguous};

/// The true explanation is named alone after the planned test.
pub static STUDY: Study = Study {
    id: "planned-experiments",
    title: "Planned tests",
    method: "Two or three explanations that one recording could not tell apart are given to the plan. Its schedule is \
             recorded with each of them as the truth, by physics written for this study, with noise of its own and a \
             thermometer of 0.005 °C, and explained against the claim. Decided are records of which the true effect is the \
             only one named, and none of the others that were planned for an equivalent of it; for a truth that a later \
             record does not show, those that are consistent. The plan promises 95 %.",
    records: 20,
    cases: || {
        let all = AMBIGUOUS.iter();
        all.map(|a| Case::new(&a.name, |records, seed| rows(a, records, seed))).collect()
    },
};

/// The lines of a case.
fn rows(ambiguous: &Ambiguous, records: u64, seed: u64) -> Vec<Row> {
    let Some(Carried { hours, truths }) = carried_out(ambiguous, records, seed) else {
        return vec![Row::number(
            "plan",
            "a schedule is found within the budget, h",
            Asked::AtLeast(0.0),
            f64::NAN,
            1,
        )];
    };
    let mut out =
        vec![Row::number("plan", "length of the schedule, h", Asked::AtMost(ambiguous.budget_h), hours, 1)];
    for truth in truths {
        let of = |claim: &str, asked, hits| Row::share(truth.kind.clone(), claim, asked, hits, records);
        let stated = "probability of deciding that the plan states";
        out.push(Row::number(truth.kind.clone(), stated, Asked::Nothing, truth.stated, 1));
        out.push(of(
            "decided: named alone, and no other that was planned for an equivalent",
            Asked::AtLeast(0.95),
            truth.decided,
        ));
        out.push(of("named without any equivalent", Asked::Nothing, truth.alone));
        out.push(of("named, with or without others", Asked::Nothing, truth.named));
    }
    out
}
