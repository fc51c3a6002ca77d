//! Several recordings of one unit explained together: what they find that none finds alone, and what they find where the
//! claim is right.

use crate::noticeable::bench::{Place, Set, recording};
use crate::noticeable::loaded;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::claim::Claim;
use sagnac::mismatch::finding::MismatchVerdict;
use sagnac::mismatch::joint::record::JointExplanation;
use sagnac::mismatch::joint::{Recording, explain_jointly};
use sagnac::mismatch::{Options, explain};
use std::collections::BTreeMap;

/// An effect of half the size that one recording would show, in six.
pub static STUDY: Study = Study {
    id: "joint-explanations",
    title: "Several recordings explained together",
    method: "Six recordings of one unit, each with noise, drivers and events of its own and the same deviations of the unit \
             from its claim, at the edges of what the claim allows (1.5 of its deviations). An effect is set into all of \
             them, of half the size that an explanation of one says would have been noticed in it. In the case of \
             disagreement, three of the six have the effect with the other sign, of twice that size. Noise, drivers and \
             effects are made by sums that share nothing with the program.",
    records: 40,
    cases,
};

/// Recordings of a unit.
const RECORDINGS: u64 = 6;
/// Distance of the seeds of two recordings of one unit: the bits that tell how the unit is off are the same.
const NEXT: u64 = 1 << 20;
/// Share of the size that one recording would show.
const SHARE: f64 = 0.5;

/// Effects that are set in, and where.
const EFFECTS: [(&str, Place); 4] = [
    ("temp_linear", Place::AtRest),
    ("temp_rate", Place::AtRest),
    ("column_driver", Place::AtRest),
    ("sf_error", Place::OnTable),
];

fn cases() -> Vec<Case> {
    let of = |(kind, place): (&'static str, Place)| {
        Case::new(format!("{kind} in all"), move |records, seed| {
            with_effect(kind, place, records, first(seed))
        })
    };
    let mut cases: Vec<Case> = EFFECTS.into_iter().map(of).collect();
    let unlike = |records, seed| disagreeing("temp_rate", Place::AtRest, records, first(seed));
    cases.push(Case::new("temp_rate with both signs", unlike));
    for (name, place) in
        [("right claim, at rest", Place::AtRest), ("right claim, on a table", Place::OnTable)]
    {
        cases.push(Case::new(name, move |records, seed| right(place, records, first(seed))));
    }
    cases
}

fn first(seed: u64) -> u64 {
    91_000 + 10_000 * (seed - 1)
}

/// Size that would have been noticed in one recording with a right claim.
fn noticeable(kind: &str, place: Place, claim: &Claim, seed: u64) -> Option<f64> {
    let outcome = explain(recording(place, seed, None), claim, &Options::default(), &mut |_| {}).ok()?;
    outcome.explanation.noticeable.iter().find(|n| n.kind == kind).map(|n| n.size)
}

/// Explains recordings of one unit with an effect of given sizes.
fn together(kind: &str, place: Place, claim: &Claim, seed: u64, sizes: &[f64]) -> Option<JointExplanation> {
    let at = BTreeMap::new();
    let of = |(i, size): (usize, &f64)| {
        let set = (*size != 0.0).then_some(Set { kind, size: *size, at: &at });
        Recording {
            name: format!("recording {}", i + 1),
            folder: i.to_string(),
            series: recording(place, seed + (1 + i as u64) * NEXT, set.as_ref()),
        }
    };
    let recordings = sizes.iter().enumerate().map(of).collect();
    explain_jointly(recordings, claim, &Options::default(), &mut |_| {}).ok().map(|o| o.explanation)
}

/// What the recordings of one unit showed.
struct Shown {
    /// The effect is named, first of all.
    named: bool,
    /// Recordings that show anything alone.
    alone: u64,
    /// The interval holds the truth; `None` where the effect is not named.
    holds: Option<bool>,
    /// Another effect is named beside it.
    second: bool,
}

fn with_effect(kind: &str, place: Place, records: u64, first: u64) -> Vec<Row> {
    let claim = loaded(place);
    let one = |seed: u64| {
        let size = SHARE * noticeable(kind, place, &claim, seed)?;
        let joint = together(kind, place, &claim, seed, &[size; RECORDINGS as usize])?;
        let named = joint.shared.first().is_some_and(|s| s.kind == kind);
        let alone =
            joint.recordings.iter().filter(|r| r.alone.verdict != MismatchVerdict::Consistent).count();
        let claimed = match kind {
            "temp_linear" => claim.mean.temperature.map_or(0.0, |t| t.coefficient_deg_h_per_degc),
            "sf_error" => claim.mean.scale_factor_ppm.unwrap_or(0.0),
            _ => 0.0,
        };
        let holds = joint.shared.iter().find(|s| s.kind == kind).map(|s| {
            let parameter = s.parameters.iter().find(|(name, _)| *name != "rms_deg_h");
            parameter.is_some_and(|(_, p)| (p.ci95[0]..=p.ci95[1]).contains(&(claimed + size)))
        });
        Some(Shown { named, alone: alone as u64, holds, second: joint.shared.len() > 1 })
    };
    let found: Vec<Shown> = (first..first + records).into_par_iter().filter_map(one).collect();
    let of = found.len() as u64;
    let count = |f: &dyn Fn(&Shown) -> bool| found.iter().filter(|x| f(x)).count() as u64;
    let alone: u64 = found.iter().map(|f| f.alone).sum();
    let intervals: Vec<bool> = found.iter().filter_map(|f| f.holds).collect();
    let hold = intervals.iter().filter(|h| **h).count() as u64;
    vec![
        Row::share(kind, "named first by all together", Asked::AtLeast(0.9), count(&|f| f.named), of),
        Row::share(kind, "recordings that show anything alone", Asked::Nothing, alone, of * RECORDINGS),
        Row::share(kind, "95 % interval holds the truth", Asked::AtLeast(0.93), hold, intervals.len() as u64),
        Row::share(kind, "a second shared effect is named", Asked::AtMost(0.05), count(&|f| f.second), of),
    ]
}

fn disagreeing(kind: &str, place: Place, records: u64, first: u64) -> Vec<Row> {
    let claim = loaded(place);
    let one = |seed: u64| {
        let size = noticeable(kind, place, &claim, seed)?;
        let sizes: Vec<f64> =
            (0..RECORDINGS).map(|i| if i % 2 == 0 { 2.0 * size } else { -2.0 * size }).collect();
        let joint = together(kind, place, &claim, seed, &sizes)?;
        Some(joint.shared.iter().any(|s| s.kind == kind))
    };
    let found: Vec<bool> = (first..first + records).into_par_iter().filter_map(one).collect();
    let shared = found.iter().filter(|f| **f).count() as u64;
    vec![Row::share(kind, "named as shared", Asked::AtMost(0.05), shared, found.len() as u64)]
}

fn right(place: Place, records: u64, first: u64) -> Vec<Row> {
    let claim = loaded(place);
    let one = |seed: u64| {
        let joint = together("none", place, &claim, seed, &[0.0; RECORDINGS as usize])?;
        Some((joint.verdict != MismatchVerdict::Consistent, !joint.shared.is_empty()))
    };
    let found: Vec<(bool, bool)> = (first..first + records).into_par_iter().filter_map(one).collect();
    let count = |f: &dyn Fn(&(bool, bool)) -> bool| found.iter().filter(|x| f(x)).count() as u64;
    let of = found.len() as u64;
    vec![
        Row::share("right claim", "called a mismatch", Asked::AtMost(0.013), count(&|f| f.0), of),
        Row::share("right claim", "a shared effect is named", Asked::AtMost(0.013), count(&|f| f.1), of),
    ]
}
