//! The study: every family and half through the engine.

use super::catalogue::{names, seeds};
use super::engine::explain_case;
use super::score::Score;
use super::truth::{Family, Half, Strength};
use super::{case, tally};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use std::path::PathBuf;

/// Concealed effects of other physics than the engine's.
pub static STUDY: Study = Study {
    id: "laboratory",
    title: "Effects concealed by a second generator",
    method: "Recordings of a unit made of a thermal network with a coil in layers, hysteresis of many loops and curves that are no \
             polynomials, in a chamber, a room and weather that are simulated too. No formula is shared with the engine. Each \
             subject is concealed so that an oracle told the truth gains 60 to 300 nats (clear) or 20 to 60 (middling); several \
             at once, physics of no catalogue, and claims that are right, with up to five columns that drive nothing, are there \
             as well. Half of the seeds and half of the unknown kinds are looked at only to report. The number of records is \
             that of each subject and strength of a half; of nulls, thirty times as many.",
    records: 30,
    cases,
};

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for half in Half::ALL {
        for family in Family::ALL {
            let name = format!("{}, {}", family.name(), half.name());
            cases.push(Case::new(name, move |records, seed| {
                run(family, half, records, 1 + 100_000 * (seed - 1))
            }));
        }
    }
    cases
}

/// Rows of a family and half, from a number of cases of each subject and strength.
pub fn run(family: Family, half: Half, records: u64, first_seed: u64) -> Vec<Row> {
    let (count, strengths) = match family {
        Family::Null => (30 * records, &[Strength::Clear][..]),
        _ => (records, &Strength::ALL[..]),
    };
    let mut jobs = vec![];
    for name in names(family) {
        for strength in strengths {
            jobs.extend(seeds(name, half, count, first_seed).into_iter().map(|seed| (name, *strength, seed)));
        }
    }
    let scored: Vec<Option<Score>> = jobs.par_iter().map(|(n, s, seed)| scored(n, *s, *seed)).collect();
    let made = scored.iter().flatten().count() as u64;
    let scores: Vec<Score> = scored.into_iter().flatten().collect();
    let mut rows = tally::rows(family, &scores);
    let of = jobs.len() as u64;
    rows.push(Row::share("any", "cases made and explained without an error", Asked::AtLeast(0.99), made, of));
    rows
}

fn scored(name: &str, strength: Strength, seed: u64) -> Option<Score> {
    let case = case::make(name, strength, seed)?;
    let at = scratch(&case.truth.case);
    let said = explain_case(&case, &at, true);
    // What is left behind costs nothing but space.
    let _ = std::fs::remove_dir_all(&at);
    match said {
        Ok(said) => Some(Score::of(&case.truth, &said.answer, &case.time_s, said.again.as_deref())),
        Err(message) => {
            eprintln!("{message}");
            None
        }
    }
}

fn scratch(case: &str) -> PathBuf {
    std::env::temp_dir().join(format!("sagnac-laboratory-{}", std::process::id())).join(case)
}
