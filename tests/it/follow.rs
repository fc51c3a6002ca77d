//! A recording that is followed while it is written.

use crate::support::{altered, limits, program, result, sagnac, shipped};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The rows of a sample of 100 h and half an hour of warm-up, and how many of them a number of hours after it has.
fn sample(name: &str) -> String {
    std::fs::read_to_string(shipped(&format!("samples/{name}.csv"))).unwrap()
}

fn rows_of(hours: f64) -> usize {
    ((hours + 0.5) * 360.0) as usize + 2
}

fn beginning(text: &str, lines: usize) -> String {
    text.lines().take(lines).map(|line| format!("{line}\n")).collect()
}

fn follow(folder: &Path, procedure: &str, serial: &str, still: &str) -> Child {
    Command::new(program())
        .current_dir(folder)
        .args([
            "run",
            procedure,
            "growing.csv",
            "--limits",
            &limits(),
            "--serial",
            serial,
            "--out",
            "followed",
        ])
        .args(["--no-store", "--follow", "--poll", "0.2s", "--still", still])
        .env("SAGNAC_LANG", "en")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Exit code and what was printed, once the program has ended.
fn ended(child: Child) -> (i32, String, String) {
    let out = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (out.status.code().unwrap_or(-1), text(out.stdout), text(out.stderr))
}

fn append(folder: &Path, text: &str) {
    let mut file = OpenOptions::new().append(true).open(folder.join("growing.csv")).unwrap();
    file.write_all(text.as_bytes()).unwrap();
}

#[test]
fn a_followed_recording_gives_the_numbers_of_a_plain_run_and_no_verdict_before() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = sample("unit-pass");
    let procedure = shipped("procedures/static-bias.toml");
    // Half a line at the end: the writer is at it.
    let first = beginning(&text, rows_of(11.0));
    let whole = beginning(&text, rows_of(12.0));
    let cut = first.len() + 7;
    std::fs::write(folder.join("growing.csv"), &whole[..cut]).unwrap();
    let child = follow(folder, &procedure, "SN-0001", "4s");
    std::thread::sleep(Duration::from_secs(2));
    append(folder, &whole[cut..]);
    let (code, out, err) = ended(child);
    assert!(code < 4, "{code} {out} {err}");
    assert!(out.contains("open, decided when the recording is complete"), "{out}");
    assert!(out.contains("it is complete"), "{out}");
    let interim = out.split("it is complete").next().unwrap();
    assert!(!interim.contains("decided: ") && !interim.contains("PASS"), "{interim}");
    sagnac(
        folder,
        &[
            "run",
            &procedure,
            "growing.csv",
            "--limits",
            &limits(),
            "--serial",
            "SN-0001",
            "--out",
            "plain",
            "--no-store",
        ],
    );
    let (mut followed, mut plain) = (result(&folder.join("followed")), result(&folder.join("plain")));
    for record in [&mut followed, &mut plain] {
        record["session"]["evaluated_at"] = serde_json::Value::Null;
    }
    assert_eq!(followed.to_string(), plain.to_string());
}

#[test]
fn a_test_that_its_plan_decides_ends_before_the_recording_stands_still_for_long() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = sample("unit-fail");
    let plan = "[interim]\nlooks = [\"10 h\", \"25 h\", \"50 h\", \"100 h\"]\n\n[conditions]\n";
    let procedure =
        altered(folder, "p.toml", &shipped("procedures/static-bias.toml"), &[("[conditions]\n", plan)]);
    std::fs::write(folder.join("growing.csv"), beginning(&text, rows_of(4.0))).unwrap();
    let began = Instant::now();
    let child = follow(folder, &procedure, "SN-0001", "500s");
    std::thread::sleep(Duration::from_secs(2));
    let whole = beginning(&text, rows_of(26.0));
    append(folder, &whole[beginning(&text, rows_of(4.0)).len()..]);
    let (code, out, err) = ended(child);
    assert!(began.elapsed() < Duration::from_secs(400));
    assert!(out.contains("open, can be decided at"), "{out} {err}");
    assert!(out.contains("decided: fail") && out.contains("decided by its plan"), "{out} {err}");
    let found = result(&folder.join("followed"));
    assert_eq!(
        (found["verdict"].as_str(), found["interim"]["look"].as_u64()),
        (Some("fail"), Some(2)),
        "{code}"
    );
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let procedure = shipped("procedures/static-bias.toml");
    let said = sagnac(folder, &["run", &procedure, "none.csv", "--follow", "--out", "r"]);
    assert!(said.code != 0 && said.err.contains("none.csv"), "{}", said.err);
    let said = sagnac(folder, &["run", &procedure, "a.csv", "b.csv", "--follow", "--out", "r"]);
    assert!(said.code != 0 && said.err.contains("--follow needs one file"), "{}", said.err);
    let phases = shipped("procedures/acceptance.toml");
    let said = sagnac(folder, &["run", &phases, "a.toml", "--follow", "--out", "r"]);
    assert!(said.code != 0 && said.err.contains("one phase"), "{}", said.err);
    let said = sagnac(folder, &["run", &procedure, "a.csv", "--follow", "--poll", "0s"]);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(!folder.join("r").exists());
}
