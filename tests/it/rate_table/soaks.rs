//! Rates of a table repeated at soaks of a chamber: the samples, the shipped procedure on them, and recordings that show less.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use sagnac_studies::bench::soaks::Soaks;
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

const PEAK_TO_PEAK: &str = "sf_over_temperature_peak_to_peak";
const SLOPE: &str = "scale_factor_temperature_sensitivity";
const HYSTERESIS: &str = "sf_temperature_hysteresis";

fn good() -> Soaks {
    Soaks {
        error_ppm: 60.0,
        per_degree_ppm: 2.0,
        parabola_ppm: 40.0,
        hysteresis_ppm: 3.0,
        cycle_ppm: 0.3,
        seed: 61,
        ..Soaks::default()
    }
}

fn bad() -> Soaks {
    Soaks { per_degree_ppm: 5.0, hysteresis_ppm: 30.0, bias_per_degree: 0.02, seed: 67, ..good() }
}

/// The samples with what stands in them.
pub fn files() -> [(&'static str, String); 2] {
    [
        ("samples/scale-factor-over-temperature-pass.csv", good().csv()),
        ("samples/scale-factor-over-temperature-fail.csv", bad().csv()),
    ]
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == id).unwrap()
}

/// The interval, or half of its width more on each side, holds the truth: of few intervals none may miss by that.
#[track_caller]
fn holds(row: &Value, truth: f64) {
    let [low, high] =
        ["low", "high"].map(|end| row["interval"][end].as_f64().unwrap_or_else(|| panic!("{row}")));
    let room = 0.5 * (high - low);
    assert!((low - room..=high + room).contains(&truth), "{truth}: {row}");
}

#[test]
fn the_samples_show_their_curves_and_verdicts() {
    for (sample, unit, verdict) in [("pass", good(), "pass"), ("fail", bad(), "fail")] {
        let r = sample_once(&format!("scale-factor-over-temperature-{sample}")).result();
        for (id, truth) in [PEAK_TO_PEAK, SLOPE, HYSTERESIS].into_iter().zip(unit.truths()) {
            let row = row(r, id);
            assert_eq!(row["verdict"], verdict, "{row}");
            holds(row, truth);
        }
        let figures: Vec<&str> =
            r["figures"].as_array().unwrap().iter().map(|f| f["id"].as_str().unwrap()).collect();
        assert!(figures.contains(&"scale_over_temperature"), "{figures:?}");
    }
}

#[test]
fn the_compensation_table_has_scale_factor_and_bias_at_every_temperature() {
    let run = sample_once("scale-factor-over-temperature-fail");
    let table: Value = serde_json::from_str(&run.text("scale_factor_compensation.json")).unwrap();
    let list = |key: &str| -> Vec<f64> {
        table[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
    };
    assert_eq!(list("temperature_deg_c").len(), 4);
    for ((t, error), bias) in
        list("temperature_deg_c").iter().zip(list("scale_factor_error_ppm")).zip(list("bias_deg_h"))
    {
        // About the middle of −40 to 70; both ways averaged but at the ends, which are reached one way only, or first.
        let off = t - 15.0;
        let curve = 60.0 + 5.0 * off + 40.0 * (off / 55.0).powi(2);
        assert!((error - curve).abs() < 16.0, "{t}: {error} {curve}");
        assert!((bias - 2.0 - 0.02 * off).abs() < 0.1, "{t}: {bias}");
    }
    assert_eq!(table["serial"], "SN-1");
    let toml: toml::Table = run.text("scale_factor_compensation.toml").parse().unwrap();
    assert_eq!(toml["format"].as_str(), Some("scale-factor-compensation/1"));
    let header = run.text("scale_factor_compensation.h");
    assert!(
        header.contains("COMP_RATE_SF_POINTS 4") && header.contains("COMP_RATE_SF_ERROR_PPM[4]"),
        "{header}"
    );
}

/// The result of a unit by the shipped procedure, a shorter recording allowed.
fn tested(folder: &Path, unit: &Soaks) -> (i32, Value) {
    std::fs::write(folder.join("r.csv"), unit.csv()).unwrap();
    let shipped = shipped("procedures/scale-factor-over-temperature.toml");
    altered(folder, "p.toml", &shipped, &[("minimum_duration = \"30 min\"", "minimum_duration = \"1 min\"")]);
    let said = sagnac(folder, &["run", "p.toml", "r.csv", "--serial", "SN-1", "--out", "o", "--force"]);
    (said.code, result(&folder.join("o")))
}

#[test]
fn what_the_soaks_do_not_show_has_no_value_and_a_reason() {
    let dir = tempdir().unwrap();
    for (temperatures, cycles, without, note) in [
        (vec![20.0], 2, vec![PEAK_TO_PEAK, SLOPE, HYSTERESIS], "soaks.one_temperature"),
        (vec![-40.0, 20.0, 70.0], 2, vec![HYSTERESIS], "soaks.one_way"),
        (vec![-40.0, 20.0, 70.0], 1, vec![PEAK_TO_PEAK, SLOPE, HYSTERESIS], "soaks.one_cycle"),
    ] {
        let (code, r) = tested(dir.path(), &Soaks { temperatures: temperatures.clone(), cycles, ..good() });
        assert_eq!(code, 3, "{temperatures:?}");
        for id in [PEAK_TO_PEAK, SLOPE, HYSTERESIS] {
            let row = row(&r, id);
            assert_eq!(row["value"].is_null(), without.contains(&id), "{row}");
            if without.contains(&id) {
                assert!(row["notes"].to_string().contains(note), "{note}: {row}");
            }
        }
        assert_eq!(dir.path().join("o/scale_factor_compensation.h").is_file(), without.len() == 1);
    }
}

#[test]
fn soaks_gone_through_once_take_the_scatter_of_cycles_from_the_soaks() {
    let dir = tempdir().unwrap();
    let unit = Soaks { cycles: 1, cycle_ppm: 2.0, ..good() };
    let (_, r) = tested(dir.path(), &unit);
    let [peak_to_peak, slope, _] = unit.truths();
    for (id, truth) in [(PEAK_TO_PEAK, peak_to_peak), (SLOPE, slope)] {
        let row = row(&r, id);
        holds(row, truth);
        assert!(row["notes"].to_string().contains("soaks.gone_through_once"), "{row}");
    }
    let width = |r: &Value| r["interval"]["high"].as_f64().unwrap() - r["interval"]["low"].as_f64().unwrap();
    // Cycles of 2 ppm scatter differences of soaks by 2.8 ppm.
    assert!(width(row(&r, PEAK_TO_PEAK)) > 3.0, "{}", row(&r, PEAK_TO_PEAK));
}

#[test]
fn a_procedure_without_a_temperature_is_told_before_anything_is_recorded() {
    let dir = tempdir().unwrap();
    let shipped = shipped("procedures/scale-factor-over-temperature.toml");
    let channel =
        "[[channel]]\nid = \"temp\"\ncolumn = \"temp_degC\"\nrole = \"temperature\"\nunit = \"degC\"\n";
    altered(dir.path(), "p.toml", &shipped, &[(channel, "")]);
    let said = sagnac(dir.path(), &["check", "p.toml", "--lang", "en"]);
    let text = format!("{}{}", said.out, said.err);
    assert!(text.contains("several temperatures"), "{text}");
    altered(
        dir.path(),
        "q.toml",
        &shipped,
        &[("soak_tolerance = \"2 degC\"", "soak_tolerance = \"0 degC\"")],
    );
    let said = sagnac(dir.path(), &["check", "q.toml", "--lang", "en"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert!(format!("{}{}", said.out, said.err).contains("soak_tolerance"), "{said:?}");
}
