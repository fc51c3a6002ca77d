//! Folders whose maker can write every file anew, hashes and pages among them, and what gives them away.

use crate::documents::{tested, verified};
use crate::support::{limits, procedure, result, sagnac, sagnac_with, sample, shipped};
use sagnac::output::sha256;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Writes a file of a folder anew, and the list of hashes to match.
pub fn rewrite(folder: &Path, name: &str, change: impl Fn(&str) -> String) {
    let at = folder.join(name);
    let before = fs::read_to_string(&at).unwrap();
    let after = change(&before);
    assert_ne!(before, after, "{name}");
    fs::write(&at, &after).unwrap();
    let list = folder.join("SHA256SUMS");
    let sums = fs::read_to_string(&list).unwrap();
    fs::write(&list, sums.replace(&sha256(before.as_bytes()), &sha256(after.as_bytes()))).unwrap();
}

/// Leaves a file of a result out, as if it had never been written.
pub fn forget(folder: &Path, name: &str) {
    fs::remove_file(folder.join(name)).unwrap();
    let list = folder.join("SHA256SUMS");
    let sums = fs::read_to_string(&list).unwrap();
    let rest: String =
        sums.lines().filter(|l| !l.ends_with(&format!("  {name}"))).map(|l| format!("{l}\n")).collect();
    fs::write(&list, rest).unwrap();
    rewrite(folder, "result.json", |text| text.replace(&format!("    \"{name}\",\n"), ""));
}

/// A folder that says of the failing recording what the passing one gives, with pages and hashes to match.
fn forged(dir: &Path, name: &str, change: impl Fn(&mut Value)) {
    let (procedure, limits) = (procedure(), limits());
    for unit in ["pass", "fail"] {
        if dir.join(unit).exists() {
            continue;
        }
        let recording = sample(unit);
        let args = ["run", &procedure, &recording, "--limits", &limits, "--serial", "SN-1", "--out", unit];
        assert!(sagnac(dir, &args).code < 2);
    }
    let (mut record, failed) = (result(&dir.join("pass")), result(&dir.join("fail")));
    record["recording"] = failed["recording"].clone();
    record["inputs"] = failed["inputs"].clone();
    change(&mut record);
    let source = format!("{name}-source");
    fs::create_dir(dir.join(&source)).unwrap();
    for (file, bytes) in crate::support::files(&dir.join("pass")) {
        let at = dir.join(&source).join(file);
        fs::create_dir_all(at.parent().unwrap()).unwrap();
        fs::write(at, bytes).unwrap();
    }
    fs::write(dir.join(&source).join("result.json"), serde_json::to_vec_pretty(&record).unwrap()).unwrap();
    let said = sagnac(dir, &["report", &source, "--out", name]);
    assert_eq!(said.code, 0, "{said:?}");
}

#[test]
fn a_forged_pass_does_not_agree_with_its_own_recording() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let recording = sample("fail");
    let unchanged: fn(&mut Value) = |_| {};
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 5] = [
        ("plain", unchanged),
        ("options", |r| r["inputs"]["options"] = "other".into()),
        ("no-inputs", |r| r["inputs"] = json!({})),
        ("version", |r| r["program"]["version"] = "0.0.1".into()),
        ("nothing-read", |r| r["recording"] = json!([])),
    ];
    for (name, change) in changes {
        forged(at, name, change);
        let (code, said) = verified(at, &[name, "--recording", &recording]);
        assert!(code == 1 || code == 3, "{name}: {code} {said}");
        assert!(!said.ends_with("Nothing differs.\n"), "{name}: {said}");
        if name == "plain" || name == "options" {
            assert!(code == 1 && said.contains("gives other figures"), "{name}: {said}");
        }
    }
    // Without a place for temporary files nothing can be computed, and nothing is said to agree.
    let none = [("TMPDIR", "/nowhere"), ("TEMP", "/nowhere"), ("TMP", "/nowhere")];
    let said = sagnac_with(at, &["verify", "pass", "--recording", &sample("pass")], &none);
    assert!(said.code == 3 && said.out.contains("no temporary folder"), "{said:?}");
    assert!(said.out.ends_with("Not everything could be checked: 1.\n"), "{said:?}");
    // Neither is the result of another version, though its pages are what they are.
    let (code, said) = verified(at, &["version"]);
    assert!(code == 3 && said.contains("? Pages not re-rendered"), "{said}");
}

#[test]
fn honest_runs_verify_wherever_their_serial_numbers_come_from() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let stated = shipped("samples/supply-sensitivity-pass.csv");
    assert_eq!(sagnac(at, &["run", "supply-sensitivity", &stated, "--out", "stated"]).code, 0);
    let (code, said) = verified(at, &["stated", "--recording", &stated]);
    assert!(code == 0 && said.contains("The recording gives the same figures"), "{said}");
    // Another number than the recording's is found.
    rewrite(&at.join("stated"), "result.json", |text| text.replace("\"serial\": \"", "\"serial\": \"9"));
    let (code, said) = verified(at, &["stated", "--recording", &stated]);
    assert!(code == 1 && said.contains("gives other figures: unit_under_test"), "{said}");

    let text = fs::read_to_string(&stated).unwrap();
    fs::write(at.join("SN-77.csv"), text.split_once('\n').unwrap().1).unwrap();
    let args = ["run", "supply-sensitivity", &stated, "SN-77.csv", "--each", "--out", "lot"];
    assert_eq!(sagnac(at, &args).code, 0);
    let (code, said) = verified(at, &["lot", "--recording", &stated, "--recording", "SN-77.csv"]);
    assert!(code == 0 && said.matches("The recording gives the same figures").count() == 2, "{said}");
    let (code, said) = verified(at, &["lot", "--recording", "SN-77.csv"]);
    assert!(code == 3 && said.contains("no recording of the unit was named"), "{said}");
    let (code, said) = verified(at, &["lot/SN-77", "--recording", "SN-77.csv"]);
    assert_eq!(code, 0, "{said}");

    // Options that the folder does not keep are named again.
    let recording = sample("pass");
    let run = ["run", &procedure(), &recording, "--serial", "SN-1", "--taus", "decade", "--out", "taus"];
    assert!(sagnac(at, &run).code < 2);
    let (code, said) = verified(at, &["taus", "--recording", &recording]);
    assert!(code == 3 && said.contains("other inputs (options)"), "{said}");
    let (code, said) = verified(at, &["taus", "--recording", &recording, "--", "--taus", "decade"]);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_lot_says_what_its_units_say() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let units = ["pass", "fail"].map(|name| shipped(&format!("samples/supply-sensitivity-{name}.csv")));
    let args = ["run", "supply-sensitivity", &units[0], &units[1], "--each", "--out", "lot"];
    assert_eq!(sagnac(at, &args).code, 1);
    let (code, said) = verified(at, &["lot"]);
    assert!(code == 0 && said.contains("agrees with the results of its units (2)"), "{said}");
    let index: Value = serde_json::from_slice(&fs::read(at.join("lot/index.json")).unwrap()).unwrap();
    let failed = index["units"].as_array().unwrap().iter().position(|u| u["verdict"] == "fail").unwrap();
    let folder = index["units"][failed]["folder"].as_str().unwrap().to_owned();
    let forge = |change: &dyn Fn(&mut Value)| {
        let mut forged = index.clone();
        change(&mut forged);
        fs::create_dir_all(at.join("source")).unwrap();
        for (file, bytes) in crate::support::files(&at.join("lot")) {
            fs::create_dir_all(at.join("source").join(&file).parent().unwrap()).unwrap();
            fs::write(at.join("source").join(file), bytes).unwrap();
        }
        fs::write(at.join("source/index.json"), serde_json::to_vec_pretty(&forged).unwrap()).unwrap();
        assert_eq!(sagnac(at, &["report", "source", "--out", "forged"]).code, 0);
        verified(at, &["forged"])
    };
    let (code, said) = forge(&|lot| {
        lot["units"][failed]["verdict"] = "pass".into();
        lot["verdict"] = "pass".into();
        lot["counts"]["fail"] = 0.into();
        lot["counts"]["pass"] = 2.into();
    });
    assert!(code == 1 && said.contains(&format!("{folder}: the index of the lot contradicts")), "{said}");
    let (code, said) = forge(&|lot| lot["verdict"] = "pass".into());
    assert!(code == 1 && said.contains("do not follow from its units"), "{said}");
    // A unit whose verdict does not follow from its own numbers.
    let unit = at.join("lot").join(&folder);
    rewrite(&unit, "result.json", |text| text.replace("\"verdict\": \"fail\"", "\"verdict\": \"pass\""));
    let (code, said) = verified(at, &["lot"]);
    assert!(code == 1 && said.contains(&format!("{folder}: ")) && said.contains("does not follow"), "{said}");
}

#[test]
fn tables_and_figures_are_those_of_the_recording() {
    let recording = sample("pass");
    for name in ["sigma_tau.csv", "figures/data.json"] {
        let dir = tested("pass");
        let at = dir.path();
        let folder = at.join("r");
        let digit = |text: &str| {
            let place =
                text.len() / 2 + text[text.len() / 2..].find(|c: char| ('1'..='8').contains(&c)).unwrap();
            format!("{}9{}", &text[..place], &text[place + 1..])
        };
        rewrite(&folder, name, digit);
        // Drawings to match.
        assert_eq!(sagnac(at, &["report", "r", "--out", "anew"]).code, 0);
        let (code, said) = verified(at, &["anew"]);
        assert!(said.contains("Compared by their hashes only") && said.contains(name), "{code} {said}");
        let (code, said) = verified(at, &["anew", "--recording", &recording]);
        assert!(code == 1 && said.contains("gives other figures") && said.contains(name), "{name}: {said}");
    }
    let dir = tested("pass");
    let svg = crate::support::names(&dir.path().join("r/figures")).into_iter().find(|n| n.ends_with(".svg"));
    rewrite(&dir.path().join("r"), &format!("figures/{}", svg.unwrap()), |text| {
        text.replacen("</svg>", "<g/></svg>", 1)
    });
    let (code, said) = verified(dir.path(), &["r"]);
    assert!(code == 1 && said.contains("not what the record gives"), "{said}");
}

#[test]
fn a_data_sheet_is_that_of_its_results() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let lot = shipped("samples/lot/*/result.json");
    assert_eq!(sagnac(at, &["datasheet", &lot, "--out", "sheet"]).code, 0);
    let (code, said) = verified(at, &["sheet"]);
    assert!(code == 0 && said.contains("The results give the numbers of the data sheet"), "{said}");
    let mut sheet: Value =
        serde_json::from_slice(&fs::read(at.join("sheet/datasheet.json")).unwrap()).unwrap();
    let bounds =
        sheet["quantities"].as_array_mut().unwrap().iter_mut().find(|q| q["bounds"][0]["value"].is_f64());
    let bound = &mut bounds.unwrap()["bounds"][0]["value"];
    *bound = (bound.as_f64().unwrap() * 0.5).into();
    fs::create_dir(at.join("source")).unwrap();
    fs::write(at.join("source/datasheet.json"), serde_json::to_vec_pretty(&sheet).unwrap()).unwrap();
    assert_eq!(sagnac(at, &["report", "source", "--out", "forged"]).code, 0);
    let (code, said) = verified(at, &["forged"]);
    assert!(code == 1 && said.contains("The results give other numbers"), "{said}");
}

#[cfg(unix)]
#[test]
fn names_in_the_list_of_hashes_lead_to_files_of_the_folder_alone() {
    use std::os::unix::fs::symlink;
    let dir = tested("pass");
    let at = dir.path();
    let page = fs::read(at.join("r/report.md")).unwrap();
    let says = |name: &str, what: &str| {
        let (code, said) = verified(at, &["r"]);
        assert!(code == 1 && said.contains(&format!("{name}: {what}")), "{name}: {said}");
    };
    fs::create_dir_all(at.join("r/empty/deep")).unwrap();
    says("empty/deep", "an empty folder");
    fs::remove_dir_all(at.join("r/empty")).unwrap();
    // A link to the same bytes is no file of the folder.
    fs::rename(at.join("r/report.md"), at.join("outside.md")).unwrap();
    symlink(at.join("outside.md"), at.join("r/report.md")).unwrap();
    says("report.md", "a link in place of a file");
    fs::remove_file(at.join("r/report.md")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(at.join("r/report.md")).status().unwrap().success());
    says("report.md", "not an ordinary file");
    fs::remove_file(at.join("r/report.md")).unwrap();
    fs::write(at.join("r/report.md"), &page).unwrap();
    symlink(at.join("outside.md"), at.join("r/more.md")).unwrap();
    says("more.md", "a link in place of a file");
    fs::remove_file(at.join("r/more.md")).unwrap();
    let list = fs::read_to_string(at.join("r/SHA256SUMS")).unwrap();
    let outside = at.join("outside.md").display().to_string();
    for name in ["../outside.md", &outside] {
        let mut lines: Vec<String> = list.lines().map(|l| format!("{l}\n")).collect();
        lines.push(format!("{}  {name}\n", sha256(&page)));
        lines.sort_by(|a, b| a[66..].cmp(&b[66..]));
        fs::write(at.join("r/SHA256SUMS"), lines.concat()).unwrap();
        says(name, "leads out of the folder");
    }
    fs::write(at.join("r/SHA256SUMS"), list).unwrap();
    assert_eq!(verified(at, &["r"]).0, 0);
}
