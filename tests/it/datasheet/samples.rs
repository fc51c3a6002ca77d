//! The shipped results of a lot: 30 simulated units of which the population is known.

use crate::datasheet::{bound, notes, of_the_lot, quantity, sheet};
use crate::support::schema::{closed, validate};
use crate::support::{root, sagnac};
use sagnac_studies::bench::noise_source::{NoiseSource, add, csv};
use serde_json::Value;
use std::fs;
use tempfile::tempdir;

/// Units in each of the three lots.
const UNITS: usize = 10;
/// Median angle random walk, deg/√h, with its spreads between lots and between units (of logarithms).
const MEDIAN_N: f64 = 0.0020;
const SPREADS: (f64, f64) = (0.03, 0.08);
/// Length of a recording, h, and its sample interval, s.
const RECORDING: (f64, f64) = (50.5, 10.0);
/// Earth rate on a vertical axis at 55.98° north, deg/h.
const EARTH_DEG_H: f64 = 12.467_4;

#[test]
#[ignore = "writes the samples: cargo test --test it datasheet -- --ignored write_the_samples"]
fn write_the_samples() {
    let dir = tempdir().unwrap();
    let (hours, dt) = RECORDING;
    let len = (hours * 3600.0 / dt) as usize;
    let time: Vec<f64> = (0..len).map(|i| dt * i as f64).collect();
    let mut chance = NoiseSource::new(30_303);
    for lot in 0..3 {
        let of_lot = SPREADS.0 * chance.normal();
        for unit in 0..UNITS {
            let serial = format!("SN-{}", 3001 + lot * UNITS + unit);
            let n = MEDIAN_N * (of_lot + SPREADS.1 * chance.normal()).exp();
            let b = 0.0025 * (0.2 * chance.normal()).exp();
            let bias = 0.1 * chance.normal();
            let mut rate = chance.white(n, dt, len);
            add(&mut rate, &chance.flicker(b, dt, len));
            rate.iter_mut().for_each(|r| *r += EARTH_DEG_H + bias);
            let temperature: Vec<f64> = (0..len).map(|_| 20.0 + 0.01 * chance.normal()).collect();
            let text = csv(
                &format!("# serial: {serial}\ntime_s,rate_deg_h,temp_degC"),
                &[&time, &rate, &temperature],
            );
            fs::write(dir.path().join(format!("{serial}.csv")), text).unwrap();
            let (file, lot) = (format!("{serial}.csv"), format!("2026-{}", lot + 1));
            let args = ["run", "static-bias", &file, "--limits", "sample-unit", "--serial", &serial];
            let more = ["--lot", &lot, "--lang", "en", "--out", &serial];
            let said = sagnac(dir.path(), &[&args[..], &more[..]].concat());
            assert!(said.code != 2, "{said:?}");
            let to = root().join("samples/lot").join(&serial);
            fs::create_dir_all(&to).unwrap();
            let record: Value =
                serde_json::from_slice(&fs::read(dir.path().join(&serial).join("result.json")).unwrap())
                    .unwrap();
            fs::write(to.join("result.json"), serde_json::to_string(&record).unwrap() + "\n").unwrap();
        }
    }
}

#[test]
fn the_shipped_lot_tells_the_population_that_it_is_from() {
    let dir = tempdir().unwrap();
    let run = of_the_lot();
    let said = &run.said;
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.out.contains("units: 30; lots: 3") && said.out.contains("Angle random walk"),
        "{}",
        said.out
    );
    let found = sheet(&run.out);
    assert_eq!(
        (&found["format"], &found["units"], &found["lots"]),
        (&"datasheet/1".into(), &30.into(), &3.into())
    );
    assert_eq!(found["procedure"]["id"], "static-bias");
    let schema: Value = serde_json::from_str(&sagnac(dir.path(), &["schema", "datasheet"]).out).unwrap();
    validate(&closed(&schema), &closed(&schema), &found, "datasheet").unwrap();

    let n = quantity(&found, "angle_random_walk");
    assert_eq!((&n["scale"], &n["units"]), (&"log".into(), &30.into()));
    let interval = &n["typical"]["interval"];
    let (low, high) = (interval["low"].as_f64().unwrap(), interval["high"].as_f64().unwrap());
    assert!(low < MEDIAN_N && MEDIAN_N < high && high / low < 1.5, "{n}");
    // The 95 % quantile of the population, which a bound lies above nearly always, and not far.
    let quantile = MEDIAN_N * (1.645 * SPREADS.0.hypot(SPREADS.1)).exp();
    let (of_true, of_measured) = (bound(n, "true", "upper"), bound(n, "measured", "upper"));
    assert!(quantile < of_true && of_true < of_measured && of_measured < 1.5 * quantile, "{n}");
    let spread = n["spread"]["between_units"].as_f64().unwrap();
    assert!((0.05..0.12).contains(&spread) && n["spread"]["between_lots"].is_null(), "{n}");
    assert!(notes(n).contains(&"datasheet.note.few_lots".to_owned()), "{n}");
    // Of a quantity that no unit has a value of, nothing is promised.
    let k = quantity(&found, "rate_random_walk");
    assert!(k["bounded"] == 30 && k["typical"].is_null() && notes(k) == ["datasheet.note.too_few"], "{k}");
    // A signed quantity has bounds on both sides.
    let bias = quantity(&found, "static_bias");
    assert!(bound(bias, "true", "lower") < 0.0 && bound(bias, "true", "upper") > 0.0, "{bias}");
    assert!(found["pairs"].as_array().unwrap().iter().any(|p| p["russian"] == "russian_drift_100s"));
    assert_eq!(found["curves"][0]["units"].as_array().unwrap().len(), 30);

    // The limits are of a kind that the program takes.
    let checked = sagnac(dir.path(), &["check", &format!("{}/limits.toml", run.path()), "--lang", "en"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    let limits: toml::Table = toml::from_str(&run.text("limits.toml")).unwrap();
    assert!(limits["limit"].as_array().unwrap().len() > 8);
    for (page, words) in [("datasheet.html", "<svg"), ("datasheet.md", "With a confidence of 95 %")] {
        assert!(run.text(page).contains(words), "{page}");
    }
    // In the other language, from the data sheet alone.
    let said = sagnac(dir.path(), &["report", run.path(), "--lang", "ru", "--out", "ru"]);
    assert_eq!(said.code, 0, "{said:?}");
    let page = fs::read_to_string(dir.path().join("ru/datasheet.html")).unwrap();
    assert!(page.contains("Сводка показателей партии") && !page.contains("datasheet."), "a text is missing");
}
