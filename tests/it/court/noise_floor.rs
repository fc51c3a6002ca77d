//! The white floor that a record sees belongs to N, whatever filter, loop or process explains it.

use super::{case, holds, limit, objections, run};
use crate::support::{measurand, result, sagnac};

#[test]
fn the_floor_of_a_loop_with_a_resonance_is_angle_random_walk() {
    let folder = tempfile::tempdir().unwrap();
    let limits = limit(folder.path(), "angle_random_walk", "max = \"0.005 deg/sqrt(h)\"");
    let (said, result) = run(folder.path(), &case("loop-with-resonance/unit.csv.gz"), &limits);
    let n = measurand(&result, "angle_random_walk");
    assert_eq!((said.code, n["verdict"].as_str()), (1, Some("fail")), "{n}");
    assert!(holds(n, 0.01), "{n}");
}

#[test]
fn angle_random_walk_behind_a_low_pass_of_second_order_is_read_below_its_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let limits = limit(folder.path(), "angle_random_walk", "max = \"0.012 deg/sqrt(h)\"");
    let (said, result) = run(folder.path(), &case("loop-with-low-pass/unit.csv.gz"), &limits);
    let n = measurand(&result, "angle_random_walk");
    assert!(holds(n, 0.01), "{n}");
    assert_eq!((said.code, n["verdict"].as_str()), (0, Some("pass")), "{n}");
    let views = result["goodness_of_fit"].as_array().unwrap();
    let jump = views.iter().find(|v| v["view"] == "jump").unwrap();
    assert_eq!(jump["departs"], false, "no step is there: {jump}");
}

#[test]
fn a_record_that_is_short_against_the_memory_of_its_filter_shows_no_floor() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["run", &case("lowpass-5s/n.toml"), &case("lowpass-5s/unit.csv"), "--out", "o"];
    let said = sagnac(folder.path(), &arguments);
    assert_ne!(said.code, 0, "three times its limit does not pass: {}", said.out);
    let result = result(&folder.path().join("o"));
    let n = measurand(&result, "angle_random_walk");
    let found = n["value"].as_f64().is_some() && holds(n, 0.3);
    assert!(found || n["verdict"] == "indeterminate" && objections(n).contains(&"white_floor"), "{n}");
}
