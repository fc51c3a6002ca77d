//! A changed byte in any file of a folder of any kind is found.

use crate::documents::tested;
use crate::support::long;
use crate::support::shared::{SharedRun, analyzed_once, shared, tested_once};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::verify::{Finding, Folder, hashes};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of every kind.
fn folders(dir: &Path) -> Vec<PathBuf> {
    let every = [
        ("tested", tested_once("pass")),
        ("explained", crate::explain::step()),
        ("joint", crate::explain::several::joint()),
        ("plan", crate::plan::ramp_planned()),
        ("comparison", shared(&["compare", "--published"], "c")),
        ("analysis", analyzed_once("pass")),
        ("sheet", crate::datasheet::of_the_lot()),
        ("lot", crate::each::tested_lot()),
    ];
    let copy = |(name, made): (&str, &SharedRun)| {
        let to = dir.join(name);
        made.copy_to(&to);
        to
    };
    every.map(copy).into()
}

#[test]
fn any_changed_byte_in_any_folder_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let folders = folders(dir.path());
    let changes = long::cases("any_changed_byte_in_any_folder_is_found", &[(); 2000], 400).len();
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(32);
    let unharmed =
        |at: &Path| Folder::at(at).is_ok_and(|f| !hashes(&f, "signatures").iter().any(Finding::differs));
    for at in &folders {
        assert!(unharmed(at), "{}: {:?}", at.display(), hashes(&Folder::at(at).unwrap(), "signatures"));
        let files: Vec<PathBuf> =
            crate::support::files(at).into_iter().map(|(name, _)| at.join(name)).collect();
        for _ in 0..changes.div_ceil(folders.len()) {
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
    let dir = tested("pass");
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
