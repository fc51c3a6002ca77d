//! A lot whose units share an error: it does not average out.

use super::input;
use crate::support::sagnac;
use serde_json::Value;

const CASE: &str = "lot-with-a-common-error";

fn results() -> Vec<String> {
    (0..20).map(|i| input(CASE, &format!("{i}.json"))).collect()
}

fn sheet(results: &[String]) -> (Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let mut args: Vec<&str> = vec!["datasheet"];
    args.extend(results.iter().map(String::as_str));
    args.extend(["--out", "sheet"]);
    let said = sagnac(folder.path(), &args);
    assert_eq!(said.code, 0, "{said:?}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join("sheet").join(name)).unwrap();
    (serde_json::from_str(&read("datasheet.json")).unwrap(), read("datasheet.md"))
}

#[test]
fn what_results_do_not_state_to_be_common_is_said_to_be_missing() {
    let (found, page) = sheet(&results());
    let notes = found["quantities"][0]["notes"].to_string();
    assert!(notes.contains("common"), "{notes}");
    assert!(
        page.contains("common to all units") && !page.contains("scatter of the measurement is taken out"),
        "{page}"
    );
}

#[test]
fn an_error_that_is_stated_to_be_common_widens_the_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let stated: Vec<String> = results()
        .iter()
        .enumerate()
        .map(|(i, path)| {
            let mut result: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
            result["measurands"][0]["common_standard_uncertainty"] = Value::from(1.0);
            let path = folder.path().join(format!("{i}.json"));
            std::fs::write(&path, result.to_string()).unwrap();
            path.to_string_lossy().into_owned()
        })
        .collect();
    let (plain, _) = sheet(&results());
    let (found, page) = sheet(&stated);
    let typical = |sheet: &Value| {
        let interval = &sheet["quantities"][0]["typical"]["interval"];
        (interval["low"].as_f64().unwrap(), interval["high"].as_f64().unwrap())
    };
    let ((low, high), (before_low, before_high)) = (typical(&found), typical(&plain));
    // One standard uncertainty of 1 for all, and a quarter of the spread of 20 units.
    assert!(
        high - low > 3.9 && before_high - before_low < 1.5,
        "{low} {high}, before {before_low} {before_high}"
    );
    assert!(low < 0.0 && high > 0.0);
    let bound = |sheet: &Value, side: &str| {
        let all = sheet["quantities"][0]["bounds"].as_array().unwrap();
        all.iter().find(|b| b["of"] == "true" && b["side"] == side).unwrap()["value"].as_f64().unwrap()
    };
    assert!(bound(&found, "upper") > bound(&plain, "upper") + 0.5);
    assert!(page.contains("share an error"), "{page}");
}
