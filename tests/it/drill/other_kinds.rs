//! The drill of the other kinds of test: what a recording over temperature, on a table, in positions or under an influence
//! reveals by itself. The sound sample shows none of it.

use super::recording::plain;
use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The site of the shipped procedures, for those that state none.
const SITE: &str = "[site]\nlatitude = \"55.98 deg\"\nelevation = \"90 deg\"\n\n";

/// A shipped sample with its rows changed: fields of a row, and its number.
fn spoilt(folder: &Path, sample: &str, mut change: impl FnMut(usize, &mut Vec<String>)) -> String {
    let text = fs::read_to_string(shipped(&format!("samples/{sample}.csv"))).unwrap();
    let mut out = String::new();
    let mut at = 0;
    for line in text.lines() {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if fields[0].parse::<f64>().is_ok() {
            change(at, &mut fields);
            at += 1;
        }
        out += &fields.join(",");
        out.push('\n');
    }
    assert!(at > 1000, "{sample}: {at} rows");
    let path = folder.join("recording.csv");
    fs::write(&path, out).unwrap();
    path.to_string_lossy().into_owned()
}

/// Multiplies a field.
fn scaled(field: &mut String, factor: f64) {
    *field = plain(field.parse::<f64>().unwrap() * factor);
}

fn run(folder: &Path, procedure: &str, recording: &str, more: &[&str]) -> Value {
    let args = [&["run", procedure, recording, "--out", "r", "--lang", "en"], more].concat();
    sagnac(folder, &args);
    result(&folder.join("r"))
}

/// Messages of the conditions of a kind that have a status, `invalid` or `remark`.
fn found<'a>(result: &'a Value, kind: &str, status: &str) -> Vec<&'a str> {
    let all = result["conditions"].as_array().unwrap().iter();
    let own =
        all.filter(|c| c["id"].as_str().unwrap().split('.').next() == Some(kind) && c["status"] == status);
    own.map(|c| c["message"]["id"].as_str().unwrap()).collect()
}

fn was_made(result: &Value, check: &str) -> bool {
    result["checks"].as_array().unwrap().iter().any(|c| c["id"] == check && c["status"] == "made")
}

#[test]
fn the_sound_samples_reveal_nothing() {
    for sample in [
        "temperature-soak-pass",
        "warm-up-pass",
        "vibration-pass",
        "magnetic-sensitivity-pass",
        "supply-sensitivity-pass",
        "bias-repeatability-pass",
        "scale-factor-pass",
        "multi-position-pass",
    ] {
        let sound = sample_once(sample).result();
        for kind in
            ["tails", "clock", "units", "earth_rate", "known_earth", "noise_level", "temperature_course"]
        {
            for status in ["invalid", "remark"] {
                let revealed = found(sound, kind, status);
                assert!(revealed.is_empty(), "{sample}: {status} {revealed:?}");
            }
        }
    }
    assert!(was_made(sample_once("temperature-soak-pass").result(), "distribution"));
    assert!(was_made(sample_once("vibration-pass").result(), "distribution"));
}

#[test]
fn clipped_tails_over_temperature_are_named_as_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(shipped("samples/temperature-soak-pass.csv")).unwrap();
    let field = |l: &str| l.split(',').nth(1).and_then(|f| f.parse::<f64>().ok());
    let rates: Vec<f64> = text.lines().filter_map(field).collect();
    // About the mean of 33 samples: the course moves by less than the noise over them.
    let mean = |i: usize| {
        let near = &rates[i.saturating_sub(16)..(i + 17).min(rates.len())];
        near.iter().sum::<f64>() / near.len() as f64
    };
    let squares = (0..rates.len()).map(|i| (rates[i] - mean(i)).powi(2)).sum::<f64>();
    let most = 2.25 * (squares / rates.len() as f64).sqrt();
    let recording = spoilt(folder.path(), "temperature-soak-pass", |i, fields| {
        fields[1] = plain(mean(i) + (rates[i] - mean(i)).clamp(-most, most));
    });
    let limits = shipped("procedures/limits/sample-temperature.toml");
    let more = ["--serial", "SN-0104", "--limits", &limits];
    let r = run(folder.path(), &shipped("procedures/temperature-soak.toml"), &recording, &more);
    assert_eq!(found(&r, "tails", "invalid"), ["tails.short"]);
    assert_eq!(r["verdict"], "indeterminate");
}

#[test]
fn a_clock_that_is_5_percent_fast_is_named_at_soaks_too() {
    let folder = tempfile::tempdir().unwrap();
    // 20 s become 21 s, a number of two digits as well.
    let recording = spoilt(folder.path(), "temperature-soak-pass", |_, fields| scaled(&mut fields[0], 1.05));
    let r = run(
        folder.path(),
        &shipped("procedures/temperature-soak.toml"),
        &recording,
        &["--serial", "SN-0104"],
    );
    assert_eq!(found(&r, "clock", "remark"), ["clock.not_round"]);
}

#[test]
fn a_temperature_with_the_wrong_sign_is_named_by_the_shape_of_the_schedule() {
    let folder = tempfile::tempdir().unwrap();
    let soak = shipped("procedures/temperature-soak.toml");
    let recording = spoilt(folder.path(), "temperature-soak-pass", |_, fields| scaled(&mut fields[2], -1.0));
    let r = run(folder.path(), &soak, &recording, &["--serial", "SN-0104"]);
    assert_eq!(found(&r, "temperature_course", "invalid"), ["schedule.reversed"]);
    // From -50 to +50 degC the ends do not tell it, and the command of the chamber does.
    let channel =
        "[[channel]]\nid = \"set\"\ncolumn = 4\nrole = \"temperature\"\nunit = \"degC\"\n\n[conditions]";
    let changes = [
        (
            "channel = \"temp\"\nlow = \"-40 degC\"",
            "channel = \"temp\"\ncommand = \"set\"\nlow = \"-50 degC\"",
        ),
        ("high = \"60 degC\"", "high = \"50 degC\""),
        ("[conditions]", channel),
    ];
    let symmetric = altered(folder.path(), "symmetric.toml", &soak, &changes);
    for (sign, named) in [(1.0, &[][..]), (-1.0, &["schedule.reversed_course"])] {
        let recording = spoilt(folder.path(), "temperature-soak-pass", |_, fields| {
            let chamber = fields[2].parse::<f64>().unwrap() - 10.0;
            fields[2] = plain(sign * chamber);
            fields.push(format!("{chamber:.1}"));
        });
        let named_column =
            fs::read_to_string(&recording).unwrap().replace("temp_degC\n", "temp_degC,set_degC\n");
        fs::write(&recording, named_column).unwrap();
        let r = run(folder.path(), &symmetric, &recording, &["--serial", "SN-0104"]);
        assert_eq!(found(&r, "temperature_course", "invalid"), named, "{sign}");
        assert!(
            r["conditions"].as_array().unwrap().iter().any(|c| c["id"] == "temperature_course"),
            "{sign}"
        );
    }
}

#[test]
fn a_table_temperature_with_the_wrong_sign_is_no_room() {
    let folder = tempfile::tempdir().unwrap();
    let recording = spoilt(folder.path(), "scale-factor-pass", |_, fields| scaled(&mut fields[4], -1.0));
    let table = shipped("procedures/scale-factor.toml");
    let r = run(folder.path(), &table, &recording, &["--serial", "S"]);
    assert_eq!(found(&r, "units", "invalid"), ["units.thermometer_sign"]);
    assert_eq!(r["verdict"], "indeterminate");
    // Where nothing rests on the temperature it is a remark; every kind of test looks.
    let recording =
        spoilt(folder.path(), "magnetic-sensitivity-pass", |_, fields| scaled(&mut fields[2], -1.0));
    let r = run(
        folder.path(),
        &shipped("procedures/magnetic-sensitivity.toml"),
        &recording,
        &["--serial", "SN-0113"],
    );
    assert_eq!(found(&r, "units", "remark"), ["units.thermometer_sign"]);
}

#[test]
fn a_gain_of_1_percent_in_positions_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let recording = spoilt(folder.path(), "multi-position-pass", |_, fields| scaled(&mut fields[1], 1.01));
    let positions = shipped("procedures/multi-position.toml");
    let r = run(folder.path(), &positions, &recording, &["--serial", "S"]);
    assert_eq!(found(&r, "known_earth", "invalid"), ["known.gain"]);
    assert_eq!(r["verdict"], "indeterminate");
    // A limit on the scale factor judges it in its row.
    let limit = "[[limit]]\nmeasurand = \"scale_factor_error\"\nmax_abs = \"5000 ppm\"\n\n[[clause]]";
    let limited = altered(folder.path(), "limited.toml", &positions, &[("[[clause]]", limit)]);
    let r = run(folder.path(), &limited, &recording, &["--serial", "S"]);
    assert!(found(&r, "known_earth", "invalid").is_empty());
    assert_eq!(r["verdict"], "fail");
}

#[test]
fn noise_below_the_family_and_a_gain_that_noise_and_earth_rate_share_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mean = 12.42;
    let limits = crate::support::limits();
    let more = ["--serial", "SN-0001", "--limits", limits.as_str()];
    let recording = spoilt(folder.path(), "unit-indeterminate", |_, fields| {
        fields[1] = plain(mean + 0.7 * (fields[1].parse::<f64>().unwrap() - mean));
    });
    let r = run(folder.path(), &crate::support::procedure(), &recording, &more);
    assert_eq!(found(&r, "noise_level", "remark"), ["noise_level.below"]);
    let recording = spoilt(folder.path(), "unit-indeterminate", |_, fields| scaled(&mut fields[1], 0.5));
    let r = run(folder.path(), &crate::support::procedure(), &recording, &more);
    let earth = r["conditions"].as_array().unwrap().iter().find(|c| c["id"] == "earth_rate").unwrap();
    assert_eq!(earth["status"], "invalid", "{earth}");
    assert!(earth["note"].as_str().unwrap().contains("the gain is wrong"), "{earth}");
    assert_eq!(r["verdict"], "indeterminate");
}

#[test]
fn a_reversed_earth_rate_is_named_under_every_influence_and_between_runs() {
    let folder = tempfile::tempdir().unwrap();
    for (procedure, serial) in
        [("vibration", "SN-0117"), ("magnetic-sensitivity", "SN-0113"), ("supply-sensitivity", "SN-0115")]
    {
        let shipped = shipped(&format!("procedures/{procedure}.toml"));
        let first = "[conditions]";
        let sited = altered(folder.path(), "sited.toml", &shipped, &[(first, &format!("{SITE}{first}"))]);
        for sign in [1.0, -1.0] {
            let sample = format!("{procedure}-pass");
            let recording = spoilt(folder.path(), &sample, |_, fields| scaled(&mut fields[1], sign));
            let r = run(folder.path(), &sited, &recording, &["--serial", serial]);
            let named: &[&str] = if sign < 0.0 { &["earth_rate.mistake"] } else { &[] };
            assert_eq!(found(&r, "earth_rate", "invalid"), named, "{procedure} {sign}");
            assert!(was_made(&r, "earth_rate"), "{procedure}");
        }
    }
    let recording =
        spoilt(folder.path(), "bias-repeatability-pass", |_, fields| scaled(&mut fields[1], -1.0));
    let runs = shipped("procedures/bias-repeatability.toml");
    let r = run(folder.path(), &runs, &recording, &["--serial", "SN-0111"]);
    assert_eq!(found(&r, "earth_rate", "invalid"), ["earth_rate.mistake"]);
}
