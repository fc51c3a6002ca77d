//! A store that something has happened to: each is named, and no result is lost.

use crate::store::{kept, store, store_says, with_store, write_results};
use crate::support::shared::tested_once;
use crate::support::{Said, files, program, result};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A store with results of three units.
fn filled() -> tempfile::TempDir {
    let dir = with_store();
    write_results(&dir.path().join("made"), 3);
    store(dir.path(), &["import", "store", "made"]);
    dir
}

/// What the store answers: every measurand of every result.
fn answer(folder: &Path) -> Vec<u8> {
    store(folder, &["export", "store", "--out", "answer.parquet", "--force"]);
    let bytes = fs::read(folder.join("answer.parquet")).unwrap();
    fs::remove_file(folder.join("answer.parquet")).unwrap();
    bytes
}

#[test]
fn the_index_made_anew_gives_the_same_answers() {
    let dir = filled();
    let addresses: Vec<String> = kept(&dir.path().join("store")).into_iter().map(|k| k.0).collect();
    store(dir.path(), &["supersede", "store", &addresses[0], "--by", &addresses[1], "--reason", "r"]);
    let before = answer(dir.path());
    let said = store(dir.path(), &["rebuild", "store"]);
    assert!(said.out.contains("Results: 6; statements: 1"), "{}", said.out);
    assert!(answer(dir.path()) == before);
    fs::remove_file(dir.path().join("store/index.sqlite")).unwrap();
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.code == 2 && said.err.contains("index is missing"), "{said:?}");
    store(dir.path(), &["rebuild", "store"]);
    assert!(answer(dir.path()) == before);
}

#[test]
fn a_changed_byte_is_found() {
    let dir = filled();
    let addresses = kept(&dir.path().join("store"));
    store(dir.path(), &["supersede", "store", &addresses[0].0, "--by", &addresses[1].0, "--reason", "r"]);
    let file = addresses[2].1.join("result.json");
    let sound = fs::read(&file).unwrap();
    let mut changed = sound.clone();
    *changed.last_mut().unwrap() ^= 1;
    fs::write(&file, &changed).unwrap();
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.code == 1 && said.err.contains(&addresses[2].0), "{said:?}");
    fs::write(&file, &sound).unwrap();
    fs::write(addresses[2].1.join("report.md"), "more").unwrap();
    assert_eq!(store_says(dir.path(), &["verify", "store"]).code, 1, "a file more");
    fs::remove_file(addresses[2].1.join("report.md")).unwrap();
    store(dir.path(), &["verify", "store"]);
    fs::remove_dir_all(&addresses[2].1).unwrap();
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.code == 1 && said.err.contains("folder is missing"), "{said:?}");
    let statement =
        fs::read_dir(dir.path().join("store/statements")).unwrap().next().unwrap().unwrap().path();
    let text = fs::read_to_string(&statement).unwrap();
    fs::write(&statement, text.replace("\"r\"", "\"x\"")).unwrap();
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.err.contains("statement has been changed"), "{said:?}");
}

#[test]
fn a_cut_index_is_named_and_made_anew() {
    let dir = filled();
    let before = answer(dir.path());
    let index = dir.path().join("store/index.sqlite");
    let whole = fs::read(&index).unwrap();
    for length in [0, 50, 100, 4096, whole.len() / 2, whole.len() - 1] {
        fs::write(&index, &whole[..length]).unwrap();
        for said in [
            store_says(dir.path(), &["verify", "store"]),
            store_says(dir.path(), &["import", "store", "made"]),
        ] {
            assert!(said.code == 2 && said.err.contains("index is damaged"), "{length}: {said:?}");
            assert_eq!(said.err.lines().count(), 1, "{length}: {said:?}");
        }
        store(dir.path(), &["rebuild", "store"]);
        assert!(answer(dir.path()) == before, "{length}");
        fs::write(&index, &whole).unwrap();
    }
    // Damage within.
    let mut holed = whole.clone();
    holed[4096..12288].fill(0xA5);
    fs::write(&index, &holed).unwrap();
    let said = store_says(dir.path(), &["verify", "store"]);
    assert!(said.code == 2 && said.err.contains("index is damaged"), "{said:?}");
}

#[test]
fn what_a_later_program_made_is_refused_by_name() {
    let dir = filled();
    let index = dir.path().join("store/index.sqlite");
    let mut bytes = fs::read(&index).unwrap();
    // The version of the user's tables in the header of the database.
    bytes[60..64].copy_from_slice(&99_u32.to_be_bytes());
    fs::write(&index, &bytes).unwrap();
    let said = store_says(dir.path(), &["import", "store", "made"]);
    assert!(said.code == 2 && said.err.contains("version 99"), "{said:?}");
    assert!(fs::read(&index).unwrap() == bytes, "it stays as it is");
    fs::write(dir.path().join("store/store.json"), "{\"format\": \"store/2\"}").unwrap();
    let said = store_says(dir.path(), &["rebuild", "store"]);
    assert!(said.code == 2 && said.err.contains("`store/2`"), "{said:?}");
}

#[test]
fn a_store_is_made_in_an_empty_folder_only() {
    let dir = filled();
    let before = files(&dir.path().join("store"));
    let said = store_says(dir.path(), &["init", "store"]);
    assert!(said.code == 2 && said.err.contains("not empty"), "{said:?}");
    assert!(files(&dir.path().join("store")) == before);
    let said = store_says(dir.path(), &["verify", "made"]);
    assert!(said.code == 2 && said.err.contains("no store"), "{said:?}");
}

/// Runs the program as somebody whom the rights of files bind.
#[cfg(unix)]
fn as_nobody(folder: &Path, args: &[&str]) -> Said {
    use std::os::unix::process::CommandExt;
    let mut command = Command::new(program());
    command.current_dir(folder).args(args).env("HOME", folder);
    if Command::new("id").arg("-u").output().unwrap().stdout == b"0\n" {
        command.uid(65534);
    }
    let output = command.output().unwrap();
    Said {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

#[cfg(unix)]
#[test]
fn a_store_that_cannot_be_written_answers_and_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let dir = filled();
    let before = answer(dir.path());
    let rights = |mode: u32| {
        for (path, _) in files(dir.path()) {
            fs::set_permissions(dir.path().join(&path), PermissionsExt::from_mode(0o444)).unwrap();
            for folder in path.ancestors().skip(1) {
                fs::set_permissions(dir.path().join(folder), PermissionsExt::from_mode(mode)).unwrap();
            }
        }
        let pending = dir.path().join("store/pending");
        fs::set_permissions(pending, PermissionsExt::from_mode(mode)).unwrap();
    };
    let out = tempfile::tempdir().unwrap();
    fs::set_permissions(out.path(), PermissionsExt::from_mode(0o777)).unwrap();
    let place = out.path().join("answer.parquet").display().to_string();
    let log = dir.path().join("store/index.sqlite-wal");
    for unsettled in [false, true] {
        if unsettled {
            // A log that only a writer could put into the index: the folders tell what is there.
            fs::write(&log, [0_u8; 64]).unwrap();
        }
        rights(0o555);
        let said = as_nobody(dir.path(), &["store", "export", "store", "--out", &place, "--force"]);
        assert!(said.code == 0 && said.err.contains("cannot be written"), "{unsettled}: {said:?}");
        assert!(fs::read(&place).unwrap() == before, "{unsettled}");
        let said = as_nobody(dir.path(), &["store", "import", "store", "made"]);
        assert!(said.code == 2 && said.err.contains("the store cannot be written"), "{said:?}");
        assert_eq!(said.err.lines().count(), 1, "{said:?}");
        rights(0o755);
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_store_as_it_was_and_the_result_beside_it() {
    let dir = filled();
    let before = answer(dir.path());
    let there = kept(&dir.path().join("store"));
    // A limit on the size of files stands for a full disk. The result is made before, and only its copy is too large.
    tested_once("pass").copy_to(&dir.path().join("r"));
    let output = Command::new("sh")
        .current_dir(dir.path())
        .args([
            "-c",
            "trap '' XFSZ; ulimit -f 256; exec \"$0\" \"$@\"",
            program(),
            "store",
            "import",
            "store",
            "r",
        ])
        .output()
        .unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert!(err.starts_with("error: failed to write") && err.lines().count() == 1, "{err}");
    assert_eq!(kept(&dir.path().join("store")), there);
    assert!(answer(dir.path()) == before);
    assert_eq!(result(&dir.path().join("r"))["verdict"], "pass");
    store(dir.path(), &["import", "store", "r"]);
    assert_eq!(kept(&dir.path().join("store")).len(), there.len() + 1);
}
