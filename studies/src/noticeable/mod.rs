//! The sizes of effects that an explanation says would have been noticed: how often they are.

pub mod bench;

use crate::study::{Asked, Case, Row, Study};
use bench::{Place, Set, claim, recording};
use rayon::prelude::*;
use sagnac::claim::Claim;
use sagnac::mismatch::finding::{Explanation, MismatchVerdict};
use sagnac::mismatch::noticeable_record::NoticeableSize;
use sagnac::mismatch::{Options, explain};
use sagnac::series::Series;
use std::collections::BTreeMap;

/// Effects of the stated sizes in fresh noise.
pub static STUDY: Study = Study {
    id: "noticeable-sizes",
    title: "Sizes that would have been noticed",
    method: "A recording in which the claim is right is explained, which states a size for each kind. An effect of that size, of \
             half and of twice that is set into another recording, with fresh noise and drivers; noise and stated values are \
             off by 1.5 of the claim's deviations. Noticed is whatever is not consistent. Searched effects have the size of \
             the typical place there, and that of the worst place at the worst place. Noise, drivers and effects are made by \
             sums that share nothing with the program.",
    records: 40,
    cases,
};

/// Kinds at rest.
pub const AT_REST: [&str; 11] = [
    "temp_linear",
    "temp_rate",
    "column_driver",
    "rate_ramp",
    "bias_step",
    "warmup_exponential",
    "line",
    "excess_arw",
    "excess_rrw",
    "markov_long",
    "noise_variance_time",
];
/// Kinds on a table.
pub const ON_TABLE: [&str; 1] = ["sf_error"];

fn cases() -> Vec<Case> {
    let of = |name: &str, place: Place, kinds: &'static [&'static str]| {
        Case::new(name, move |records, seed| run(place, kinds, &Dose::ALL, records, 1 + 100_000 * (seed - 1)))
    };
    vec![of("at rest", Place::AtRest, &AT_REST), of("on a table", Place::OnTable, &ON_TABLE)]
}

/// How an effect is set in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dose {
    /// Half of the stated size.
    Half,
    /// The stated size.
    Whole,
    /// Twice the stated size.
    Twice,
    /// At the worst place, the size stated for it.
    Worst,
}

impl Dose {
    /// All of them.
    pub const ALL: [Dose; 4] = [Dose::Half, Dose::Whole, Dose::Twice, Dose::Worst];

    fn claim(self) -> &'static str {
        match self {
            Dose::Half => "noticed at half of the stated size",
            Dose::Whole => "noticed at the stated size",
            Dose::Twice => "noticed at twice the stated size",
            Dose::Worst => "noticed at the worst place, at the size stated for it",
        }
    }

    /// 95 % is stated; a chance of two in a hundred is left to either side of it beyond that of the Monte Carlo.
    fn asked(self) -> Asked {
        match self {
            Dose::Half => Asked::AtMost(0.7),
            Dose::Whole | Dose::Worst => Asked::AtLeast(0.93),
            Dose::Twice => Asked::AtLeast(0.99),
        }
    }
}

/// Shares of the records in which each kind is noticed at each dose.
pub fn run(place: Place, kinds: &[&str], doses: &[Dose], records: u64, first_seed: u64) -> Vec<Row> {
    let claim = loaded(place);
    let told: Vec<(u64, Option<Explanation>)> = (first_seed..first_seed + records)
        .into_par_iter()
        .map(|seed| (seed, explained(recording(place, 2 * seed, None), &claim)))
        .collect();
    kinds.iter().flat_map(|kind| of_kind(place, kind, doses, &claim, &told)).collect()
}

/// Of one kind.
fn of_kind(
    place: Place,
    kind: &str,
    doses: &[Dose],
    claim: &Claim,
    told: &[(u64, Option<Explanation>)],
) -> Vec<Row> {
    let noticed: Vec<Vec<(Dose, bool)>> = told
        .par_iter()
        .map(|(seed, told)| noticed_of(place, kind, doses, claim, *seed, told.as_ref()))
        .collect();
    let mut rows = vec![];
    for dose in Dose::ALL {
        let of: Vec<bool> =
            noticed.iter().flatten().filter(|(d, _)| *d == dose).map(|(_, noticed)| *noticed).collect();
        if of.is_empty() {
            continue;
        }
        let hits = of.iter().filter(|n| **n).count() as u64;
        rows.push(Row::share(kind, dose.claim(), dose.asked(), hits, of.len() as u64));
    }
    let stated = noticed.iter().filter(|n| !n.is_empty()).count() as u64;
    rows.push(Row::share(kind, "a size is stated", Asked::AtLeast(0.9), stated, told.len() as u64));
    rows
}

/// What is noticed of a kind in one pair of recordings: the first tells the sizes, the noise of the second is its own.
fn noticed_of(
    place: Place,
    kind: &str,
    doses: &[Dose],
    claim: &Claim,
    seed: u64,
    told: Option<&Explanation>,
) -> Vec<(Dose, bool)> {
    let Some(told) = told else { return vec![] };
    let Some(stated) = told.noticeable.iter().find(|n| n.kind == kind) else { return vec![] };
    let one = |dose: Dose| {
        let (size, at) = size(stated, dose)?;
        let set = Set { kind, size, at };
        // The deviations of the truth from the claim are those of the first recording.
        let fresh = recording(place, 2 * seed + (1 << 40), Some(&set));
        let explanation = explained(fresh, claim)?;
        Some((dose, explanation.verdict != MismatchVerdict::Consistent))
    };
    doses.iter().copied().filter_map(one).collect()
}

fn size(stated: &NoticeableSize, dose: Dose) -> Option<(f64, &BTreeMap<String, f64>)> {
    // A ratio is the larger, the farther it is from 1.
    let nil = if stated.parameter == "ratio" { 1.0 } else { 0.0 };
    let times = |factor: f64| nil + factor * (stated.size - nil);
    match dose {
        Dose::Half => Some((times(0.5), &stated.at)),
        Dose::Whole => Some((times(1.0), &stated.at)),
        Dose::Twice => Some((times(2.0), &stated.at)),
        Dose::Worst => stated.worst.as_ref().map(|w| (w.size, &w.at)),
    }
}

fn explained(series: Series, claim: &Claim) -> Option<Explanation> {
    explain(series, claim, &Options::default(), &mut |_| {}).ok().map(|o| o.explanation)
}

/// The claim of a place, as the program reads it.
pub fn loaded(place: Place) -> Claim {
    let read = sagnac::config::model::parse("model.toml", claim(place).as_bytes());
    read.map(|m| m.claim).unwrap_or_else(|_| panic!("the claim cannot be read"))
}
