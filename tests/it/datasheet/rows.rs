//! The rows that a sheet file chooses, and what the sheet says of limits.

use super::{bound, of_the_lot, quantity, sheet};
use crate::support::{root, sagnac};
use tempfile::tempdir;

const FILE: &str = "format = \"sheet/1\"\ntitle = { en = \"Model S\", ru = \"Модель S\" }\n\
    [[row]]\nmeasurand = \"bias_instability\"\nfootnote = \"At rest.\"\n\
    [[row]]\nmeasurand = \"angle_random_walk\"\nname = { en = \"ARW\", ru = \"СУ\" }\nunit = \"deg/h/sqrt(Hz)\"\n\
    [[row]]\nmeasurand = \"rate_ramp\"\nchannel = \"nowhere\"\n";

#[test]
fn rows_names_units_and_footnotes_are_those_of_the_file() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("s.toml"), FILE).unwrap();
    let results = root().join("samples/lot/*/result.json").display().to_string();
    let said = sagnac(dir.path(), &["datasheet", &results, "--sheet", "s.toml", "--out", "own"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    let (all, own) = (sheet(&of_the_lot().out), sheet(&dir.path().join("own")));
    let ids: Vec<&str> =
        own["quantities"].as_array().unwrap().iter().map(|q| q["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["bias_instability", "angle_random_walk"]);
    assert_eq!(own["title"], "Model S");
    let (plain, arw) = (quantity(&all, "angle_random_walk"), quantity(&own, "angle_random_walk"));
    // 1 deg/√h is 60 deg/h/√Hz.
    for (a, b) in [
        (bound(plain, "measured", "upper"), bound(arw, "measured", "upper")),
        (plain["largest"]["value"].as_f64().unwrap(), arw["largest"]["value"].as_f64().unwrap()),
    ] {
        assert!((b / a - 60.0).abs() < 1e-9, "{a} {b}");
    }
    assert_eq!((arw["name"].as_str(), arw["unit"].as_str()), (Some("ARW"), Some("deg/h/sqrt(Hz)")));
    let page = std::fs::read_to_string(dir.path().join("own/datasheet.html")).unwrap();
    assert!(page.contains("At rest.") && page.contains("nowhere"), "{page}");
}

#[test]
fn what_more_units_would_promise_and_what_a_limit_risks_is_said() {
    let all = sheet(&of_the_lot().out);
    let arw = quantity(&all, "angle_random_walk");
    let more = &arw["outlook"][0];
    let now = bound(arw, "measured", "upper");
    let typical = arw["typical"]["value"].as_f64().unwrap();
    let value = more["value"].as_f64().unwrap();
    assert!(more["units"] == 60 && value < now && value > typical, "{more}");
    let risks = arw["risks"].as_array().unwrap();
    let of = |i: usize, side: &str| risks[i][side].as_f64().unwrap();
    assert_eq!(risks.len(), 4, "{arw}");
    assert!((1..4).all(|i| of(i, "producer") >= of(i - 1, "producer")), "{risks:?}");
    assert!(all["curves"][0]["points"][0]["bound"].as_f64().is_some(), "{}", all["curves"][0]["points"][0]);
}

#[test]
fn a_sheet_file_with_a_foreign_unit_is_refused_at_its_line() {
    let dir = tempdir().unwrap();
    let text = "format = \"sheet/1\"\n[[row]]\nmeasurand = \"angle_random_walk\"\nunit = \"V\"\n";
    std::fs::write(dir.path().join("s.toml"), text).unwrap();
    let results = root().join("samples/lot/*/result.json").display().to_string();
    let said = sagnac(dir.path(), &["datasheet", &results, "--sheet", "s.toml", "--out", "own"]);
    assert!(said.code == 2 && said.err.contains("s.toml:4"), "{said:?}");
    assert!(!dir.path().join("own").exists());
}
