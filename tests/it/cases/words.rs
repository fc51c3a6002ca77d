//! Sentences and figures that must agree with the rule they state.

use super::run;
use crate::support::{measurand, sagnac, sample, shipped};

#[test]
fn a_condition_says_the_range_that_it_accepts() {
    let (said, found) =
        run("scale-factor", &shipped("samples/scale-factor-pass.csv"), &["--serial", "SN-0101"]);
    let conditions = found["conditions"].as_array().unwrap();
    let response =
        conditions.iter().find(|c| c["id"].as_str().unwrap().starts_with("table_response")).unwrap();
    assert_eq!(response["required"], "output over input from 0.3 to 2", "{}", said.out);
}

#[test]
fn a_row_that_passes_by_its_upper_limit_says_so() {
    let limits = shipped("procedures/limits/sample-unit.toml");
    let (said, found) = run("static-bias", &sample("pass"), &["--serial", "SN-0001", "--limits", &limits]);
    assert_eq!(said.code, 0, "{}", said.out);
    let rows = found["measurands"].as_array().unwrap();
    let bounded = rows.iter().filter(|m| m["verdict"] == "pass" && m["value"].is_null()).count();
    assert_eq!(said.out.matches("met (upper limit)").count(), bounded, "{}", said.out);
}

#[test]
fn a_claim_states_what_is_not_resolved_as_a_bound() {
    let folder = tempfile::tempdir().unwrap();
    let result = folder.path().join("r");
    let said = sagnac(
        folder.path(),
        &["run", "static-bias", &sample("pass"), "--serial", "SN-0001", "--out", &result.to_string_lossy()],
    );
    assert_eq!(said.code, 0, "{said:?}");
    let found = crate::support::result(&result);
    let model = sagnac(folder.path(), &["model", &result.to_string_lossy(), "--out", "model.toml"]);
    assert_eq!(model.code, 0, "{model:?}");
    let text = std::fs::read_to_string(folder.path().join("model.toml")).unwrap();
    for (id, key) in [
        ("angle_random_walk", "N_at_most_deg_rt_h"),
        ("bias_instability", "B_at_most_deg_h"),
        ("rate_random_walk", "K_at_most_deg_h_rt_h"),
    ] {
        let row = measurand(&found, id);
        let limit = row["upper_limit"]["value"].as_f64().filter(|_| row["value"].is_null());
        let stated =
            text.lines().find_map(|l| l.strip_prefix(key)?.trim().strip_prefix('=')?.trim().parse().ok());
        let stated: Option<f64> = stated;
        assert_eq!(stated.is_some(), limit.is_some(), "{id}: {text}");
        assert!(stated.zip(limit).is_none_or(|(a, b)| a >= b), "{id}: {text}");
    }
}
