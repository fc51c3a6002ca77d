//! Commands of every kind that are killed at random moments: nothing is lost, and every later command works.

#![cfg(unix)]

use crate::store::{kept, store, store_says, with_store, write_results};
use crate::support::{files, names, program, sagnac, shipped};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::output::sha256;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Units whose results come in again and again.
const UNITS: usize = 6;

/// The commands that are killed.
const VERBS: [&str; 9] =
    ["import", "run", "supersede", "rebuild", "prune", "export", "verify", "sign", "init"];

/// The arguments of a command of a kind; `i` makes its outputs its own.
fn arguments(folder: &Path, verb: &str, i: usize) -> Vec<String> {
    let recording = shipped("samples/supply-sensitivity-pass.csv");
    let addresses: Vec<String> = kept(&folder.join("store")).into_iter().map(|k| k.0).collect();
    let of = |args: &[&str]| args.iter().map(|a| (*a).to_owned()).collect::<Vec<_>>();
    let last = addresses.len().saturating_sub(1);
    match verb {
        "run" => {
            let (out, serial) = (format!("r{i}"), format!("R-{}", i % 3));
            let args = ["run", "supply-sensitivity", &recording, "--serial", &serial, "--out", &out];
            [of(&args), of(&["--store", "store", "--keep-recording"])].concat()
        }
        "supersede" if addresses.len() > 1 => {
            // In ascending order of addresses, so that no circle is asked for.
            let old = i % last;
            of(&["store", "supersede", "store", &addresses[old], "--by", &addresses[last], "--reason", "r"])
        }
        "prune" => of(&["store", "prune", "store", "--to", "archive"]),
        "export" => of(&["store", "export", "store", "--out", "table.parquet", "--force"]),
        "verify" | "rebuild" => of(&["store", verb, "store"]),
        "sign" => of(&["sign", "signed", "--key", "anna"]),
        "init" => of(&["store", "init", "other"]),
        _ => of(&["store", "import", "store", "made"]),
    }
}

fn start(folder: &Path, args: &[String]) -> std::process::Child {
    Command::new(program())
        .current_dir(folder)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// The hashes of the files in some folders.
fn hashes(folders: &[&Path]) -> BTreeSet<String> {
    let there = folders.iter().filter(|folder| folder.is_dir());
    there.flat_map(|folder| files(folder)).map(|(_, bytes)| sha256(&bytes)).collect()
}

/// Kills commands; gives how many were killed in their course.
fn kill_all_verbs(times: usize, seed: u64) -> usize {
    let dir = with_store();
    let at = dir.path();
    write_results(&at.join("made"), UNITS);
    crate::documents::signing::key(at, "anna", 1);
    let recording = shipped("samples/supply-sensitivity-pass.csv");
    let signed = ["run", "supply-sensitivity", &recording, "--out", "signed"];
    assert_eq!(sagnac(at, &signed).code, 0);
    store(at, &["import", "store", "made"]);
    let (copies, archive) = (at.join("store/recordings"), at.join("archive"));
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let (mut killed, mut results, mut kept_recordings) = (0, 2 * UNITS, BTreeSet::new());
    // How long each command takes that is not killed.
    let mut usual = VERBS.map(|_| Duration::ZERO);
    for i in 0..times {
        let which = i % VERBS.len();
        let (verb, args) = (VERBS[which], arguments(at, VERBS[which], i));
        if verb == "sign" {
            let _ = fs::remove_dir_all(at.join("signed/signatures"));
        }
        if verb == "init" {
            let _ = fs::remove_dir_all(at.join("other"));
        }
        if usual[which].is_zero() || i % 40 == which {
            let began = Instant::now();
            let code = start(at, &args).wait().unwrap().code();
            // The unit of the sample is another one, so that its test is not done as required.
            assert!(code == Some(0) || verb == "run" && code == Some(3), "{i} {args:?}: {code:?}");
            usual[which] = began.elapsed();
        } else {
            let mut child = start(at, &args);
            let share: f64 = random.random();
            std::thread::sleep(usual[which].mul_f64(share));
            child.kill().unwrap();
            killed += usize::from(child.wait().unwrap().code().is_none());
        }
        let said = store_says(at, &["verify", "store"]);
        assert!(said.code == 0, "kill {i} of {verb}: {said:?}");
        let now = kept(&at.join("store")).len();
        assert!(now >= results, "kill {i} of {verb}: {now} of {results} results");
        results = now;
        // A recording that the store had is there still, or whole where it was moved.
        let there = hashes(&[&copies, &archive]);
        assert!(there.is_superset(&kept_recordings), "kill {i} of {verb}");
        kept_recordings = hashes(&[&copies]).union(&kept_recordings).cloned().collect();
        kept_recordings.retain(|hash| names(&copies).contains(hash) || names(&archive).contains(hash));
        if verb == "init" && !at.join("other/store.json").exists() {
            store(at, &["init", "other"]);
        }
        if verb == "sign" {
            let said = sagnac(at, &["sign", "signed", "--key", "anna"]);
            assert_eq!(said.code, 0, "kill {i} of {verb}: {said:?}");
            let said = sagnac(at, &["verify", "signed"]);
            assert_eq!(said.code, 0, "kill {i} of {verb}: {said:?}");
        }
    }
    killed
}

#[test]
fn a_killed_command_of_any_kind_loses_nothing() {
    kill_all_verbs(3 * VERBS.len(), 55);
}

#[test]
#[ignore = "kills 300 commands"]
fn three_hundred_kills_of_all_kinds_lose_nothing() {
    let killed = kill_all_verbs(420, 2026);
    println!("{killed} commands were killed in their course");
    assert!(killed >= 300, "{killed}");
}
