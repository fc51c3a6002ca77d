//! Flicker, random walk and ramp where something else explains the slow part of a record.

use super::{case, limit, objections, run};
use crate::support::measurand;

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
