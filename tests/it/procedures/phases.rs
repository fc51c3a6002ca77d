//! Procedures of several phases from the command line.

use crate::support::shared::phased_once;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn sagnac(args: &[&str], out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sagnac")).args(args).arg("--out").arg(out).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn result(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("result.json")).unwrap()).unwrap()
}

fn acceptance() -> String {
    root("procedures/acceptance.toml").to_string_lossy().into_owned()
}

#[test]
fn one_report_covers_all_phases_and_the_worst_verdict_is_that_of_the_whole() {
    for (end, code, verdicts) in
        [("pass", 0, ["pass", "pass", "pass"]), ("fail", 1, ["pass", "fail", "pass"])]
    {
        let run = phased_once(end);
        assert_eq!(run.said.code, code, "{:?}", run.said);
        let (out, whole) = (&run.out, run.result());
        assert_eq!(whole["procedure"]["id"], "acceptance");
        assert_eq!(whole["unit_under_test"]["serial"], "SN-0111");
        let phases = whole["phases"].as_array().unwrap();
        let of = |i: usize| phases[i]["verdict"].as_str().unwrap();
        assert_eq!([of(0), of(1), of(2)], verdicts);
        // Each phase alone says the same as its part of the whole.
        let mut rows = 0;
        for p in phases {
            let own = result(&out.join(p["folder"].as_str().unwrap()));
            assert_eq!((&own["verdict"], &own["summary"]), (&p["verdict"], &p["summary"]));
            let (mine, whole) = (own["measurands"].as_array().unwrap(), p["measurands"].as_array().unwrap());
            assert_eq!(mine.len(), whole.len());
            for (a, b) in mine.iter().zip(whole) {
                assert_eq!((&a["id"], &a["value"], &a["verdict"]), (&b["id"], &b["value"], &b["verdict"]));
                assert_eq!(b["phase"], p["id"]);
            }
            rows += mine.len();
            assert!(p["conditions"].as_array().unwrap().iter().all(|c| c["phase"] == p["id"]));
            for f in p["figures"].as_array().unwrap() {
                assert!(out.join(f["file"].as_str().unwrap()).exists(), "{f}");
            }
        }
        assert_eq!(whole["measurands"].as_array().unwrap().len(), rows);
        assert_eq!(whole["recording"].as_array().unwrap().len(), 3);
        let page = run.text("report.html");
        let mut ids: Vec<&str> =
            page.match_indices(" id=\"").filter_map(|(i, m)| page[i + m.len()..].split('"').next()).collect();
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all, "marks of the page are unique");
        for title in ["Repeatability of the bias", "Scale factor", "Input-axis alignment"] {
            assert!(page.contains(title), "{title}");
        }
        assert!(out.join("report.md").exists());
    }
}

/// A manifest over the samples, in a folder of its own.
fn manifest(folder: &Path, files: &[(&str, Option<&str>)]) -> String {
    let mut text = String::from("format = \"manifest/1\"\nserial = \"SN-0111\"\nseveral_phases = true\n");
    for (name, phase) in files {
        std::fs::copy(root(&format!("samples/{name}")), folder.join(name)).unwrap();
        text.push_str(&format!("[[file]]\npath = \"{name}\"\n"));
        if let Some(phase) = phase {
            text.push_str(&format!("phase = \"{phase}\"\n"));
        }
    }
    let path = folder.join("manifest.toml");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn what_does_not_fit_is_said_before_anything_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let refused = |args: &[&str], words: &str| {
        let done = sagnac(args, &out);
        assert_eq!(done.status.code(), Some(2), "{args:?}");
        assert!(said(&done).contains(words), "{words}: {}", said(&done));
        assert!(!out.exists());
    };
    let sample = root("samples/scale-factor-pass.csv").to_string_lossy().into_owned();
    refused(&["run", &acceptance(), &sample, "--lang", "en"], "pass a manifest that names the phase");
    let odd = manifest(folder.path(), &[("scale-factor-pass.csv", Some("scalefactor"))]);
    refused(&["run", &acceptance(), &odd, "--lang", "en"], "unknown phase");
    let none = manifest(folder.path(), &[("scale-factor-pass.csv", None)]);
    refused(&["run", &acceptance(), &none, "--lang", "en"], "names no phase");
    let limits = root("procedures/limits/sample-unit.toml").to_string_lossy().into_owned();
    let good = root("samples/acceptance-pass.toml").to_string_lossy().into_owned();
    refused(
        &["run", &acceptance(), &good, "--limits", &limits, "--lang", "en"],
        "limits belong to the phases",
    );
}

#[test]
fn a_phase_without_a_recording_is_an_error_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let two = manifest(
        folder.path(),
        &[
            ("bias-repeatability-pass.csv", Some("repeatability")),
            ("scale-factor-pass.csv", Some("scale-factor")),
        ],
    );
    let done = sagnac(&["run", &acceptance(), &two], &out);
    assert_eq!(done.status.code(), Some(2), "{}", said(&done));
    let whole = result(&out);
    assert_eq!(whole["verdict"], "error");
    assert_eq!(whole["phases"][2]["summary"][0]["id"], "phases.not_recorded");
    assert_eq!(whole["phases"][0]["verdict"], "pass");
}

#[test]
fn a_phase_that_fails_says_why_on_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let all = manifest(
        folder.path(),
        &[
            ("bias-repeatability-pass.csv", Some("repeatability")),
            ("scale-factor-pass.csv", Some("scale-factor")),
            ("misalignment-pass.csv", Some("alignment")),
        ],
    );
    let sample = folder.path().join("scale-factor-pass.csv");
    let text = std::fs::read_to_string(&sample).unwrap().replacen("counts", "turns", 1);
    std::fs::write(&sample, text).unwrap();
    let done = sagnac(&["run", &acceptance(), &all, "--lang", "en"], &out);
    assert_eq!(done.status.code(), Some(2), "{}", said(&done));
    let shown = String::from_utf8_lossy(&done.stdout).into_owned();
    let line = shown.lines().find(|l| l.contains("Scale factor")).unwrap_or_else(|| panic!("{shown}"));
    assert!(line.ends_with("error"), "{line}");
    let reasons = shown.split("\nScale factor\n").nth(1).unwrap_or_else(|| panic!("{shown}"));
    assert!(reasons.contains("counts"), "{shown}");
    let stderr = said(&done);
    // At the line of the procedure that asks for the column, and only there.
    assert!(
        stderr.contains("there is no column `counts`\n") && stderr.contains("scale-factor.toml:"),
        "{stderr}"
    );
    assert_eq!(stderr.matches("error: ").count(), 1, "{stderr}");
}

#[test]
fn phases_within_a_phase_reach_its_procedure() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(root("procedures/bias-repeatability.toml")).unwrap();
    let runs = "[[repeatability_test.run]]\nphase = \"cold\"\n\n[conditions]";
    let text = text.replacen("[conditions]", runs, 1).replace("minimum_duration = \"30 min\"\n", "");
    std::fs::write(folder.path().join("runs.toml"), text).unwrap();
    let phased = "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
                  [[phase]]\nid = \"series\"\nprocedure = \"runs.toml\"\n";
    let procedure = folder.path().join("phased.toml");
    std::fs::write(&procedure, phased).unwrap();
    let one = manifest(folder.path(), &[("bias-repeatability-pass.csv", Some("series.cold"))]);
    let out = folder.path().join("report");
    let done = sagnac(&["run", procedure.to_str().unwrap(), &one], &out);
    // The whole file is one run of the phase: too few.
    assert_eq!(done.status.code(), Some(3), "{}", said(&done));
    let whole = result(&out);
    assert_eq!(whole["recording"][0]["phase"], "series.cold");
    let ids: Vec<&str> =
        whole["conditions"].as_array().unwrap().iter().filter_map(|c| c["message"]["id"].as_str()).collect();
    assert!(ids.contains(&"runs.one"), "{ids:?}");
}

#[test]
fn problems_of_phases_have_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("phased.toml");
    let text = "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
                [[phase]]\nid = \"a\"\nprocedure = \"none.toml\"\n[[phase]]\nid = \"a\"\nprocedure = \"none.toml\"\n";
    std::fs::write(&path, text).unwrap();
    let check = |path: &Path| {
        Command::new(env!("CARGO_BIN_EXE_sagnac")).args(["check", "--lang", "en"]).arg(path).output().unwrap()
    };
    let done = check(&path);
    let shown = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(2), "{shown}");
    assert!(shown.contains("phased.toml:10:") && shown.contains("cannot be distinguished"), "{shown}");
    std::fs::write(&path, text.replacen("id = \"a\"", "id = \"b\"", 1)).unwrap();
    let missing = check(&path);
    assert!(String::from_utf8_lossy(&missing.stdout).contains("none.toml"), "{missing:?}");
    let sound = check(&root("procedures/acceptance.toml"));
    assert_eq!(sound.status.code(), Some(0), "{sound:?}");
}
