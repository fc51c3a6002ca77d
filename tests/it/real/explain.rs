//! Real recordings against what a plain claim of N, B and K says of them, where the folder named by `SAGNAC_REAL_DATA`
//! holds them. The claims are the published or independently computed values of each set.

use crate::support::real::set;
use crate::support::sagnac;
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

/// N deg/√h, B deg/h and K deg/h/√h at a sample rate, nothing else, the bias hardly known.
fn claim(rate_hz: f64, n: f64, b: f64, k: f64, bias: f64) -> String {
    format!(
        "[recording]\ncase = \"plain\"\nsample_rate_hz = {rate_hz}\n[noise]\nN_deg_rt_h = {n}\nB_deg_h = {b}\n\
         K_deg_h_rt_h = {k}\n[bias]\nvalue_deg_h = {bias}\n[uncertainty]\nN_rel = 0.02\nB_rel = 0.15\nK_rel = 0.2\n\
         bias_deg_h = 10\n"
    )
}

fn explained(recording: &Path, column: &str, unit: &str, model: &str, more: &[&str]) -> Value {
    let folder = tempdir().unwrap();
    std::fs::write(folder.path().join("model.toml"), model).unwrap();
    let path = recording.display().to_string();
    let args = ["explain", &path, "--rate", column, "--unit", unit, "--model", "model.toml", "--out", "out"];
    let said = sagnac(folder.path(), &[&args, more].concat());
    assert!(matches!(said.code, 1 | 3), "{}", said.err);
    println!("{}", said.out);
    serde_json::from_str(&std::fs::read_to_string(folder.path().join("out/explain.json")).unwrap()).unwrap()
}

/// Places of all findings in a domain.
fn places(report: &Value, domain: &str) -> Vec<(f64, f64)> {
    let effects = report["effects"].as_array().unwrap();
    let all = effects.iter().flat_map(|e| e["where"].as_array().unwrap());
    all.filter(|w| w["domain"] == domain)
        .map(|w| (w["from"].as_f64().unwrap(), w["to"].as_f64().unwrap()))
        .collect()
}

fn heldout_gain(report: &Value) -> f64 {
    let of = |which: &str| report["fit"][which]["heldout_log_likelihood"].as_f64().unwrap();
    of("augmented") - of("baseline")
}

#[test]
fn a_fibre_optic_unit_is_told_to_have_a_comb_at_its_reset_frequency() {
    let Some(folder) = set("fog_blueseis_serrodyne_ramp") else { return };
    // N from 1 to 10 Hz; 360 s hold neither B nor K. Mean rate as the set gives it.
    let model = claim(200.0, 5.3e-5, 0.002, 0.0, 11.15);
    // The ramp that makes the resets is in the file: concealed, its comb is what is left to find.
    let hide = ["--hide", "ramp_counts"];
    let report = explained(&folder.join("vertical_360s.parquet"), "rate_counts", "nrad/s", &model, &hide);
    assert_eq!(report["verdict"], "unknown-mismatch");
    // Resets at 4.166 to 4.176 Hz and lines at every multiple.
    let comb = places(&report, "frequency").into_iter().find(|(from, _)| (4.16..4.18).contains(from));
    assert!(comb.is_some_and(|(_, to)| to > 16.0), "{:?}", places(&report, "frequency"));
    assert!(heldout_gain(&report) > 1000.0);
}

#[test]
fn a_micromechanical_unit_is_told_to_have_a_filter() {
    let Some(folder) = set("mems_adis16405_static") else { return };
    let report = explained(
        &folder.join("unit1.parquet"),
        "rate_x_deg_s",
        "deg/s",
        &claim(100.0, 2.451, 28.3, 0.0, 1300.0),
        &[],
    );
    // From 0.01 to 0.02 s the deviation of the set falls by 1.24 and not by √2.
    assert_eq!(report["effects"][0]["kind"], "bandwidth_filter", "{}", report["effects"]);
    let cutoff = report["effects"][0]["parameters"]["cutoff_hz"]["value"].as_f64().unwrap();
    assert!((25.0..100.0).contains(&cutoff), "{cutoff}");
    assert!(heldout_gain(&report) > 1000.0);
}

/// LN-100, x down, against N, B and the mean of the set.
fn ring_laser(more: &[&str]) -> Option<Value> {
    let folder = set("rlg_ln100_two_position")?;
    let model = claim(64.055, 0.0016, 0.05, 0.0, -11.98);
    Some(explained(&folder.join("x_down.parquet"), "rate_x_deg_h", "deg/h", &model, more))
}

#[test]
fn a_ring_laser_unit_is_told_where_its_lines_are() {
    let Some(report) = ring_laser(&[]) else { return };
    // Quantisation and lines at 9.195, 19.08, 20.7 and 29.93 Hz: the strongest is named, and the small rest is placed.
    let spans = places(&report, "frequency");
    assert!(spans.iter().any(|(from, to)| *from < 29.95 && *to > 29.93), "{spans:?}");
    let rest = report["rest"]["where"].as_array().expect("a rest");
    let lines = rest.iter().filter(|p| p["domain"] == "frequency");
    let mut ends = lines.map(|p| (p["from"].as_f64().unwrap(), p["to"].as_f64().unwrap()));
    assert!(ends.any(|(from, to)| from < 20.75 && to > 20.65), "{rest:?}");
    assert!(heldout_gain(&report) > 1000.0);
}

#[test]
fn a_ring_laser_unit_has_its_lines_and_its_quantisation_named_where_more_effects_are_allowed() {
    let Some(report) = ring_laser(&["--max-effects", "5"]) else { return };
    let effects = report["effects"].as_array().unwrap();
    // The digits of the output are a step as well, of 0.007 arcsec, which the values show and the spectrum does not.
    let in_spectrum = |e: &&Value| e["where"].as_array().unwrap().iter().any(|w| w["domain"] == "frequency");
    let mut quantised = effects.iter().filter(|e| e["kind"] == "quantization");
    let steps = quantised.find(in_spectrum).expect("quantisation");
    // Noise of the angle that is white up to 32 Hz: 400 to 500 (deg/h)²/Hz there is a Q of 0.8 arcsec, a step of 2.6.
    let arcsec = steps["parameters"]["lsb_arcsec"]["value"].as_f64().unwrap();
    assert!((2.0..3.2).contains(&arcsec), "{arcsec}");
    let spans = places(&report, "frequency");
    for line_hz in [9.2, 19.08, 20.7, 29.94] {
        let near = |(from, to): &(f64, f64)| to - from < 1.0 && from - 0.1 < line_hz && line_hz < to + 0.1;
        assert!(spans.iter().any(near), "{line_hz} Hz: {spans:?}");
    }
    assert!(heldout_gain(&report) > 10_000.0);
}

#[test]
fn real_recordings_are_consistent_with_themselves() {
    let files = [
        ("mems_astropi_68h_temperature", "part_b_warming_day.csv.gz", "gyro_z_rad_s"),
        ("mems_astropi_68h_temperature", "part_d_cool_days.csv.gz", "gyro_y_rad_s"),
        ("fog_aegiverse_iris_two_position", "z_up.csv.gz", "gyro_z_deg_s"),
        ("rlg_ln100_two_position", "x_up.parquet", "rate_x_deg_h"),
    ];
    for (folder, file, column) in files {
        let Some(folder) = set(folder) else { return };
        let path = folder.join(file).display().to_string();
        let out = tempdir().unwrap();
        let args = ["explain", &path, "--simulation", &path, "--rate", column, "--out", "out"];
        let said = sagnac(out.path(), &args);
        assert_eq!(said.code, 0, "{file}: {said:?}");
        assert!(said.out.starts_with("CONSISTENT"), "{file}: {}", said.out);
    }
}
