//! Result folders appear whole or not at all, whatever happens to the run and whoever else writes there.

#![cfg(unix)]

use crate::support::quick::Quick;
use crate::support::{
    Files, Said, files, names, program, result, sagnac, sagnac_as_typed, sample, steady_files,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::tempdir;

fn arguments(name: &str, out: &str) -> Vec<String> {
    // The samples take turns: each replaces the result of the other.
    let quick = Quick::new(name);
    quick.args().iter().chain(&["--force", "--out", out]).map(|a| (*a).to_owned()).collect()
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

fn finish(folder: &Path, name: &str, out: &str) -> Files {
    let arguments = arguments(name, out);
    let said = sagnac(folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(said.code <= 1, "{said:?}");
    steady_files(&folder.join(out))
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
        let found = steady_files(&dir.path().join("out"));
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
    assert_eq!(names(dir.path()), ["out"], "what dead runs left is removed by the next");
    killed
}

#[test]
fn a_killed_run_leaves_the_earlier_result_or_the_new_one() {
    let killed = kill_at_random_moments(16, 7);
    assert!(killed >= 8, "{killed} of 16 were killed in their course");
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
        let found = steady_files(&dir.path().join("out"));
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
        ("thesis", "is not a result folder of this program"),
        ("other", "is not a result folder of this program"),
        ("signed", "contains `scan.pdf`"),
        ("link", "is a link"),
        ("..", "not a valid name for a new folder"),
        (".", "not a valid name for a new folder"),
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
    assert_eq!(steady_files(&dir.path().join("out")), passing);
    assert_eq!(names(dir.path()), ["out"]);
}

/// A run without `--force`.
fn typed(folder: &Path, arguments: &[&str]) -> Said {
    sagnac_as_typed(folder, arguments, &[])
}

fn run<'a>(procedure: &'a str, recording: &'a str, limits: &'a str, serial: &'a str) -> Vec<&'a str> {
    vec!["run", procedure, recording, "--limits", limits, "--serial", serial, "--out", "out"]
}

#[test]
fn a_result_of_other_inputs_is_replaced_by_force_only() {
    let dir = tempdir().unwrap();
    let Quick { procedure, recording: pass, limits } = Quick::new("pass");
    let fail = Quick::new("fail").recording;
    let other_limits =
        crate::support::altered(dir.path(), "limits.toml", &limits, &[("[limits]", "# tighter\n[limits]")]);
    let other_procedure = crate::support::altered(
        dir.path(),
        "procedure.toml",
        &procedure,
        &[("[procedure]", "# new\n[procedure]")],
    );
    let first = run(&procedure, &pass, &limits, "SN-1");
    assert_eq!(typed(dir.path(), &first).code, 0);
    assert_eq!(typed(dir.path(), &first).code, 0, "the same inputs anew");
    let before = files(&dir.path().join("out"));
    for (other, differs) in [
        (run(&procedure, &fail, &limits, "SN-1"), "recording"),
        (run(&procedure, &pass, &other_limits, "SN-1"), "limits"),
        (run(&other_procedure, &pass, &limits, "SN-1"), "procedure"),
        (run(&procedure, &pass, &limits, "SN-2"), "unit"),
    ] {
        let said = typed(dir.path(), &other);
        assert_eq!(said.code, 2, "{differs}: {said:?}");
        for part in
            ["result `pass` of unit SN-1", &format!("made from different inputs: {differs};"), "--force"]
        {
            assert!(said.err.contains(part), "{part}: {}", said.err);
        }
        assert!(files(&dir.path().join("out")) == before, "{differs}");
    }
    let mut forced = run(&procedure, &fail, &limits, "SN-1");
    forced.push("--force");
    let said = typed(dir.path(), &forced);
    assert!(
        said.code == 1 && said.err.contains("replaced the result `pass` of unit SN-1, evaluated 20"),
        "{said:?}"
    );
    assert_eq!(result(&dir.path().join("out"))["verdict"], "fail");

    let analysed = ["analyze", &pass, "--out", "a"];
    assert_eq!(typed(dir.path(), &analysed).code, 0);
    let said = typed(dir.path(), &["analyze", &fail, "--out", "a"]);
    assert!(said.code == 2 && said.err.contains("a result (`no limits`, no serial number)"), "{said:?}");
    let compared = ["compare", &pass, "--out", "c"];
    assert_eq!(typed(dir.path(), &compared).code, 0);
    assert_eq!(typed(dir.path(), &compared).code, 0);
    let said = typed(dir.path(), &["compare", &fail, "--out", "c"]);
    assert!(said.code == 2 && said.err.contains("a comparison made 20"), "{said:?}");
    let model = crate::support::shipped("samples/model-static.toml");
    let simulate = |seed: &'static str| {
        let dir = dir.path().to_owned();
        let model = model.clone();
        move |more: &[&str]| {
            let args = ["simulate", &model, "--out", "s.csv", "--duration", "20min", "--seed", seed];
            typed(&dir, &[&args[..], more].concat())
        }
    };
    assert_eq!(simulate("1")(&[]).code, 0);
    assert_eq!(simulate("1")(&[]).code, 0, "the same recording anew");
    let said = simulate("2")(&[]);
    assert!(said.code == 2 && said.err.contains("exists with different content"), "{said:?}");
    assert_eq!(simulate("2")(&["--force"]).code, 0);
    assert_eq!(names(dir.path()), ["a", "c", "limits.toml", "out", "procedure.toml", "s.csv"]);
}

#[test]
fn nothing_that_the_result_does_not_list_is_removed_and_no_input() {
    let dir = tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let Quick { procedure, recording, limits } = Quick::new("pass");
    let arguments = run(&procedure, "u.csv", &limits, "SN-1");
    std::fs::copy(&recording, at("u.csv")).unwrap();
    assert_eq!(typed(dir.path(), &arguments).code, 0);
    for name in ["figures/photo.jpg", "explain/thoughts.txt", "phases/u.csv", "figures/sub/scan.pdf"] {
        std::fs::create_dir_all(at("out").join(name).parent().unwrap()).unwrap();
        std::fs::write(at("out").join(name), "of the user").unwrap();
        for force in [&[][..], &["--force"]] {
            let said = typed(dir.path(), &[&arguments[..], force].concat());
            assert!(
                said.code == 2 && said.err.contains("which this program did not write"),
                "{name}: {said:?}"
            );
            assert_eq!(std::fs::read(at("out").join(name)).unwrap(), b"of the user");
        }
        std::fs::remove_file(at("out").join(name)).unwrap();
        let _ = std::fs::remove_dir(at("out").join(name).parent().unwrap());
    }
    // The recording itself, the procedure, the limits in the folder of the result.
    std::fs::copy(&recording, at("out/figures/u.csv")).unwrap();
    std::fs::copy(&limits, at("out/limits.toml")).unwrap();
    for arguments in [
        run(&procedure, "out/figures/u.csv", &limits, "SN-1"),
        [run(&procedure, "out/figures/*.csv", &limits, "SN-1"), vec!["--join"]].concat(),
        run(&procedure, "u.csv", "out/limits.toml", "SN-1"),
        vec!["analyze", "out/figures/u.csv", "--out", "out"],
        vec!["compare", "u.csv", "out", "--out", "out"],
        vec!["explain", "u.csv", "--simulation", "out/figures/u.csv", "--out", "out"],
    ] {
        let said = typed(dir.path(), &[&arguments[..], &["--force"]].concat());
        assert!(
            said.code == 2
                && (said.err.contains("is inside the result folder")
                    || said.err.contains("folder of this program")),
            "{arguments:?} {said:?}"
        );
        assert!(at("out/figures/u.csv").exists() && at("out/limits.toml").exists());
    }
    assert_eq!(names(dir.path()), ["out", "u.csv"]);
}

#[test]
fn a_signal_leaves_nothing_half_made() {
    let dir = tempdir().unwrap();
    let time = run_time(tempdir().unwrap().path());
    let signal = |child: &Child, name: &str| {
        let id = child.id().to_string();
        assert!(Command::new("kill").args([&format!("-{name}"), &id]).status().unwrap().success());
    };
    // Sooner and later, since a busy machine does not run at one speed. Where tests run in the background of a shell, INT
    // is ignored, and under nohup HUP.
    let names_of_signals = ["INT", "TERM", "HUP"];
    let mut interrupted = [0; 3];
    for attempt in 0..60 {
        let which = attempt % names_of_signals.len();
        let name = names_of_signals[which];
        let mut child = start(dir.path(), "pass", "out");
        // Late enough that the folder was begun.
        std::thread::sleep(time.mul_f64(0.2 + 0.1 * f64::from(attempt as u32 % 7)));
        signal(&child, name);
        interrupted[which] += u64::from(child.wait().unwrap().code().is_none());
        assert!(names(dir.path()).iter().all(|n| n == "out"), "{name}: {:?}", names(dir.path()));
        if attempt >= 5 && interrupted[1] > 0 && interrupted.iter().sum::<u64>() >= 3 {
            break;
        }
    }
    let all = interrupted.iter().sum::<u64>();
    assert!(interrupted[1] > 0 && all >= 3, "interrupted runs by signal: {interrupted:?}");
    // A run that was killed leaves its folder; one beside it that lives keeps its own.
    let mut live = start(dir.path(), "pass", "live");
    let mut dead = start(dir.path(), "pass", "dead");
    std::thread::sleep(time.mul_f64(0.5));
    dead.kill().unwrap();
    dead.wait().unwrap();
    finish(dir.path(), "pass", "next");
    assert_eq!(live.wait().unwrap().code(), Some(0));
    let left: Vec<String> = names(dir.path()).into_iter().filter(|n| n.starts_with('.')).collect();
    assert!(left.is_empty(), "{left:?}");
}
