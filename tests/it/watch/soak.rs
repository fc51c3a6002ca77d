//! A day of a bench in little time: thousands of recordings while the watcher is killed again and again.

use super::Bench;
use super::once::start;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeMap;
use std::fs;
use std::process::Child;
use std::time::{Duration, Instant};

const FOREVER: [&str; 6] = ["watch", "in", "--rules", "watch.toml", "--out", "out"];
/// Recordings that lie in the folder and wait at a time.
const WAITING: usize = 50;
/// The watcher is killed after up to so many tests.
const TESTS_BETWEEN_KILLS: usize = 120;
/// Growth of the memory of a watcher between its first tests and its last ones, MiB: at all, and for each test, all of which stand
/// on the page of their day.
const MOST_GROWTH_MIB: f64 = 16.0;
const MOST_GROWTH_OF_A_TEST_MIB: f64 = 0.024;

/// Resident memory of a process, MiB.
fn resident_mib(child: &Child) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1024.0)
}

/// Ids of the tests in the journal with how often each stands there.
fn tested(bench: &Bench) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    if !bench.at("out/journal.jsonl").exists() {
        return counts;
    }
    for line in bench.journal() {
        if let Some(test) = line.get("tested") {
            *counts.entry(test["test"]["id"].as_str().unwrap().to_owned()).or_insert(0) += 1;
        }
    }
    counts
}

#[test]
#[ignore = "takes minutes: cargo xtask study watch-soak"]
fn a_day_of_recordings_is_tested_once_each() {
    let files: usize = std::env::var("SAGNAC_SOAK_FILES").map_or(10_000, |n| n.parse().unwrap());
    let bench = Bench::new("after = \"1 s\"\n");
    let mut random = Xoshiro256PlusPlus::seed_from_u64(63);
    let begun = Instant::now();
    let mut watcher = start(&bench, &FOREVER);
    let (mut put, mut kills, mut memory) = (0, 0, vec![]);
    let (mut kill_at, mut last) = (random.random_range(20..TESTS_BETWEEN_KILLS), (0, Instant::now()));
    loop {
        let done = tested(&bench).len();
        while put < files && put < done + WAITING {
            bench.numbered(&format!("x_SN-{put}.csv"), put);
            put += 1;
        }
        if done > last.0 {
            last = (done, Instant::now());
        }
        assert!(last.1.elapsed() < Duration::from_secs(300), "stands still at {done} of {files}");
        memory.extend(resident_mib(&watcher).map(|mib| (done, mib)));
        if done >= files {
            break;
        }
        if done >= kill_at {
            watcher.kill().unwrap();
            watcher.wait().unwrap();
            kills += 1;
            kill_at = done + random.random_range(20..TESTS_BETWEEN_KILLS);
            watcher = start(&bench, &FOREVER);
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    watcher.kill().unwrap();
    watcher.wait().unwrap();
    let counts = tested(&bench);
    assert_eq!((counts.len(), counts.values().max()), (files, Some(&1)), "each once");
    assert_eq!(bench.results().len(), files);
    let most = |of: &dyn Fn(usize) -> bool| {
        memory.iter().filter(|(done, _)| of(*done)).map(|(_, mib)| *mib).fold(0.0, f64::max)
    };
    let (first, end) = (most(&|done| done < files / 10), most(&|done| done > files - files / 10));
    println!(
        "{files} recordings, {kills} kills, {:.0} s; memory of the watcher {first:.1} MiB at first, {end:.1} MiB at the end",
        begun.elapsed().as_secs_f64()
    );
    let most_growth = MOST_GROWTH_MIB + MOST_GROWTH_OF_A_TEST_MIB * files as f64;
    assert!(kills > 0 && end < first + most_growth, "{first} and {end} MiB");
}
