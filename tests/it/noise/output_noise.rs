//! Output noise and its density: the samples, the shipped procedure on them, and what a recording does not show.
//!
//! `cargo test --test it noise -- --ignored write_the_samples` writes the samples anew. Their noise comes from a generator that
//! uses no code of the analysis.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, root, sagnac, shipped};
use sagnac_studies::bench::noise_source::{NoiseSource, add};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use tempfile::tempdir;

/// Interval of the samples, s, and their number: 9 min.
const DT_S: f64 = 0.05;
const SAMPLES: usize = 10_800;
/// N of the unit that passes, deg/√h, and its line: amplitude, deg/h, and frequency, Hz.
const N: f64 = 0.002;
const LINE: (f64, f64) = (0.15, 3.3);

fn text(serial: &str, rate_deg_h: &[f64]) -> String {
    let mut out = format!("# serial: {serial}\ntime_s,rate_deg_h\n");
    for (i, rate) in rate_deg_h.iter().enumerate() {
        let _ = writeln!(out, "{:.2},{rate:.4}", i as f64 * DT_S);
    }
    out
}

/// Every sample with its text: one with a line, one with a resonance at 4 Hz.
fn files() -> [(&'static str, String); 2] {
    let mut source = NoiseSource::new(119);
    let mut pass = source.white(N, DT_S, SAMPLES);
    let line = |i: usize| LINE.0 * (TAU * LINE.1 * DT_S * i as f64).sin();
    add(&mut pass, &(0..SAMPLES).map(line).collect::<Vec<f64>>());
    let mut source = NoiseSource::new(120);
    let mut fail = source.white(N, DT_S, SAMPLES);
    let quadratures = [(); 2].map(|()| source.markov(0.35, 0.3, DT_S, SAMPLES));
    let resonance = |i: usize| {
        let turn = TAU * 4.0 * DT_S * i as f64;
        quadratures[0][i] * turn.cos() + quadratures[1][i] * turn.sin()
    };
    add(&mut fail, &(0..SAMPLES).map(resonance).collect::<Vec<f64>>());
    let about = |series: Vec<f64>| series.iter().map(|y| y + 12.5).collect::<Vec<f64>>();
    [
        ("output-noise-pass", text("SN-0119", &about(pass))),
        ("output-noise-fail", text("SN-0120", &about(fail))),
    ]
}

#[test]
#[ignore = "writes the samples"]
fn write_the_samples() {
    for (name, text) in files() {
        std::fs::write(root().join(format!("samples/{name}.csv")), text).unwrap();
    }
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for (name, text) in files() {
        let stored = std::fs::read_to_string(root().join(format!("samples/{name}.csv"))).unwrap();
        assert!(stored == text, "{name}");
    }
}

fn row<'a>(result: &'a Value, id: &str, channel: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id && r["channel"] == channel).unwrap_or_else(|| panic!("{id} {channel}"))
}

fn holds(row: &Value, truth: f64) {
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
    // Of the few intervals here none may miss by half its width.
    let half = 0.25 * (end("high") - end("low"));
    assert!((end("low") - half..=end("high") + half).contains(&truth), "{truth}: {row}");
}

#[test]
fn a_quiet_unit_passes_with_its_density_one_sided() {
    let r = sample_once("output-noise-pass").result();
    let density = 2f64.sqrt() * 60.0 * N;
    for channel in ["rate@0.5-2Hz", "rate@2-9Hz"] {
        let row = row(r, "rate_noise_density", channel);
        assert_eq!((row["unit"].as_str(), row["verdict"].as_str()), (Some("deg/h/sqrt(Hz)"), Some("pass")));
        holds(row, density);
    }
    holds(row(r, "output_noise_rms", "rate"), (3600.0 * N * N / DT_S + 0.5 * LINE.0.powi(2)).sqrt());
    let mask = row(r, "spectral_mask", "rate");
    assert_eq!(mask["verdict"], "pass", "{mask}");
    // The mask lies lowest from 1 Hz on.
    let low = mask["interval"]["low"].as_f64().unwrap();
    assert!(low <= density / 0.22 * 1.02, "{mask}");
    // The line is told of, and left to its own limit.
    let notes = mask["notes"].to_string();
    assert!(notes.contains("in_band.lines_out"), "{notes}");
}

#[test]
fn a_resonance_fails_the_mask_where_it_lies() {
    let r = sample_once("output-noise-fail").result();
    let mask = row(r, "spectral_mask", "rate");
    assert_eq!(mask["verdict"], "fail", "{mask}");
    let notes = mask["notes"].as_array().unwrap();
    let worst = notes.iter().find(|n| n["id"] == "in_band.worst").unwrap();
    let hz = |name: &str| worst["args"][name].as_f64().or(worst["args"][name]["value"].as_f64());
    let (from, to) = (hz("from_hz"), hz("to_hz"));
    assert!(from.zip(to).is_none_or(|(from, to)| from < 4.4 && to > 3.6), "{worst}");
    assert_eq!(row(r, "rate_noise_density", "rate@2-9Hz")["verdict"], "fail");
    assert_eq!(row(r, "rate_noise_density", "rate@0.5-2Hz")["verdict"], "pass");
}

#[test]
fn frequencies_that_a_recording_does_not_show_have_no_value() {
    let dir = tempdir().unwrap();
    let procedure = shipped("procedures/output-noise.toml");
    altered(dir.path(), "p.toml", &procedure, &[("to = \"9 Hz\"", "to = \"12 Hz\"")]);
    let sample = shipped("samples/output-noise-pass.csv");
    let said = sagnac(dir.path(), &["run", "p.toml", &sample, "--serial", "SN-0119", "--out", "o"]);
    assert_eq!(said.code, 3, "{said:?}");
    let r = result(&dir.path().join("o"));
    let open = row(&r, "rate_noise_density", "rate@2-12Hz");
    assert!(open["value"].is_null() && open["verdict"] == "indeterminate", "{open}");
}

#[test]
fn bands_and_masks_that_make_no_sense_are_named() {
    let dir = tempdir().unwrap();
    let shipped = shipped("procedures/output-noise.toml");
    let recording = "[[noise_test.band]]\nfrom = \"0.5 Hz\"";
    for (from, to, expected) in [
        ("to = \"2 Hz\"", "to = \"0.4 Hz\"", "must be above `from`"),
        ("frequency = \"9.5 Hz\"", "frequency = \"0.5 Hz\"", "in the order of frequency"),
        ("[[noise_test.mask]]", "[[noise_test.band]]", "frequency"),
        ("max = \"0.20 deg/h/sqrt(Hz)\"", "max = \"0.003 deg/sqrt(h)\"", "is not a density"),
        (
            recording,
            "[recording]\nsample_rate = \"10 Hz\"\n\n[[noise_test.band]]\nfrom = \"0.5 Hz\"",
            "beyond half",
        ),
    ] {
        altered(dir.path(), "p.toml", &shipped, &[(from, to)]);
        let said = sagnac(dir.path(), &["check", "p.toml"]);
        assert_eq!(said.code, 2, "{from}: {said:?}");
        assert!(format!("{said:?}").contains(expected), "{expected}: {said:?}");
    }
}
