//! A report as a numbered protocol of its house: number, organisation, place, those who sign, certificates in the budget.

use crate::support::quick::Quick;
use crate::support::{Said, altered, measurand, result, sagnac};
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A test whose report is a protocol; the folder `r` in the temporary one holds its result.
fn tested() -> (TempDir, Said) {
    let dir = tempdir().unwrap();
    let quick = Quick::new("pass");
    let keys = "[report]\nprotocol = \"GT-{serial}-{date}\"\norganisation = { en = \"Gyro Laboratory\", ru = \"Лаборатория гироскопов\" }\n\
                place = { en = \"Hall 4\", ru = \"Зал 4\" }\nsignatories = [\"quality_control\", \"customer_representative\"]\n";
    let procedure = altered(dir.path(), "p.toml", &quick.procedure, &[("[report]\n", keys)]);
    let args =
        ["run", &procedure, &quick.recording, "--limits", &quick.limits, "--serial", "SN-1", "--out", "r"];
    let said = sagnac(dir.path(), &args);
    (dir, said)
}

fn page(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn a_protocol_has_its_number_its_house_and_those_who_sign() {
    let (dir, said) = tested();
    assert_eq!(said.code, 0, "{said:?}");
    let folder = dir.path().join("r");
    let record = result(&folder);
    let day = &record["session"]["evaluated_at"].as_str().unwrap()[..10];
    let number = format!("GT-SN-1-{day}");
    assert_eq!(record["session"]["protocol"], number);
    assert_eq!(record["procedure"]["organisation"], "Gyro Laboratory");
    let html = page(&folder, "report.html");
    for shown in [&number, "Gyro Laboratory", "Hall 4", "Quality control", "Representative of the customer"] {
        assert!(html.contains(shown), "{shown}");
    }
    let markdown = page(&folder, "report.md");
    assert!(markdown.contains("| Quality control | | | |") && markdown.contains(&number), "{markdown}");
}

#[test]
fn a_protocol_is_written_again_in_russian() {
    let (dir, _) = tested();
    let said = sagnac(dir.path(), &["report", "r", "--lang", "ru", "--out", "ru"]);
    assert_eq!(said.code, 0, "{said:?}");
    let html = page(&dir.path().join("ru"), "report.html");
    for shown in ["Лаборатория гироскопов", "Зал 4", "ОТК", "Представитель заказчика (ВП)", "№ GT-SN-1-"]
    {
        assert!(html.contains(shown), "{shown}");
    }
}

#[test]
fn a_certificate_stands_beside_the_component_that_it_states() {
    let dir = tempdir().unwrap();
    let shipped = crate::support::shipped("procedures/scale-factor.toml");
    let name =
        "name = { en = \"rate table with angle read-out\", ru = \"поворотный стенд с отсчётом угла\" }\n";
    let keys = format!(
        "{name}certificate = \"18/2026-0412\"\ncalibrated = 2026-03-02\ncomponent = \"table_rate\"\n"
    );
    let procedure = altered(dir.path(), "p.toml", &shipped, &[(name, &keys)]);
    let recording = crate::support::shipped("samples/scale-factor-pass.csv");
    let said = sagnac(dir.path(), &["run", &procedure, &recording, "--serial", "SN-0001", "--out", "r"]);
    let folder = dir.path().join("r");
    let record = result(&folder);
    let budget = &measurand(&record, "scale_factor_error")["budget"];
    let of_table = budget.as_array().unwrap().iter().find(|c| c["input"] == "table_rate").unwrap();
    assert_eq!((&of_table["source"], &of_table["common_to"]), (&"certificate".into(), &"table".into()));
    let html = page(&folder, "report.html");
    assert!(html.contains("certificate 18/2026-0412 (2026-03-02)"), "{said:?}");
    assert!(html.contains("Uncertainty budgets"));
}
