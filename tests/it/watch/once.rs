//! Each recording is tested once: over further looks, copies, kills and restarts.

use super::{Bench, pairs};
use crate::store::kept;
use crate::support::{program, sagnac, steady_files};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Starts a watcher that goes on, or looks once.
pub(super) fn start(bench: &Bench, args: &[&str]) -> Child {
    start_from(Path::new(program()), bench, args)
}

/// The same, from a file of the program.
fn start_from(program: &Path, bench: &Bench, args: &[&str]) -> Child {
    Command::new(program)
        .current_dir(bench.folder())
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn a_recording_is_tested_once_with_the_numbers_of_the_command_line() {
    let bench = Bench::new("");
    bench.put("a_SN-1.csv", "pass");
    bench.put("b_SN-2.csv", "fail");
    let said = bench.once();
    assert_eq!(said.code, 1, "{said:?}");
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass"), ("SN-2", "fail")]));
    let quick = &bench.quick;
    let by_hand = ["run", &quick.procedure, "in/a_SN-1.csv", "--limits", &quick.limits, "--serial", "SN-1"];
    let said = sagnac(bench.folder(), &[&by_hand[..], &["--out", "by-hand"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let (place, _) = bench.results().remove(0);
    assert!(place.starts_with(bench.at("out/results/SN-1")), "{}", place.display());
    assert_eq!(steady_files(&place), steady_files(&bench.at("by-hand")));

    let journal = bench.journal();
    let said = bench.once();
    assert_eq!((said.code, said.err.as_str()), (0, ""), "nothing is new: {said:?}");
    assert_eq!(bench.journal(), journal);
    bench.put("copy_SN-1.csv", "pass");
    let said = bench.once();
    assert!(said.code == 0 && said.err.contains("copy_SN-1.csv: same content"), "{said:?}");
    assert_eq!((bench.results().len(), bench.journal().len()), (2, 3));
    bench.rule("*_{serial}.csv", "");
    let limits = fs::read_to_string(&quick.limits).unwrap().replace("0.0025", "0.0024");
    fs::write(bench.at("other.toml"), limits).unwrap();
    let rules = fs::read_to_string(bench.at("watch.toml")).unwrap();
    fs::write(bench.at("watch.toml"), rules.replace(&quick.limits, "other.toml")).unwrap();
    bench.once();
    assert_eq!(bench.results().len(), 4, "other limits are another test");
}

#[test]
#[cfg(target_os = "linux")]
fn a_watcher_goes_on_while_its_program_is_replaced() {
    let bench = Bench::new("after = \"1 s\"\n");
    let own = bench.at("sagnac");
    fs::copy(program(), &own).unwrap();
    let mut watcher = start_from(&own, &bench, &["watch", "in", "--rules", "watch.toml", "--out", "out"]);
    let begun = Instant::now();
    while !bench.at("out/journal.jsonl").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    fs::remove_file(&own).unwrap();
    fs::write(&own, "another version").unwrap();
    bench.put("a_SN-1.csv", "pass");
    while !fs::read_to_string(bench.at("out/journal.jsonl")).unwrap().contains("\"tested\"") {
        assert!(begun.elapsed() < Duration::from_secs(120), "no test was made");
        std::thread::sleep(Duration::from_millis(50));
    }
    watcher.kill().unwrap();
    watcher.wait().unwrap();
    assert_eq!(bench.verdicts(), pairs(&[("SN-1", "pass")]));
}

#[test]
fn twenty_kills_lose_and_double_nothing() {
    const FILES: usize = 6;
    let bench = Bench::new("store = \"store\"\n");
    assert_eq!(sagnac(bench.folder(), &["store", "init", "store"]).code, 0);
    (0..FILES).for_each(|i| bench.numbered(&format!("x_SN-{i}.csv"), i));
    let mut random = Xoshiro256PlusPlus::seed_from_u64(63);
    for _ in 0..20 {
        let mut child = start(&bench, &Bench::ONCE);
        let share: f64 = random.random();
        std::thread::sleep(Duration::from_secs_f64(2.0 * share));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let said = bench.once();
    assert_eq!(said.code, 0, "{said:?}");
    let serials: BTreeSet<String> = bench.verdicts().into_iter().map(|(serial, _)| serial).collect();
    assert_eq!((bench.results().len(), serials.len()), (FILES, FILES));
    assert_eq!(kept(&bench.at("store")).len(), FILES, "each is one attempt");
    let tested = bench.journal().iter().filter(|line| line.get("tested").is_some()).count();
    assert_eq!(tested, FILES);
    for (place, _) in bench.results() {
        assert_eq!(sagnac(bench.folder(), &["verify", place.to_str().unwrap()]).code, 0);
    }
}

#[test]
fn a_result_without_its_line_is_entered_and_not_made_again() {
    let bench = Bench::new("store = \"store\"\n");
    assert_eq!(sagnac(bench.folder(), &["store", "init", "store"]).code, 0);
    bench.put("a_SN-1.csv", "pass");
    assert_eq!(bench.once().code, 0);
    let (place, before) = bench.results().remove(0);
    let written = fs::metadata(place.join("result.json")).unwrap().modified().unwrap();
    let journal = fs::read_to_string(bench.at("out/journal.jsonl")).unwrap();
    // The line was cut by a loss of power.
    fs::write(bench.at("out/journal.jsonl"), &journal[..journal.len() - 9]).unwrap();
    assert_eq!(bench.once().code, 0);
    let after = bench.results();
    assert_eq!(after, [(place.clone(), before)]);
    assert_eq!(fs::metadata(place.join("result.json")).unwrap().modified().unwrap(), written);
    assert_eq!((kept(&bench.at("store")).len(), bench.journal().len()), (1, 1));
}

#[cfg(unix)]
#[test]
fn a_watcher_tests_what_comes_and_ends_when_asked() {
    let bench = Bench::new("after = \"300 ms\"\n");
    let mut child = start(&bench, &["watch", "in", "--rules", "watch.toml", "--out", "out"]);
    let began = Instant::now();
    let wait_for = |what: &str, done: &dyn Fn() -> bool| {
        while !done() {
            assert!(began.elapsed() < Duration::from_secs(120), "{what}");
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    let journal = bench.at("out/journal.jsonl");
    wait_for("it begins", &|| journal.exists());
    let said = bench.once();
    assert!(said.code == 2 && said.err.contains("another `sagnac watch`"), "{said:?}");
    for (name, number) in [("a_SN-1.csv", 1), ("b_SN-2.csv", 2)] {
        bench.numbered(name, number);
        wait_for(name, &|| bench.journal().len() == number);
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(bench.record()["counts"]["pass"], 2);
}
