//! Every measurand where a truth lies at its edge, or where a second effect walks in step with the first, in short.
//!
//! A case draws a recording, the procedure and the truth; the program tests it as a user would, and `result.json` is set
//! against the truth. The studies are `cargo xtask validate edges-...`, one a family.

mod in_step;
mod noise_source;
mod tallies;

use sagnac::measurand::MEASURANDS;
use sagnac::record::{MeasurandRecord, RunRecord};
use sagnac_studies::edges::case::{Case, Edge, Simulated};
use sagnac_studies::edges::{FAMILIES, tally};
use std::path::Path;
use std::process::Command;

/// Recordings of each case in the study that runs with the tests.
const SHORT: usize = 8;

/// Runs the program and reads its result.
fn by_the_program(simulated: &Simulated, folder: &Path) -> Result<Vec<MeasurandRecord>, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sagnac"));
    command.current_dir(folder).env("RAYON_NUM_THREADS", "1");
    command.args(["run", "p.toml", "r.csv", "--serial", "SN-0001", "--out", "o"]);
    if simulated.is_limited() {
        command.args(["--limits", "l.toml"]);
    }
    let output = command.output().map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&output.stderr);
    let text = std::fs::read_to_string(folder.join("o/result.json")).map_err(|e| format!("{e}: {said}"))?;
    serde_json::from_str::<RunRecord>(&text).map(|r| r.measurands).map_err(|e| e.to_string())
}

#[test]
fn every_measurand_stands_in_one_family_and_every_family_is_complete() {
    for family in FAMILIES.iter() {
        let gaps = family.gaps();
        assert!(gaps.is_empty(), "{}: neither a case nor a reason why there is none: {gaps:#?}", family.name);
        for id in &family.ids {
            assert!(MEASURANDS.iter().any(|m| m.id == id), "{}: `{id}` is no measurand", family.name);
        }
    }
    for m in MEASURANDS {
        let stands = |ids: &[String]| ids.iter().any(|id| id == m.id);
        let families: Vec<_> = FAMILIES.iter().filter(|f| stands(&f.ids)).map(|f| &f.name).collect();
        assert_eq!(families.len(), 1, "`{}` stands in {families:?}", m.id);
    }
}

#[test]
fn every_measurand_stands_in_a_row_of_every_disturbance_or_with_a_reason() {
    let gaps = sagnac_studies::disturbances::gaps(MEASURANDS.iter().map(|m| m.id));
    assert!(gaps.is_empty(), "neither a case nor a reason why there is none: {gaps:#?}");
}

#[test]
fn intervals_hold_at_the_edges_in_a_short_study() {
    if !crate::support::long::wanted("intervals_hold_at_the_edges_in_a_short_study") {
        return;
    }
    let mut wrong = Vec::new();
    for family in FAMILIES.iter() {
        for case in &family.cases {
            let tallies = tally::run(case, SHORT, 0, &by_the_program);
            wrong.extend(
                tallies.iter().filter_map(|t| t.certainly_wrong().map(|why| format!("{}: {why}", case.name))),
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn slow_terms_have_a_case_at_every_edge() {
    let noise = FAMILIES.iter().find(|f| f.name == "noise").unwrap();
    for id in ["bias_instability", "rate_random_walk", "rate_ramp", "quantization"] {
        for edge in [Edge::Zero, Edge::BelowNoise] {
            let shown = |c: &&Case| c.edges.contains(&edge) && c.ids.iter().any(|i| i == id);
            assert!(noise.cases.iter().any(|c| shown(&c)), "{id}: {edge:?}");
        }
    }
}
