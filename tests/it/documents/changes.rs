//! A changed byte in any file of a folder of any kind is found.

use crate::documents::tested;
use crate::support::{limits, sagnac, sample, shipped, short_procedure};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::verify::{Finding, Folder, hashes};
use std::fs;
use std::path::{Path, PathBuf};

/// Changes over all folders.
const CHANGES: usize = 2000;

const MODEL: &str = "[recording]\ncase = \"unit\"\nsample_rate_hz = 1.0\ncolumns = [\"time_s\", \"rate_deg_h\"]\n\
    [noise]\nN_deg_rt_h = 0.01\n[bias]\nvalue_deg_h = 1.0\n[uncertainty]\nN_rel = 0.02\nbias_deg_h = 0.5\n";

/// Folders of every kind that a few small runs give.
fn folders(dir: &Path) -> Vec<PathBuf> {
    let run = |args: &[&str]| {
        let said = sagnac(dir, args);
        assert!(matches!(said.code, 0 | 1 | 3), "{args:?}: {said:?}");
    };
    fs::write(dir.join("model.toml"), MODEL).unwrap();
    for (name, seed) in [("a.csv", "1"), ("b.csv", "2")] {
        run(&["simulate", "model.toml", "--duration", "1h", "--seed", seed, "--out", name]);
    }
    run(&["explain", "a.csv", "--model", "model.toml", "--out", "explained"]);
    run(&["explain", "a.csv", "b.csv", "--model", "model.toml", "--out", "joint"]);
    run(&["plan", "explained", "--model", "model.toml", "--budget", "1h", "--out", "plan"]);
    run(&["compare", "--published", "--out", "comparison"]);
    run(&["analyze", "a.csv", "--out", "analysis"]);
    let mut units: Vec<PathBuf> =
        fs::read_dir(shipped("samples/lot")).unwrap().map(|e| e.unwrap().path()).collect();
    units.retain(|p| p.is_dir());
    units.sort();
    let units: Vec<String> = units.iter().map(|p| p.join("result.json").display().to_string()).collect();
    let units: Vec<&str> = units.iter().map(String::as_str).collect();
    run(&[&["datasheet"], units.as_slice(), &["--out", "sheet"]].concat());
    let (procedure, limits) = (short_procedure(dir), limits());
    let (pass, fail) = (sample("pass"), sample("fail"));
    run(&[
        "run",
        &procedure,
        &pass,
        &fail,
        "--each",
        "--serial-from",
        "{stem}",
        "--limits",
        &limits,
        "--out",
        "lot",
    ]);
    ["explained", "joint", "plan", "comparison", "analysis", "sheet", "lot"]
        .iter()
        .map(|n| dir.join(n))
        .collect()
}

#[test]
fn any_changed_byte_in_any_folder_is_found() {
    let dir = tested("pass", "");
    let mut folders = folders(dir.path());
    folders.push(dir.path().join("r"));
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(32);
    let unharmed =
        |at: &Path| Folder::at(at).is_ok_and(|f| !hashes(&f, "signatures").iter().any(Finding::differs));
    for at in &folders {
        assert!(unharmed(at), "{}: {:?}", at.display(), hashes(&Folder::at(at).unwrap(), "signatures"));
        let files: Vec<PathBuf> =
            crate::support::files(at).into_iter().map(|(name, _)| at.join(name)).collect();
        for _ in 0..CHANGES.div_ceil(folders.len()) {
            let file = &files[chance.random_range(0..files.len())];
            let good = fs::read(file).unwrap();
            let mut bad = good.clone();
            let place = chance.random_range(0..bad.len());
            bad[place] ^= 1 << chance.random_range(0..8_u32);
            fs::write(file, &bad).unwrap();
            assert!(!unharmed(at), "{}: byte {place}", file.display());
            fs::write(file, &good).unwrap();
        }
        assert!(unharmed(at), "{}", at.display());
    }
}

#[test]
fn a_file_that_is_taken_away_or_added_is_named() {
    let dir = tested("pass", "");
    let said = |name: &str| crate::documents::verified(dir.path(), &[name]).1;
    fs::write(dir.path().join("r/notes.txt"), "x").unwrap();
    assert!(said("r").contains("notes.txt: was not written with the result"), "{}", said("r"));
    fs::remove_file(dir.path().join("r/notes.txt")).unwrap();
    fs::rename(dir.path().join("r/report.md"), dir.path().join("report.md")).unwrap();
    assert!(said("r").contains("report.md: missing"), "{}", said("r"));
    fs::rename(dir.path().join("report.md"), dir.path().join("r/report.md")).unwrap();
    fs::remove_file(dir.path().join("r/SHA256SUMS")).unwrap();
    assert!(said("r").contains("states no hashes"), "{}", said("r"));
}
