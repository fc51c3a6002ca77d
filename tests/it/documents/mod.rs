//! Documents that a factory signs: what was written is found again or what differs is named; who signed it; what is typeset.

mod changes;
mod exports;
pub mod forged;
mod papers;
mod pdf;
mod signers;
pub mod signing;

use crate::support::shared::tested_once;
use crate::support::{sagnac, sagnac_with, sample};
use std::path::Path;
use tempfile::TempDir;

/// A folder with the result `r` of a unit.
fn tested(unit: &str) -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    tested_once(unit).copy_to(&dir.path().join("r"));
    dir
}

/// What `verify` says of a folder, and its exit code.
fn verified(dir: &Path, args: &[&str]) -> (i32, String) {
    let said = sagnac(dir, &[&["verify"], args].concat());
    (said.code, format!("{}{}", said.out, said.err))
}

#[test]
fn a_result_is_verified_from_its_hashes_to_its_figures() {
    let dir = tested("pass");
    let recording = sample("pass");
    let (code, said) = verified(dir.path(), &["r", "--recording", &recording]);
    assert_eq!(code, 0, "{said}");
    for part in [
        "hashes recomputed",
        "reproduce from the record",
        "pass; rows with a limit: 7",
        "same figures: 28 quantities",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(!said.contains('✗') && said.ends_with("Nothing differs.\n"), "{said}");
    // The record alone names the same folder; another recording is none of this result.
    assert_eq!(verified(dir.path(), &["r/result.json"]).0, 0);
    let other = sample("fail");
    let (code, said) = verified(dir.path(), &["r", "--recording", &other]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("its hash differs"), "{said}");
    // A store in the settings of the user keeps no further attempt.
    let at = dir.path();
    assert_eq!(sagnac(at, &["store", "init", "store"]).code, 0);
    std::fs::create_dir(at.join("sagnac")).unwrap();
    std::fs::write(
        at.join("sagnac/config.toml"),
        format!("[store]\npath = \"{}\"\n", at.join("store").display()),
    )
    .unwrap();
    let set = [("XDG_CONFIG_HOME", at.to_str().unwrap())];
    assert_eq!(sagnac_with(at, &["verify", "r", "--recording", &recording], &set).code, 0);
    assert_eq!(std::fs::read_dir(at.join("store/results")).unwrap().count(), 0);
    let said = sagnac(dir.path(), &["verify", "r", "--lang", "ru"]);
    assert!(said.out.ends_with("Расхождений нет.\n"), "{said:?}");
}

#[test]
fn a_verdict_that_the_numbers_do_not_give_is_found_behind_new_hashes() {
    let dir = tested("fail");
    let at = dir.path().join("r/result.json");
    let text = std::fs::read_to_string(&at).unwrap();
    let forged = text.replace("\"verdict\": \"fail\"", "\"verdict\": \"pass\"");
    assert_ne!(forged, text);
    std::fs::write(&at, &forged).unwrap();
    // Whoever changes a file can write a new list of hashes too.
    let list = dir.path().join("r/SHA256SUMS");
    let sums = std::fs::read_to_string(&list).unwrap();
    let hash = sagnac::output::sha256;
    std::fs::write(&list, sums.replace(&hash(text.as_bytes()), &hash(forged.as_bytes()))).unwrap();
    let (code, said) = verified(dir.path(), &["r"]);
    assert_eq!(code, 1, "{said}");
    assert!(
        said.contains("hashes recomputed") && said.contains("does not follow from value and limit"),
        "{said}"
    );
    assert!(said.contains("report.html: not what the record gives"), "{said}");
}

#[test]
fn what_is_no_result_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("notes.txt"), "x").unwrap();
    for name in ["notes.txt", ".", "nowhere"] {
        let said = sagnac(dir.path(), &["verify", name]);
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains("error"), "{said:?}");
    }
    let said = sagnac(dir.path(), &["verify", ".", "--signers", "none"]);
    assert_eq!(said.code, 2, "{said:?}");
}
