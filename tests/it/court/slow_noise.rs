//! Flicker, random walk and ramp where something else explains the slow part of a record.

use super::{analyzed, case, limit, objections, run};
use crate::support::measurand;
use sagnac_studies::bench::noise_source::NoiseSource;

#[test]
fn flicker_beside_a_long_process_does_not_fail() {
    let folder = tempfile::tempdir().unwrap();
    let limits = limit(folder.path(), "bias_instability", "max = \"0.004 deg/h\"");
    let (said, result) = run(folder.path(), &case("long-markov/unit.csv.gz"), &limits);
    let b = measurand(&result, "bias_instability");
    assert_eq!((said.code, b["verdict"].as_str()), (3, Some("indeterminate")), "{b}");
}

#[test]
fn random_walk_does_not_fail_for_a_step_and_the_step_is_timed_from_the_start_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let limits = limit(folder.path(), "rate_random_walk", "max = \"0.005 deg/h/sqrt(h)\"");
    let (said, result) = run(folder.path(), &case("step-counted-from-warm-up/unit.csv"), &limits);
    let k = measurand(&result, "rate_random_walk");
    assert_eq!((said.code, k["verdict"].as_str()), (3, Some("indeterminate")), "{k}");
    assert!(objections(k).contains(&"step"), "{k}");
    let all = k["objections"].as_array().unwrap();
    let step = all.iter().find(|o| o["check"] == "step").unwrap();
    let time_s = step["found"]["args"]["time_s"].as_f64().unwrap();
    assert!((time_s - 18_000.0).abs() < 300.0, "{time_s}");
    let place = |words: &str| said.out.find(words).unwrap_or_else(|| panic!("{words}: {}", said.out));
    assert!(
        place("Not decided") < place("the level steps by") && place("the level steps by") < place("Quantity")
    );
}

#[test]
fn a_small_step_in_white_noise_leaves_random_walk_open_and_a_walk_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let contradicted = |rates: &[f64]| {
        let found = analyzed(folder.path(), 1.0, rates);
        let row = measurand(&found, "rate_random_walk");
        (row["value"].is_number(), objections(row).contains(&"step"))
    };
    for seed in 0..4 {
        let mut source = NoiseSource::new(31 + seed);
        let white = source.white(0.002, 1.0, 14_400);
        // Half a standard deviation of a sample, at a place of its own in each record.
        let from = 3000 + 2500 * seed as usize;
        let stepped: Vec<f64> =
            white.iter().enumerate().map(|(i, v)| if i < from { *v } else { v + 0.06 }).collect();
        assert_eq!(contradicted(&stepped), (true, true), "{seed}");
        let walk = source.walk(0.05, 1.0, 14_400);
        let walking: Vec<f64> = white.iter().zip(&walk).map(|(v, w)| v + w).collect();
        assert_eq!(contradicted(&walking), (true, false), "{seed}");
    }
}
