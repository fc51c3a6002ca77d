//! `sagnac model`: from a recording, or its result, to a claim that other recordings are held against.

use crate::support::shared::tested_once;
use crate::support::synthetic::white;
use crate::support::{sagnac, sample};
use sagnac::config::model::load;
use std::fmt::Write;
use tempfile::tempdir;

const TRUTH: &str = "[recording]\ncase = \"unit\"\nsample_rate_hz = 1.0\ncolumns = [\"time_s\", \"rate_deg_h\"]\n\
    [noise]\nN_deg_rt_h = 0.01\nK_deg_h_rt_h = 0.1\n[bias]\nvalue_deg_h = 1.0\n";

const STEP: &str =
    "[[effect]]\nkind = \"bias_step\"\n[effect.parameters]\nstep_deg_h = 3.0\ntime_s = 14400.0\n";

#[test]
fn the_model_of_one_recording_fits_the_next_and_not_one_with_a_step() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    std::fs::write(at.join("truth.toml"), TRUTH).unwrap();
    std::fs::write(at.join("step.toml"), format!("{TRUTH}{STEP}")).unwrap();
    for (model, seed, out) in
        [("truth.toml", "1", "a.csv"), ("truth.toml", "2", "b.csv"), ("step.toml", "3", "c.csv")]
    {
        let said = sagnac(at, &["simulate", model, "--duration", "8h", "--seed", seed, "--out", out]);
        assert_eq!(said.code, 0, "{said:?}");
    }
    let said = sagnac(at, &["model", "a.csv", "--case", "unit 7", "--out", "m.toml"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    assert!(said.out.contains("sagnac explain RECORDING --model m.toml"), "{}", said.out);
    let claim = load(&at.join("m.toml")).unwrap();
    assert_eq!((claim.case.as_str(), claim.description.text()), ("unit 7", "a.csv"));
    let (n, k) = (claim.noise.n, claim.noise.k);
    // Four deviations.
    assert!((n / 0.01 - 1.0).abs() < 4.0 * claim.uncertainty.n_rel, "{n}");
    assert!((k / 0.1).ln().abs() < 4.0 * claim.uncertainty.k_rel, "{k}");
    assert!(claim.uncertainty.n_rel > 0.0 && claim.uncertainty.bias_deg_h > 0.0);
    let explained = |recording: &str| {
        sagnac(at, &["explain", recording, "--model", "m.toml", "--out", recording.trim_end_matches(".csv")])
    };
    assert_eq!(explained("b.csv").code, 0);
    assert_eq!(explained("c.csv").code, 1);

    // What stands there is not replaced unasked.
    let part = ["model", "a.csv", "--from", "1h", "--to", "3h", "--out", "m.toml"];
    let refused = crate::support::sagnac_as_typed(at, &part, &[]);
    assert!(refused.code == 2 && refused.err.contains("m.toml"), "{refused:?}");
    let said = crate::support::sagnac_as_typed(at, &[part.as_slice(), &["--force", "--quiet"]].concat(), &[]);
    assert_eq!((said.code, said.out.as_str()), (0, "m.toml\n"), "{said:?}");
    let part = load(&at.join("m.toml")).unwrap();
    assert!(part.noise != claim.noise && (part.noise.n / 0.01 - 1.0).abs() < 0.1, "{:?}", part.noise);
    let said = sagnac(at, &["model", "a.csv", "--from", "20h", "--out", "none.toml"]);
    assert!(said.code == 2 && !at.join("none.toml").exists(), "{said:?}");
}

#[test]
fn the_model_of_a_result_is_that_of_its_recording() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    let tested = tested_once("pass").path();
    assert_eq!(sagnac(at, &["model", tested, "--out", "of-result.toml"]).code, 0);
    assert_eq!(sagnac(at, &["model", &sample("pass"), "--out", "of-recording.toml"]).code, 0);
    let (result, recording) =
        (load(&at.join("of-result.toml")).unwrap(), load(&at.join("of-recording.toml")).unwrap());
    assert!(
        (result.noise.n / recording.noise.n - 1.0).abs() < 0.02,
        "{} {}",
        result.noise.n,
        recording.noise.n
    );
    assert!((result.sample_rate_hz / recording.sample_rate_hz - 1.0).abs() < 1e-6);
    // A bias is without the rotation of the Earth; a recording is not.
    let apart = (result.mean.bias_deg_h - recording.mean.bias_deg_h).abs();
    assert!(apart < 4.0 * recording.uncertainty.bias_deg_h.max(0.01), "{apart}");
    let said = sagnac(at, &["explain", &sample("pass"), "--model", "of-result.toml", "--out", "e"]);
    assert!(said.code == 0, "{said:?}");
    for (args, why) in [
        (vec!["model", tested, "--from", "1h", "--out", "x.toml"], "name the recording"),
        (vec!["model", tested, "--rate", "nowhere", "--out", "x.toml"], "choose one with --rate"),
        (vec!["model", "missing.csv", "--out", "x.toml"], "missing.csv"),
    ] {
        let said = sagnac(at, &args);
        assert!(said.code == 2 && said.err.contains(why), "{args:?}: {said:?}");
        assert!(!at.join("x.toml").exists());
    }
}

#[test]
fn noise_that_is_not_even_is_stated_and_allowed_and_no_more() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    // A normal number z and a part of z² - 1: of 0.06 and of 0.2.
    let recording = |name: &str, seed: u64, part: f64| {
        let mut text = String::from("time_s,rate_deg_h\n");
        for i in 0..20_000u64 {
            let z = white(seed, i);
            let _ = writeln!(text, "{i},{:.6}", 5.0 + z + part * (z * z - 1.0));
        }
        std::fs::write(at.join(name), text).unwrap();
    };
    recording("a.csv", 11, 0.06);
    recording("b.csv", 12, 0.06);
    recording("c.csv", 13, 0.2);
    assert_eq!(sagnac(at, &["model", "a.csv", "--out", "m.toml"]).code, 0);
    let claim = load(&at.join("m.toml")).unwrap();
    // (6 part + 8 part³) / (1 + 2 part²)^1.5 is 0.358; with two deviations of 0.018 besides.
    assert!((0.33..0.46).contains(&claim.uncertainty.skewness), "{}", claim.uncertainty.skewness);
    let explained = |recording: &str, model: &str, out: &str| {
        sagnac(at, &["explain", recording, "--model", model, "--out", out]).code
    };
    assert_eq!(explained("b.csv", "m.toml", "b"), 0);
    assert_eq!(explained("c.csv", "m.toml", "c"), 3);
    let text = std::fs::read_to_string(at.join("m.toml")).unwrap();
    let even: Vec<&str> = text.lines().filter(|l| !l.starts_with("skewness")).collect();
    std::fs::write(at.join("even.toml"), even.join("\n")).unwrap();
    assert_eq!(explained("b.csv", "even.toml", "d"), 3);
}
