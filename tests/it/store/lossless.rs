//! Nothing that a store holds is lost: not to commands that tidy up, not to outputs named by mistake, not to kills.

#![cfg(unix)]

use crate::store::{a_result, kept, store, store_says, with_store, write_result, write_results};
use crate::support::{files, limits, names, procedure, program, result, sagnac, sagnac_as_typed, sample};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// A store with one run whose recording is kept; gives the copy too.
fn with_recording() -> (tempfile::TempDir, PathBuf) {
    let dir = with_store();
    let (procedure, limits, pass) = (procedure(), limits(), sample("pass"));
    let run = ["run", &procedure, &pass, "--limits", &limits, "--serial", "1", "--out", "r"];
    let said = sagnac(dir.path(), &[&run[..], &["--store", "store", "--keep-recording"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let copies = dir.path().join("store/recordings");
    let copy = copies.join(&files(&copies)[0].0);
    (dir, copy)
}

#[test]
fn recordings_leave_the_store_for_no_place_inside_it() {
    let (dir, copy) = with_recording();
    symlink(dir.path().join("store/recordings"), dir.path().join("link")).unwrap();
    fs::create_dir(dir.path().join("archive")).unwrap();
    let hash = copy.parent().unwrap().file_name().unwrap().to_owned();
    symlink(copy.parent().unwrap(), dir.path().join("archive").join(hash)).unwrap();
    for to in ["store/recordings", "store", "store/new/deep", "new/../store/x", "link", "archive"] {
        let said = store_says(dir.path(), &["prune", "store", "--to", to]);
        assert!(said.code == 2 && said.err.contains("lies in a store"), "{to}: {said:?}");
        assert!(fs::read(&copy).unwrap() == fs::read(sample("pass")).unwrap(), "{to}");
    }
    assert!(!dir.path().join("store/new").exists());
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn a_copy_goes_only_when_its_twin_was_read_back() {
    let (dir, copy) = with_recording();
    let whole = fs::read(&copy).unwrap();
    let place =
        dir.path().join("archive").join(copy.strip_prefix(dir.path().join("store/recordings")).unwrap());
    fs::create_dir_all(place.parent().unwrap()).unwrap();
    let mut flipped = whole.clone();
    flipped[1000] ^= 1;
    for wrong in [&[][..], &whole[..whole.len() - 1], &flipped] {
        fs::write(&place, wrong).unwrap();
        let said = store_says(dir.path(), &["prune", "store", "--to", "archive"]);
        assert!(said.code == 2 && said.err.contains("nothing was removed"), "{said:?}");
        assert!(fs::read(&copy).unwrap() == whole && fs::read(&place).unwrap() == wrong);
    }
    fs::remove_file(&place).unwrap();
    symlink(&copy, &place).unwrap();
    assert_eq!(store_says(dir.path(), &["prune", "store", "--to", "archive"]).code, 2);
    assert!(fs::read(&copy).unwrap() == whole);
    fs::remove_file(&place).unwrap();
    // What is whole at the target is taken for the copy, and what a killed copy left is no obstacle.
    fs::write(&place, &whole).unwrap();
    let left = copy.parent().unwrap().join(".unit-pass.csv.partial-00000000-abcdef");
    fs::write(&left, "half").unwrap();
    let said = store(dir.path(), &["prune", "store", "--to", "archive"]);
    assert!(said.out.contains("Moved copies of recordings: 1"), "{said:?}");
    assert!(!copy.exists() && fs::read(&place).unwrap() == whole);
}

#[test]
fn outputs_do_not_go_into_a_store() {
    let (dir, _) = with_recording();
    let before = files(&dir.path().join("store/results"));
    let (_, folder) = kept(&dir.path().join("store")).remove(0);
    let inside = folder.strip_prefix(dir.path()).unwrap().to_str().unwrap().to_owned();
    let (procedure, limits, fail) = (procedure(), limits(), sample("fail"));
    for args in [
        &["run", &procedure, &fail, "--limits", &limits, "--serial", "1", "--force", "--out", &inside][..],
        &["store", "export", "store", "--force", "--out", "store/index.sqlite"],
        &["history", "--store", "store", "--force", "--out", "store/store.json"],
        &["simulate", &crate::support::shipped("samples/model-static.toml"), "--out", "store/results/x.csv"],
    ] {
        let said = sagnac_as_typed(dir.path(), args, &[]);
        assert!(said.code == 2 && said.err.contains("lies in the store"), "{args:?}: {said:?}");
    }
    assert!(files(&dir.path().join("store/results")) == before);
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn a_missing_index_keeps_no_run_from_its_store() {
    let (dir, _) = with_recording();
    let index = dir.path().join("store/index.sqlite");
    let lose = || {
        for ending in ["", "-wal", "-shm"] {
            let _ = fs::remove_file(format!("{}{ending}", index.display()));
        }
    };
    lose();
    let (procedure, limits, pass) = (procedure(), limits(), sample("pass"));
    let run = ["run", &procedure, &pass, "--limits", &limits, "--serial", "1", "--out", "again"];
    let said = sagnac(dir.path(), &[&run[..], &["--store", "store"]].concat());
    assert!(said.code == 0 && said.err.contains("the index was missing and has been rebuilt"), "{said:?}");
    assert_eq!(result(&dir.path().join("again"))["attempt"]["number"], 2);
    lose();
    // The log of an index that is gone belongs to no other.
    fs::write(dir.path().join("store/index.sqlite-wal"), [1_u8; 5000]).unwrap();
    let said = sagnac(dir.path(), &["history", "--store", "store"]);
    assert!(said.code == 0 && said.err.contains("rebuilt"), "{said:?}");
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn what_a_killed_init_leaves_is_finished() {
    let dir = tempfile::tempdir().unwrap();
    for folder in ["results", "statements", "pending"] {
        fs::create_dir_all(dir.path().join("store").join(folder)).unwrap();
    }
    fs::write(dir.path().join("store/index.sqlite"), "half").unwrap();
    store(dir.path(), &["init", "store"]);
    write_results(&dir.path().join("made"), 1);
    store(dir.path(), &["import", "store", "made"]);
    // What is not its own is left alone.
    fs::create_dir(dir.path().join("other")).unwrap();
    fs::write(dir.path().join("other/index.sqlite"), "of another program").unwrap();
    assert_eq!(store_says(dir.path(), &["init", "other"]).code, 2);
    assert_eq!(fs::read(dir.path().join("other/index.sqlite")).unwrap(), b"of another program");
}

#[test]
fn import_opens_nothing_but_the_files_of_results_and_keeps_signatures() {
    let dir = with_store();
    let at = |name: &str| dir.path().join(name);
    let (procedure, limits, pass) = (procedure(), limits(), sample("pass"));
    let run = |out: &str| {
        let args = ["run", &procedure, &pass, "--limits", &limits, "--serial", "1", "--out", out];
        assert_eq!(sagnac(dir.path(), &args).code, 0);
    };
    run("r");
    let refused = |name: &str, why: &str| {
        let said = store_says(dir.path(), &["import", "store", name]);
        assert!(
            said.code == 1 && said.err.contains(why) && said.out.contains("refused: 1"),
            "{name}: {said:?}"
        );
        assert!(kept(&at("store")).is_empty(), "{name}");
    };
    let record = fs::read_to_string(at("r/result.json")).unwrap();
    fs::write(at("r/result.json"), record.replace("\"verdict\": \"pass\"", "\"verdict\": \"fail\"")).unwrap();
    refused("r", "`result.json` contradicts SHA256SUMS");
    fs::write(at("r/result.json"), &record).unwrap();
    let page = fs::read(at("r/report.md")).unwrap();
    fs::write(at("r/report.md"), "other").unwrap();
    refused("r", "`report.md` contradicts SHA256SUMS");
    fs::remove_file(at("r/report.md")).unwrap();
    fs::write(at("secret"), &page).unwrap();
    symlink(at("secret"), at("r/report.md")).unwrap();
    refused("r", "report.md: not an ordinary file");
    fs::remove_file(at("r/report.md")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(at("r/report.md")).status().unwrap().success());
    refused("r", "report.md: not an ordinary file");
    fs::remove_file(at("r/report.md")).unwrap();
    fs::write(at("r/report.md"), &page).unwrap();
    // A folder that leads out of itself.
    fs::rename(at("r/figures"), at("figures")).unwrap();
    symlink(at("figures"), at("r/figures")).unwrap();
    refused("r", "not an ordinary file");
    fs::remove_file(at("r/figures")).unwrap();
    fs::rename(at("figures"), at("r/figures")).unwrap();

    store(dir.path(), &["import", "store", "r"]);
    let (address, folder) = kept(&at("store")).remove(0);
    assert!(!folder.join("signatures").exists());
    crate::documents::signing::key(dir.path(), "anna", 1);
    assert_eq!(sagnac(dir.path(), &["sign", "r", "--key", "anna"]).code, 0);
    let said = store(dir.path(), &["import", "store", "r"]);
    assert!(said.out.contains("Added: 0; there already: 1"), "{said:?}");
    assert_eq!(kept(&at("store")).len(), 1, "a signature is no other attempt");
    assert!(files(&folder.join("signatures")) == files(&at("r/signatures")));
    let stored = folder.display().to_string();
    let said = sagnac(dir.path(), &["verify", &stored]);
    assert!(said.code == 0 && said.out.contains("01-tested.json"), "{said:?}");
    // Into another store with its signatures at once, under the same address.
    store(dir.path(), &["init", "other"]);
    store(dir.path(), &["import", "other", "r"]);
    assert_eq!(kept(&at("other"))[0].0, address);
    assert_eq!(names(&kept(&at("other"))[0].1.join("signatures")).len(), 2);
    for name in ["store", "other"] {
        store(dir.path(), &["verify", name]);
    }
    // Other signatures of the same result are not put over those that are there.
    fs::remove_dir_all(at("r/signatures")).unwrap();
    crate::documents::signing::key(dir.path(), "berta", 2);
    assert_eq!(sagnac(dir.path(), &["sign", "r", "--key", "berta"]).code, 0);
    let said = store_says(dir.path(), &["import", "store", "r"]);
    assert!(said.code == 1 && said.err.contains("other signatures"), "{said:?}");
}

/// What the program does with a disk that is full behind standard output.
fn with_full_output(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output =
        std::process::Command::new(program()).current_dir(folder).args(args).stdout(full).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[cfg(target_os = "linux")]
#[test]
fn what_could_not_be_said_is_no_success() {
    let (dir, _) = with_recording();
    write_result(dir.path(), "made", &a_result("2", "L", "2026-03-01T10:00:00Z", 0.5));
    let recording = sample("pass");
    for args in [
        &["--help"][..],
        &["--version"],
        &["effects"],
        &["inspect", &recording],
        &["verify", "r"],
        &["history", "--store", "store"],
        &["history", "--store", "store", "--format", "json"],
        &["store", "verify", "store"],
        &["store", "import", "store", "made"],
        &["report", "r", "--out", "anew"],
        &["analyze", &recording, "--format", "json", "--out", "a"],
        &["procedures", "show", "static-bias"],
        &["schema", "result"],
        &["completions", "bash"],
        &["man"],
    ] {
        let (code, err) = with_full_output(dir.path(), args);
        assert_eq!(code, Some(2), "{args:?}: {err}");
        assert!(err.contains("failed to write to standard output: No space left"), "{args:?}: {err}");
    }
}
