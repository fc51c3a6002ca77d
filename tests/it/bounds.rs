//! What a user names is read within bounds: a pipe, a device or a file of any size ends in one diagnostic that names it.

use crate::documents::signing::key;
use crate::support::quick::Quick;
use crate::support::{root, sagnac, sample};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time for a command that takes a second or two, and would take minutes if its work grew with the square of its input.
const SOON: Duration = Duration::from_secs(60);

/// Makes a pipe that nobody writes to.
#[cfg(unix)]
fn pipe(folder: &Path) -> String {
    assert!(std::process::Command::new("mkfifo").arg(folder.join("pipe")).status().unwrap().success());
    "pipe".to_owned()
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_by_name_wherever_a_file_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    let quick = Quick::new("pass");
    assert_eq!(quick.run(at, &["--out", "r"]).code, 0);
    key(at, "anna", 1);
    assert_eq!(sagnac(at, &["sign", "r", "--key", "anna"]).code, 0);
    let Quick { procedure, recording, limits } = &quick;
    let run = |procedure, recording, limits| {
        vec!["run", procedure, recording, "--limits", limits, "--serial", "SN-2", "--out", "o"]
    };
    for odd in [pipe(at).as_str(), "/dev/zero"] {
        for args in [
            vec!["inspect", odd],
            vec!["analyze", odd, "--out", "a"],
            vec!["check", odd],
            run(odd, recording, limits),
            run(procedure, odd, limits),
            run(procedure, recording, odd),
            vec!["compare", odd, "--out", "c"],
            vec!["report", odd, "--out", "p"],
            vec!["verify", "r", "--signers", odd],
            vec!["sign", "r", "--key", odd],
        ] {
            let said = sagnac(at, &args);
            assert_eq!(said.code, 2, "{args:?}: {said:?}");
            let text = format!("{}{}", said.out, said.err);
            assert!(text.contains(odd), "{args:?}: {said:?}");
            assert!(text.contains("not a file but a pipe or a device"), "{args:?}: {said:?}");
            assert_eq!(text.matches("error: ").count(), 1, "{args:?}: {said:?}");
        }
        let said = sagnac(at, &["inspect", odd, "--lang", "ru"]);
        assert!(said.err.contains("это не файл, а канал или устройство"), "{said:?}");
    }
}

#[test]
fn keys_and_lists_beyond_any_size_are_refused_with_the_bound() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    assert_eq!(Quick::new("pass").run(at, &["--out", "r"]).code, 0);
    key(at, "anna", 1);
    assert_eq!(sagnac(at, &["sign", "r", "--key", "anna"]).code, 0);
    fs::write(at.join("large"), vec![b'#'; (4 << 20) + 1]).unwrap();
    for (args, bound) in
        [(["verify", "r", "--signers", "large"], "4194304"), (["sign", "r", "--key", "large"], "1048576")]
    {
        let said = sagnac(at, &args);
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains("large: ") && said.err.contains(bound), "{said:?}");
    }
}

#[test]
fn a_list_of_signers_takes_time_that_grows_with_its_length() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    assert_eq!(Quick::new("pass").run(at, &["--out", "r"]).code, 0);
    key(at, "anna", 1);
    assert_eq!(sagnac(at, &["sign", "r", "--key", "anna"]).code, 0);
    let public = fs::read_to_string(at.join("anna.pub")).unwrap();
    let stars = format!("{}b {}\n", "a*".repeat(2000), public.trim());
    let list = stars.repeat((4 << 20) / stars.len());
    fs::write(at.join("signers"), list).unwrap();
    let began = Instant::now();
    let said = sagnac(at, &["verify", "r", "--signers", "signers"]);
    assert!(matches!(said.code, 0 | 1), "{said:?}");
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
}

#[test]
fn a_recording_of_many_columns_is_inspected_in_one_reading() {
    let dir = tempfile::tempdir().unwrap();
    let columns = 5000;
    let mut text = "time_s".to_owned();
    text.extend((1..columns).map(|i| format!(",aux_{i}")));
    for row in 0..50 {
        text.push_str(&format!("\n{row}"));
        text.extend((1..columns).map(|i| format!(",{}", (row * 31 + i * 7) % 101)));
    }
    fs::write(dir.path().join("wide.csv"), text).unwrap();
    let began = Instant::now();
    let said = sagnac(dir.path(), &["inspect", "wide.csv"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("aux_4999"), "{}", said.out);
    assert!(began.elapsed() < SOON, "{:?}", began.elapsed());
}

#[test]
fn a_reader_that_overflows_ends_the_reading_in_the_release_build_too() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let manifest: toml::Table = toml::from_str(&manifest).unwrap();
    let checks = &manifest["profile"]["release"]["package"]["sagnac-ingest"]["overflow-checks"];
    assert_eq!(checks.as_bool(), Some(true));
}

#[test]
fn templates_end_with_one_diagnostic_when_their_budget_is_used_up() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path();
    fs::create_dir(at.join("t")).unwrap();
    let lines = "x".repeat(1 << 20);
    for (template, said_of_it) in [
        (
            "{% for a in range(100000) %}{% for b in range(100000) %}{% endfor %}{% endfor %}".to_owned(),
            "steps",
        ),
        (format!("{{% for a in range(100000) %}}{lines}{{% endfor %}}"), "bytes"),
        (
            format!(
                "{{% set x = '{lines}' %}}{{% set y %}}{{% for a in range(100000) %}}{{{{ x }}}}{{% endfor %}}{{% endset %}}"
            ),
            "bytes",
        ),
        ("{% macro a() %}{{ a() }}{% endmacro %}{{ a() }}".to_owned(), "recursion"),
    ] {
        fs::write(at.join("t/report.html"), template).unwrap();
        let said = sagnac(at, &["analyze", &sample("pass"), "--templates", "t", "--out", "o"]);
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains("template `report.html`") && said.err.contains(said_of_it), "{said:?}");
        assert_eq!(said.err.matches("error: ").count(), 1, "{said:?}");
        assert!(!at.join("o").exists());
    }
}
