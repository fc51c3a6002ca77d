//! Ends of a recording before its time: each is told, and leaves the bench safe.

use super::twin::Trouble;
use super::{Bench, SHORT, unit};
use crate::support::{program, sagnac};
use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn what_goes_wrong_ends_the_recording_and_is_told() {
    for (trouble, words) in [
        (Trouble::GyroCable, "connection to `gyro` is lost"),
        (Trouble::GyroSilent, "`gyro` has said nothing"),
        (Trouble::TableStuck, "`table` does not follow: table_rate_deg_s should be -20"),
        (Trouble::TableCable, "connection to `table` is lost"),
        (Trouble::Overvoltage(6.0), "`supply` is beyond its limits: supply_v = 6"),
    ] {
        let bench = Bench::new(unit(2.0), &[(25.0, trouble)], "20 s", SHORT);
        let said = bench.record();
        assert!(said.code == 1 && said.err.contains(words), "{trouble:?}: {said:?}");
        bench.is_safe();
        assert_eq!(bench.event("wrong").len(), 1, "{trouble:?}");
        assert_eq!(bench.event("end")[0]["how"], "fault");
        let inspected = sagnac(bench.folder(), &["inspect", "rec/recording.toml"]);
        assert_eq!(inspected.code, 0, "{trouble:?}: {inspected:?}");
    }
}

#[test]
fn a_chamber_that_stands_still_is_told() {
    let ramp = "format = \"schedule/1\"\n[start]\ntemp_degC = 25.0\n[[step]]\ndo = \"ramp\"\nto_degC = 60.0\n\
        rate_degC_per_h = 900.0\n[[step]]\ndo = \"hold\"\nduration_h = 0.1\n";
    let bench = Bench::new(unit(2.0), &[(60.0, Trouble::ChamberFrozen)], "60 s", ramp);
    let said = bench.record();
    assert!(said.code == 1 && said.err.contains("`chamber` does not follow: temp_degC"), "{said:?}");
    bench.is_safe();
}

#[test]
fn a_step_of_a_clock_is_told_and_the_recording_goes_on_by_its_own() {
    let bench = Bench::new(unit(2.0), &[(60.0, Trouble::ClockStep(-3.0))], "60 s", SHORT);
    let said = bench.record();
    assert!(said.code == 3 && said.out.contains("the clock of `gyro` made a step of -3"), "{said:?}");
    bench.is_safe();
    let [step] = &bench.event("wrong")[..] else { panic!("{:?}", bench.event("wrong")) };
    assert_eq!(step["fault"], "clock_step");
    assert!((step["seconds"].as_f64().unwrap() + 3.0).abs() < 0.01, "{step}");
    assert_eq!(bench.event("end")[0]["how"], "complete");
}

/// The recorder at work, until it has written a part.
fn running(bench: &Bench, part: &str) -> std::process::Child {
    let mut command = Command::new(program());
    command.current_dir(bench.folder()).args(bench.args()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let began = Instant::now();
    while !bench.at(part).exists() {
        let ended = child.try_wait().unwrap();
        assert!(ended.is_none() && began.elapsed() < Duration::from_secs(60), "no {part}: {ended:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// A schedule that lasts longer than any test waits.
const LONG: &str = "format = \"schedule/1\"\n[[step]]\ndo = \"table_rates\"\nrates_deg_s = [20.0]\ndwell_s = 30.0\ncount = 10000\n";

#[cfg(unix)]
#[test]
fn a_request_to_end_leaves_a_whole_recording_and_a_safe_bench() {
    let bench = Bench::new(unit(2.0), &[], "20 s", LONG);
    let child = running(&bench, "rec/gyro-000002.csv");
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &pid]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    bench.is_safe();
    assert_eq!(bench.event("end")[0]["how"], "asked");
    assert!(bench.at("rec/SHA256SUMS").exists());
}

#[test]
fn a_kill_at_any_moment_leaves_every_complete_part_readable() {
    for kill in 0..4 {
        let bench = Bench::new(unit(2.0), &[], "5 s", LONG);
        let mut child = running(&bench, &format!("rec/gyro-{:06}.csv", 1 + kill * 3));
        // Somewhere between two parts.
        std::thread::sleep(Duration::from_micros(700 * kill));
        child.kill().unwrap();
        child.wait().unwrap();
        let mut rows = 0;
        for entry in fs::read_dir(bench.at("rec")).unwrap().flatten() {
            let name = entry.file_name().into_string().unwrap();
            if name.starts_with("gyro-") {
                let text = fs::read_to_string(entry.path()).unwrap();
                assert!(text.ends_with('\n') && text.lines().all(|l| l.split(',').count() == 4), "{name}");
                rows += text.lines().count() - 1;
            }
        }
        let said = sagnac(bench.folder(), &["inspect", "rec/recording.toml"]);
        assert_eq!(said.code, 0, "{kill}: {said:?}");
        let shown = said.out.replace(['\u{a0}', '\u{202f}', ',', ' '], "");
        assert!(rows > 5 && shown.contains(&rows.to_string()), "{rows}: {}", said.out);
    }
}
