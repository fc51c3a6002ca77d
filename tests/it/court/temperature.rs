//! A sweep of temperature is no test at rest, whichever command is asked.

use super::{case, objections};
use crate::support::{measurand, result, sagnac};

#[test]
fn no_command_takes_a_sweep_of_temperature_for_a_test_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = case("thermal-sweep-as-static/sweep.csv");
    let inspected = sagnac(folder.path(), &["inspect", &sweep]);
    let static_test = inspected.out.lines().find(|l| l.trim_start().starts_with("static test")).unwrap();
    assert!(static_test.contains("No:"), "{static_test}");
    let analysed = sagnac(folder.path(), &["analyze", &sweep, "--out", "a"]);
    let found = result(&folder.path().join("a"));
    for id in ["angle_random_walk", "bias_instability", "rate_random_walk", "rate_ramp", "static_bias"] {
        assert!(objections(measurand(&found, id)).contains(&"temperature"), "{id}");
    }
    assert!(analysed.out.lines().any(|l| l.contains("Not decided")), "{}", analysed.out);
    let drafted = sagnac(folder.path(), &["init", &sweep, "--out", "d"]);
    assert_eq!(drafted.code, 0, "{drafted:?}");
    let draft = std::fs::read_to_string(folder.path().join("d/procedure.toml")).unwrap();
    assert!(draft.contains("[temperature_test]"), "{draft}");
    let said = sagnac(folder.path(), &["run", "d/procedure.toml", &sweep, "--serial", "J-1", "--out", "r"]);
    assert_ne!(said.code, 2, "{said:?}");
    let value = |id: &str| measurand(&result(&folder.path().join("r")), id)["value"].as_f64();
    let range = value("bias_over_temperature_peak_to_peak").unwrap();
    assert!((range / 1700.0 - 1.0).abs() < 0.1, "{range}");
}
