//! A temperature that goes with the voltage: no verdict may come of it.

use sagnac_studies::edges::FAMILIES;

#[test]
fn a_temperature_in_step_with_the_level_leaves_no_verdict() {
    let mut cases = FAMILIES.iter().flat_map(|f| &f.cases);
    let case = cases.find(|c| c.name == "supply without effect, temperature in step with it").unwrap();
    let simulated = (case.draw)(5);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.csv"), &simulated.csv).unwrap();
    let limit = "[[limit]]\nmeasurand = \"supply_sensitivity\"\nmax_abs = \"0.1 deg/h/V\"\n";
    std::fs::write(folder.path().join("p.toml"), simulated.procedure + limit).unwrap();
    let done = std::process::Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .current_dir(folder.path())
        .args(["run", "p.toml", "r.csv", "--serial", "S", "--out", "o"])
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(3), "{}", String::from_utf8_lossy(&done.stdout));
    let text = std::fs::read_to_string(folder.path().join("o/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    let conditions = result["conditions"].as_array().unwrap();
    let said = conditions.iter().find(|c| c["id"] == "influence_temperature").unwrap();
    assert_eq!(said["status"], "invalid", "{said}");
    assert!((said["observed"]["difference"].as_f64().unwrap() - 8.0).abs() < 0.1, "{said}");
    let row =
        result["measurands"].as_array().unwrap().iter().find(|m| m["id"] == "supply_sensitivity").unwrap();
    assert!(row["value"].is_null() && row["verdict"] == "indeterminate", "{row}");
}
