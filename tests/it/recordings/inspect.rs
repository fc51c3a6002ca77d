//! `sagnac inspect` on files: what it prints, what it refuses.

use assert_cmd::Command;
use std::fmt::Write;
use std::path::PathBuf;

struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Files {
        Files(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

/// Exit code, standard output on one line, standard error.
fn inspect(path: &PathBuf, more: &[&str]) -> (i32, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_sagnac")).arg("inspect").arg(path).args(more).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    for line in text.lines().skip(1).filter(|l| !l.contains("SHA-256")) {
        assert!(line.chars().count() <= 100, "too long: {line}");
        assert!(!line.contains('\u{1b}') && line == line.trim_end(), "{line:?}");
    }
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ");
    (output.status.code().unwrap(), joined, String::from_utf8(output.stderr).unwrap())
}

/// A rate that looks random enough for every check.
fn rate(i: u32) -> f64 {
    f64::from(i.wrapping_mul(2_654_435_761).rotate_left(7) % 10_007) * 1e-3
}

#[test]
fn a_column_of_text_does_not_keep_the_numbers_from_being_told() {
    let files = Files::new();
    let mut text = String::from("time_s,rate_deg_h,section\n");
    for i in 0..3000u32 {
        // The text begins late, after the first thousand rows.
        let section = if (1500..2500).contains(&i) { "x_rot" } else { "" };
        writeln!(text, "{:.2},{:.4},{section}", f64::from(i) * 0.01, rate(i)).unwrap();
    }
    let (code, out, err) = inspect(&files.write("unit.csv", &text), &[]);
    assert_eq!(code, 0, "{err}");
    for wanted in ["section text", "100 Hz, one sample every 10 ms", "rows 3 000", "Gyro output `rate_deg_h`"]
    {
        assert!(out.contains(wanted), "{wanted}: {out}");
    }
    assert!(!out.contains("not numbers"), "text is no fault: {out}");
}

#[test]
fn the_same_file_gives_the_same_words() {
    let files = Files::new();
    let rows: String = (0..500).map(|i| format!("{i},{:.3}\n", rate(i))).collect();
    let path = files.write("unit.csv", &format!("time_s,rate_deg_h\n{rows}"));
    assert_eq!(inspect(&path, &[]), inspect(&path, &[]));
}

#[test]
fn missing_fields_are_counted_and_located() {
    let files = Files::new();
    let mut text = String::from("time_s,rate_deg_h\n");
    for i in 0..500 {
        let value = if i == 40 { "oops".to_owned() } else { format!("{:.3}", rate(i)) };
        let value = if i == 50 { String::new() } else { value };
        writeln!(text, "{i},{value}").unwrap();
    }
    let (code, out, err) = inspect(&files.write("unit.csv", &text), &[]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("1 of the fields are empty, NaN or infinite"), "{out}");
    assert!(out.contains("row 41, 40 s:") && out.contains("line 42 character 4: `oops`"), "{out}");
}

#[test]
fn a_sample_rate_helps_where_there_is_no_time() {
    let files = Files::new();
    let rows: String = (0..2000).map(|i| format!("{:.3}\n", rate(i))).collect();
    let path = files.write("unit.csv", &format!("rate_deg_h\n{rows}"));
    let (code, out, _) = inspect(&path, &[]);
    assert!(code == 0 && out.contains("rows are counted (2 000). Give --sample-rate HZ"), "{out}");
    let (code, out, _) = inspect(&path, &["--sample-rate", "100"]);
    assert!(
        code == 0 && out.contains("100 Hz, one sample every 10 ms") && out.contains("length 20 s"),
        "{out}"
    );
    let (code, out, err) = inspect(&path, &["--sample-rate", "0"]);
    assert!(code == 2 && out.is_empty() && err.contains("not a positive number"), "{err}");
}

#[test]
fn stamps_are_read_and_other_text_is_named() {
    let files = Files::new();
    let rows: String = (0..60).map(|i| format!("2026-11-21T05:00:{i:02}Z,{:.3}\n", rate(i))).collect();
    let (code, out, err) = inspect(&files.write("unit.csv", &format!("time,rate_deg_h\n{rows}")), &[]);
    assert_eq!(code, 0, "{err}");
    for said in [
        "Timestamps in `time`.",
        "1 Hz, one sample every 1 s",
        "start 2026-11-21T05:00:00.000Z",
        "year first",
    ] {
        assert!(out.contains(said), "no `{said}` in {out}");
    }
    let rows: String = (0..60).map(|i| format!("noon {i},{:.3}\n", rate(i))).collect();
    let (code, out, err) = inspect(&files.write("noon.csv", &format!("time,rate_deg_h\n{rows}")), &[]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("`time` looks like a time but holds text (noon 0)"), "{out}");
}

#[test]
fn what_is_no_recording_is_refused_with_one_message() {
    let files = Files::new();
    for (name, text) in [("words.csv", "a,b\nx,y\nz,w\n"), ("empty.csv", "")] {
        let (code, out, err) = inspect(&files.write(name, text), &[]);
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.starts_with("error: ") && err.lines().count() == 1, "{err}");
    }
    let (code, _, err) = inspect(&files.0.path().join("none.csv"), &[]);
    assert!(code == 2 && err.contains("none.csv"), "{err}");
}
