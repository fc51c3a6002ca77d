//! The table of edges: how every measurand behaves where a truth lies at its edge, or where a second effect walks in
//! step with the first.
//!
//! Each family of measurands is one file with its cases and a generator of its own, which imports nothing from the
//! analysis. A case draws a recording, the procedure and the truth; the program tests it as a user would, and
//! `result.json` is set against the truth. A short study of every case runs with the tests. The table in
//! `docs/validation/edges.md` is written by
//!
//! ```sh
//! cargo test --release --test edges -- --ignored --nocapture
//! ```
//!
//! `FAMILY` restricts it to one family, `RECORDS` sets the number of recordings of each case.

mod case;
mod influence;
mod noise;
mod noise_source;
mod on_table;
mod page;
mod rate_table;
mod small_rates;
mod study;
mod temperature;
mod tilts;

use case::Family;
use sagnac::measurand::MEASURANDS;

/// Every family. One more: one file and one line.
static FAMILIES: &[&Family] = &[
    &influence::FAMILY,
    &noise::FAMILY,
    &rate_table::FAMILY,
    &small_rates::FAMILY,
    &temperature::FAMILY,
    &tilts::FAMILY,
];

/// Recordings of each case in the study that runs with the tests.
const SHORT: usize = 8;

#[test]
fn every_measurand_stands_in_one_family_and_every_family_is_complete() {
    for family in FAMILIES {
        let gaps = family.gaps();
        assert!(gaps.is_empty(), "{}: neither a case nor a reason why there is none: {gaps:#?}", family.name);
        for id in family.ids {
            assert!(MEASURANDS.iter().any(|m| m.id == *id), "{}: `{id}` is no measurand", family.name);
        }
    }
    for m in MEASURANDS {
        let families: Vec<_> = FAMILIES.iter().filter(|f| f.ids.contains(&m.id)).map(|f| f.name).collect();
        assert_eq!(families.len(), 1, "`{}` stands in {families:?}", m.id);
    }
}

#[test]
fn intervals_hold_at_the_edges_in_a_short_study() {
    let mut wrong = Vec::new();
    for family in FAMILIES {
        for case in family.cases {
            let tallies = study::run(case, SHORT, 0);
            wrong.extend(
                tallies.iter().filter_map(|t| t.certainly_wrong().map(|why| format!("{}: {why}", case.name))),
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "the whole table takes an hour or more"]
fn the_table() {
    let only = std::env::var("FAMILY").ok();
    for family in FAMILIES.iter().filter(|f| only.as_ref().is_none_or(|name| name == f.name)) {
        let mut results = Vec::new();
        for case in family.cases {
            let records = std::env::var("RECORDS").ok().and_then(|r| r.parse().ok()).unwrap_or(case.records);
            let tallies = study::run(case, records, 1_000_000);
            for tally in &tallies {
                println!("{} | {} | {}", family.name, case.name, tally.line());
            }
            results.push((case, tallies));
        }
        page::keep(family, &results);
    }
    page::write(FAMILIES);
}
