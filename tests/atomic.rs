//! Result folders appear whole or not at all, whatever happens to the run and whoever else writes there.

#![cfg(unix)]

mod support;

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use support::{files, limits, names, procedure, program, result, sagnac, sample};
use tempfile::tempdir;

/// The files of a result without the moment of its making.
type Content = Vec<(PathBuf, Vec<u8>)>;

fn content(folder: &Path) -> Content {
    let at = result(folder)["session"]["evaluated_at"].as_str().unwrap().to_owned();
    let shown = format!("{} {} UTC", &at[..10], &at[11..19]);
    let without = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).unwrap();
        text.replace(&at, "<clock>").replace(&shown, "<clock>").into_bytes()
    };
    files(folder).into_iter().map(|(path, bytes)| (path, without(bytes))).collect()
}

fn arguments(name: &str, out: &str) -> Vec<String> {
    ["run", &procedure(), &sample(name), "--limits", &limits(), "--serial", "SN-1", "--out", out]
        .map(str::to_owned)
        .to_vec()
}

fn start(folder: &Path, name: &str, out: &str) -> Child {
    Command::new(program())
        .current_dir(folder)
        .args(arguments(name, out))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn finish(folder: &Path, name: &str, out: &str) -> Content {
    let arguments = arguments(name, out);
    let said = sagnac(folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(said.code <= 1, "{said:?}");
    content(&folder.join(out))
}

/// How long a run takes from its start to its end: the shortest of five, which other work on the machine has delayed
/// least.
fn run_time(folder: &Path) -> Duration {
    let times = [(); 5].map(|()| {
        let began = Instant::now();
        assert_eq!(start(folder, "fail", "timed").wait().unwrap().code(), Some(1));
        began.elapsed()
    });
    times.into_iter().min().unwrap()
}

/// How a share of the run time is drawn: half of the moments over the whole run, half near its end, where the folder is
/// written and put in place.
fn share(i: u64, random: &mut Xoshiro256PlusPlus) -> f64 {
    let uniform: f64 = random.random();
    if i.is_multiple_of(2) { uniform } else { 0.7 + 0.4 * uniform }
}

/// Kills runs at random moments while each replaces the result of the other sample; gives how many of them ran.
fn kill_at_random_moments(times: u64, seed: u64) -> u64 {
    let dir = tempdir().unwrap();
    let failing = finish(dir.path(), "fail", "out");
    let passing = finish(dir.path(), "pass", "out");
    assert_ne!(passing, failing);
    let beside = tempdir().unwrap();
    let mut whole_run = run_time(beside.path());
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut in_place = "pass";
    let (mut killed, mut replaced) = (0, 0);
    for i in 0..times {
        let next = if in_place == "pass" { "fail" } else { "pass" };
        // Other work on the machine comes and goes.
        if i % 20 == 19 {
            whole_run = run_time(beside.path());
        }
        let mut child = start(dir.path(), next, "out");
        std::thread::sleep(whole_run.mul_f64(share(i, &mut random)).min(Duration::from_secs(20)));
        child.kill().unwrap();
        killed += u64::from(child.wait().unwrap().code().is_none());
        let found = content(&dir.path().join("out"));
        let name = if found == passing { "pass" } else { "fail" };
        assert!(found == passing || found == failing, "kill {i}: neither the earlier result nor the new one");
        replaced += u64::from(name != in_place);
        in_place = name;
        let strange: Vec<String> =
            names(dir.path()).into_iter().filter(|n| n != "out" && !n.starts_with(".out.partial-")).collect();
        assert!(strange.is_empty(), "{strange:?}");
    }
    println!("{times} runs: {killed} killed in their course, {replaced} had replaced the earlier result");
    // What the killed runs left does not disturb the next.
    assert_eq!(finish(dir.path(), "pass", "out"), passing);
    killed
}

#[test]
fn a_killed_run_leaves_the_earlier_result_or_the_new_one() {
    let killed = kill_at_random_moments(24, 7);
    assert!(killed >= 12, "{killed} of 24 were killed in their course");
}

#[test]
#[ignore = "takes minutes"]
fn a_killed_run_leaves_the_earlier_result_or_the_new_one_200_times() {
    let killed = kill_at_random_moments(200, 11);
    assert!(killed >= 150, "{killed} of 200 were killed in their course");
}

#[test]
fn runs_to_one_folder_at_the_same_time_leave_one_whole_result() {
    let dir = tempdir().unwrap();
    let passing = finish(dir.path(), "pass", "p");
    let failing = finish(dir.path(), "fail", "f");
    for round in 0..3 {
        let children: Vec<Child> =
            (0..4).map(|i| start(dir.path(), if i % 2 == 0 { "pass" } else { "fail" }, "out")).collect();
        for (i, mut child) in children.into_iter().enumerate() {
            assert_eq!(child.wait().unwrap().code(), Some(i as i32 % 2), "round {round}, run {i}");
        }
        let found = content(&dir.path().join("out"));
        assert!(found == passing || found == failing, "round {round}");
        assert_eq!(names(dir.path()), ["f", "out", "p"], "round {round}");
        std::fs::remove_dir_all(dir.path().join("out")).unwrap();
    }
}

#[test]
fn what_is_not_ours_is_refused_and_left_as_it_is() {
    let dir = tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    std::fs::write(at("file"), "a file").unwrap();
    std::fs::create_dir(at("thesis")).unwrap();
    std::fs::write(at("thesis/chapter.txt"), "three years of work").unwrap();
    std::fs::create_dir(at("other")).unwrap();
    std::fs::write(at("other/result.json"), "{\"format\": \"another program\"}").unwrap();
    finish(dir.path(), "pass", "signed");
    std::fs::write(at("signed/scan.pdf"), "with signatures").unwrap();
    finish(dir.path(), "pass", "real");
    std::os::unix::fs::symlink("real", at("link")).unwrap();
    let before = files(dir.path());
    for (out, fragment) in [
        ("file", "is a file"),
        ("file/below", "file"),
        ("thesis", "no result folder of this program"),
        ("other", "no result folder of this program"),
        ("signed", "holds `scan.pdf`"),
        ("link", "is a link"),
        ("..", "not the name of a folder"),
        (".", "not the name of a folder"),
    ] {
        let arguments = arguments("fail", out);
        let said = sagnac(dir.path(), &arguments.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(said.code, 2, "{out}: {said:?}");
        assert!(said.err.contains(fragment), "{out}: {}", said.err);
        assert_eq!(said.err.lines().count(), 1, "{out}: {}", said.err);
        assert!(files(dir.path()) == before, "{out}");
    }
}

#[test]
fn a_place_that_cannot_be_written_is_an_error_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["analyze", &sample("pass"), "--out", "/proc/sagnac/result"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert!(said.err.contains("/proc/sagnac") && said.err.lines().count() == 1, "{}", said.err);

    let closed = dir.path().join("closed");
    std::fs::create_dir(&closed).unwrap();
    std::fs::set_permissions(&closed, PermissionsExt::from_mode(0o555)).unwrap();
    let rights_hold = std::fs::create_dir(closed.join("probe")).is_err();
    let said = sagnac(dir.path(), &["analyze", &sample("pass"), "--out", "closed/result"]);
    if rights_hold {
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains("closed") && said.err.lines().count() == 1, "{}", said.err);
        assert!(names(&closed).is_empty());
    } else {
        println!("skipped: the rights of folders do not hold for this user");
    }
}

#[test]
fn a_file_that_cannot_be_written_whole_leaves_the_earlier_result() {
    let dir = tempdir().unwrap();
    let passing = finish(dir.path(), "pass", "out");
    // A limit on the size of files stands for a full disk: writing fails half way through a file.
    let output = Command::new("sh")
        .current_dir(dir.path())
        .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"", program()])
        .args(arguments("fail", "out"))
        .output()
        .unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert!(err.starts_with("error: failed to write") && err.lines().count() == 1, "{err}");
    assert_eq!(content(&dir.path().join("out")), passing);
    assert_eq!(names(dir.path()), ["out"]);
}
