//! The report of a test that could not be carried out says nothing of what was not done.

use crate::support::{limits, procedure, result, sagnac, shipped, short_procedure, synthetic};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

/// Sentences that are true only of a recording that was examined or evaluated.
const CLAIMS: &[&str] = &[
    "No faults found",
    "Checked and not found",
    "Nothing was excluded",
    "None found",
    "samples, interval",
    "0 samples",
];

/// Recordings of which no row can be used, by name.
fn unusable(folder: &Path) -> Vec<&'static str> {
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text).unwrap();
    write("empty.csv", String::new());
    write("header.csv", "time_s,rate_deg_h,temp_degC\n".to_owned());
    let words: String = (0..200).map(|i| format!("{i},no,no\n")).collect();
    write("words.csv", format!("time_s,rate_deg_h,temp_degC\n{words}"));
    let stamps: String = (0..200).map(|_| "no,1.0,20\n".to_owned()).collect();
    write("stamps.csv", format!("time_s,rate_deg_h,temp_degC\n{stamps}"));
    write("column.csv", synthetic::recording(500).replace("rate_deg_h", "other"));
    write("one.csv", synthetic::recording(1));
    std::fs::write(
        folder.join("noise.bin"),
        (0..9999u32).flat_map(|i| (i * i).to_le_bytes()).collect::<Vec<u8>>(),
    )
    .unwrap();
    vec!["empty.csv", "header.csv", "words.csv", "stamps.csv", "column.csv", "one.csv", "noise.bin"]
}

fn examined(result: &Value, id: &str) -> bool {
    result["integrity"]["examined"].as_array().unwrap().iter().any(|e| e == id)
}

fn holds(folder: &Path, name: &str) -> String {
    ["report.md", "report.html"]
        .map(|page| std::fs::read_to_string(folder.join(page)).unwrap_or_else(|e| panic!("{name}: {e}")))
        .concat()
}

#[test]
fn an_error_report_claims_nothing_in_any_kind_of_test() {
    let dir = tempdir().unwrap();
    let names = unusable(dir.path());
    let procedures = [
        "static-bias",
        "scale-factor",
        "threshold",
        "misalignment",
        "multi-position",
        "temperature-ramp",
        "temperature-soak",
        "warm-up",
        "bias-repeatability",
        "magnetic-sensitivity",
        "supply-sensitivity",
        "vibration",
    ];
    let mut errors = 0;
    for procedure in procedures {
        let path = shipped(&format!("procedures/{procedure}.toml"));
        // Some of them are refused where they are opened, whatever the test.
        let of_every_test = ["header.csv", "words.csv", "one.csv"];
        for name in names.iter().filter(|n| procedure == "static-bias" || of_every_test.contains(*n)) {
            let said = sagnac(dir.path(), &["run", &path, name, "--serial", "S", "--out", "r"]);
            let what = format!("{procedure} {name}");
            let r = result(&dir.path().join("r"));
            assert_ne!(r["verdict"], "pass", "{what}");
            if said.code != 2 {
                continue;
            }
            errors += 1;
            let pages = holds(&dir.path().join("r"), &what);
            for claim in CLAIMS {
                assert!(!pages.contains(claim), "{what}: `{claim}`");
            }
            assert!(pages.contains("The recording was not checked for faults."), "{what}");
            assert_eq!(r["integrity"]["examined"], Value::Array(vec![]), "{what}");
            assert!(r["conditions"].as_array().unwrap().iter().all(|c| c["status"] != "ok"), "{what}");
            for clause in r["clauses"].as_array().unwrap() {
                assert_ne!(clause["status"], "here", "{what}: {clause}");
            }
        }
        std::fs::remove_dir_all(dir.path().join("r")).unwrap();
    }
    assert!(errors > 25, "{errors}");
}

#[test]
fn what_cannot_be_examined_is_not_told_as_absent() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("short.csv"), synthetic::recording(40)).unwrap();
    let plain: String = (0..3000).map(|i| format!("{:.5}\n", 12.5 + 0.1 * synthetic::white(1, i))).collect();
    std::fs::write(dir.path().join("clockless.csv"), format!("rate_deg_h\n{plain}")).unwrap();
    std::fs::write(dir.path().join("sound.csv"), synthetic::recording(3000)).unwrap();
    let analyse = |name: &str, more: &[&str]| {
        let said = sagnac(dir.path(), &[&["analyze", name, "--out", "a"][..], more].concat());
        assert_eq!(said.code, 0, "{said:?}");
        (result(&dir.path().join("a")), holds(&dir.path().join("a"), name))
    };
    let (sound, pages) = analyse("sound.csv", &[]);
    assert_eq!(sound["integrity"]["examined"].as_array().unwrap().len(), 12);
    assert!(pages.contains("No faults found.") && !pages.contains("Not checked"));
    let (short, pages) = analyse("short.csv", &[]);
    assert!(examined(&short, "gaps") && !examined(&short, "outliers") && !examined(&short, "repeated"));
    assert!(pages.contains("Not checked, because the required data are missing: "), "{pages}");
    let (clockless, pages) = analyse("clockless.csv", &["--sample-rate", "1"]);
    assert!(!examined(&clockless, "gaps") && !examined(&clockless, "backward_timestamps"));
    assert!(
        examined(&clockless, "outliers")
            && pages.contains("Not checked, because the required data are missing: ")
    );
}

#[test]
fn a_test_of_phases_that_could_not_run_says_so_of_its_clauses() {
    let dir = tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("good.csv"), synthetic::recording(3000)).unwrap();
    std::fs::write(at("other.csv"), synthetic::recording(3001)).unwrap();
    std::fs::write(at("bad.csv"), "time_s,rate_deg_h,temp_degC\n").unwrap();
    let short = short_procedure(dir.path());
    let name = Path::new(&short).file_name().unwrap().to_string_lossy().into_owned();
    let phase = |id: &str| format!("[[phase]]\nid = \"{id}\"\nprocedure = \"{name}\"\n\n");
    let clause = "[[clause]]\nclause = \"1\"\ntitle = \"t\"\nstatus = \"here\"\n";
    let head =
        "format = \"procedure/1\"\n[procedure]\nid = \"whole\"\ntitle = \"Whole\"\nrevision = \"A\"\n\n";
    std::fs::write(at("whole.toml"), format!("{head}{}{}{clause}", phase("a"), phase("b"))).unwrap();
    let file = |name: &str, phase: &str| format!("[[file]]\npath = \"{name}\"\nphase = \"{phase}\"\n");
    for (a, b, expected) in [
        ("good.csv", Some("other.csv"), "here"),
        ("good.csv", Some("bad.csv"), "partly"),
        ("good.csv", None, "partly"),
        ("bad.csv", None, "not_done"),
    ] {
        let b = b.map(|b| file(b, "b")).unwrap_or_default();
        std::fs::write(
            at("m.toml"),
            format!("format = \"manifest/1\"\nseveral_phases = true\n{}{b}", file(a, "a")),
        )
        .unwrap();
        sagnac(dir.path(), &["run", "whole.toml", "m.toml", "--serial", "S", "--out", "r"]);
        assert_eq!(result(&at("r"))["clauses"][0]["status"], expected);
        std::fs::remove_dir_all(at("r")).unwrap();
    }
}

#[test]
fn a_procedure_is_sound_only_with_the_files_that_it_names() {
    let dir = tempdir().unwrap();
    let text = std::fs::read_to_string(procedure()).unwrap();
    let at = |name: &str| dir.path().join(name);
    let with = |more: &str| std::fs::write(at("p.toml"), format!("{text}\n{more}\n")).unwrap();
    let check = |file: &str| sagnac(dir.path(), &["check", file]);
    with("[explain]\nmodel = \"model.toml\"");
    let said = check("p.toml");
    assert!(said.code == 2 && format!("{said:?}").contains("model.toml"), "{said:?}");
    std::fs::write(at("model.toml"), "[noise]\nN_deg_rt_h = \"a\"\n").unwrap();
    assert_eq!(check("p.toml").code, 2);
    std::fs::copy(shipped("samples/model-static.toml"), at("model.toml")).unwrap();
    assert_eq!(check("p.toml").code, 0);
    with("[recording]\nlayout = \"layout.toml\"");
    let said = check("p.toml");
    assert!(said.code == 2 && format!("{said:?}").contains("layout.toml"), "{said:?}");
    std::fs::write(at("layout.toml"), "format = \"layout/1\"\nrecord_bytes = 0\n").unwrap();
    assert_eq!(check("p.toml").code, 2);
    std::fs::copy(limits(), at("l.toml")).unwrap();
    let phased = "format = \"procedure/1\"\n[procedure]\nid = \"w\"\ntitle = \"W\"\nrevision = \"A\"\n\n[[phase]]\nid = \"a\"\nprocedure = \"p.toml\"\nlimits = \"l.toml\"\n";
    std::fs::write(at("w.toml"), phased).unwrap();
    assert_eq!(check("w.toml").code, 2, "a phase whose layout is wrong");
    with("");
    assert_eq!(check("w.toml").code, 0);
}
