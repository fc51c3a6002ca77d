//! Recordings that change while they are read, and places that cannot take a result: an error that says so, and
//! the earlier result or a whole new one, never half.

#![cfg(unix)]

use crate::support::quick::Quick;
use crate::support::synthetic::{HEADER, recording};
use crate::support::{files, names, procedure, program, result};
use sagnac::i18n::{Lang, Localize};
use sagnac::ingest::{IngestError, IngestErrorKind, open};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::tempdir;

/// Rows of a recording that is several blocks long.
const ROWS: u64 = 200_000;

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    e.write_all(bytes).unwrap();
    e.finish().unwrap()
}

/// Reads a recording that is changed as soon as its first block is there.
fn changed_after_the_first_block(name: &str, bytes: &[u8], change: &dyn Fn(&Path)) -> IngestError {
    let dir = tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let source = open(&path).unwrap();
    let mut done = false;
    let outcome = source.read(&[0], &mut |_| {
        if !std::mem::replace(&mut done, true) {
            change(&path);
        }
        ControlFlow::Continue(())
    });
    outcome.expect_err(name)
}

fn append(path: &Path, bytes: &[u8]) {
    std::fs::OpenOptions::new().append(true).open(path).unwrap().write_all(bytes).unwrap();
}

#[test]
fn a_recording_that_changes_while_it_is_read_is_refused() {
    let plain = recording(ROWS).into_bytes();
    let packed = gzip(&plain);
    let parquet = std::fs::read(crate::support::shipped("tests/bad-input/recording/sound.parquet")).unwrap();
    for (name, bytes) in [("r.csv", &plain), ("r.csv.gz", &packed), ("r.parquet", &parquet)] {
        let refused = |what: &str, change: &dyn Fn(&Path), fragments: &[&str]| {
            let e = changed_after_the_first_block(name, bytes, change);
            let said = e.say(Lang::En);
            assert_eq!(e.kind(), IngestErrorKind::Changed, "{name} {what}: {said}");
            assert!(
                said.contains(name) && fragments.iter().any(|f| said.contains(f)),
                "{name} {what}: {said}"
            );
        };
        refused("grows", &|p| append(p, b"1,2,3\n"), &["changed while", "was written to"]);
        refused("is removed", &|p| std::fs::remove_file(p).unwrap(), &["removed or renamed"]);
        refused(
            "is renamed",
            &|p| std::fs::rename(p, p.with_extension("old")).unwrap(),
            &["removed or renamed"],
        );
        let same_size = |p: &Path| {
            let beside = p.with_extension("new");
            std::fs::write(&beside, bytes).unwrap();
            std::fs::rename(beside, p).unwrap();
        };
        refused("is replaced by its like", &same_size, &["the file was replaced by another"]);
        let rewritten = |p: &Path| {
            std::thread::sleep(std::time::Duration::from_millis(20));
            let mut file = std::fs::OpenOptions::new().write(true).open(p).unwrap();
            file.write_all(&bytes[..4]).unwrap();
        };
        refused("is written to", &rewritten, &["was written to"]);
    }
}

#[test]
fn a_recording_that_shrinks_while_it_is_read_is_refused() {
    let plain = recording(ROWS).into_bytes();
    for (name, bytes) in [("r.csv", plain.clone()), ("r.csv.gz", gzip(&plain))] {
        let shorter = bytes.len() as u64 / 2;
        let e = changed_after_the_first_block(name, &bytes, &|p| {
            std::fs::OpenOptions::new().write(true).open(p).unwrap().set_len(shorter).unwrap();
        });
        assert!(matches!(e.kind(), IngestErrorKind::Changed | IngestErrorKind::Damaged), "{name}: {e}");
        assert!(e.say(Lang::En).contains(name), "{e}");
    }
}

/// Every run ends with a whole result, of the recording as it was or an error that says what happened to it.
#[test]
fn a_run_on_a_changing_recording_leaves_a_whole_result() {
    let dir = tempdir().unwrap();
    let path = dir.path().join("r.csv");
    let sound = recording(ROWS);
    let mut endings = [0; 4];
    let mut earlier = None;
    for round in 0..8u64 {
        std::fs::write(&path, &sound).unwrap();
        let mut child = Command::new(program())
            .current_dir(dir.path())
            .args(["run", &procedure(), "r.csv", "--serial", "SN-1", "--force", "--out", "out"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(8 * round));
        match round % 4 {
            0 => append(&path, b"200000,12.5,20.0\n"),
            1 => std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(1_000_000).unwrap(),
            2 => std::fs::remove_file(&path).unwrap(),
            _ => {
                std::fs::write(dir.path().join("other"), recording(1000)).unwrap();
                std::fs::rename(dir.path().join("other"), &path).unwrap();
            }
        }
        let mut err = String::new();
        std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut err).unwrap();
        let code = child.wait().unwrap().code().unwrap();
        assert!(!err.contains("panicked"), "{err}");
        endings[code as usize] += 1;
        let out = dir.path().join("out");
        if out.exists() {
            let r = result(&out);
            // A recording that went before it was opened costs no earlier result.
            if earlier.as_ref() == Some(&r) {
                continue;
            }
            earlier = Some(r.clone());
            let shown = names(&out);
            assert!(["report.html", "report.md", "result.json"].iter().all(|n| shown.iter().any(|s| s == n)));
            if r["verdict"] == "error" {
                assert!(r["errors"][0].to_string().contains("r.csv"), "{r}");
            } else {
                // What was evaluated is one of the states that the file really had, and named by its hash.
                assert_eq!(r["recording"][0]["sha256"].as_str().unwrap().len(), 64);
                let samples = r["recording"][0]["samples"].as_u64().unwrap();
                assert!([ROWS, ROWS + 1, 1000].contains(&samples) || round % 4 == 1, "{samples}");
            }
        } else {
            assert_eq!((code, err.lines().count() >= 1), (2, true), "{err}");
        }
        let strange: Vec<String> =
            names(dir.path()).into_iter().filter(|n| !["out", "r.csv"].contains(&n.as_str())).collect();
        assert!(strange.is_empty(), "{strange:?}");
    }
    println!("exit codes 0 to 3: {endings:?}");
    assert_eq!(endings[1], 0, "no limit was given that could fail");
}

fn run_into(folder: &Path, out: &str) -> crate::support::Said {
    Quick::new("pass").run(folder, &["--out", out])
}

#[test]
fn names_that_no_folder_can_have_are_refused_with_the_place() {
    let dir = tempdir().unwrap();
    let long = "n".repeat(300);
    let deep = "d/".repeat(2500) + "out";
    std::fs::write(dir.path().join("file"), "").unwrap();
    std::os::unix::fs::symlink("nowhere", dir.path().join("dangling")).unwrap();
    std::os::unix::fs::symlink("circle", dir.path().join("circle")).unwrap();
    let before = names(dir.path());
    for out in [&long, &deep, "file/out", "dangling", "circle/out", "/dev/null", "/dev/null/out"] {
        let said = run_into(dir.path(), out);
        assert_eq!(said.code, 2, "{out}: {said:?}");
        assert!(said.err.starts_with("error: ") && said.err.lines().count() == 1, "{out}: {}", said.err);
        assert_eq!(names(dir.path()), before, "{out}");
    }
}

/// A disk that is full at every possible moment: the size of the files that may be written grows step by step.
#[test]
fn a_disk_that_fills_up_at_any_moment_leaves_the_earlier_result() {
    let dir = tempdir().unwrap();
    assert_eq!(run_into(dir.path(), "out").code, 0);
    let earlier = files(&dir.path().join("out"));
    let largest = earlier.iter().map(|f| f.1.len()).max().unwrap() as u64;
    let mut refused = 0;
    // Blocks of 512 bytes, as the shell counts them.
    for step in 0..12u64 {
        let blocks = step * (largest / 512 + 8) / 11;
        let output = Command::new("sh")
            .current_dir(dir.path())
            .args(["-c", &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\""), program()])
            .args(Quick::new("fail").args())
            .args(["--force", "--out", "out"])
            .output()
            .unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        let now = files(&dir.path().join("out"));
        match output.status.code() {
            Some(2) => {
                assert!(err.starts_with("error: failed to ") && err.lines().count() == 1, "{blocks}: {err}");
                assert!(now == earlier, "{blocks} blocks: half a result");
                refused += 1;
            }
            code => {
                assert_eq!(code, Some(1), "{blocks}: {err}");
                assert!(now != earlier);
            }
        }
        assert_eq!(names(dir.path()), ["out"], "{blocks}");
    }
    assert!(refused >= 6, "{refused}");
}

/// Whether a signal is ignored here, as interrupts are by what a shell runs in the background.
fn ignored(number: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok()).is_some_and(|m| m >> (number - 1) & 1 == 1)
}

/// A run that is asked to stop leaves the earlier result as it was, and nothing that it had begun.
#[test]
fn a_run_that_is_asked_to_stop_leaves_the_earlier_result() {
    let dir = tempdir().unwrap();
    assert_eq!(run_into(dir.path(), "out").code, 0);
    let earlier = files(&dir.path().join("out"));
    let rows: String = (0..2_000_000).map(|i| format!("{i},12.5,20.0\n")).collect();
    std::fs::write(dir.path().join("long.csv"), format!("{HEADER}\n{rows}")).unwrap();
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        if ignored(number) {
            eprintln!("{signal} is ignored by what runs the tests, and so by what they start: skipped");
            continue;
        }
        let mut child = Command::new(program())
            .current_dir(dir.path())
            .args(["run", &procedure(), "long.csv", "--serial", "SN-1", "--force", "--out", "out"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(60));
        let sent =
            Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert_eq!(child.wait().unwrap().code(), None, "{signal} ends the run");
        assert!(files(&dir.path().join("out")) == earlier, "{signal}");
    }
    assert_eq!(names(dir.path()), ["long.csv", "out"]);
    assert_eq!(run_into(dir.path(), "out").code, 0);
    assert_eq!(names(dir.path()), ["long.csv", "out"]);
}
