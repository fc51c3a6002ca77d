//! Recordings over temperature and of the warm-up that are not what they seem: by their sign, their Earth rate, their start.

use crate::thermal_study::samples::{root, row, run};
use serde_json::Value;

const RAMP: (&str, &str) = ("procedures/temperature-ramp.toml", "procedures/limits/sample-temperature.toml");
const SOAK: (&str, &str) = ("procedures/temperature-soak.toml", "procedures/limits/sample-temperature.toml");
const WARM: (&str, &str) = ("procedures/warm-up.toml", "procedures/limits/sample-warm-up.toml");

/// Runs a sample with its rows, stamp and rate first, altered.
fn altered(
    (procedure, limits): (&str, &str),
    sample: &str,
    alter: impl Fn(f64, f64) -> Option<(f64, f64)>,
) -> (i32, Value) {
    let text = std::fs::read_to_string(root().join("samples").join(sample)).unwrap();
    let line = |line: &str| -> Option<String> {
        let fields: Vec<&str> = line.split(',').collect();
        let (Ok(time), Some(Ok(rate))) = (fields[0].parse(), fields.get(1).map(|f| f.parse::<f64>())) else {
            return Some(line.to_owned());
        };
        let (time, rate) = alter(time, rate)?;
        let rest: String = fields[2..].iter().map(|f| format!(",{f}")).collect();
        Some(format!("{time},{rate:.5}{rest}"))
    };
    let rows: Vec<String> = text.lines().filter_map(line).collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("altered.csv");
    std::fs::write(&file, rows.join("\n") + "\n").unwrap();
    let serial = text.lines().next().and_then(|l| l.strip_prefix("# serial: ")).unwrap().to_owned();
    run(procedure, limits, file.to_str().unwrap(), &serial)
}

fn unmet(result: &Value) -> String {
    let conditions = result["conditions"].as_array().unwrap();
    conditions.iter().filter(|c| c["status"] == "invalid").map(|c| c["note"].as_str().unwrap()).collect()
}

#[test]
fn a_reversed_sign_or_an_earth_rate_taken_out_is_named_over_temperature_and_in_the_warm_up() {
    let name = "a_reversed_sign_or_an_earth_rate_taken_out_is_named_over_temperature_and_in_the_warm_up";
    let samples =
        [(WARM, "warm-up-pass.csv"), (RAMP, "temperature-pass.csv"), (SOAK, "temperature-soak-pass.csv")];
    for (files, sample) in crate::support::long::cases(name, &samples, 1) {
        let (code, result) = altered(files, sample, |t, r| Some((t, -r)));
        assert!(code == 3 && unmet(&result).contains("the sign is reversed"), "{sample}: {}", unmet(&result));
        let (code, result) = altered(files, sample, |t, r| Some((t, r - 12.467)));
        assert!(code == 3 && unmet(&result).contains("already removed"), "{sample}: {}", unmet(&result));
    }
}

#[test]
fn a_warm_up_whose_beginning_is_cut_off_does_not_pass() {
    let said = |result: &Value| row(result, "warm_up_time")["notes"].to_string();
    // By the stamps the declared start is not that of the recording.
    let (code, result) = altered(WARM, "warm-up-fail.csv", |t, r| (t >= 3985.0).then_some((t, r)));
    assert!(code == 3 && said(&result).contains("thermal_start.late"), "{code} {}", said(&result));
    // With new stamps nothing of the recording tells, and without a declaration nothing does.
    let folder = tempfile::tempdir().unwrap();
    let undeclared = folder.path().join("undeclared.toml");
    let text = std::fs::read_to_string(root().join(WARM.0)).unwrap();
    std::fs::write(&undeclared, text.replace("start = \"declared\"\n", "")).unwrap();
    let anew = (undeclared.to_str().unwrap(), WARM.1);
    let (code, result) = altered(anew, "warm-up-fail.csv", |t, r| (t >= 3985.0).then_some((t - 3985.0, r)));
    assert!(code == 3 && said(&result).contains("thermal_start.not_asked"), "{code} {}", said(&result));
    assert!(row(&result, "turn_on_transient")["value"].is_null());
    // A warm-up that is too long from the first row on is too long from wherever the start was.
    assert_eq!(altered(anew, "warm-up-fail.csv", |t, r| Some((t, r))).0, 1);
}

#[test]
fn a_declared_start_is_said_to_be_declared() {
    let (code, result) = altered(WARM, "warm-up-pass.csv", |t, r| Some((t, r)));
    assert_eq!(code, 0);
    assert!(result["summary"].to_string().contains("summary.start_declared"), "{}", result["summary"]);
    for id in ["warm_up_time", "turn_on_transient"] {
        assert!(row(&result, id)["notes"].to_string().contains("thermal_start.declared"));
    }
}
