//! `[explain]` in a procedure: the recording of a run against the model of its family.

use crate::support::shared::{SharedRun, shared, shared_input};
use crate::support::{result, sagnac, shipped};
use tempfile::tempdir;

/// A procedure for recordings of the samples' models, with what follows.
fn procedure(more: &str) -> String {
    format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
         [unit_under_test]\nserial_required = false\n\
         [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [[measurand]]\nid = \"static_bias\"\n[measurand.options]\nearth_rate = \"keep\"\n{more}"
    )
}

/// A recording of the step model.
fn recording() -> &'static str {
    shared(&["simulate", &shipped("samples/model-step.toml")], "step.csv").path()
}

/// The step model without its step, as that of its family.
fn family() -> String {
    let stated = std::fs::read_to_string(shipped("samples/model-step.toml")).unwrap();
    let (before, rest) = stated.split_once("[[effect]]").unwrap();
    let (_, after) = rest.split_once("[simulation]").unwrap();
    format!("{before}[simulation]{after}")
}

/// That recording tested, and held against the model of its family.
pub fn unlike_its_family() -> &'static SharedRun {
    shared_input("family.toml", family);
    let procedure = shared_input("explains.toml", || procedure("[explain]\nmodel = \"family.toml\"\n"));
    shared(&["run", &procedure, recording()], "r")
}

#[test]
fn a_unit_that_differs_from_its_family_is_told_beside_its_verdict() {
    let run = unlike_its_family();
    let said = &run.said;
    assert_eq!(said.code, 0, "the verdict is that of the limits alone: {said:?}");
    assert!(said.out.contains("bias") && said.out.contains("omits"), "{}", said.out);
    let explained = &run.result()["explained"];
    assert_eq!(explained["explanation"]["verdict"], "mismatch");
    assert_eq!(explained["explanation"]["effects"][0]["kind"], "bias_step");
    let step = explained["explanation"]["effects"][0]["parameters"]["step_deg_h"]["value"].as_f64().unwrap();
    assert!((step - 0.2).abs() < 0.04, "{step}");
    for name in ["report.html", "report.md", "explain/report.html", "explain/explain.json"] {
        assert!(run.out.join(name).is_file(), "{name}");
    }
    let page = run.text("report.html");
    assert!(page.contains("explain/report.html") && page.contains("family.toml"));
}

#[test]
fn a_unit_like_its_model_is_told_to_be_so_and_twice_into_one_folder() {
    let dir = tempdir().unwrap();
    std::fs::copy(shipped("samples/model-step.toml"), dir.path().join("own.toml")).unwrap();
    std::fs::write(dir.path().join("p.toml"), procedure("[explain]\nmodel = \"own.toml\"\n")).unwrap();
    for _ in 0..2 {
        let said = sagnac(dir.path(), &["run", "p.toml", recording(), "--out", "r"]);
        assert_eq!(said.code, 0, "{said:?}");
    }
    assert_eq!(result(&dir.path().join("r"))["explained"]["explanation"]["verdict"], "consistent");
}

#[test]
fn a_model_that_is_wrong_is_refused_before_the_recording_is_read() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("bad.toml"), "[recording]\nsample_rate_hz = \"ten\"\n").unwrap();
    std::fs::write(dir.path().join("p.toml"), procedure("[explain]\nmodel = \"bad.toml\"\n")).unwrap();
    let said = sagnac(dir.path(), &["run", "p.toml", recording(), "--out", "r"]);
    assert_eq!(said.code, 2);
    assert!(said.err.contains("bad.toml:2"), "{}", said.err);
    assert!(!dir.path().join("r").exists());
}
