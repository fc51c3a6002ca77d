//! `[explain]` in a procedure: the recording of a run against the model of its family.

use crate::support::{result, root, sagnac};
use std::path::Path;
use tempfile::tempdir;

/// A procedure for recordings of the samples' models, with what follows.
fn procedure(dir: &Path, more: &str) {
    let text = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
         [unit_under_test]\nserial_required = false\n\
         [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [[measurand]]\nid = \"static_bias\"\n[measurand.options]\nearth_rate = \"keep\"\n{more}"
    );
    std::fs::write(dir.join("p.toml"), text).unwrap();
}

/// A recording of the step model, and that model without its step as the family's.
fn recording(dir: &Path) {
    let model = root().join("samples/model-step.toml");
    let said = sagnac(dir, &["simulate", &model.display().to_string(), "--out", "step.csv"]);
    assert_eq!(said.code, 0, "{said:?}");
    let stated = std::fs::read_to_string(model).unwrap();
    let (before, rest) = stated.split_once("[[effect]]").unwrap();
    let (_, after) = rest.split_once("[simulation]").unwrap();
    std::fs::write(dir.join("family.toml"), format!("{before}[simulation]{after}")).unwrap();
    std::fs::write(dir.join("own.toml"), stated).unwrap();
}

#[test]
fn a_unit_that_differs_from_its_family_is_told_beside_its_verdict() {
    let dir = tempdir().unwrap();
    recording(dir.path());
    procedure(dir.path(), "[explain]\nmodel = \"family.toml\"\n");
    let said = sagnac(dir.path(), &["run", "p.toml", "step.csv", "--out", "r"]);
    assert_eq!(said.code, 0, "the verdict is that of the limits alone: {said:?}");
    assert!(said.out.contains("bias") && said.out.contains("omits"), "{}", said.out);
    let explained = &result(&dir.path().join("r"))["explained"];
    assert_eq!(explained["explanation"]["verdict"], "mismatch");
    assert_eq!(explained["explanation"]["effects"][0]["kind"], "bias_step");
    let step = explained["explanation"]["effects"][0]["parameters"]["step_deg_h"]["value"].as_f64().unwrap();
    assert!((step - 0.2).abs() < 0.04, "{step}");
    for name in ["report.html", "report.md", "explain/report.html", "explain/explain.json"] {
        assert!(dir.path().join("r").join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(dir.path().join("r/report.html")).unwrap();
    assert!(page.contains("explain/report.html") && page.contains("family.toml"));
}

#[test]
fn a_unit_like_its_model_is_told_to_be_so_and_twice_into_one_folder() {
    let dir = tempdir().unwrap();
    recording(dir.path());
    procedure(dir.path(), "[explain]\nmodel = \"own.toml\"\n");
    for _ in 0..2 {
        let said = sagnac(dir.path(), &["run", "p.toml", "step.csv", "--out", "r"]);
        assert_eq!(said.code, 0, "{said:?}");
    }
    assert_eq!(result(&dir.path().join("r"))["explained"]["explanation"]["verdict"], "consistent");
}

#[test]
fn a_model_that_is_wrong_is_refused_before_the_recording_is_read() {
    let dir = tempdir().unwrap();
    recording(dir.path());
    std::fs::write(dir.path().join("bad.toml"), "[recording]\nsample_rate_hz = \"ten\"\n").unwrap();
    procedure(dir.path(), "[explain]\nmodel = \"bad.toml\"\n");
    let said = sagnac(dir.path(), &["run", "p.toml", "step.csv", "--out", "r"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("bad.toml:2"), "{}", said.err);
    assert!(!dir.path().join("r").exists());
}
