//! Several recordings of one unit, explained together.

use super::{json, model, names, rows, with};
use crate::support::sagnac;
use crate::support::shared::{SharedRun, shared, shared_input};
use tempfile::tempdir;

/// Temperature as [`with`] writes it, without the noise of its sensor.
fn temperature(i: usize) -> f64 {
    (i as f64 / 900.0).sin()
}

/// Recordings of a unit whose bias follows its temperature.
const RECORDINGS: [&str; 4] = ["a.csv", "b.csv", "c.csv", "d.csv"];

fn recording(i: usize) -> String {
    shared_input(&format!("joint-{}", RECORDINGS[i]), || rows(300 + 10 * i as u64, |k| 0.05 * temperature(k)))
}

/// Them explained together.
pub fn joint() -> &'static SharedRun {
    let recordings = [0, 1, 2, 3].map(recording);
    let mut args = vec!["explain"];
    args.extend(recordings.iter().map(String::as_str));
    let model = model();
    args.extend(["--model", &model]);
    shared(&args, "all")
}

#[test]
fn what_recordings_share_is_found_with_all_of_them() {
    let dir = tempdir().unwrap();
    let run = joint();
    let (said, all) = (&run.said, &run.out);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    assert_eq!(
        names(all),
        ["SHA256SUMS", "augmented.toml", "joint.json", "recordings", "report.html", "report.md"]
    );
    let joint = json(&all.join("joint.json"));
    assert_eq!(joint["format"], "explain-joint/1");
    let shared = &joint["shared"][0];
    assert_eq!(shared["kind"], "temp_linear", "{joint:#}");
    let ci = &shared["parameters"]["coefficient_deg_h_per_degC"]["ci95"];
    let (low, high) = (ci[0].as_f64().unwrap(), ci[1].as_f64().unwrap());
    // Wider than 95 %, for these are single recordings.
    let slack = 0.5 * (high - low);
    assert!(low - slack < 0.05 && 0.05 < high + slack, "{ci}");
    for (i, recording) in joint["recordings"].as_array().unwrap().iter().enumerate() {
        assert!(recording["name"].as_str().unwrap().ends_with(RECORDINGS[i]), "{recording}");
        assert_eq!(recording["together"]["verdict"], "consistent", "{recording}");
        let own = all.join(recording["folder"].as_str().unwrap()).join("explain.json");
        assert_eq!(json(&own)["verdict"], "consistent");
    }
    assert!(said.out.contains("d.csv"), "{}", said.out);

    // The folder renders anew, in the other language as well.
    let anew = sagnac(dir.path(), &["report", run.path(), "--lang", "ru", "--out", "anew"]);
    assert_eq!((anew.code, anew.err.as_str()), (0, ""), "{anew:?}");
    let page = std::fs::read_to_string(dir.path().join("anew/report.html")).unwrap();
    assert!(page.contains("Общее для записей"), "{page}");

    // With the shared effect in the model nothing is left.
    let augmented = format!("{}/augmented.toml", run.path());
    let args = ["explain", &recording(0), "--model", &augmented, "--out", "again"];
    assert_eq!(sagnac(dir.path(), &args).code, 0);
}

#[test]
fn a_recording_that_does_not_fit_the_model_is_named() {
    let dir = tempdir().unwrap();
    with(dir.path(), "a.csv", 1, |_| 0.0);
    std::fs::write(dir.path().join("b.csv"), "time_s,rate_deg_h\n0,1\n10,2\n20,1\n30,3\n").unwrap();
    let said = sagnac(dir.path(), &["explain", "a.csv", "b.csv", "--model", "model.toml", "--out", "e"]);
    assert!(said.code == 2 && said.err.contains("b.csv") && !said.err.contains("a.csv"), "{said:?}");
    assert!(!dir.path().join("e").exists());
    let said = sagnac(dir.path(), &["explain", "a.csv", "b.csv", "--simulation", "a.csv", "--out", "e"]);
    assert!(said.code == 2 && said.err.contains("--model"), "{said:?}");
}
