//! A thermometer whose readings are those of a room in another unit passes no test that rests on it.

use super::root;
use super::runs::run;

/// The shipped sample with its temperatures on another scale, under the unit that the procedure declares.
fn judged(scale: impl Fn(f64) -> f64) -> (i32, Vec<(String, String)>) {
    let text = std::fs::read_to_string(root("samples/scale-factor-pass.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let changed = rows.lines().map(|row| {
        let (before, temperature) = row.rsplit_once(',').unwrap();
        format!("{before},{:.2}\n", scale(temperature.parse().unwrap()))
    });
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("recording.csv");
    std::fs::write(&data, format!("{header}\n{}", changed.collect::<String>())).unwrap();
    let (code, result) = run(&root("procedures/scale-factor.toml"), &data);
    let broken = result["conditions"].as_array().unwrap().iter().filter(|c| c["status"] == "invalid");
    let text = |v: &serde_json::Value| v.as_str().unwrap_or_default().to_owned();
    (code, broken.map(|c| (text(&c["id"]), text(&c["note"]))).collect())
}

#[test]
fn kelvin_and_fahrenheit_under_the_name_of_celsius_are_named() {
    for (unit, scale) in [("K", (|t| t + 273.15) as fn(f64) -> f64), ("degF", |t| 1.8 * t + 32.0)] {
        let (code, broken) = judged(scale);
        assert_ne!(code, 0, "{unit}");
        assert!(
            broken
                .iter()
                .any(|(id, note)| id == "units.temp" && note.contains(&format!("as {unit} it would be"))),
            "{unit}: {broken:?}"
        );
    }
    let (code, broken) = judged(|t| t);
    assert_eq!((code, broken.len()), (0, 0), "{broken:?}");
    // A chamber at −40 °C is no room on any scale.
    let (_, broken) = judged(|t| t - 62.0);
    assert!(broken.is_empty(), "{broken:?}");
}
